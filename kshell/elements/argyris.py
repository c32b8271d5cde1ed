"""The Argyris triangle: quintics, continuously differentiable across edges.

Source: J. H. Argyris, I. Fried, D. W. Scharpf, Aeronautical Journal 72 (1968) 701-709;
transformation after Dominguez & Sayas, ACM TOMS 35 (2008), algorithm 884.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.elements.affine import AffineTriangles
from kshell.elements.base import PlateElement
from kshell.elements.morley import REFERENCE_MIDPOINTS, midpoint_normal_functionals, normal_components
from kshell.elements.reference import PARTIALS, VERTICES, DualBasis, monomials
from kshell.mesh.mesh import EDGE_VERTICES

Floats = NDArray[np.float64]

VERTEX_PARTIALS = PARTIALS[0] + PARTIALS[1] + PARTIALS[2]


def _functionals() -> Floats:
    at_vertices = np.stack([monomials(5, VERTICES, p) for p in VERTEX_PARTIALS], axis=1)
    return np.concatenate([at_vertices.reshape(18, 21), midpoint_normal_functionals(5)])


class ElementArgyris(PlateElement):
    """Argyris triangle.

    Degrees of freedom: w, w_x, w_y, w_xx, w_xy, w_yy at the vertices, w_n at the edge midpoints.
    """

    nodal_dofs = 6
    facet_dofs = 1
    maxdeg = 5
    dofnames = ("u", "u_x", "u_y", "u_xx", "u_xy", "u_yy", "u_n")
    doflocs = np.concatenate([np.repeat(VERTICES, 6, axis=0), REFERENCE_MIDPOINTS])

    basis = DualBasis(5, _functionals())
    vertex_powers = (0, 1, 1, 2, 2, 2)
    edge_powers = (1,)

    def transformation(self, triangles: AffineTriangles) -> Floats:
        """M: gradients and Hessians at vertices by the chain rule; on an edge w is the quintic given
        by its end values, slopes and second derivatives, so its slope at the midpoint is known."""
        j = triangles.jacobian
        x_xi, x_eta, y_xi, y_eta = j[:, 0, 0], j[:, 0, 1], j[:, 1, 0], j[:, 1, 1]
        m = np.zeros((len(triangles), 21, 21))
        for v in range(3):
            block = m[:, 6 * v : 6 * v + 6, 6 * v : 6 * v + 6]
            block[:, 0, 0] = 1.0
            block[:, 1, 1], block[:, 1, 2] = x_xi, y_xi
            block[:, 2, 1], block[:, 2, 2] = x_eta, y_eta
            block[:, 3, 3], block[:, 3, 4], block[:, 3, 5] = x_xi**2, 2 * x_xi * y_xi, y_xi**2
            block[:, 4, 3], block[:, 4, 5] = x_xi * x_eta, y_xi * y_eta
            block[:, 4, 4] = x_xi * y_eta + x_eta * y_xi
            block[:, 5, 3], block[:, 5, 4], block[:, 5, 5] = x_eta**2, 2 * x_eta * y_eta, y_eta**2
        along_normal, along_tangent = normal_components(triangles)
        for k, ends in enumerate(EDGE_VERTICES):
            row = 18 + k
            m[:, row, row] = along_normal[:, k]
            tx, ty = triangles.tangents[:, k].T
            length = triangles.lengths[:, k]
            # from lower to higher vertex: 15/8 [w] / L - 7/16 (w_t + w_t) + L/32 [w_tt]
            for v, end in zip(ends, (-1.0, 1.0), strict=True):
                sign = end * triangles.sense[:, k]
                value = 15 / 8 * sign / length
                second = sign * length / 32
                parts = (
                    value,
                    -7 / 16 * tx,
                    -7 / 16 * ty,
                    second * tx**2,
                    2 * second * tx * ty,
                    second * ty**2,
                )
                for dof, part in enumerate(parts):
                    m[:, row, 6 * v + dof] = along_tangent[:, k] * part
        return m
