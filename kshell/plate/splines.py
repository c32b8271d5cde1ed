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


def spline_derivatives(x: Floats, y: Floats, degree: int, periodic: bool = False) -> tuple[Floats, Floats]:
    """First and second derivatives at the points of the spline through them.

    Parameters
    ----------
    x : (n,) array
        Ascending, n > degree; closed curves with the first point again at the end, n > degree + 1.
    y : (n, k) array
    degree : int
        Odd.
    periodic : bool
        Of a closed curve; else without knots at the (degree - 1) / 2 points beside either end.

    Returns
    -------
    two (n, k) arrays
    """
    n = len(x)
    if periodic:
        m = n - 1
        period = x[-1] - x[0]
        knots = np.concatenate([x[m - degree : m] - period, x, x[1 : degree + 1] + period])
        interval = degree + np.minimum(np.arange(n), m - 1)
        columns = (np.arange(m)[:, None] + np.arange(degree + 1)) % m
        values, rows = _basis(knots, degree, x[:-1], interval[:-1]), y[:-1]
    else:
        aside = (degree + 1) // 2
        knots = np.concatenate(
            [np.repeat(x[0], degree + 1), x[aside : n - aside], np.repeat(x[-1], degree + 1)]
        )
        interval = np.clip(np.searchsorted(knots, x, side="right") - 1, degree, n - 1)
        columns = interval[:, None] - degree + np.arange(degree + 1)
        values, rows = _basis(knots, degree, x, interval), y
    coefficients = _solve(columns, values, rows)
    if periodic:
        coefficients = np.concatenate([coefficients, coefficients[:degree]])
    found = []
    for order in (1, 2):
        if order > degree:
            found.append(np.zeros_like(y))
            break
        p, count = degree - order, len(coefficients)
        width = knots[p + 2 : p + 1 + count] - knots[1:count]
        coefficients = (p + 1) * np.diff(coefficients, axis=0) / width[:, None]
        knots, interval = knots[1:-1], interval - 1
        here = interval[:, None] - p + np.arange(p + 1)
        found.append(np.einsum("na,nak->nk", _basis(knots, p, x, interval), coefficients[here]))
    return found[0], found[1]


def _basis(knots: Floats, degree: int, x: Floats, interval: Ints) -> Floats:
    """(point, degree + 1) the B-splines that are not zero between the knots interval and interval + 1."""
    out = np.ones((len(x), 1))
    for d in range(1, degree + 1):
        above = np.zeros((len(x), d + 1))
        for r in range(d):
            right, left = knots[interval + 1 + r], knots[interval + 1 + r - d]
            part = out[:, r] / (right - left)
            above[:, r] += (right - x) * part
            above[:, r + 1] = (x - left) * part
        out = above
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
