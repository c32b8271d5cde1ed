"""Vertices made where a flat mesh has none: places of probes, of single loads and of supports."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.mesh import Mesh
from kshell.mesh.refine import bisect
from kshell.mesh.triangulation import EDGE_VERTICES

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

HERE = 1e-9  # distance from a vertex, in the size of the mesh, that is none
ON_LINE = 1e-9  # the same from a straight line
STRAIGHT = 1e-9  # sine of an angle that is none
TRIES = 8
BLUNT = 0.35  # of the smallest angle before, that must be left after a vertex has been moved


def with_vertices(mesh: Mesh, places: Floats) -> tuple[Mesh, list[int]]:
    """The mesh with a vertex at each place, where that can be.

    Triangles around a place are cut until a vertex near is free to be moved there: one inside, or one on a straight
    line that the place lies on, too.

    Parameters
    ----------
    mesh : Mesh
        Flat, of order 1, refined by bisection or ready for it.
    places : (n, 3) array

    Returns
    -------
    mesh : Mesh
    left : list of int
        Numbers of the places that have none.
    """
    kept: set[int] = set()
    left: list[int] = []
    for number, place in enumerate(places):
        found = _with_vertex(mesh, place, kept)
        if found is None:
            left.append(number)
            continue
        mesh, vertex = found
        kept.add(vertex)
    return mesh, left


def _with_vertex(mesh: Mesh, place: Floats, kept: set[int]) -> tuple[Mesh, int] | None:
    for _ in range(TRIES):
        distance = np.linalg.norm(mesh.points - place, axis=1)
        nearest = int(distance.argmin())
        if distance[nearest] <= HERE * mesh.size:
            return mesh, nearest
        at = _triangles_at(mesh, place)
        if not len(at):
            return None
        corners = np.unique(mesh.triangles[at])
        for vertex in corners[np.argsort(distance[corners])].tolist():
            if vertex not in kept:
                moved = _moved(mesh, vertex, place)
                if moved is not None:
                    return moved, vertex
        mesh = bisect(mesh, at).mesh
    return None


def _triangles_at(mesh: Mesh, place: Floats) -> Ints:
    x = mesh.points[mesh.triangles][:, :, :2]
    a, b = x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]
    d = place[:2] - x[:, 0]
    twice = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    u = (d[:, 0] * b[:, 1] - d[:, 1] * b[:, 0]) / twice
    v = (a[:, 0] * d[:, 1] - a[:, 1] * d[:, 0]) / twice
    return np.flatnonzero(np.minimum(np.minimum(u, v), 1 - u - v) >= -HERE)


def _moved(mesh: Mesh, vertex: int, place: Floats) -> Mesh | None:
    """The mesh with a vertex moved to a place, if that changes no line and leaves good triangles."""
    if any(group.dimension == 0 and vertex in group.members for group in mesh.groups.values()):
        return None
    around = np.flatnonzero((mesh.triangles == vertex).any(axis=1))
    edges = np.unique(mesh.triangle_edges[around])
    edges = edges[(mesh.edges[edges] == vertex).any(axis=1)]
    lines = [edge for edge in edges.tolist() if _belongs(mesh, edge)]
    if lines:
        if len(lines) != 2 or _belongs(mesh, lines[0]) != _belongs(mesh, lines[1]):
            return None
        ends = mesh.points[mesh.edges[lines]].reshape(-1, 3)
        one, other = (x for x in ends if np.linalg.norm(x - mesh.points[vertex]) > 0.0)
        along, length = other - one, float(np.linalg.norm(other - one))
        for x in (mesh.points[vertex], place):
            if np.linalg.norm(np.cross(along, x - one)) > STRAIGHT * length**2:
                return None
        if not 0.0 < float((place - one) @ along) < length**2:
            return None
    points = mesh.points.copy()
    before = _smallest_angle(points[mesh.triangles[around]])
    points[vertex, :2] = place[:2]
    if _smallest_angle(points[mesh.triangles[around]]) < BLUNT * before:
        return None
    return replace(mesh, points=points)


def _belongs(mesh: Mesh, edge: int) -> tuple[str, ...]:
    """Names of what an edge bounds or belongs to: curve groups, the border, borders of surface groups."""
    out = [name for name, group in mesh.groups.items() if group.dimension == 1 and edge in group.members]
    beside = np.flatnonzero((mesh.triangle_edges == edge).any(axis=1))
    if len(beside) == 1:
        out.append("border of the mesh")
    for name, group in mesh.groups.items():
        if group.dimension == 2 and len(beside) == 2 and np.isin(beside, group.members).sum() == 1:
            out.append(name)
    return tuple(out)


def _smallest_angle(x: Floats) -> float:
    """Over triangles (n, 3, 3) in the plane; negative for those turned over."""
    out = np.inf
    for i, j in EDGE_VERTICES:
        k = 3 - i - j
        a, b = x[:, i, :2] - x[:, k, :2], x[:, j, :2] - x[:, k, :2]
        sense = 1.0 if (k + 1) % 3 == i else -1.0
        twice = sense * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
        out = min(out, float(np.arctan2(twice, (a * b).sum(axis=1)).min()))
    return out
