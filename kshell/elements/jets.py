"""Polynomials by recurrence, with their first and second derivatives: jets.

A jet is an array (6, ...) of a function of two variables at points: value, d/dx, d/dy, d2/dx2, d2/dy2, d2/dxdy.
Three-term recurrences on jets give orthogonal polynomials of any degree, and their derivatives, to a few roundings:
no table of monomial coefficients, whose condition grows tenfold per degree, is ever inverted.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

KEPT_POINTS = 64  # whose values are kept


def affine_jet(constant: float, gradient: tuple[float, float], points: Floats) -> Floats:
    """The jet of constant + gradient . x at points (..., 2)."""
    out = np.zeros((6, *points.shape[:-1]))
    out[0] = constant + points @ np.asarray(gradient)
    out[1], out[2] = gradient
    return out


def times(a: Floats, b: Floats) -> Floats:
    """The jet of a product; leading axes behind the first may broadcast."""
    a0, a1, a2, a11, a22, a12 = a
    b0, b1, b2, b11, b22, b12 = b
    return np.stack(
        [
            a0 * b0,
            a1 * b0 + a0 * b1,
            a2 * b0 + a0 * b2,
            a11 * b0 + 2 * a1 * b1 + a0 * b11,
            a22 * b0 + 2 * a2 * b2 + a0 * b22,
            a12 * b0 + a1 * b2 + a2 * b1 + a0 * b12,
        ]
    )


def jacobi_jets(degree: int, a: float, b: float, x: Floats) -> list[Floats]:
    """Jacobi polynomials P_0 ... P_degree of weights (1 - x)^a (1 + x)^b, composed with the jet x.

    Source: Abramowitz & Stegun 1964, 22.7.1.
    """
    one = np.zeros_like(x)
    one[0] = 1.0
    out = [one]
    if degree > 0:
        out.append(0.5 * (a + b + 2) * x + 0.5 * (a - b) * one)
    for n in range(2, degree + 1):
        c = 2 * n + a + b
        scale = 2 * n * (n + a + b) * (c - 2)
        slope, shift = (c - 1) * c * (c - 2) / scale, (c - 1) * (a * a - b * b) / scale
        back = 2 * (n + a - 1) * (n + b - 1) * c / scale
        out.append(times(slope * x + shift * one, out[-1]) - back * out[-2])
    return out


def jacobi_family(degree: int, x: Floats) -> Floats:
    """Values (n, i, point) of the Jacobi polynomials P_n of weights (1 - x)^(2 i + 1), n and i up to a degree.

    Those with n + i beyond the degree are not to be used. Source: as of `jacobi_jets`.
    """
    out = np.ones((degree + 1, degree + 1, len(x)))
    for n, (slope, shift, back) in enumerate(_family(degree), start=1):
        m = len(slope)
        out[n, :m] = (slope * x + shift) * out[n - 1, :m]
        if back is not None:
            out[n, :m] -= back * out[n - 2, :m]
    return out


@lru_cache(maxsize=32)
def family_table(degree: int) -> tuple[Floats, Floats, Floats]:
    """The same coefficients (n, i), slope, shift and back, zero where there are none."""
    out = np.zeros((3, degree + 1, degree + 1))
    for n, row in enumerate(_family(degree), start=1):
        for table, part in zip(out, row, strict=True):
            if part is not None:
                table[n, : len(part)] = part[:, 0]
    return out[0], out[1], out[2]


@lru_cache(maxsize=32)
def _family(degree: int) -> list[tuple[Floats, Floats, Floats | None]]:
    """Coefficients (i, 1) of the recurrences of `jacobi_family`, n = 1 ... degree."""
    if degree == 0:
        return []
    a: Floats = 2.0 * np.arange(degree + 1.0)[:, None] + 1.0
    out: list[tuple[Floats, Floats, Floats | None]] = [(0.5 * (a + 2.0), 0.5 * a, None)]
    for n in range(2, degree + 1):
        a = a[: degree + 1 - n]
        c = 2 * n + a
        scale = 2 * n * (n + a) * (c - 2)
        slope, shift = (c - 1) * c * (c - 2) / scale, (c - 1) * a * a / scale
        out.append((slope, shift, 2 * (n + a - 1) * (n - 1) * c / scale))
    return out


def scaled_legendre_jets(degree: int, x: Floats, t: Floats) -> list[Floats]:
    """t^n P_n(x / t), n = 0 ... degree: polynomials in the jets x and t, where t may vanish."""
    one = np.zeros_like(x)
    one[0] = 1.0
    out = [one]
    if degree > 0:
        out.append(x)
    square = times(t, t)
    for n in range(1, degree):
        out.append(((2 * n + 1) * times(x, out[n]) - n * times(square, out[n - 1])) / (n + 1))
    return out


def legendre(degree: int, s: Floats) -> Floats:
    """Legendre polynomials of 2 s - 1, (..., degree + 1): orthogonal on [0, 1], with squares 1 / (2 n + 1).

    Not to be written to: those of few points are kept.
    """
    s = np.asarray(s, dtype=np.float64)
    return (_legendre if s.size <= KEPT_POINTS else _legendre.__wrapped__)(degree, s.tobytes(), s.shape)


@lru_cache(maxsize=64)
def _legendre(degree: int, s: bytes, shape: tuple[int, ...]) -> Floats:
    """The same of points as bytes: elements ask for those of the same rules again and again."""
    x = 2.0 * np.frombuffer(s).reshape(shape) - 1.0
    out: Floats = np.polynomial.legendre.legvander(x, degree).astype(np.float64)
    out.flags.writeable = False
    return out
