"""The shape of curved edges of a plate, as polynomials of the place along each edge.

Symbols
-------
gamma(s)   an edge as a curve, s in [0, 1] from its lower to its higher vertex
delta(s)   gamma(s) minus the chord  =  s (1 - s) phi(s), phi a polynomial
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

KEPT_POINTS = 64  # along an edge, of rules whose terms are kept


@dataclass(frozen=True)
class EdgeCurves:
    """Shape of a set of edges, in the plane.

    Attributes
    ----------
    edges : (n,) int array
        Edge numbers, sorted.
    tangent : (n, end, 2) array
        Unit tangents at the lower and the higher vertex, pointing from lower to higher. Where a line
        is smooth both neighbouring edges have the same tangent; at a corner each has its own.
    curvature : (n, end, 2) array
        Second derivative of the curve by arc length, a vector across the tangent.
    shape : (n, k, 2) array
        Coefficients of phi(s) in 1, s, s^2, ...: as many as the longest of the set has.
    arcs : (n,) bool array
        Whether an edge is an arc of a circle or an ellipse, known to rounding.
    sharpest : float
        Largest turn (radians) of the mesh lines that was taken as part of a smooth curve.
    sharpest_at : (2,) array
    """

    edges: Ints
    tangent: Floats
    curvature: Floats
    shape: Floats
    arcs: NDArray[np.bool_]
    sharpest: float
    sharpest_at: Floats

    def place(self, edges: NDArray[np.integer]) -> NDArray[np.int64]:
        """Positions of given edges in this set."""
        return np.searchsorted(self.edges, edges)

    def deviation(self, place: NDArray[np.integer], s: Floats) -> Floats:
        """delta(s) of some edges: (n, point, 2)."""
        return np.asarray(self.deviations(place, s)[0])

    def deviations(self, place: NDArray[np.integer], s: Floats) -> Floats:
        """delta(s) of some edges and its first and second derivative by s: (3, n, point, 2)."""
        terms = (_terms if len(s) <= KEPT_POINTS else _terms.__wrapped__)(self.shape.shape[1], s.tobytes())
        return (terms @ self.shape[place]).reshape(len(place), 3, -1, 2).swapaxes(0, 1)

    @cached_property
    def curved(self) -> NDArray[np.bool_]:
        """(n,) whether an edge deviates from its chord by more than rounding."""
        return np.abs(self.shape).max(axis=(1, 2)) > 0.0


@lru_cache(maxsize=32)
def _terms(n: int, points: bytes) -> Floats:
    """(3 point, n) what delta(s) and its derivatives are of the coefficients of phi; rules ask for the same points."""
    s, power = np.frombuffer(points), np.arange(n + 2)
    terms = np.zeros((3, len(s), n + 2))  # s^0, s^1, ... and their derivatives
    terms[0] = s[:, None] ** power
    terms[1, :, 1:] = terms[0, :, :-1] * power[1:]
    terms[2, :, 1:] = terms[1, :, :-1] * power[1:]
    return (terms[..., 1:-1] - terms[..., 2:]).reshape(-1, n)  # s phi(s) - s^2 phi(s)


def joined_curves(one: EdgeCurves, other: EdgeCurves) -> EdgeCurves:
    """Two sets of edges as one."""
    order = np.argsort(np.concatenate([one.edges, other.edges]))
    edges, tangent, curvature, arcs = (
        np.concatenate([getattr(one, name), getattr(other, name)])[order]
        for name in ("edges", "tangent", "curvature", "arcs")
    )
    most = max(one.shape.shape[1], other.shape.shape[1])
    shapes = [np.pad(x.shape, ((0, 0), (0, most - x.shape.shape[1]), (0, 0))) for x in (one, other)]
    shape = np.concatenate(shapes)[order]
    worse = one if one.sharpest >= other.sharpest else other
    return EdgeCurves(edges, tangent, curvature, shape, arcs, worse.sharpest, worse.sharpest_at)
