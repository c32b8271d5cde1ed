"""Quadrature rules on the reference triangle and on the unit interval."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kshell.elements.triangle_rules import RULES

Floats = NDArray[np.float64]


@lru_cache(maxsize=32)
def triangle_rule(degree: int) -> tuple[Floats, Floats]:
    """Points (point, 2) and weights (point,) exact for polynomials of a degree; weights sum to 1/2.

    Symmetric rules as far as they are tabulated, beyond them Gauss rules on the square collapsed to the triangle.
    """
    known = [d for d in RULES if d >= degree]
    if not known:
        return _collapsed_rule(degree)
    points, weights = [], []
    for weight, *place in RULES[min(known)]:
        if not place:
            orbit = [(1 / 3, 1 / 3)]
        elif len(place) == 1:
            (a,) = place
            orbit = [(a, a), (1 - 2 * a, a), (a, 1 - 2 * a)]
        else:
            a, b = place
            c = 1 - a - b
            orbit = [(a, b), (b, c), (c, a), (b, a), (c, b), (a, c)]
        points += orbit
        weights += [weight] * len(orbit)
    return np.array(points), np.array(weights)


def _collapsed_rule(degree: int) -> tuple[Floats, Floats]:
    """(s, t) in the unit square to (s, t (1 - s)), whose Jacobian 1 - s adds a degree along s."""
    s, along = interval_rule(degree // 2 + 2)
    t, across = interval_rule(degree // 2 + 1)
    points = np.stack([np.repeat(s, len(t)), np.outer(1 - s, t).ravel()], axis=1)
    return points, np.outer(along * (1 - s), across).ravel()


@lru_cache(maxsize=32)
def interval_rule(count: int) -> tuple[Floats, Floats]:
    """Gauss points (point,) and weights (point,) on [0, 1], exact to degree 2 count - 1."""
    x, w = np.polynomial.legendre.leggauss(count)
    return (x + 1) / 2, w / 2
