"""Integrals of smooth functions over an interval or a rectangle of parameters.

Gauss-Legendre panels, doubled until two answers agree. All points of one level are evaluated in one
call, which for vectorised integrands is far quicker than an adaptive routine that asks point by point.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable

import numpy as np

from kshell.errors import InputError, KshellWarning
from kshell.geometry.components import Floats

POINTS = 12  # per panel and direction: exact to degree 23
TOLERANCE = 1e-13  # of the integral of the absolute value
FINEST = {1: 4096, 2: 64}  # panels per direction


def panel_points(a: float, b: float, panels: int) -> tuple[Floats, Floats]:
    """Gauss points and weights of equal panels on [a, b], both (panels * POINTS,)."""
    x, w = np.polynomial.legendre.leggauss(POINTS)
    width = (b - a) / panels
    centre = a + width * (np.arange(panels) + 0.5)
    points = (centre[:, None] + 0.5 * width * x).ravel()
    return points, np.tile(0.5 * width * w, panels)


def over_interval(
    f: Callable[[Floats], Floats], a: float, b: float, what: str = "the integral", scale: float = 0.0
) -> float:
    """Integral of f(t), vectorised over t, from a to b; `scale` as in `over_rectangle`."""
    return _doubled(lambda n: _sum_1d(f, a, b, n), 1, what, scale)


def over_rectangle(
    f: Callable[[Floats, Floats], Floats],
    u_range: tuple[float, float],
    v_range: tuple[float, float],
    what: str = "the integral",
    scale: float = 0.0,
) -> float:
    """Integral of f(u, v) du dv over a rectangle; f takes arrays of one shape.

    The error sought is a part of the integral of |f|, or of `scale` if that is larger: give the natural size
    of the answer where f may be zero but for rounding.
    """
    return _doubled(lambda n: _sum_2d(f, u_range, v_range, n), 2, what, scale)


def _sum_1d(f: Callable[[Floats], Floats], a: float, b: float, n: int) -> tuple[float, float]:
    t, w = panel_points(a, b, n)
    terms = w * f(t)
    return float(terms.sum()), float(np.abs(terms).sum())


def _sum_2d(
    f: Callable[[Floats, Floats], Floats], u_range: tuple[float, float], v_range: tuple[float, float], n: int
) -> tuple[float, float]:
    u, w_u = panel_points(*u_range, n)
    v, w_v = panel_points(*v_range, n)
    terms = w_u[:, None] * w_v * f(*np.meshgrid(u, v, indexing="ij"))
    return float(terms.sum()), float(np.abs(terms).sum())


def _doubled(rule: Callable[[int], tuple[float, float]], dimension: int, what: str, scale: float) -> float:
    n = 1
    value, size = rule(n)
    while True:
        n *= 2
        finer, size = rule(n)
        size = max(size, scale)
        if not np.isfinite(finer):
            raise InputError(f"{what} is not finite: the integrand has a pole in the range")
        change = abs(finer - value)
        if change <= TOLERANCE * size:
            return finer
        if n >= FINEST[dimension]:
            if change > 1e-9 * size:
                message = (
                    f"{what} is only known to a relative {change / size:.1e}: the integrand is not smooth"
                )
                warnings.warn(KshellWarning(message), stacklevel=4)
            return finer
        value = finer
