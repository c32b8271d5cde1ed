"""Displacements, membrane forces, moments and stresses of a solved shell at vertices, centroids and any point.

The frame of tensors is that of recovery.py: e_1 is the projection of the global x on the tangent plane (of y
where x is normal).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.material.section import Section
from kshell.mesh.closest import Nearest
from kshell.mesh.mesh import Mesh
from kshell.result.deferred import Deferred
from kshell.result.rows import Rows
from kshell.shell.resultants import Resultants
from kshell.shell.vertex_fields import Recovered, VertexFields

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

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
    offset : (triangle,)
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
        offset: Floats,
        patches: Ints,
        corner_angles: Floats,
        find: Callable[[Floats], Nearest],
    ) -> None:
        self.mesh, self.recovery, self.find = mesh, recovery, find
        self._recovered = Recovered(recovery, section, offset)
        self._vertices = VertexFields(mesh, self._recovered, patches, corner_angles)

    @property
    def vertex_fields(self) -> Deferred[Floats]:
        """Fields at vertices, names as in `Result.fields`."""
        return self._vertices.fields

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
        """Values at the points of the surface nearest to (n, 3) points.

        Returns
        -------
        dict
            x, u, rotation, N, M, membrane_stress_resultant, stress_top, stress_middle, stress_bottom, axis_1 and
            normal of the frame, each (n, 3), Q (n, 2) except of order 1, and distance (n,) to the point used.
        """
        found = self.find(np.asarray(points, dtype=float))
        rows = [self._at(int(t), xi) for t, xi in zip(found.triangles, found.xi, strict=True)]
        out = {name: np.array([row[name] for row in rows]) for name in rows[0]}
        out["distance"] = np.linalg.norm(out["x"] - points, axis=1)
        return out

    def _at(self, triangle: int, xi: Floats) -> dict[str, Floats]:
        one = np.array([triangle])
        u, rotation = self._recovered.displacement(xi[None], one)
        found, tensors = self._recovered.tensors(xi[None], one)
        values = {name: part[0, 0] for name, part in tensors.items()}
        frame = found.axes[0, 0]
        barycentric = np.array([1 - xi.sum(), *xi])
        corner = int(barycentric.argmax())
        at_corner = barycentric[corner] > AT_VERTEX
        if at_corner:  # the mean of all triangles there is closer than the value of one
            corners, frames = self._vertices.corners
            values = {name: part[triangle, corner] for name, part in corners.items()}
            frame = frames[triangle, corner]
            rotation = self._vertices.corner_rotation[triangle, corner][None, None]
        out = {"x": found.position[0, 0], "u": u[0, 0], "rotation": rotation[0, 0]}
        out |= {"M": values.pop("moment"), "N": values.pop("membrane_force"), **values}
        if not self.recovery.constant_moments:
            if at_corner:
                out["Q"] = self._vertices.corner_shear[triangle, corner]
            else:
                out["Q"] = frame[:2] @ self._recovered.shear(xi[None], one)[0, 0]
        return {**out, "axis_1": frame[0], "normal": frame[2]}
