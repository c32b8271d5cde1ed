"""Interpolating splines of odd degree through points of a curve, and their derivatives at the points.

Source: C. de Boor, A Practical Guide to Splines (1978), chapters IX (B-splines), X (derivatives) and XIII
(interpolation; the ends by leaving out knots beside them).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

DENSE = 160  # unknowns up to which a full matrix is quicker than loading what solves sparse ones


def spline_derivatives(
    x: Floats, y: Floats, degree: int, periodic: bool = False, count: int = 2
) -> list[Floats]:
    """First and further derivatives at the points of the spline through them.

    Parameters
    ----------
    x : (n,) array
        Ascending, n > degree; closed curves with the first point again at the end, n > degree + 1.
    y : (n, k) array
    degree : int
        Odd.
    periodic : bool
        Of a closed curve; else without knots at the (degree - 1) / 2 points beside either end.
    count : int
        How many derivatives.

    Returns
    -------
    list of (n, k) arrays
    """
    knots, coefficients = _interpolated(x, y, degree, periodic)
    interval = np.clip(np.searchsorted(knots, x, side="right") - 1, degree, len(coefficients) - 1)
    found = []
    for order in range(1, count + 1):
        if order > degree:
            found.append(np.zeros_like(y))
            continue
        knots, coefficients, interval = (
            knots[1:-1],
            _derived(knots, coefficients, degree - order),
            interval - 1,
        )
        found.append(_at(knots, coefficients, degree - order, x, interval))
    return found


def spline_at(x: Floats, y: Floats, degree: int, at: Floats, periodic: bool = False) -> tuple[Floats, Floats]:
    """Values and first derivatives at places between the points of the spline through them.

    Parameters
    ----------
    x, y, periodic :
        As for `spline_derivatives`.
    degree : int
        1 or more; of even degree the knots of open curves lie midway between points.
    at : (m,) array
        From the first to the last point.

    Returns
    -------
    two (m, k) arrays
    """
    knots, coefficients = _interpolated(x, y, degree, periodic)
    interval = np.clip(np.searchsorted(knots, at, side="right") - 1, degree, len(coefficients) - 1)
    value = _at(knots, coefficients, degree, at, interval)
    slopes = _derived(knots, coefficients, degree - 1)
    return value, _at(knots[1:-1], slopes, degree - 1, at, interval - 1)


def _interpolated(x: Floats, y: Floats, degree: int, periodic: bool) -> tuple[Floats, Floats]:
    """Knots and coefficients of the B-splines of the spline through points."""
    n = len(x)
    if periodic:
        m = n - 1
        period = x[-1] - x[0]
        knots = np.concatenate([x[m - degree : m] - period, x, x[1 : degree + 1] + period])
        columns = (np.arange(m)[:, None] + np.arange(degree + 1)) % m
        values = _basis(knots, degree, x[:-1], degree + np.arange(m))
        coefficients = _solve(columns, values, y[:-1])
        return knots, np.concatenate([coefficients, coefficients[:degree]])
    aside = (degree + 1) // 2
    inner = x if degree % 2 else 0.5 * (x[1:] + x[:-1])
    knots = np.concatenate(
        [np.repeat(x[0], degree + 1), inner[aside : len(inner) - aside], np.repeat(x[-1], degree + 1)]
    )
    interval = np.clip(np.searchsorted(knots, x, side="right") - 1, degree, n - 1)
    columns = interval[:, None] - degree + np.arange(degree + 1)
    return knots, _solve(columns, _basis(knots, degree, x, interval), y)


def _derived(knots: Floats, coefficients: Floats, degree: int) -> Floats:
    """Coefficients of the derivative, which is of one degree less, on the knots without the first and the last."""
    count = len(coefficients)
    width = knots[degree + 2 : degree + 1 + count] - knots[1:count]
    return np.asarray((degree + 1) * np.diff(coefficients, axis=0) / width[:, None])


def _at(knots: Floats, coefficients: Floats, degree: int, x: Floats, interval: Ints) -> Floats:
    here = interval[:, None] - degree + np.arange(degree + 1)
    return np.asarray(np.einsum("na,nak->nk", _basis(knots, degree, x, interval), coefficients[here]))


def _basis(knots: Floats, degree: int, x: Floats, interval: Ints) -> Floats:
    """(point, degree + 1) the B-splines that are not zero between the knots interval and interval + 1."""
    out = np.ones((len(x), 1))
    for d in range(1, degree + 1):
        right = knots[interval[:, None] + np.arange(1, d + 1)]
        left = knots[interval[:, None] + np.arange(1 - d, 1)]
        part = out / (right - left)
        out = np.zeros((len(x), d + 1))
        out[:, :d] = (right - x[:, None]) * part
        out[:, 1:] += (x[:, None] - left) * part
    return out


def _solve(columns: Ints, values: Floats, rows: Floats) -> Floats:
    """The coefficients (n, k) of the square matrix with some entries in each row."""
    n = len(columns)
    at = np.repeat(np.arange(n), columns.shape[1])
    if n <= DENSE:
        matrix = np.zeros((n, n))
        np.add.at(matrix, (at, columns.ravel()), values.ravel())
        return np.asarray(np.linalg.solve(matrix, rows), dtype=np.float64)
    from scipy.sparse import coo_matrix
    from scipy.sparse.linalg import splu

    whole = coo_matrix((values.ravel(), (at, columns.ravel())), shape=(n, n)).tocsc()
    return np.asarray(splu(whole).solve(rows))
