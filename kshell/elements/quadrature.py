"""Quadrature rules on the reference triangle and on the unit interval."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@lru_cache(maxsize=32)
def triangle_rule(degree: int) -> tuple[Floats, Floats]:
    """Points (point, 2) and weights (point,) exact for polynomials of a degree; weights sum to 1/2."""
    from skfem.quadrature import get_quadrature
    from skfem.refdom import RefTri

    points, weights = get_quadrature(RefTri, degree)
    return np.ascontiguousarray(points.T), weights


@lru_cache(maxsize=32)
def interval_rule(count: int) -> tuple[Floats, Floats]:
    """Gauss points (point,) and weights (point,) on [0, 1], exact to degree 2 count - 1."""
    x, w = np.polynomial.legendre.leggauss(count)
    return (x + 1) / 2, w / 2
