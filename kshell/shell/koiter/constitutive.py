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

from collections.abc import Sequence
from typing import NamedTuple

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


class TriangleStiffness(NamedTuple):
    """K of triangles in its parts: without coupling two are zero, and neither kept nor multiplied by."""

    membrane: Floats  # (triangle, r, r), K of c
    bending: Floats  # (triangle, r, r), K of l, which makes moments of curvatures
    mixed: Floats | None  # (triangle, r, r), from c to moments; None where the section does not couple them

    @classmethod
    def of(cls, surface: Surface, section: Section, blocks: Sequence[slice]) -> TriangleStiffness:
        """Of all triangles of a surface, block by block."""
        parts = [triangle_stiffness(surface, section, block) for block in blocks]
        none = np.zeros((0, surface.reference.strains, surface.reference.strains))
        membrane, bending = (np.concatenate([none, *(part[k] for part in parts)]) for k in range(2))
        coupled = any(part.mixed is not None for part in parts)
        return cls(membrane, bending, np.concatenate([part[2] for part in parts]) if coupled else None)

    def times(self, triangles: slice | NDArray[np.integer], columns: Floats) -> Floats:
        """K times columns (triangle, 2 r, k) of some triangles."""
        r = self.membrane.shape[1]
        c, length = columns[:, :r], columns[:, r:]
        out = np.empty(columns.shape)
        np.matmul(self.membrane[triangles], c, out=out[:, :r])
        np.matmul(self.bending[triangles], length, out=out[:, r:])
        if self.mixed is not None:
            mixed = self.mixed[triangles]
            out[:, :r] += np.matmul(mixed.swapaxes(1, 2), length)
            out[:, r:] += np.matmul(mixed, c)
        return out

    def whole(self) -> Floats:
        """(triangle, 2 r, 2 r) K."""
        r = self.membrane.shape[1]
        size = r + self.bending.shape[1]
        out = np.zeros((len(self.membrane), size, size))
        out[:, :r, :r], out[:, r:, r:] = self.membrane, self.bending
        if self.mixed is not None:
            out[:, r:, :r], out[:, :r, r:] = self.mixed, self.mixed.swapaxes(1, 2)
        return out


def triangle_stiffness(surface: Surface, section: Section, triangles: slice) -> TriangleStiffness:
    """K of a range of triangles."""
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
    bending = np.linalg.inv(_integrate(reference, 1 / j**3, product(moment, flexibility, moment)))
    bending = 0.5 * (bending + bending.swapaxes(1, 2))
    if not np.any(section.coupling):
        return TriangleStiffness(_integrate(reference, j, product(strain, a, strain)), bending, None)
    membrane = _integrate(reference, j, product(strain, a - b @ flexibility @ b, strain))
    mixed = _integrate(reference, 1 / j, product(moment, flexibility @ b, strain))
    carried = bending @ mixed
    return TriangleStiffness(membrane + mixed.swapaxes(1, 2) @ carried, bending, carried)
