"""Points on lines of discontinuity: the side whose values they get, and the others."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from kshell.material.tensors import von_mises
from kshell.mesh.closest import Locator
from kshell.plate.points import Located
from kshell.plate.sharing import ON_EDGE, Shared, along_edges, around

if TYPE_CHECKING:
    from kshell.plate.recovery import Fields

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SAME = 1e-9  # stresses that differ by rounding
DIFFERENT = 1e-4  # part of the largest moment by which moments on both sides of a line differ noticeably


class LinePoints:
    """Points of a plate across whose lines ``jump`` (edge,), if given, moments may jump."""

    def __init__(self, fields: Fields, jump: NDArray[np.bool_] | None) -> None:
        self.fields, self.domain = fields, fields.domain
        self._jump = jump if jump is not None and jump.any() else None

    @property
    def may_jump(self) -> bool:
        """Whether there are such lines."""
        return self._jump is not None

    def find(self, points: Floats) -> Located:
        """The triangles of points (n, 3) or (n, 2); on a line of discontinuity those of the side of larger stress."""
        found = self.fields.locator.find(np.asarray(points, dtype=float)[:, :2])
        for k in self._on_lines(found):
            sides = self.sides(found.triangles[k], found.xy[k])
            _, *stresses = self._forces_and_stresses(sides, found.xy[k])
            size = np.max([von_mises(stress) for stress in stresses], axis=0)
            found.triangles[k] = sides[int(np.argmax(size > (1 - SAME) * size.max()))]
            found.xi[k] = self.domain.affine(found.triangles[[k]]).reference_coordinates(found.xy[None, [k]])[
                0
            ]
        return found

    def _on_lines(self, found: Located) -> Ints:
        """Which points lie on a line of discontinuity, or on a vertex of one."""
        if self._jump is None:
            return np.zeros(0, dtype=np.int64)
        x, y = found.xi[:, 0].T
        at_edge = np.stack([y, 1 - x - y, x], axis=1) < ON_EDGE  # local edges (0, 1), (1, 2), (0, 2)
        edges = self.domain.mesh.triangle_edges[found.triangles]
        on_line = (self._jump[edges] & at_edge & ~np.isin(edges, self.domain.bent)).any(axis=1)
        return np.flatnonzero(on_line | ((at_edge.sum(axis=1) > 1) & self._at_vertex(found)))

    def both(self, found: Located) -> Shared:
        """Both triangles of points on edges across which nothing jumps."""
        return along_edges(self.domain, found, self._jump)

    def around(self, found: Located) -> Shared:
        """The same, and at vertices all triangles of the fan."""
        return around(self.domain, self.fields.layout.fans, found, self._jump)

    def _at_vertex(self, found: Located) -> NDArray[np.bool_]:
        """Whether any corner of the triangles has several fans."""
        several = np.bincount(self.fields.layout.fans.vertex) > 1
        return np.any(several[self.domain.mesh.triangles[found.triangles]], axis=1)

    def sides(self, triangle: int, xy: Floats) -> Ints:
        """The triangles that a point (2,) of one of them belongs to, within rounding, in order."""
        mesh = self.domain.mesh
        near = np.flatnonzero(np.isin(mesh.triangles, mesh.triangles[triangle]).any(axis=1))
        xi = self.domain.affine(near).reference_coordinates(np.broadcast_to(xy, (len(near), 1, 2)))[:, 0]
        depth = np.minimum(xi.min(axis=1), 1 - xi.sum(axis=1))
        return near[depth > -ON_EDGE]

    def _forces_and_stresses(self, triangles: Ints, xy: Floats) -> tuple[Floats, Floats, Floats]:
        """(n, 3) moments and stresses at the top and the bottom of some triangles at one point (2,)."""
        at = np.broadcast_to(xy, (len(triangles), 1, 2))
        xi = self.domain.affine(triangles).reference_coordinates(at)
        moment = self.fields.moment(triangles, xi, at)[:, 0]
        return moment, *self.fields.stresses(moment, triangles, at[:, 0])

    def differing_sides(self, points: Floats) -> list[tuple[int, Ints]]:
        """Which of some points (n, 3) lie where moments or stresses jump.

        Returns
        -------
        list of (point, triangles)
            The triangle whose values are used, then those whose values differ.
        """
        found = self.find(points)
        out = []
        for k in self._on_lines(found):
            sides = self.sides(found.triangles[k], found.xy[k])
            other = np.zeros(len(sides), dtype=bool)
            for values in self._forces_and_stresses(sides, found.xy[k]):
                own = values[sides == found.triangles[k]][0]
                other |= np.abs(values - own).max(axis=1) > DIFFERENT * np.abs(values).max()
            if other.any():
                out.append((int(k), np.concatenate([[found.triangles[k]], sides[other]])))
        return out

    def on(self, points: Floats, group: str) -> Located:
        """Points (n, 3) in the triangles of a surface group, or the nearest points of it."""
        members = np.asarray(self.domain.mesh.groups[group].members, dtype=np.int64)
        found = self.find(points)
        for k, point in enumerate(points):
            sides = np.intersect1d(self.sides(found.triangles[k], found.xy[k]), members)
            if not len(sides):
                corners = self.domain.points[self.domain.mesh.triangles[members]]
                flat = np.concatenate([corners, np.zeros((*corners.shape[:2], 1))], axis=2)
                nearest = Locator(flat).find(np.array([[point[0], point[1], 0.0]]))
                sides, found.xy[k] = members[nearest.triangles], nearest.x[0, :2]
                found.distance[k] = nearest.distance[0]
            self._move(found, k, int(sides[0]))
        return found

    def each_side(self, point: Floats) -> list[tuple[int, Located]]:
        """A triangle of each piece beside a point (3,) where moments or stresses jump, with the point in it."""
        out = []
        for _, triangles in self.differing_sides(point[None]):
            _, first = np.unique(self.fields.rows.patch_of_triangle[triangles], return_index=True)
            for triangle in triangles[np.sort(first)].tolist():
                found = self.find(point[None])
                self._move(found, 0, triangle)
                out.append((triangle, found))
        return out

    def _move(self, found: Located, k: int, triangle: int) -> None:
        found.triangles[k] = triangle
        affine = self.domain.affine(found.triangles[[k]])
        found.xi[k] = affine.reference_coordinates(found.xy[None, [k]])[0]
