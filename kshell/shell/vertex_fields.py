"""Values of a solved shell at the vertices of its mesh.

They are means over the triangles around a vertex, by their angles, within each patch that is smooth, taken as
tensors in space, because frames of neighbours differ. Where patches meet, at folds and branches, the vertex shows
the patch with the largest stress.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.material.section import Section
from kshell.material.tensors import principal, von_mises
from kshell.mesh.mesh import Mesh
from kshell.result.deferred import Deferred
from kshell.shell.frames import frames_of_normals, in_frame, in_space
from kshell.shell.reference import VERTICES
from kshell.shell.resultants import Resultants

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

FACES = ("bottom", "middle", "top")


@dataclass(frozen=True)
class Recovered:
    """What a solution is at reference points of triangles.

    Attributes
    ----------
    recovery : of the discretisation
        With `resultants(points, triangles)` and `displacement(points, triangles)`.
    section : kshell.material.section.Section
    offset : float
        Of the middle of the material above the mesh.
    """

    recovery: Any
    section: Section
    offset: float

    def tensors(self, points: Floats, triangles: Ints) -> tuple[Resultants, dict[str, Floats]]:
        """Resultants, and N, M and stresses (triangle, point, 3) by name, at reference points."""
        found = self.recovery.resultants(points, triangles)
        half = 0.5 * self.section.thickness(triangles, found.position)
        out = {"membrane_force": found.membrane_force, "moment": found.moment}
        for face, stiffness, side in zip(FACES, self.section.moduli, (-1.0, 0.0, 1.0), strict=True):
            out[f"stress_{face}"] = found.stress(stiffness, self.offset + side * half)
        return found, out

    def displacement(self, points: Floats, triangles: Ints) -> tuple[Floats, Floats]:
        """Displacement and rotation (triangle, point, 3)."""
        u, rotation = self.recovery.displacement(points, triangles)
        return u, rotation


class VertexFields:
    """Fields at the vertices.

    Parameters
    ----------
    mesh : Mesh
        In space.
    recovered : Recovered
    patches : (triangle,) int array
        Smooth pieces, over which values are averaged.
    corner_angles : (triangle, 3)
    """

    def __init__(self, mesh: Mesh, recovered: Recovered, patches: Ints, corner_angles: Floats) -> None:
        self.mesh, self.recovered, self.patches, self.corner_angles = mesh, recovered, patches, corner_angles

    @cached_property
    def corners(self) -> tuple[dict[str, Floats], Floats]:
        """Averaged values (triangle, 3, ...) at the corners by name, and the frames there (triangle, 3, 3, 3)."""
        every = np.arange(len(self.mesh.triangles))
        found, tensors = self.recovered.tensors(VERTICES, every)
        names = list(tensors)
        spatial = [in_space(tensors[name], found.axes) for name in names]
        columns = np.concatenate([*spatial, found.axes[..., 2, :]], axis=-1)
        means = self._average(columns, self.patches)
        frame = frames_of_normals(means[..., -3:])
        out = {name: in_frame(means[..., 6 * k : 6 * k + 6], frame) for k, name in enumerate(names)}
        return out, frame

    def _average(self, values: Floats, patches: Ints) -> Floats:
        return patch_means(self.mesh, self.corner_angles, values, patches)

    @cached_property
    def fields(self) -> Deferred[Floats]:
        """Fields at vertices, names as in `Result.fields`."""
        spatial = ("membrane_force", "moment", *(f"stress_{face}" for face in FACES))
        makers: dict[str, Callable[[], Floats]] = {
            "displacement": lambda: self.displacement,
            "rotation": lambda: self.rotation,
            **{name: partial(self._tensor, name) for name in spatial},
            **{f"von_mises_{face}": partial(self._von_mises, face) for face in FACES},
            "principal_forces": lambda: principal(self._tensor("membrane_force")),
            "principal_moments": lambda: principal(self._tensor("moment")),
            "frame_axis_1": lambda: self._at_vertices(self.corners[1])[:, 0],
            "normal": lambda: self._at_vertices(self.corners[1])[:, 2],
        }
        return Deferred(makers)

    @cached_property
    def _motion(self) -> tuple[Floats, Floats]:
        """Displacement and rotation at the corners of triangles (triangle, 3, 3)."""
        return self.recovered.displacement(VERTICES, np.arange(len(self.mesh.triangles)))

    @cached_property
    def displacement(self) -> Floats:
        """(vertex, 3); all triangles around a vertex share it."""
        out = np.zeros((len(self.mesh.points), 3))
        out[self.mesh.triangles] = self._motion[0]
        return out

    @cached_property
    def rotation(self) -> Floats:
        """(vertex, 3), the mean of the triangles around."""
        one = np.zeros(len(self.mesh.triangles), dtype=np.int64)
        return self._at_vertices(self._average(self._motion[1], one))

    @cached_property
    def _corner_of_vertex(self) -> Ints:
        """(vertex,) the corner that is shown at each vertex: where patches meet that of the largest stress."""
        corners, _ = self.corners
        shown = np.max([von_mises(corners[f"stress_{face}"]) for face in FACES], axis=0).ravel()
        order = np.argsort(shown, kind="stable")
        corner = np.zeros(len(self.mesh.points), dtype=np.int64)
        corner[self.mesh.triangles.ravel()[order]] = order  # the largest comes last and stays
        return corner

    def _at_vertices(self, values: Floats) -> Floats:
        """(vertex, ...) of values at corners (triangle, 3, ...)."""
        return values.reshape(-1, *values.shape[2:])[self._corner_of_vertex]

    def _tensor(self, name: str) -> Floats:
        return self._at_vertices(self.corners[0][name])

    def _von_mises(self, face: str) -> Floats:
        return von_mises(self._tensor(f"stress_{face}"))


def patch_means(mesh: Mesh, corner_angles: Floats, values: Floats, patches: Ints) -> Floats:
    """Mean of corner values at each vertex of each patch, by the angles of the triangles.

    Parameters
    ----------
    corner_angles : (triangle, 3)
    values : (triangle, 3, n)
        At the corners.
    patches : (triangle,)

    Returns
    -------
    (triangle, 3, n), the mean at each corner.
    """
    key = patches.astype(np.int64)[:, None] * len(mesh.points) + mesh.triangles
    _, place = np.unique(key.ravel(), return_inverse=True)
    weight = corner_angles.ravel()
    total = np.bincount(place, weights=weight)
    flat = values.reshape(len(place), -1)
    means = np.stack([np.bincount(place, weights=weight * column) / total for column in flat.T], axis=1)
    return means[place].reshape(values.shape)
