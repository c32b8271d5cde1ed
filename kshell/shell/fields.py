"""Displacements, membrane forces, moments and stresses of a solved shell at vertices, centroids and any point.

The frame of tensors is that of recovery.py: e_1 is the projection of the global x on the tangent plane (of y
where x is normal).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache, cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.material.section import Section
from kshell.material.tensors import von_mises
from kshell.mesh.closest import Locator, Nearest
from kshell.mesh.mesh import Mesh
from kshell.result.deferred import Deferred
from kshell.result.rows import Rows
from kshell.shell.resultants import Resultants
from kshell.shell.vertex_fields import FACES, Left, Recovered, VertexFields

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

CENTROID = np.array([[1 / 3, 1 / 3]])
MIDDLES = np.array([[0.5, 0.0], [0.5, 0.5], [0.0, 0.5]])  # of the edges (0, 1), (1, 2), (0, 2)
SAME = 1e-9  # stresses that differ by rounding
# points times triangles in whose values they are looked for at a time: many points in one triangle, or few in many
AT_A_TIME = 1024
AT_VERTEX = 1.0 - 1e-6  # barycentric coordinate from which a point counts as the vertex


class ShellFields:
    """Everything that can be read off a solution.

    Parameters
    ----------
    mesh : Mesh
        In space.
    recovery : of the discretisation
        With `resultants(points, triangles)` and `displacement(points, triangles)`.
    section : kshell.material.section.Section
    offset : (triangle,)
        Of the middle of the material above the mesh.
    patches : (triangle,) int array
        Smooth pieces, over which values are averaged.
    rows : Rows
        Of these pieces.
    corner_angles : (triangle, 3)
    find : function
        Points (n, 3) to the nearest ones of the mesh.
    left : function, optional
        As in `Recovered`.
    """

    def __init__(
        self,
        mesh: Mesh,
        recovery: Any,
        section: Section,
        offset: Floats,
        patches: Ints,
        rows: Rows,
        corner_angles: Floats,
        find: Callable[[Floats], Nearest],
        left: Left | None = None,
    ) -> None:
        self.mesh, self.recovery, self.find = mesh, recovery, find
        self._recovered = Recovered(recovery, section, offset, left)
        self._vertices = VertexFields(mesh, self._recovered, patches, rows, corner_angles)
        self._last: tuple[bytes, list[dict[str, Any]]] | None = None

    @property
    def vertex_fields(self) -> Deferred[Floats]:
        """Fields at vertices, names as in `Result.fields`."""
        return self._vertices.fields

    @property
    def has_sheets(self) -> bool:
        """Whether smooth pieces of the surface meet anywhere."""
        return self.rows.extra > 0

    @property
    def rows(self) -> Rows:
        """What the rows of `vertex_fields` belong to."""
        return self._vertices.rows

    @cached_property
    def edge_displacement(self) -> Floats:
        """(edge, 3) displacement of the middle of each edge."""
        owner, local = self.mesh.edge_owner.T
        u, _ = self._recovered.displacement(MIDDLES, np.arange(len(self.mesh.triangles)))
        return u[owner, local]

    @cached_property
    def cell_fields(self) -> Deferred[Floats]:
        """Values at the centroids of triangles."""
        every = np.arange(len(self.mesh.triangles))
        return Deferred(
            {
                "thickness": lambda: self._recovered.section.thickness(every, self._centroids[0].position)[
                    :, 0
                ],
                "membrane_force": lambda: self._centroids[1]["membrane_force"][:, 0],
                "membrane_stress_resultant": lambda: self._centroids[1]["membrane_stress_resultant"][:, 0],
                "moment": lambda: self._centroids[1]["moment"][:, 0],
                "frame_axis_1": lambda: self._centroids[0].axes[:, 0, 0],
                "normal": lambda: self._centroids[0].axes[:, 0, 2],
            }
        )

    @cached_property
    def _centroids(self) -> tuple[Resultants, dict[str, Floats]]:
        return self._recovered.tensors(CENTROID, np.arange(len(self.mesh.triangles)))

    def at(self, points: Floats) -> dict[str, Floats]:
        """Values at the points of the surface nearest to (n, 3) points, of the sheet of the largest stress.

        Returns
        -------
        dict
            x, u, rotation, N, M, membrane_stress_resultant, stress_top, stress_middle, stress_bottom, axis_1 and
            normal of the frame, each (n, 3), Q (n, 2) except of order 1, and distance (n,) to the point used.
        """
        found = self.find(np.asarray(points, dtype=float))
        shown: dict[int, dict[str, Any]] = {}
        if self.rows.extra:
            weights = np.concatenate([1 - found.xi.sum(axis=1, keepdims=True), found.xi], axis=1)
            for k in np.flatnonzero((weights <= 1 - AT_VERTEX).any(axis=1)).tolist():
                beside = self._beside(int(found.triangles[k]), found.xi[k])
                if len(beside) > 1:
                    shown[k] = self._shown(beside)
        if shown and len(shown) == len(found.triangles):
            return self._together(list(shown.values()), points)
        out = self._values(found.triangles, found.xi)
        for k, values in shown.items():
            for name, value in values.items():
                out[name][k] = value
        return {**out, "distance": np.linalg.norm(out["x"] - points, axis=1)}

    def sampled(self, xi: Floats) -> Deferred[Floats]:
        """Fields (triangle, point, k) at reference points (point, 2), as in `kshell.result.sampled`."""
        every = np.arange(len(self.mesh.triangles))

        @cache
        def forces() -> tuple[Resultants, dict[str, Floats]]:
            return self._recovered.tensors(xi, every)

        def tensor(name: str) -> Floats:
            return forces()[1][name]

        def shear() -> Floats:
            return np.einsum("tpax,tpx->tpa", forces()[0].axes[:, :, :2], self._recovered.shear(xi, every))

        faces = FACES if self._recovered.section.has_stress else ()
        tensors = (
            "moment",
            "membrane_force",
            "membrane_stress_resultant",
            *(f"stress_{face}" for face in faces),
        )
        makers: dict[str, Callable[[], Floats]] = {
            "position": lambda: forces()[0].position,
            "displacement": lambda: self._recovered.displacement(xi, every)[0],
            **{name: partial(tensor, name) for name in tensors},
            "shear": shear,
        }
        return Deferred(makers)

    def motion(self, points: Floats) -> Floats:
        """(n, 3) the displacement u of `at` alone."""
        found = self.find(np.asarray(points, dtype=float))
        parts = [
            self._recovered.displacement(xi[None], triangle[None])[0][0]
            for triangle, xi in zip(found.triangles, found.xi, strict=True)
        ]
        return np.concatenate([np.zeros((0, 3)), *parts])

    def on(self, points: Floats, group: str) -> dict[str, Floats]:
        """The values of `at` on the triangles of a surface group."""
        found = Locator.on(self.mesh, group, np.asarray(points, dtype=float))
        inside = set(self.mesh.groups[group].members.tolist())
        rows = []
        for t, xi in zip(found.triangles, found.xi, strict=True):
            beside = self._beside(int(t), xi)
            rows.append(self._shown([place for place in beside if place[0] in inside]))
        return self._together(rows, points)

    def sheets(self, point: Floats) -> dict[str, dict[str, Any]]:
        """Values of every sheet that meets at the point, by the names of their surface groups; empty where one is."""
        found = self.find(np.asarray(point, dtype=float)[None])
        beside = self._beside(int(found.triangles[0]), found.xi[0])
        if len(beside) < 2:
            return {}
        names = self.rows.names_of([triangle for triangle, _ in beside])
        return dict(zip(names, self._each(beside), strict=True))

    def _together(self, rows: list[dict[str, Any]], points: Floats) -> dict[str, Floats]:
        out = {name: np.array([row[name] for row in rows]) for name in rows[0]}
        out["distance"] = np.linalg.norm(out["x"] - points, axis=1)
        return out

    def _shown(self, beside: list[tuple[int, Floats]]) -> dict[str, Any]:
        """Values of the sheet with the largest stress, or where there are no stresses with the largest moment."""
        values = self._each(beside)
        tensors = [f"stress_{face}" for face in FACES if f"stress_{face}" in values[0]] or ["M"]
        size = [max(float(von_mises(each[name])) for name in tensors) for each in values]
        return values[int(np.argmax(np.array(size) > (1 - SAME) * max(size)))]

    def _beside(self, triangle: int, xi: Floats) -> list[tuple[int, Floats]]:
        """A triangle of each smooth piece at a place, the one found first, and its reference coordinates there."""
        if not self.rows.extra:
            return [(triangle, xi)]
        corners = self.mesh.triangles
        barycentric = np.array([1 - xi.sum(), *xi])
        near = corners[triangle][barycentric > 1 - AT_VERTEX]  # the vertex or the ends of the edge it lies on
        if len(near) == 3:
            return [(triangle, xi)]
        weights = barycentric[barycentric > 1 - AT_VERTEX]
        own = self.rows.patch_of_triangle
        sharing = np.flatnonzero(np.isin(corners, near).sum(axis=1) == len(near))
        _, first = np.unique(own[sharing], return_index=True)
        others = [int(t) for t in sharing[np.sort(first)] if own[t] != own[triangle]]
        out = [(triangle, xi)]
        for t in others:
            place = np.zeros(3)
            for vertex, weight in zip(near, weights, strict=True):
                place[corners[t] == vertex] = weight
            out.append((t, place[1:] / place.sum()))
        return out

    def _each(self, beside: list[tuple[int, Floats]]) -> list[dict[str, Any]]:
        """Values at some places; those of the last ones are kept, which are asked for twice."""
        triangles, xi = np.array([t for t, _ in beside]), np.array([at for _, at in beside])
        key = triangles.tobytes() + xi.tobytes()
        if self._last is None or self._last[0] != key:
            found = self._values(triangles, xi)
            each = [{name: part[k] for name, part in found.items()} for k in range(len(beside))]
            self._last = key, each
        return self._last[1]

    def _values(self, triangles: Ints, xi: Floats) -> dict[str, Floats]:
        """Values at one reference point (n, 2) in each of some triangles (n,)."""
        parts, order = [], np.argsort(triangles, kind="stable")
        for block in _blocks(triangles[order]):
            mine = order[block]
            some, which = np.unique(triangles[mine], return_inverse=True)
            pick = which, np.arange(len(mine))
            u, rotation = self._recovered.displacement(xi[mine], some)
            found, tensors = self._recovered.tensors(xi[mine], some)
            part = {"x": found.position[pick], "u": u[pick], "rotation": rotation[pick]}
            part |= {"M": tensors["moment"][pick], "N": tensors["membrane_force"][pick]}
            part |= {name: t[pick] for name, t in tensors.items() if name not in ("moment", "membrane_force")}
            frame = found.axes[pick]
            if not self.recovery.constant_moments:
                shear = self._recovered.shear(xi[mine], some)[pick]
                part["Q"] = np.einsum("nax,nx->na", frame[:, :2], shear)
            parts.append({**part, "axis_1": frame[:, 0], "normal": frame[:, 2]})
        back = np.argsort(order)
        out = {name: np.concatenate([part[name] for part in parts])[back] for name in parts[0]}
        out["triangle"] = np.array(triangles)
        barycentric = np.concatenate([1 - xi.sum(axis=1, keepdims=True), xi], axis=1)
        at_corner = np.flatnonzero(barycentric.max(axis=1) > AT_VERTEX)
        if len(at_corner):  # the mean of all triangles there is closer than the value of one
            corner = barycentric[at_corner].argmax(axis=1)
            known = self._vertices.around(self.mesh.triangles[triangles[at_corner], corner])
            place = np.searchsorted(known.triangles, triangles[at_corner]), corner
            corners, frames = known.corners
            means = {{"moment": "M", "membrane_force": "N"}.get(name, name): c for name, c in corners.items()}
            means |= {"rotation": known.rotation, "axis_1": frames[:, :, 0]}
            means |= {"normal": frames[:, :, 2]}
            if "Q" in out:
                means["Q"] = known.shear
            for name, mean in means.items():
                out[name][at_corner] = mean[place]
        return out


def _blocks(triangles: Ints) -> Iterator[slice]:
    """Slices of sorted triangles that are evaluated at a time, at the points of all of them."""
    start, n = 0, len(triangles)
    first = np.concatenate([[True], triangles[1:] != triangles[:-1]])
    different = np.cumsum(first)
    while start < n:
        count = np.arange(1, n - start + 1)[:AT_A_TIME]
        work = count * (different[start : start + len(count)] - different[start] + 1)
        end = start + max(int(np.searchsorted(work, AT_A_TIME, side="right")), 1)
        yield slice(start, end)
        start = end
