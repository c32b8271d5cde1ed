"""The stiffness of one triangle in its own strains: membrane coefficients and condensed moments.

The energy of a triangle is 1/2 s . K s with s = (c, l). Here c are the coefficients of the membrane strain
E = sum_r c_r Phi_r, and l_r = int kappa : tau_r the curvature measured by the moment functions
tau_r = Phi_r / J^2. Moments m are unknowns of the triangle alone (Hellan, Herrmann, Johnson); with the energy
w(E, kappa) of the section, the triangle maximises

    m . l - int w*(E, M) J,   M = sum_r m_r tau_r,   w* = 1/2 (M - B E) . D^-1 (M - B E) - 1/2 E . A E,

over m, which gives (Neunteufel and Schoeberl, arXiv:1904.04714, here with coupling B)

    K = [ F + H^T G^-1 H    H^T G^-1 ]     F = int Phi (A - B D^-1 B) Phi J
        [ G^-1 H            G^-1     ],    G = int tau D^-1 tau J,   H = int tau D^-1 B Phi J,

and the moments m = G^-1 (l + H c): the second half of K s.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.shell.frames import components, contravariant_to_frame, covariant_to_frame, tangent_frame
from kshell.shell.koiter.surface import Surface
from kshell.shell.reference import ReferenceTriangle
from kshell.shell.section import Section, section_at

Floats = NDArray[np.float64]


def _integrate(reference: ReferenceTriangle, weight: Floats, left: Floats) -> Floats:
    """int Phi_r . left . Phi_s over a triangle.

    Parameters
    ----------
    weight : (triangle, q)
    left : (3, 3, triangle, q) matrix between components 11, 22, 12
    """
    psi, w = reference.psi, reference.weights
    count = psi.shape[1]
    pairs = (w[:, None, None] * psi[:, :, None] * psi[:, None, :]).reshape(len(w), -1)  # (q, k k')
    values = (left * weight).reshape(-1, len(w)) @ pairs
    # (v, v', triangle, k, k') -> (triangle, k, v, k', v')
    values = values.reshape(3, 3, -1, count, count).transpose(2, 3, 0, 4, 1)
    return values.reshape(-1, 3 * count, 3 * count)


def triangle_stiffness(surface: Surface, section: Section, triangles: slice) -> Floats:
    """K of a range of triangles: (triangle, 2 r, 2 r)."""
    reference = surface.reference
    x = surface.tangents(reference.first, triangles)
    j = surface.area_elements[triangles]

    def places() -> Floats:
        return np.einsum("qn,tnx->tqx", reference.values, surface.nodes[surface.triangle_nodes[triangles]])

    a, b, d, angle = section_at(section, triangles, places)
    e1, e2, _ = tangent_frame(x, section.direction_of(triangles), angle)
    f = components(x, e1, e2)
    strain = np.moveaxis(covariant_to_frame(f), (0, 1), (2, 3))  # (triangle, q, 3, 3)
    moment = np.moveaxis(contravariant_to_frame(f), (0, 1), (2, 3))

    def product(left: Floats, middle: Floats, right: Floats) -> Floats:
        matrix = np.swapaxes(left, -1, -2) @ middle @ right
        return np.ascontiguousarray(np.moveaxis(matrix, (2, 3), (0, 1)))

    flexibility: Floats = np.asarray(np.linalg.inv(d), dtype=float)
    n = reference.strains
    bending = np.linalg.inv(_integrate(reference, 1 / j**3, product(moment, flexibility, moment)))
    result = np.zeros((len(j), 2 * n, 2 * n))
    result[:, n:, n:] = 0.5 * (bending + bending.swapaxes(1, 2))
    coupled = bool(np.any(section.coupling))
    membrane = a - b @ flexibility @ b if coupled else a
    result[:, :n, :n] = _integrate(reference, j, product(strain, membrane, strain))
    if coupled:
        mixed = _integrate(reference, 1 / j, product(moment, flexibility @ b, strain))
        carried = result[:, n:, n:] @ mixed
        result[:, n:, :n] = carried
        result[:, :n, n:] = carried.swapaxes(1, 2)
        result[:, :n, :n] += mixed.swapaxes(1, 2) @ carried
    return result
