"""Constant tables of the Hellan-Herrmann-Johnson triangle of order p: all that does not depend on the mesh.

Local unknowns of a triangle, in this order (k = p (p + 1) / 2 moment functions):

    w at the 3 vertices | p - 1 bubbles of each edge | p slopes of each edge | (p - 1)(p - 2) / 2 inner bubbles

Symbols
-------
N_j        hierarchic basis of w (`kshell.elements.hierarchic`)
psi_k      orthonormal basis of the moments' components
P_m        Legendre polynomials along an edge; slopes are alpha = length dw/dn = sum_m alpha_m P_m
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from kshell.elements.hierarchic import (
    hierarchic,
    hierarchic_jets,
    orthonormal,
    orthonormal_jets,
    polynomial_count,
)
from kshell.elements.jets import legendre
from kshell.elements.quadrature import interval_rule, triangle_rule
from kshell.elements.reference import VERTICES
from kshell.mesh.mesh import EDGE_VERTICES

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

LARGEST_ORDER = 12  # tables are good to rounding there; beyond, condensing the inner unknowns loses digits


def edge_points(edge: int, s: Floats) -> Floats:
    """Reference coordinates (..., 2) of points s in [0, 1] of a local edge."""
    a, b = VERTICES[EDGE_VERTICES[edge]]
    return a + s[..., None] * (b - a)


def edge_reference(place: Ints, s: Floats) -> Floats:
    """(n, point, 2) reference coordinates of points s of local edges (n,)."""
    return np.stack([edge_points(edge, s) for edge in range(3)])[place]


@dataclass(frozen=True)
class Tables:
    """Tables of one order.

    Attributes
    ----------
    order : int
    rows : (12, k m) array, m local unknowns
        Reference strains: integrals of psi_k N_j,ab for ab = 11, 22, 12; then per edge minus the integrals of
        psi_k N_j,1 and psi_k N_j,2; then per edge the integrals of psi_k with the slopes' Legendre polynomials.
    load : (m,) array
        Integrals of the basis of w over the reference triangle, zero for slopes.
    deflection : (n,) int array
        Places of the basis of w among the local unknowns.
    """

    order: int
    rows: Floats
    load: Floats
    deflection: Ints

    @cached_property
    def moments(self) -> int:
        """Number k of moment functions per component."""
        return polynomial_count(self.order - 1)

    @cached_property
    def outer(self) -> int:
        """Number of local unknowns that triangles share."""
        return 3 + 3 * (self.order - 1) + 3 * self.order

    @cached_property
    def count(self) -> int:
        """Number m of local unknowns."""
        return self.outer + polynomial_count(self.order - 3)

    @cached_property
    def forward(self) -> Floats:
        """(m, 12 k) the table as the map from local unknowns to reference strains."""
        return np.ascontiguousarray(self.rows.reshape(-1, self.count).T)

    def bubbles(self, edge: int) -> slice:
        """Places of the bubbles of w on a local edge."""
        start = 3 + edge * (self.order - 1)
        return slice(start, start + self.order - 1)

    def slopes(self, edge: int) -> slice:
        """Places of the slopes on a local edge."""
        start = 3 * self.order + edge * self.order
        return slice(start, start + self.order)

    def on_edge(self, edge: int, s: Floats) -> Floats:
        """w at points s of a local edge, from all local unknowns: (point, m)."""
        out = np.zeros((len(s), self.count))
        out[:, self.deflection] = hierarchic(self.order, edge_points(edge, s))
        return out

    def slopes_on_edge(self, edge: int, s: Floats) -> Floats:
        """alpha at points s of a local edge: (point, m)."""
        out = np.zeros((len(s), self.count))
        out[:, self.slopes(edge)] = legendre(self.order - 1, s)
        return out

    def edge_mean(self, edge: int, slopes: bool) -> Floats:
        """(m,) mean over a local edge of w, or of alpha."""
        s, ws = interval_rule(self.order + 1)
        return ws @ (self.slopes_on_edge(edge, s) if slopes else self.on_edge(edge, s))

    def inside(self, xi: Floats) -> Floats:
        """w at reference points (..., 2): (..., m)."""
        return orthonormal(self.order, xi) @ self.jets[0]

    def gradients(self, xi: Floats) -> Floats:
        """Reference gradient of w at reference points (..., 2): (..., 2, m)."""
        psi = orthonormal(self.order, xi)
        return np.stack([psi @ table for table in self.jets[1:3]], axis=-2)

    def moment_functions(self, xi: Floats) -> Floats:
        """psi at reference points (..., 2): (..., k)."""
        return orthonormal(self.order - 1, xi)

    def moment_gradients(self, xi: Floats) -> Floats:
        """Reference gradient of psi at reference points (..., 2): (..., 2, k)."""
        psi = orthonormal(self.order - 1, xi)
        return np.stack([psi @ table for table in self._moment_gradients], axis=-2)

    @cached_property
    def jets(self) -> Floats:
        """(6, psi, m): w's functions and their derivatives 1, 2, 11, 22, 12 in psi of the degree of w.

        For points of every triangle's own, where a recurrence on jets takes longer than the rest.
        """
        points, weights = triangle_rule(2 * self.order)
        test = (weights[:, None] * orthonormal(self.order, points)).T
        out = np.zeros((6, len(test), self.count))
        out[..., self.deflection] = test @ hierarchic_jets(self.order, points)
        return out

    @cached_property
    def _moment_gradients(self) -> Floats:
        """(2, k, k) derivatives of psi in psi."""
        points, weights = triangle_rule(2 * self.order)
        test = (weights[:, None] * orthonormal(self.order - 1, points)).T
        found: Floats = test @ orthonormal_jets(self.order - 1, points)[1:3]
        return found


@lru_cache(maxsize=LARGEST_ORDER)
def tables(order: int) -> Tables:
    """The tables of an order from 1 to `LARGEST_ORDER`, made once."""
    k, n = polynomial_count(order - 1), polynomial_count(order)
    shared = 3 * order  # vertices and bubbles of edges
    deflection = np.concatenate([np.arange(shared), np.arange(n - shared) + 2 * shared])
    m = 2 * shared + n - shared
    rows = np.zeros((12, k, m))
    points, weights = triangle_rule(2 * order)
    jets = hierarchic_jets(order, points)
    weighted = weights[:, None] * orthonormal(order - 1, points)  # (point, k)
    for component in range(3):
        rows[component][:, deflection] = weighted.T @ jets[3 + component]
    s, ws = interval_rule(order + 1)
    polynomials = legendre(order - 1, s)
    for edge in range(3):
        at = edge_points(edge, s)
        jets_there = hierarchic_jets(order, at)
        test = ws[:, None] * orthonormal(order - 1, at)
        for axis in range(2):
            rows[3 + 2 * edge + axis][:, deflection] = -test.T @ jets_there[1 + axis]
        first = shared + edge * order
        rows[9 + edge][:, first : first + order] = test.T @ polynomials
    load = np.zeros(m)
    load[deflection] = weights @ jets[0]
    return Tables(order, rows.reshape(12, -1), load, deflection)


@lru_cache(maxsize=32)
def canonical(order: int, degree: int) -> Floats:
    """Canonical interpolant of polynomials of a degree, between hierarchic coefficients: (n of order, n of degree).

    It keeps values at vertices, moments on edges to degree order - 2 and inside to degree order - 3. For moments m of
    the element, div div m acts on a smooth v as it acts on the interpolant of v (Brezzi & Raviart 1976; Comodi 1989).
    """

    def functionals(of: int) -> Floats:
        rows = [hierarchic(of, VERTICES)]
        s, ws = interval_rule(max(order, of) + 1)
        if order > 1:
            test = ws[:, None] * legendre(order - 2, s)
            rows += [test.T @ hierarchic(of, edge_points(edge, s)) for edge in range(3)]
        if order > 2:
            points, weights = triangle_rule(order - 3 + of)
            rows.append((weights[:, None] * orthonormal(order - 3, points)).T @ hierarchic(of, points))
        return np.concatenate(rows)

    found: Floats = np.linalg.solve(functionals(order), functionals(degree)).astype(np.float64)
    return found
