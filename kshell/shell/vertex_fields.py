"""Values of a solved shell at the vertices of its mesh.

They are means over the triangles around a vertex, by their angles, within each patch that is smooth, taken as
tensors in space, because frames of neighbours differ. Where patches meet, at folds and branches and where the section
or moments jump, the vertex has a row for each (`kshell.result.rows`).

Shear forces Q = P div_s M follow from the moments of each triangle as tensors in space, g^a . M,a projected on the
tangent plane, which is M_ij|j. Moments of order 1 are constant in each triangle and say nothing of them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.energy import in_blocks
from kshell.material.section import BOTTOM, MIDDLE, TOP, Section
from kshell.material.tensors import principal, von_mises
from kshell.mesh.mesh import Mesh
from kshell.result.deferred import Deferred
from kshell.result.rows import Rows
from kshell.shell.frames import frames_of_normals, in_frame, in_space
from kshell.shell.means import patch_means
from kshell.shell.reference import VERTICES, first_derivatives, lattice
from kshell.shell.resultants import Resultants
from kshell.shell.vectors import cross, dot

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

Left = Callable[[int, Ints, Floats], Floats]

FACES = ("bottom", "middle", "top")
FEW = 0.25  # of the triangles, around some vertices, that are worth looking at by themselves
BLOCK = (
    2048  # triangles looked at together; what is found on the way takes ten times the room of what is kept
)
DEGREE = 4  # of the polynomials through which moments inside a triangle are differentiated
SYMMETRIC = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])  # places of xx yy zz yz xz xy in the full tensor


@dataclass(frozen=True)
class Recovered:
    """What a solution is at reference points of triangles.

    Attributes
    ----------
    recovery : of the discretisation
        With `resultants(points, triangles)` and `displacement(points, triangles)`.
    section : kshell.material.section.Section
    offset : (triangle,)
        Of the middle of the material above the mesh.
    left : function, optional
        Stress that layers keep without resultant (triangle, point, 3) at a face, of triangles, at points in space.
    """

    recovery: Any
    section: Section
    offset: Floats
    left: Left | None = None

    def tensors(self, points: Floats, triangles: Ints) -> tuple[Resultants, dict[str, Floats]]:
        """Resultants, and N, M and stresses (triangle, point, 3) by name, at reference points."""
        found = self.recovery.resultants(points, triangles)
        out = {
            "membrane_force": found.membrane_force,
            "membrane_stress_resultant": found.membrane_stress_resultant,
            "moment": found.moment,
        }
        if self.section.has_stress:
            middle = self.offset[triangles][:, None]
            for face, side in zip(FACES, (BOTTOM, MIDDLE, TOP), strict=True):
                left = None if self.left is None else self.left(side, triangles, found.position)
                out[f"stress_{face}"] = found.stress(
                    *self.section.stress(side, triangles, found.position), middle, left
                )
        return found, out

    def shear(self, points: Floats, triangles: Ints) -> Floats:
        """Q as vectors in space (triangle, point, 3), at reference points, from the moments inside each triangle."""
        parts = [self._shear(points, triangles[some]) for some in in_blocks(len(triangles), BLOCK)]
        return np.concatenate(parts) if parts else np.zeros((0, len(points), 3))

    def _shear(self, points: Floats, triangles: Ints) -> Floats:
        found = self.recovery.resultants(lattice(DEGREE), triangles)
        slopes = first_derivatives(DEGREE, points)
        moment = in_space(found.moment, found.axes)[..., SYMMETRIC]  # (triangle, node, 3, 3)
        tangents = np.einsum("aqn,tnx->axtq", slopes, found.position)
        normal = cross(tangents[0], tangents[1])
        square = dot(normal, normal)
        reciprocal = np.stack([cross(tangents[1], normal), cross(normal, tangents[0])]) / square
        force = np.einsum("aqn,tnij,ajtq->itq", slopes, moment, reciprocal, optimize=True)
        force = force - normal * (dot(normal, force) / square)
        return np.moveaxis(force, 0, 2)

    def displacement(self, points: Floats, triangles: Ints) -> tuple[Floats, Floats]:
        """Displacement and rotation (triangle, point, 3)."""
        u, rotation = self.recovery.displacement(points, triangles)
        return u, rotation


class CornerMeans:
    """Values at corners of some triangles, averaged over the triangles around each vertex.

    Parameters
    ----------
    recovered : Recovered
    triangles : (triangle,) int array
        Increasing. At a vertex around which some are missing the means are not those of the shell.
    vertices, corner_angles : (triangle, 3)
        Of these triangles.
    patches : (triangle,) int array
        Of these triangles.
    """

    def __init__(
        self, recovered: Recovered, triangles: Ints, vertices: Ints, corner_angles: Floats, patches: Ints
    ) -> None:
        self.recovered, self.triangles, self.vertices = recovered, triangles, vertices
        self.corner_angles, self.patches = corner_angles, patches

    @cached_property
    def corners(self) -> tuple[dict[str, Floats], Floats]:
        """Averaged values (triangle, 3, ...) at the corners by name, and the frames there (triangle, 3, 3, 3)."""
        names: list[str] = []
        parts = []
        for some in in_blocks(len(self.triangles), BLOCK):
            found, tensors = self.recovered.tensors(VERTICES, self.triangles[some])
            names = list(tensors)
            spatial = [in_space(tensors[name], found.axes) for name in names]
            parts.append(np.concatenate([*spatial, found.axes[..., 2, :]], axis=-1))
        means = self._average(np.concatenate(parts), self.patches)
        frame = frames_of_normals(means[..., -3:])
        out = {name: in_frame(means[..., 6 * k : 6 * k + 6], frame) for k, name in enumerate(names)}
        return out, frame

    def _average(self, values: Floats, patches: Ints) -> Floats:
        return patch_means(self.vertices, self.corner_angles, values, patches)

    @cached_property
    def motion(self) -> tuple[Floats, Floats]:
        """Displacement and rotation at the corners of triangles (triangle, 3, 3)."""
        return self.recovered.displacement(VERTICES, self.triangles)

    @cached_property
    def rotation(self) -> Floats:
        """(triangle, 3, 3) at the corners, the mean of the triangles around the vertex."""
        return self._average(self.motion[1], np.zeros(len(self.triangles), dtype=np.int64))

    @cached_property
    def shear(self) -> Floats:
        """(triangle, 3, 2) shear forces at the corners, means of the patch, in the frames of `corners`."""
        shear = self.recovered.shear(VERTICES, self.triangles)
        return np.einsum("tcix,tcx->tci", self.corners[1][..., :2, :], self._average(shear, self.patches))


class VertexFields:
    """Fields at the vertices.

    Parameters
    ----------
    mesh : Mesh
        In space.
    recovered : Recovered
    patches : (triangle,) int array
        Smooth pieces, over which values are averaged.
    rows : Rows
        Of these pieces.
    corner_angles : (triangle, 3)
    """

    def __init__(
        self, mesh: Mesh, recovered: Recovered, patches: Ints, rows: Rows, corner_angles: Floats
    ) -> None:
        self.mesh, self.recovered, self.patches, self.corner_angles = mesh, recovered, patches, corner_angles
        self.rows = rows

    @cached_property
    def every(self) -> CornerMeans:
        """The means at the corners of all triangles."""
        return self._means(np.arange(len(self.mesh.triangles)))

    def around(self, vertices: Ints) -> CornerMeans:
        """The means at some vertices: of the triangles around them alone where these are few, and not known anyway."""
        if "corners" not in self.every.__dict__:
            near = np.flatnonzero(np.isin(self.mesh.triangles, vertices).any(axis=1))
            if len(near) <= FEW * len(self.mesh.triangles):
                return self._means(near)
        return self.every

    def _means(self, triangles: Ints) -> CornerMeans:
        return CornerMeans(
            self.recovered,
            triangles,
            self.mesh.triangles[triangles],
            self.corner_angles[triangles],
            self.patches[triangles],
        )

    @cached_property
    def fields(self) -> Deferred[Floats]:
        """Fields at vertices, names as in `Result.fields`."""
        faces = FACES if self.recovered.section.has_stress else ()
        spatial = (
            "membrane_force",
            "membrane_stress_resultant",
            "moment",
            *(f"stress_{face}" for face in faces),
        )
        makers: dict[str, Callable[[], Floats]] = {
            "displacement": lambda: self._at_rows(self.every.motion[0]),
            "rotation": lambda: self._at_rows(self.every.rotation),
            **{name: partial(self._tensor, name) for name in spatial},
            **{f"von_mises_{face}": partial(self._von_mises, face) for face in faces},
            "principal_forces": lambda: principal(self._tensor("membrane_force")),
            "principal_moments": lambda: principal(self._tensor("moment")),
            "frame_axis_1": lambda: self._at_rows(self.every.corners[1])[:, 0],
            "normal": lambda: self._at_rows(self.every.corners[1])[:, 2],
        }
        if not self.recovered.recovery.constant_moments:
            makers["shear"] = lambda: self._at_rows(self.every.shear)
        return Deferred(makers)

    def _at_rows(self, values: Floats) -> Floats:
        """(row, ...) of values at corners (triangle, 3, ...) that are the same at all corners of a row."""
        out = np.zeros((len(self.rows.vertex), *values.shape[2:]))
        out[self.rows.corner] = values
        return out

    def _tensor(self, name: str) -> Floats:
        return self._at_rows(self.every.corners[0][name])

    def _von_mises(self, face: str) -> Floats:
        return von_mises(self._tensor(f"stress_{face}"))
