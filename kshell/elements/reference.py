"""Polynomials on the reference triangle (0, 0), (1, 0), (0, 1), and bases dual to given functionals.

A basis is a table of monomial coefficients: everything the elements need (values, derivatives,
exact integrals of products) follows from it, once per element type.
"""

from __future__ import annotations

from functools import cached_property, lru_cache
from math import factorial

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

VERTICES = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])

# partial derivatives of each order, as (times in xi, times in eta)
PARTIALS = (
    ((0, 0),),
    ((1, 0), (0, 1)),
    ((2, 0), (1, 1), (0, 2)),
    ((3, 0), (2, 1), (1, 2), (0, 3)),
    ((4, 0), (3, 1), (2, 2), (1, 3), (0, 4)),
)


@lru_cache(maxsize=32)
def exponents(degree: int) -> NDArray[np.int64]:
    """(monomial, 2) exponents of xi and eta of all monomials up to a degree; not to be written to."""
    return np.array(
        [(i, j) for total in range(degree + 1) for i in range(total, -1, -1) for j in [total - i]]
    )


def falling(n: NDArray[np.int64], k: int) -> NDArray[np.int64]:
    """n (n - 1) ... (n - k + 1): the factor that k derivatives put in front of x^n."""
    out = np.ones_like(n)
    for step in range(k):
        out = out * (n - step)
    return out


def monomials(degree: int, points: Floats, partial: tuple[int, int] = (0, 0)) -> Floats:
    """One partial derivative of every monomial at points (..., 2): an array (..., monomial)."""
    power = exponents(degree)
    of_both = powers(points, degree)  # (..., xi or eta, exponent)
    if partial == (0, 0):
        return of_both[..., 0, power[:, 0]] * of_both[..., 1, power[:, 1]]
    factor = falling(power[:, 0], partial[0]) * falling(power[:, 1], partial[1])
    left = np.maximum(power - np.array(partial), 0)
    return factor * of_both[..., 0, left[:, 0]] * of_both[..., 1, left[:, 1]]


def powers(x: Floats, degree: int) -> Floats:
    """x^0 ... x^degree along a new last axis, by repeated multiplication."""
    out = np.ones((*np.shape(x), degree + 1))
    for k in range(1, degree + 1):
        out[..., k] = out[..., k - 1] * x
    return out


class DualBasis:
    """The polynomials of a degree that are dual to as many functionals.

    Parameters
    ----------
    degree : int
    functionals : (basis, monomial) array
        Each functional applied to each monomial, in the order of `exponents`.
    """

    def __init__(self, degree: int, functionals: Floats) -> None:
        self.degree = degree
        self.coefficients: Floats = np.linalg.inv(functionals).astype(np.float64)  # (monomial, basis)

    def __len__(self) -> int:
        return self.coefficients.shape[1]

    def tabulate(self, points: Floats, order: int = 0) -> Floats:
        """All partial derivatives of one order.

        Parameters
        ----------
        points : (..., 2) array
            Reference coordinates; they may lie outside the triangle.
        order : int
            0 to 4.

        Returns
        -------
        (..., partial, basis) array, the partials in the order of `PARTIALS`.
        """
        shape = (*points.shape[:-1], len(PARTIALS[order]), len(self))
        if order > self.degree:
            return np.zeros(shape)
        return (monomials(self.degree - order, points) @ self._derivatives[order]).reshape(shape)

    @cached_property
    def _derivatives(self) -> tuple[Floats, ...]:
        """By order: (monomial of the derivative's degree, partial * basis) coefficients of the derivatives."""
        power = exponents(self.degree)
        out = []
        for order, partials in enumerate(PARTIALS[: self.degree + 1]):
            lower = {
                pair: row for row, pair in enumerate(map(tuple, exponents(self.degree - order).tolist()))
            }
            table = np.zeros((len(lower), len(partials), len(self)))
            for k, partial in enumerate(partials):
                factor = falling(power[:, 0], partial[0]) * falling(power[:, 1], partial[1])
                for m in np.flatnonzero(factor):
                    i, j = (power[m] - partial).tolist()
                    table[lower[i, j], k] = factor[m] * self.coefficients[m]
            out.append(table.reshape(len(lower), -1))
        return tuple(out)

    def product_integrals(self, order: int) -> Floats:
        """Exact integrals over the reference triangle of products of derivatives.

        Returns
        -------
        (partial, partial, basis, basis) array.
        """
        power = exponents(self.degree)
        out = []
        for a in PARTIALS[order]:
            for b in PARTIALS[order]:
                fa = falling(power[:, 0], a[0]) * falling(power[:, 1], a[1])
                fb = falling(power[:, 0], b[0]) * falling(power[:, 1], b[1])
                total = power[:, None] + power[None, :] - np.array(a) - np.array(b)
                table = fa[:, None] * fb[None, :] * monomial_integrals(total)
                out.append(self.coefficients.T @ table @ self.coefficients)
        n = len(PARTIALS[order])
        return np.array(out).reshape(n, n, len(self), len(self))

    @cached_property
    def integrals(self) -> Floats:
        """(basis,) exact integral of each basis function over the reference triangle."""
        return self.coefficients.T @ monomial_integrals(exponents(self.degree))


def monomial_integrals(power: NDArray[np.int64]) -> Floats:
    """Integral of xi^i eta^j over the reference triangle, i! j! / (i + j + 2)!, for (..., 2) exponents."""
    top = int(max(power.max(), 0))
    table = np.array(
        [[factorial(i) * factorial(j) / factorial(i + j + 2) for j in range(top + 1)] for i in range(top + 1)]
    )
    safe = np.maximum(power, 0)  # a negative exponent goes with a zero factor
    return table[safe[..., 0], safe[..., 1]]
