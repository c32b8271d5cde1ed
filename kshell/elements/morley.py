"""The Morley triangle: quadratics fixed by vertex values and mid-edge normal derivatives.

Source: L. S. D. Morley, Aeronautical Quarterly 19 (1968) 149-169.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.elements.affine import AffineTriangles
from kshell.elements.base import PlateElement
from kshell.elements.reference import VERTICES, DualBasis, monomials
from kshell.mesh.mesh import EDGE_VERTICES

Floats = NDArray[np.float64]

# normals of the reference edges, (0, -1), (1, 1), (1, 0): each edge vector turned by -90 degrees
REFERENCE_EDGES = VERTICES[EDGE_VERTICES[:, 1]] - VERTICES[EDGE_VERTICES[:, 0]]
REFERENCE_NORMALS = np.stack([REFERENCE_EDGES[:, 1], -REFERENCE_EDGES[:, 0]], axis=-1)
REFERENCE_MIDPOINTS = VERTICES[EDGE_VERTICES].mean(axis=1)


def midpoint_normal_functionals(degree: int) -> Floats:
    """(edge, monomial) derivative along the reference normals at the edge midpoints."""
    gradient = np.stack([monomials(degree, REFERENCE_MIDPOINTS, p) for p in ((1, 0), (0, 1))], axis=1)
    return np.einsum("kx,kxm->km", REFERENCE_NORMALS, gradient)


def normal_components(triangles: AffineTriangles) -> tuple[Floats, Floats]:
    """How the mapped reference normals split into the normal and tangent of each edge.

    Returns
    -------
    along_normal, along_tangent : (triangle, edge) arrays
        J n_ref = along_normal n + along_tangent t.
    """
    j, n = triangles.jacobian, triangles.normals
    mapped = np.empty_like(n)  # J n_ref: (triangle, edge, 2)
    mapped[:, 0], mapped[:, 1], mapped[:, 2] = -j[:, :, 1], j[:, :, 0] + j[:, :, 1], j[:, :, 0]
    along_normal = mapped[..., 0] * n[..., 0] + mapped[..., 1] * n[..., 1]
    # t is n turned by 90 degrees
    return along_normal, mapped[..., 1] * n[..., 0] - mapped[..., 0] * n[..., 1]


class ElementMorley(PlateElement):
    """Morley triangle. Degrees of freedom: w at the vertices, w_n at the edge midpoints."""

    nodal_dofs = 1
    facet_dofs = 1
    maxdeg = 2
    dofnames = ("u", "u_n")
    doflocs = np.concatenate([VERTICES, REFERENCE_MIDPOINTS])

    basis = DualBasis(2, np.concatenate([monomials(2, VERTICES), midpoint_normal_functionals(2)]))
    vertex_powers = (0,)
    edge_powers = (1,)

    def _transformation(self, triangles: AffineTriangles) -> Floats:
        """M: the tangential derivative at a midpoint of a quadratic is the difference quotient."""
        along_normal, along_tangent = normal_components(triangles)
        m = np.zeros((len(triangles), 6, 6))
        slope = along_tangent * triangles.sense / triangles.lengths
        for k, (a, b) in enumerate(EDGE_VERTICES):
            m[:, k, k] = 1.0
            m[:, 3 + k, 3 + k] = along_normal[:, k]
            m[:, 3 + k, a] = -slope[:, k]
            m[:, 3 + k, b] = slope[:, k]
        return m
