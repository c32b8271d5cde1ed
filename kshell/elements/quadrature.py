"""Quadrature rules on the reference triangle and on the unit interval."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
SYMMETRIC_UP_TO = 19  # the highest degree that scikit-fem tabulates


@lru_cache(maxsize=32)
def triangle_rule(degree: int) -> tuple[Floats, Floats]:
    """Points (point, 2) and weights (point,) exact for polynomials of a degree; weights sum to 1/2.

    Symmetric rules where scikit-fem has one, beyond them Gauss rules on the square collapsed to the triangle.
    """
    if degree > SYMMETRIC_UP_TO:
        return _collapsed_rule(degree)
    from skfem.quadrature import get_quadrature
    from skfem.refdom import RefTri

    points, weights = get_quadrature(RefTri, degree)
    return np.ascontiguousarray(points.T), weights


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
