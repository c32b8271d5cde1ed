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


def solve_dense(matrix: Floats, rhs: Floats) -> Solution | None:
    """Solve A x = b, A positive definite, as a dense array.

    Parameters
    ----------
    matrix : (n, n) float array
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
    from scipy.linalg.lapack import dpotrf, dpotrs

    begin = time.perf_counter()
    b = checked_rhs(rhs, len(matrix))
    if not np.isfinite(matrix).all():
        return None
    factor, info = dpotrf(matrix, lower=1)
    if info != 0:
        return None

    def solve(right: Floats) -> Any:
        return dpotrs(factor, right, lower=1)[0]

    _, stiffness = softest_vector(matrix, solve)
    if not stiffness > FREE_MOTION:
        return None
    ready = time.perf_counter()
    columns = b.reshape(len(b), -1)
    x, history, steps, residual = refine(matrix.__matmul__, columns, solve)
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
        seconds={"setup": ready - begin, "solve": time.perf_counter() - ready},
    )
