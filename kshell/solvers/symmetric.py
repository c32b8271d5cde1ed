"""Factors of one symmetric matrix that need not be positive definite, with the count of its negative eigenvalues.

By Sylvester's law of inertia a factorisation L D L^T has as many negative pivots as the matrix has negative
eigenvalues. PARDISO has pivots of one or two unknowns; CHOLMOD, in the variant that takes one column after the other,
and SuperLU have those on the diagonal, whatever their size: they count only where their factors give a solution back.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from kshell.solvers.backends import CHOLMOD, PARDISO, RSLAB, SUPERLU, Singular, superlu
from kshell.solvers.repeated import Cholmod, CholmodColumns, Pardiso, Rslab
from kshell.solvers.system import Floats

# relative residual of a solve up to which the signs of pivots on the diagonal are believed
BELIEVED = 1e-6
# up to so many unknowns SuperLU counts in reasonable time
SUPERLU_UP_TO = 60_000


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
    if hasattr(matrix, "factorised"):  # one that several processes have knows how
        divided: SymmetricFactor = matrix.factorised(definite)
        return divided
    if definite and CHOLMOD.installed:
        indptr, indices, data = _lower(matrix)
        try:
            factor = Cholmod(indptr, indices).factorise(data)
        except Singular:
            pass  # not positive definite: the pivots below say how far
        else:
            return SymmetricFactor(factor.solve, factor.count_negative, CHOLMOD.name)
    if RSLAB.installed:
        indptr, indices, data = _lower(matrix)
        factor = Rslab(indptr, indices).factorise(data)
        return SymmetricFactor(factor.solve, factor.count_negative, RSLAB.name)
    if PARDISO.installed:
        indptr, indices, data = _lower(matrix)
        factor = Pardiso(indptr, indices).factorise(data)
        return SymmetricFactor(factor.solve, factor.count_negative, PARDISO.name)
    if CHOLMOD.installed:
        found = _columns(matrix)
        if found is not None:
            return found
    return _superlu(matrix)


def counts(unknowns: int) -> bool:
    """Whether a library here counts eigenvalues of so large a matrix in reasonable time."""
    return RSLAB.installed or PARDISO.installed or CHOLMOD.installed or unknowns <= SUPERLU_UP_TO


def _columns(matrix: Any) -> SymmetricFactor | None:
    """L D L^T by CHOLMOD, D diagonal; None where it does not give a solution back."""
    scale, scaled = _scaled(matrix)
    indptr, indices, data = _lower(scaled)
    try:
        factor = CholmodColumns(indptr, indices).factorise(data)
    except Singular:
        return None
    if _miss(scaled, factor.solve) > BELIEVED:
        return None
    return SymmetricFactor(_unscaled(factor.solve, scale), factor.count_negative, CHOLMOD.name)


def _scaled(matrix: Any) -> tuple[Floats, Any]:
    """S and S A S with a diagonal of ones in size, which has the same inertia: meshes may be graded by 1e-6."""
    import scipy.sparse as sp

    size = np.abs(matrix.diagonal())
    scale = 1.0 / np.sqrt(np.where(size > 0.0, size, 1.0))
    by = sp.diags(scale)
    return scale, (by @ matrix @ by).tocsr()


def _unscaled(solve: Callable[[Any], Any], scale: Floats) -> Callable[[Any], Any]:
    def both(rhs: Any) -> Any:
        s = scale if rhs.ndim == 1 else scale[:, None]
        return s * solve(s * rhs)

    return both


def _miss(matrix: Any, solve: Callable[[Any], Any]) -> float:
    """Relative residual of a solve; infinite where it overflows."""
    rhs = np.random.default_rng(0).standard_normal(matrix.shape[0])
    with np.errstate(over="ignore", invalid="ignore"):
        miss = float(np.linalg.norm(matrix @ solve(rhs) - rhs) / np.linalg.norm(rhs))
    return miss if np.isfinite(miss) else float("inf")


def _lower(matrix: Any) -> tuple[Any, Any, Floats]:
    """Compressed columns of the lower triangle, which are the rows of the upper one."""
    import scipy.sparse as sp

    upper = sp.triu(matrix, format="csr")
    upper.sort_indices()
    return upper.indptr, upper.indices, upper.data


def _superlu(matrix: Any) -> SymmetricFactor:
    scale, scaled = _scaled(matrix)
    lu = superlu(scaled)

    def count_negative() -> int | None:
        if not np.array_equal(lu.perm_r, lu.perm_c):
            return None
        if _miss(scaled, lu.solve) > BELIEVED:
            return None
        return int(np.sum(lu.U.diagonal() < 0))

    return SymmetricFactor(_unscaled(lu.solve, scale), count_negative, SUPERLU.name)
