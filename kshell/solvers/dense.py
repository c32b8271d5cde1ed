"""Small systems: a dense Cholesky factorisation, which beats the bookkeeping of sparse ones."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from kshell.solvers.checks import FREE_MOTION, checked_rhs, softest_vector
from kshell.solvers.refine import refine
from kshell.solvers.system import Floats, Solution

# Up to here it is as fast as CHOLMOD on plates (Argyris 334 unknowns: 0.6 ms against 0.8 ms), and five times as fast
# with the sparsity pattern that it makes unnecessary.
DENSE_UP_TO = 400
HOPELESS = 1e-9  # relative energy error after refinement that a sparse solver shall look at


class DenseFactor:
    """Cholesky factor of A, positive definite, for any number of loads.

    Parameters
    ----------
    matrix : (n, n) float array
        Symmetric; the lower triangle is used.

    Attributes
    ----------
    good : bool
        False where the matrix is singular, nearly singular or not finite.
    """

    def __init__(self, matrix: Floats) -> None:
        from scipy.linalg.lapack import dpotrf

        begin = time.perf_counter()
        self.matrix, self.good = matrix, False
        if np.isfinite(matrix).all():
            self._factor, info = dpotrf(matrix, lower=1)
            self.good = info == 0 and bool(softest_vector(matrix, self.apply)[1] > FREE_MOTION)
        self.seconds = time.perf_counter() - begin

    def apply(self, right: Floats) -> Any:
        """A^-1 right, not refined, (n,) or (n, load)."""
        from scipy.linalg.lapack import dpotrs

        return dpotrs(self._factor, right, lower=1)[0].reshape(right.shape)


def solve_dense(matrix: Floats | DenseFactor, rhs: Floats) -> Solution | None:
    """Solve A x = b, A positive definite, as a dense array.

    Parameters
    ----------
    matrix : (n, n) float array or DenseFactor
        Symmetric; the lower triangle is used.
    rhs : (n,) or (n, load) float array

    Returns
    -------
    Solution, or None where the matrix is singular, nearly singular or not finite: the ordinary way finds the words.

    Raises
    ------
    InputError
        If the load is not finite.
    """
    factor = matrix if isinstance(matrix, DenseFactor) else DenseFactor(matrix)
    b = checked_rhs(rhs, len(factor.matrix))
    if not factor.good:
        return None
    ready = time.perf_counter()
    columns = b.reshape(len(b), -1)
    x, history, steps, residual = refine(factor.matrix.__matmul__, columns, factor.apply)
    if not (np.isfinite(x).all() and history[-1] <= HOPELESS):
        return None
    size = np.linalg.norm(columns, axis=0)
    left = np.linalg.norm(residual, axis=0)
    return Solution(
        x=x.reshape(b.shape),
        name="Cholesky (LAPACK)",
        why=f"{len(b)} unknowns: up to {DENSE_UP_TO} a dense factorisation is the fastest",
        iterations=steps,
        history=history,
        energy_error=history[-1],
        residual=float(np.max(left / np.where(size > 0, size, 1.0), initial=0.0)),
        seconds={"setup": factor.seconds, "solve": time.perf_counter() - ready},
    )
