"""Consistency terms on curved lines inside a plate, where two triangles meet along an arc.

Across a curved line both triangles have the same w, grad w, tangential second derivatives and slope at the true
middle, so that their deflections agree along it but for what is left between these places. As on held edges
(`kshell.plate.holds`) the moment and the force there do a little work on the rest. It is taken out against the trace
that the common numbers of an edge define, which needs one triangle at a time:

    sum over both sides of   - int V(w) (v - v^) + V(v) (w - w^)  +  int M_nn(w) (v_n - v_n^) + M_nn(v) (w_n - w_n^)

For the exact solution the terms of both sides cancel, because its V, M_nn, w and w_n go on across the line.

Symbols
-------
gamma(s)   the edge, s in [0, 1];  n(s) its unit normal, out of the triangle
w^         quintic in s with w, dw/ds, d2w/ds2 of both ends
w_n^       n . c + quartic in s with w_n - n . c and its derivative at both ends and its value in the middle,
           c the mean of both gradients: exact where the plate only tilts
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kshell.elements import matrices
from kshell.elements.quadrature import interval_rule
from kshell.mesh.mesh import EDGE_VERTICES
from kshell.plate.holds import POINTS, CurvedHold, Rows

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MUCH = 0.7  # radians: nine edges around a circle; with a tenth, half as many on an ellipse leave the matrix indefinite


@dataclass
class CurvedTie(CurvedHold):
    """The terms of one side of curved edges inside, as a quadratic form."""

    def __post_init__(self) -> None:
        super().__post_init__()
        affine = self.domain.affine(self.patch.triangles)
        at_ends = self.domain.edge_points(self.edges, np.array([0.0, 0.5, 1.0]), np.ones(3), self.side)
        _, velocity, bend = self.domain.edge_motion(self.edges, np.array([0.0, 0.5, 1.0]))
        n = len(self.edges)
        local = np.argmax(
            self.domain.mesh.triangle_edges[self.patch.triangles] == self.edges[:, None], axis=1
        )
        # local vertices at the lower and the higher end
        vertices = EDGE_VERTICES[local]
        lower = self.domain.mesh.edges[self.edges, 0]
        first = self.domain.mesh.triangles[self.patch.triangles, vertices[:, 0]]
        vertices = np.where((first == lower)[:, None], vertices, vertices[:, ::-1])

        size = self.element.count
        each = np.arange(n)
        value, slope = np.zeros((n, 6, size)), np.zeros((n, 5, size))
        mean = np.zeros((n, 2, size))
        for end, k in enumerate((0, 2)):
            v, a, normal = velocity[:, k], bend[:, k], at_ends.normal[:, k]
            turn = self._turning(v, a, normal)
            dof = 6 * vertices[:, end]
            value[each, 3 * end, dof] = 1.0
            for axis in range(2):
                mean[each, axis, dof + 1 + axis] = 0.5
                value[each, 3 * end + 1, dof + 1 + axis] = v[:, axis]
                value[each, 3 * end + 2, dof + 1 + axis] = a[:, axis]
                slope[each, 2 * end, dof + 1 + axis] = normal[:, axis]
                slope[each, 2 * end + 1, dof + 1 + axis] = turn[:, axis]
            for part, (left, right) in enumerate(((0, 0), (0, 1), (1, 1))):
                both = v[:, left] * v[:, right] * (1.0 if left == right else 2.0)
                value[each, 3 * end + 2, dof + 3 + part] = both
                cross = normal[:, left] * v[:, right]
                slope[each, 2 * end + 1, dof + 3 + part] = (
                    cross if left == right else cross + normal[:, right] * v[:, left]
                )
        gradient = matrices.rows(
            self.element, affine, at_ends.xi[:, 1:2], 1, self.element.transformation(affine)
        )
        slope[:, 4] = (at_ends.normal[:, 1, None, :] @ gradient[:, 0])[:, 0]
        for place, k in enumerate((0, 2)):
            slope[:, 2 * place] -= np.einsum("na,nad->nd", at_ends.normal[:, k], mean)
            turn = self._turning(velocity[:, k], bend[:, k], at_ends.normal[:, k])
            slope[:, 2 * place + 1] -= np.einsum("na,nad->nd", turn, mean)
        slope[:, 4] -= np.einsum("na,nad->nd", at_ends.normal[:, 1], mean)

        s = interval_rule(POINTS)[0]
        tilt = self.patch.normal @ mean  # (n, point, dof)
        transform = self.element.transformation(affine)
        to_reference = np.linalg.inv(transform)
        self.value_trace = (hermite(s, QUINTIC) @ value) @ to_reference
        self.slope_trace = (tilt + hermite(s, QUARTIC) @ slope) @ to_reference

    def _penalty(self, positions: Ints) -> tuple[Floats, Floats]:
        """A tenth of that on held edges is enough, but for edges that turn by much."""
        domain, edges = self.domain, self.edges[positions]
        middle = domain.curves.deviation(domain.curves.place(edges), np.array([0.5]))[:, 0]
        turn = 8 * np.linalg.norm(middle, axis=1) / domain.mesh.edge_lengths[edges]
        share = np.clip((turn / MUCH) ** 2, 0.1, 1.0)[:, None, None]
        value, slope = super()._penalty(positions)
        return share * value, share * slope

    @staticmethod
    def _turning(velocity: Floats, bend: Floats, normal: Floats) -> Floats:
        """(n, 2) derivative of the unit normal by s."""
        speed = np.linalg.norm(velocity, axis=1)
        tangent = velocity / speed[:, None]
        return -((bend * normal).sum(axis=1) / speed)[:, None] * tangent

    def _rows(self, positions: Ints, transform: Floats) -> Rows:
        rows = super()._rows(positions, transform)
        return Rows(
            value=rows.value - self.value_trace[positions] @ transform,
            slope=rows.slope - self.slope_trace[positions] @ transform,
            moment=rows.moment,
            force=rows.force,
        )


def _conditions(places: list[tuple[float, int]]) -> Floats:
    """Inverse of the matrix of derivatives of powers at places: coefficients of the polynomials dual to them."""
    power = np.arange(len(places))
    rows = []
    for s, order in places:
        factor = np.ones(len(places))
        for k in range(order):
            factor = factor * (power - k)
        rows.append(factor * np.where(power >= order, s ** np.maximum(power - order, 0.0), 0.0))
    return np.linalg.inv(np.array(rows))


QUINTIC = _conditions([(0.0, 0), (0.0, 1), (0.0, 2), (1.0, 0), (1.0, 1), (1.0, 2)])
QUARTIC = _conditions([(0.0, 0), (0.0, 1), (1.0, 0), (1.0, 1), (0.5, 0)])


def hermite(s: Floats, dual: Floats) -> Floats:
    """(point, condition) values of the polynomials dual to the conditions at s."""
    return np.vander(s, len(dual), increasing=True) @ dual
