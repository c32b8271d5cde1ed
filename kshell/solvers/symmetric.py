"""Factors of one symmetric matrix that need not be positive definite, with the count of its negative eigenvalues.

By Sylvester's law of inertia a factorisation L D L^T has as many negative pivots as the matrix has negative
eigenvalues. CHOLMOD has positive pivots only, PARDISO pivots of one or two unknowns, SuperLU those on the diagonal: it
counts only where it kept to the diagonal and its factors give a solution back.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from kshell.solvers.backends import CHOLMOD, PARDISO, SUPERLU, Singular, superlu
from kshell.solvers.repeated import Cholmod, Pardiso
from kshell.solvers.system import Floats

# relative residual of a solve with SuperLU up to which the signs of its pivots are believed
BELIEVED = 1e-6


class SymmetricFactor(NamedTuple):
    """A factorised symmetric matrix.

    Attributes
    ----------
    solve : callable
        (n,) or (n, k) to the same.
    count_negative : callable
        Number of negative eigenvalues, None where the library cannot say.
    name : str
        Of the library.
    """

    solve: Callable[[Any], Any]
    count_negative: Callable[[], int | None]
    name: str


def factorise_symmetric(matrix: Any, definite: bool) -> SymmetricFactor:
    """The fastest factorisation installed that fits.

    Parameters
    ----------
    matrix : (n, n) sparse matrix
        Symmetric.
    definite : bool
        Whether it is likely positive definite; if it turns out not to be, pivots of both signs are taken.

    Raises
    ------
    Singular
        If a pivot is zero.
    """
    if definite and CHOLMOD.installed:
        indptr, indices, data = _lower(matrix)
        try:
            factor = Cholmod(indptr, indices).factorise(data)
        except Singular:
            pass  # not positive definite: the pivots below say how far
        else:
            return SymmetricFactor(factor.solve, factor.count_negative, CHOLMOD.name)
    if PARDISO.installed:
        indptr, indices, data = _lower(matrix)
        factor = Pardiso(indptr, indices).factorise(data)
        return SymmetricFactor(factor.solve, factor.count_negative, PARDISO.name)
    return _superlu(matrix)


def _lower(matrix: Any) -> tuple[Any, Any, Floats]:
    """Compressed columns of the lower triangle, which are the rows of the upper one."""
    import scipy.sparse as sp

    upper = sp.triu(matrix, format="csr")
    upper.sort_indices()
    return upper.indptr, upper.indices, upper.data


def _superlu(matrix: Any) -> SymmetricFactor:
    lu = superlu(matrix)

    def count_negative() -> int | None:
        if not np.array_equal(lu.perm_r, lu.perm_c):
            return None
        rhs = np.random.default_rng(0).standard_normal(matrix.shape[0])
        miss = np.linalg.norm(matrix @ lu.solve(rhs) - rhs)
        if not miss <= BELIEVED * np.linalg.norm(rhs):
            return None
        return int(np.sum(lu.U.diagonal() < 0))

    return SymmetricFactor(lu.solve, count_negative, SUPERLU.name)
