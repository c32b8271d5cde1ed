"""Surfaces that touch: the triangles of a shell through its nodes, those of obstacles, and what is near or crosses."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

MISSING = 'contact needs the package ipctk: pip install "kshell[contact]"'


@dataclass(frozen=True)
class Body:
    """An obstacle as triangles.

    Attributes
    ----------
    name : str
    points : (n, 3)
        At the time 0.
    faces : (m, 3)
    displacement : function of the time
        (3,) since the time 0.
    """

    name: str
    points: Floats
    faces: Ints
    displacement: Callable[[float], Floats]


def library() -> Any:
    """ipctk, on one thread.

    Raises
    ------
    InputError
        If it is not installed.
    """
    try:
        import ipctk
    except ImportError:
        raise InputError(MISSING) from None
    ipctk.set_num_threads(1)
    ipctk.set_logger_level(ipctk.LoggerLevel.error)  # it would write among what is asked for on stdout
    return ipctk


class Surfaces:
    """The triangles of a shell and of obstacles.

    Parameters
    ----------
    points : (node, 3)
        Of the shell at rest; its first unknowns are their displacements.
    faces : (m, 3)
    bodies : sequence of Body
    of_itself : bool
    """

    def __init__(self, points: Floats, faces: Ints, bodies: Sequence[Body], of_itself: bool) -> None:
        self.ipc, self.count = library(), len(points)
        self.bodies = [replace(body, displacement=lru_cache(8)(body.displacement)) for body in bodies]
        places, parts = [points], [faces]
        self.ranges: dict[str, slice] = {}
        first = len(points)
        for body in bodies:
            places.append(body.points)
            parts.append(body.faces + first)
            self.ranges[body.name] = slice(first, first + len(body.points))
            first += len(body.points)
        self.rest = np.asfortranarray(np.concatenate(places))
        self.faces = np.asfortranarray(np.concatenate(parts).astype(np.int32))
        self.edges = np.asfortranarray(self.ipc.edges(self.faces))
        self.mesh = self.ipc.CollisionMesh(self.rest, self.edges, self.faces)
        allowed = self.ipc.make_static_obstacle_filter(self.count)
        if not of_itself:
            patch = np.concatenate([np.zeros(self.count), np.ones(first - self.count)]).astype(np.int32)
            allowed = allowed & self.ipc.make_vertex_patches_filter(patch)
        self.mesh.can_collide = allowed

    def at(self, x: Floats, time: float) -> Floats:
        """(point, 3) places of all points."""
        out = self.rest.copy(order="F")
        out[: self.count] += x[: 3 * self.count].reshape(-1, 3)
        for body in self.bodies:
            out[self.ranges[body.name]] += body.displacement(time)
        return np.asfortranarray(out)

    def travel(self, begin: float, end: float) -> Floats:
        """(body, 3) displacements of obstacles between two times."""
        moved = [body.displacement(end) - body.displacement(begin) for body in self.bodies]
        return np.array(moved).reshape(-1, 3)

    def collisions(self, places: Floats, distance: float, thickness: float) -> Any:
        """All pairs nearer than a distance beyond the thickness."""
        found = self.ipc.NormalCollisions()
        found.use_area_weighting = True
        found.build(self.mesh, places, distance, thickness)
        return found

    def gap(self, places: Floats, distance: float) -> float:
        """The smallest distance, if it is below the one given; that one otherwise."""
        found = self.collisions(places, distance, 0.0)
        return (
            distance if found.empty() else float(np.sqrt(found.compute_minimum_distance(self.mesh, places)))
        )

    def crossing(self, places: Floats) -> tuple[Floats, Floats] | None:
        """Centres of two triangles that intersect, None where none do."""
        if not self.ipc.has_intersections(self.mesh, places):
            return None
        broad = self.ipc.BruteForce() if len(self.faces) < 200 else self.ipc.HashGrid()
        broad.can_vertices_collide = self.mesh.can_collide
        broad.build(places, self.edges, self.faces, 0.0)
        for pair in broad.detect_edge_face_candidates():
            edge, face = self.edges[pair.edge_id], self.faces[pair.face_id]
            if set(edge) & set(face):
                continue
            if self.ipc.is_edge_intersecting_triangle(*places[edge], *places[face]):
                holder = next(k for k, corners in enumerate(self.faces) if set(edge) <= set(corners))
                return places[self.faces[holder]].mean(axis=0), places[face].mean(axis=0)
        return places[0], places[-1]

    def nearest(self, places: Floats, distance: float) -> tuple[Floats, Floats] | None:
        """Two places nearer to each other than a distance, of the nearest pair."""
        found = self.collisions(places, distance, 0.0)
        best, pair = np.inf, None
        for number in range(len(found)):
            one = found[number]
            ids = [k for k in one.vertex_ids(self.edges, self.faces) if k >= 0]
            size = one.compute_distance(places[ids].ravel())
            if size < best:
                half = 1 if len(ids) < 4 or found.is_face_vertex(number) else 2
                best, pair = size, (places[ids[:half]].mean(axis=0), places[ids[half:]].mean(axis=0))
        return pair
