"""Displacements, membrane forces, moments and stresses of a solved shell at vertices, centroids and any point.

The frame of tensors is that of recovery.py: e_1 is the projection of the global x on the tangent plane (of y
where x is normal). Vertex values are means over the triangles around, by their angles, within each patch that
is smooth. They are averaged as tensors in space, because frames of neighbours differ. Where patches meet, at
folds and branches, the vertex shows the patch with the largest stress.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.material.section import Section
from kshell.material.tensors import principal, von_mises
from kshell.mesh.closest import Nearest
from kshell.mesh.mesh import Mesh
from kshell.result.deferred import Deferred
from kshell.shell.frames import plane_tangents, tangent_frame
from kshell.shell.koiter.recovery import Resultants
from kshell.shell.reference import VERTICES

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

FACES = ("bottom", "middle", "top")
CENTROID = np.array([[1 / 3, 1 / 3]])
MIDDLES = np.array([[0.5, 0.0], [0.5, 0.5], [0.0, 0.5]])  # of the edges (0, 1), (1, 2), (0, 2)
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
    offset : float
        Of the middle of the material above the mesh.
    patches : (triangle,) int array
        Smooth pieces, over which values are averaged.
    corner_angles : (triangle, 3)
    find : function
        Points (n, 3) to the nearest ones of the mesh.
    """

    def __init__(
        self,
        mesh: Mesh,
        recovery: Any,
        section: Section,
        offset: float,
        patches: Ints,
        corner_angles: Floats,
        find: Callable[[Floats], Nearest],
    ) -> None:
        self.mesh, self.recovery, self.section, self.offset = mesh, recovery, section, offset
        self.patches, self.corner_angles, self.find = patches, corner_angles, find

    def tensors(self, points: Floats, triangles: Ints) -> tuple[Resultants, dict[str, Floats]]:
        """Resultants, and N, M and stresses (triangle, point, 3) by name, at reference points."""
        found = self.recovery.resultants(points, triangles)
        half = 0.5 * self.section.thickness(triangles, found.position)
        out = {"membrane_force": found.membrane_force, "moment": found.moment}
        for face, stiffness, side in zip(FACES, self.section.moduli, (-1.0, 0.0, 1.0), strict=True):
            out[f"stress_{face}"] = found.stress(stiffness, self.offset + side * half)
        return found, out

    @cached_property
    def _corners(self) -> tuple[dict[str, Floats], Floats]:
        """Averaged values (triangle, 3, ...) at the corners by name, and the frames there (triangle, 3, 3, 3)."""
        every = np.arange(len(self.mesh.triangles))
        found, tensors = self.tensors(VERTICES, every)
        names = list(tensors)
        spatial = [_in_space(tensors[name], found.axes) for name in names]
        columns = np.concatenate([*spatial, found.axes[..., 2, :]], axis=-1)
        means = self._average(columns, self.patches)
        frame = _frame(means[..., -3:])
        out = {name: _in_frame(means[..., 6 * k : 6 * k + 6], frame) for k, name in enumerate(names)}
        return out, frame

    def _average(self, values: Floats, patches: Ints) -> Floats:
        """Mean at the vertices of each patch of corner values (triangle, 3, n), for each corner."""
        key = patches.astype(np.int64)[:, None] * len(self.mesh.points) + self.mesh.triangles
        _, place = np.unique(key.ravel(), return_inverse=True)
        weight = self.corner_angles.ravel()
        total = np.bincount(place, weights=weight)
        flat = values.reshape(len(place), -1)
        means = np.stack([np.bincount(place, weights=weight * column) / total for column in flat.T], axis=1)
        return means[place].reshape(values.shape)

    @cached_property
    def vertex_fields(self) -> Deferred[Floats]:
        """Fields at vertices, names as in `Result.fields`."""
        spatial = ("membrane_force", "moment", *(f"stress_{face}" for face in FACES))
        makers: dict[str, Callable[[], Floats]] = {
            "displacement": lambda: self._vertex_displacement,
            "rotation": lambda: self._vertex_rotation,
            **{name: partial(self._vertex_tensor, name) for name in spatial},
            **{f"von_mises_{face}": partial(self._vertex_von_mises, face) for face in FACES},
            "principal_forces": lambda: principal(self._vertex_tensor("membrane_force")),
            "principal_moments": lambda: principal(self._vertex_tensor("moment")),
            "frame_axis_1": lambda: self._at_vertices(self._corners[1])[:, 0],
            "normal": lambda: self._at_vertices(self._corners[1])[:, 2],
        }
        return Deferred(makers)

    @cached_property
    def _motion(self) -> tuple[Floats, Floats]:
        """Displacement and rotation at the corners of triangles (triangle, 3, 3)."""
        return self.recovery.displacement(VERTICES, np.arange(len(self.mesh.triangles)))

    @cached_property
    def _vertex_displacement(self) -> Floats:
        """(vertex, 3); all triangles around a vertex share it."""
        out = np.zeros((len(self.mesh.points), 3))
        out[self.mesh.triangles] = self._motion[0]
        return out

    @cached_property
    def _vertex_rotation(self) -> Floats:
        one = np.zeros(len(self.mesh.triangles), dtype=np.int64)
        return self._at_vertices(self._average(self._motion[1], one))

    @cached_property
    def _corner_of_vertex(self) -> Ints:
        """(vertex,) the corner that is shown at each vertex: where patches meet that of the largest stress."""
        corners, _ = self._corners
        shown = np.max([von_mises(corners[f"stress_{face}"]) for face in FACES], axis=0).ravel()
        order = np.argsort(shown, kind="stable")
        corner = np.zeros(len(self.mesh.points), dtype=np.int64)
        corner[self.mesh.triangles.ravel()[order]] = order  # the largest comes last and stays
        return corner

    def _at_vertices(self, values: Floats) -> Floats:
        """(vertex, ...) of values at corners (triangle, 3, ...)."""
        return values.reshape(-1, *values.shape[2:])[self._corner_of_vertex]

    def _vertex_tensor(self, name: str) -> Floats:
        return self._at_vertices(self._corners[0][name])

    def _vertex_von_mises(self, face: str) -> Floats:
        return von_mises(self._vertex_tensor(f"stress_{face}"))

    @cached_property
    def edge_displacement(self) -> Floats:
        """(edge, 3) displacement of the middle of each edge."""
        owner, local = self.mesh.edge_owner.T
        u, _ = self.recovery.displacement(MIDDLES, np.arange(len(self.mesh.triangles)))
        return u[owner, local]

    @cached_property
    def cell_fields(self) -> Deferred[Floats]:
        """Values at the centroids of triangles."""
        every = np.arange(len(self.mesh.triangles))
        return Deferred(
            {
                "thickness": lambda: self.section.thickness(every, self._centroids[0].position)[:, 0],
                "membrane_force": lambda: self._centroids[1]["membrane_force"][:, 0],
                "moment": lambda: self._centroids[1]["moment"][:, 0],
                "frame_axis_1": lambda: self._centroids[0].axes[:, 0, 0],
                "normal": lambda: self._centroids[0].axes[:, 0, 2],
            }
        )

    @cached_property
    def _centroids(self) -> tuple[Resultants, dict[str, Floats]]:
        return self.tensors(CENTROID, np.arange(len(self.mesh.triangles)))

    def at(self, points: Floats) -> dict[str, Floats]:
        """Values at the points of the surface nearest to (n, 3) points.

        Returns
        -------
        dict
            x, u, rotation, N, M, stress_top, stress_middle, stress_bottom, axis_1 and normal of the frame, each
            (n, 3), and distance (n,) to the point used.
        """
        found = self.find(np.asarray(points, dtype=float))
        rows = [self._at(int(t), xi) for t, xi in zip(found.triangles, found.xi, strict=True)]
        out = {name: np.array([row[name] for row in rows]) for name in rows[0]}
        out["distance"] = np.linalg.norm(out["x"] - points, axis=1)
        return out

    def _at(self, triangle: int, xi: Floats) -> dict[str, Floats]:
        one = np.array([triangle])
        u, rotation = self.recovery.displacement(xi[None], one)
        found, tensors = self.tensors(xi[None], one)
        values = {name: part[0, 0] for name, part in tensors.items()}
        frame = found.axes[0, 0]
        barycentric = np.array([1 - xi.sum(), *xi])
        corner = int(barycentric.argmax())
        if barycentric[corner] > AT_VERTEX:  # the mean of all triangles there is closer than the value of one
            corners, frames = self._corners
            values = {name: part[triangle, corner] for name, part in corners.items()}
            frame = frames[triangle, corner]
            rotation = self.vertex_fields["rotation"][self.mesh.triangles[triangle, corner]][None, None]
        out = {"x": found.position[0, 0], "u": u[0, 0], "rotation": rotation[0, 0]}
        out |= {"M": values.pop("moment"), "N": values.pop("membrane_force"), **values}
        return {**out, "axis_1": frame[0], "normal": frame[2]}


def _in_space(tensor: Floats, axes: Floats) -> Floats:
    """Components xx yy zz yz xz xy (..., 6) in space of plane tensors (..., 3) in frames with rows e_1, e_2, n."""
    a, b = axes[..., 0, :], axes[..., 1, :]
    t11, t22, t12 = (tensor[..., k, None] for k in range(3))
    i, j = np.array([0, 1, 2, 1, 0, 0]), np.array([0, 1, 2, 2, 2, 1])
    return (
        t11 * a[..., i] * a[..., j]
        + t22 * b[..., i] * b[..., j]
        + t12 * (a[..., i] * b[..., j] + b[..., i] * a[..., j])
    )


def _in_frame(spatial: Floats, axes: Floats) -> Floats:
    """Components 11, 22, 12 (..., 3) in frames of tensors in space (..., 6)."""
    full = spatial[..., np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])]
    plane = axes[..., :2, :] @ full @ axes[..., :2, :].swapaxes(-1, -2)
    return np.stack([plane[..., 0, 0], plane[..., 1, 1], plane[..., 0, 1]], axis=-1)


def _frame(normal: Floats) -> Floats:
    """Frames (..., 3, 3), rows e_1, e_2, n, on planes with normals (..., 3) of any length."""
    n = np.moveaxis(normal / np.linalg.norm(normal, axis=-1, keepdims=True), -1, 0)
    return np.moveaxis(np.stack(tangent_frame(np.stack(plane_tangents(n)))), (0, 1), (-2, -1))
