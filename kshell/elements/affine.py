"""Affine triangles in the plane: Jacobians, edge tangents and normals, maps of derivatives.

Only differences of coordinates enter, so nothing here depends on where the mesh lies.

Symbols
-------
J        columns are the edges (v1 - v0, v2 - v0) of a triangle: x = x_0 + J xi
t        unit tangent of an edge, from the lower to the higher vertex number
n        unit normal of an edge, t turned by -90 degrees; the same seen from both sides
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.mesh import EDGE_VERTICES, Mesh

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class AffineTriangles:
    """A batch of triangles.

    Attributes
    ----------
    corners : (triangle, 3, 2) array
        Vertex coordinates relative to any origin, best near the triangles.
    sense : (triangle, 3) array
        +1 where the local edge (a, b) of (0, 1), (1, 2), (0, 2) runs from the lower to the higher
        global vertex number, else -1.
    """

    corners: Floats
    sense: Floats
    transformations: dict[type, Floats] = field(default_factory=dict, init=False, repr=False)
    """What `PlateElement.transformation` found, by element."""

    @classmethod
    def of_mesh(cls, mesh: Mesh, triangles: NDArray[np.integer] | slice = slice(None)) -> AffineTriangles:
        """The triangles of a planar mesh, or some of them (indices or a slice)."""
        return cls.of_arrays(mesh.points[:, :2], mesh.triangles[triangles])

    @classmethod
    def of_arrays(cls, points: Floats, triangles: NDArray[np.integer]) -> AffineTriangles:
        """From vertex coordinates (vertex, 2) and vertex indices (triangle, 3)."""
        ends = triangles[:, EDGE_VERTICES]
        sense = np.where(ends[..., 0] < ends[..., 1], 1.0, -1.0)
        return cls(points[triangles], sense)

    def __len__(self) -> int:
        return len(self.corners)

    @cached_property
    def jacobian(self) -> Floats:
        """(triangle, 2, 2) J."""
        c = self.corners
        return np.ascontiguousarray(np.swapaxes(c[:, 1:] - c[:, :1], 1, 2))

    @cached_property
    def determinant(self) -> Floats:
        """(triangle,) det J, twice the signed area."""
        j = self.jacobian
        return j[:, 0, 0] * j[:, 1, 1] - j[:, 0, 1] * j[:, 1, 0]

    @cached_property
    def inverse(self) -> Floats:
        """(triangle, 2, 2) of d xi_a / d x_i: grad v = inverse^T grad_xi v."""
        j = self.jacobian
        out = np.empty_like(j)
        out[:, 0, 0], out[:, 0, 1] = j[:, 1, 1], -j[:, 0, 1]
        out[:, 1, 0], out[:, 1, 1] = -j[:, 1, 0], j[:, 0, 0]
        out /= self.determinant[:, None, None]
        return out

    @cached_property
    def edge_vectors(self) -> Floats:
        """(triangle, edge, 2) from the first to the second local vertex of each edge."""
        return self.corners[:, EDGE_VERTICES[:, 1]] - self.corners[:, EDGE_VERTICES[:, 0]]

    @cached_property
    def lengths(self) -> Floats:
        """(triangle, edge) edge lengths."""
        return np.hypot(self.edge_vectors[..., 0], self.edge_vectors[..., 1])

    @cached_property
    def tangents(self) -> Floats:
        """(triangle, edge, 2) t, from the lower to the higher global vertex."""
        return self.edge_vectors * (self.sense / self.lengths)[..., None]

    @cached_property
    def normals(self) -> Floats:
        """(triangle, edge, 2) n, t turned by -90 degrees."""
        t = self.tangents
        out = np.empty_like(t)
        out[..., 0], out[..., 1] = t[..., 1], -t[..., 0]
        return out

    def reference_coordinates(self, points: Floats) -> Floats:
        """xi of points (triangle, point, 2), given relative to the same origin as the corners."""
        return (points - self.corners[:, None, 0]) @ np.swapaxes(self.inverse, 1, 2)

    @cached_property
    def curvature_map(self) -> Floats:
        """(triangle, 3, 3) from (v_xi_xi, v_xi_eta, v_eta_eta) to (v_xx, v_yy, 2 v_xy)."""
        a, b = self.inverse[:, 0, 0], self.inverse[:, 0, 1]  # d xi / dx, d xi / dy
        c, d = self.inverse[:, 1, 0], self.inverse[:, 1, 1]  # d eta / dx, d eta / dy
        out = np.empty((len(self), 3, 3))
        out[:, 0, 0], out[:, 0, 1], out[:, 0, 2] = a * a, 2 * a * c, c * c
        out[:, 1, 0], out[:, 1, 1], out[:, 1, 2] = b * b, 2 * b * d, d * d
        out[:, 2, 0], out[:, 2, 1], out[:, 2, 2] = 2 * a * b, 2 * (a * d + b * c), 2 * c * d
        return out

    @cached_property
    def third_map(self) -> Floats:
        """(triangle, 4, 4) from third derivatives in xi, eta to (v_xxx, v_xxy, v_xyy, v_yyy)."""
        a, b = self.inverse[:, 0, 0], self.inverse[:, 0, 1]  # d xi / dx, d xi / dy
        c, d = self.inverse[:, 1, 0], self.inverse[:, 1, 1]  # d eta / dx, d eta / dy
        aa, ac, cc, bb, bd, dd = a * a, a * c, c * c, b * b, b * d, d * d
        out = np.empty((len(self), 4, 4))
        for row, columns in enumerate(
            (
                (aa * a, 3 * aa * c, 3 * a * cc, cc * c),
                (aa * b, aa * d + 2 * ac * b, cc * b + 2 * ac * d, cc * d),
                (bb * a, bb * c + 2 * bd * a, dd * a + 2 * bd * c, dd * c),
                (bb * b, 3 * bb * d, 3 * b * dd, dd * d),
            )
        ):
            for column, value in enumerate(columns):
                out[:, row, column] = value
        return out
