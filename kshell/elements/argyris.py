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

    def _transformation(self, triangles: AffineTriangles) -> Floats:
        """M: gradients and Hessians at vertices by the chain rule; on an edge w is the quintic given
        by its end values, slopes and second derivatives, so its slope at the midpoint is known."""
        j = triangles.jacobian
        x_xi, x_eta, y_xi, y_eta = j[:, 0, 0], j[:, 0, 1], j[:, 1, 0], j[:, 1, 1]
        m = np.zeros((len(triangles), 21, 21))
        block = m[:, :6, :6]
        block[:, 0, 0] = 1.0
        block[:, 1:3, 1:3] = np.swapaxes(j, 1, 2)
        block[:, 3, 3], block[:, 3, 4], block[:, 3, 5] = x_xi**2, 2 * x_xi * y_xi, y_xi**2
        block[:, 4, 3], block[:, 4, 5] = x_xi * x_eta, y_xi * y_eta
        block[:, 4, 4] = x_xi * y_eta + x_eta * y_xi
        block[:, 5, 3], block[:, 5, 4], block[:, 5, 5] = x_eta**2, 2 * x_eta * y_eta, y_eta**2
        m[:, 6:12, 6:12] = m[:, 12:18, 12:18] = block

        along_normal, along_tangent = normal_components(triangles)
        edge = np.arange(3)
        m[:, 18 + edge, 18 + edge] = along_normal
        # slope at the midpoint, from lower to higher vertex: 15/8 [w] / L - 7/16 (w_t + w_t) + L/32 [w_tt]
        t = triangles.tangents
        rise = along_tangent * triangles.sense  # [ ] is then from the first to the second local vertex
        parts = np.empty((len(triangles), 3, 6))
        parts[..., 0] = 15 / 8 * rise / triangles.lengths
        parts[..., 1:3] = (-7 / 16 * along_tangent)[..., None] * t
        bend = rise * triangles.lengths / 32
        parts[..., 3] = bend * t[..., 0] ** 2
        parts[..., 4] = 2 * bend * t[..., 0] * t[..., 1]
        parts[..., 5] = bend * t[..., 1] ** 2
        rows = m[:, 18:, :18].reshape(len(triangles), 3, 3, 6)  # a view: (triangle, edge, vertex, dof)
        rows[:, edge, EDGE_VERTICES[:, 1]] = parts
        rows[:, edge, EDGE_VERTICES[:, 0]] = parts * np.array([-1.0, 1.0, 1.0, -1.0, -1.0, -1.0])
        return m
