"""Factors of one symmetric matrix that need not be positive definite, with the count of its negative eigenvalues.

Half of the matrix is copied once, in an order of elimination where one is given; nothing but the factor is kept.

By Sylvester's law of inertia a factorisation L D L^T has as many negative pivots as the matrix has negative
eigenvalues. PARDISO has pivots of one or two unknowns; CHOLMOD, in the variant that takes one column after the other,
and SuperLU have those on the diagonal, whatever their size: they count only where their factors give a solution back.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kshell.solvers.backends import CHOLMOD, PARDISO, RSLAB, SUPERLU, Singular, superlu
from kshell.solvers.repeated import Cholmod, CholmodColumns, Pardiso, Rslab
from kshell.solvers.system import Floats

Ints = NDArray[np.integer]

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


class Half(NamedTuple):
    """The lower triangle in compressed columns, which are the rows of the upper one; rows and columns in an order."""

    indptr: Any
    indices: Any
    data: Floats
    order: Ints | None = None

    @classmethod
    def of(cls, matrix: Any, order: Ints | None = None) -> Half:
        """Of a symmetric matrix (n, n); order (n,) has the unknown in each place."""
        import scipy.sparse as sp

        if order is None:
            upper = sp.triu(matrix, format="csr")
        else:
            place = np.empty(len(order), dtype=np.int32)
            place[order] = np.arange(len(order), dtype=np.int32)
            given = sp.triu(matrix, format="coo")
            row, column = place[given.row], place[given.col]
            ends = np.minimum(row, column), np.maximum(row, column)
            upper = sp.coo_matrix((given.data, ends), shape=given.shape).tocsr()
        upper.sort_indices()
        return cls(upper.indptr, upper.indices, upper.data, order)

    def diagonal(self) -> Floats:
        """(n,), the first entry of each row of the upper triangle; zero where there is none."""
        first = self.indptr[:-1]
        out = np.zeros(len(first))
        some = np.diff(self.indptr) > 0
        own = np.flatnonzero(some)[self.indices[first[some]] == np.flatnonzero(some)]
        out[own] = self.data[first[own]]
        return out

    def scaled(self, scale: Floats) -> Half:
        """S A S with a diagonal S."""
        rows = np.repeat(scale, np.diff(self.indptr))
        return Half(self.indptr, self.indices, self.data * rows * scale[self.indices], self.order)

    def times(self, x: Floats) -> Floats:
        """The product with (n,), in the order of the half."""
        import scipy.sparse as sp

        n = len(self.indptr) - 1
        upper = sp.csr_matrix((self.data, self.indices, self.indptr), shape=(n, n))
        return np.asarray(upper @ x + upper.T @ x - self.diagonal() * x)

    def solving(self, solve: Callable[[Any], Any]) -> Callable[[Any], Any]:
        """A solution in the order of the half as one in the order of the unknowns."""
        order = self.order
        if order is None:
            return solve

        def both(rhs: Any) -> Any:
            out = np.empty_like(rhs)
            out[order] = solve(np.asarray(rhs)[order])
            return out

        return both


def factorise_symmetric(matrix: Any, definite: bool, order: Ints | None = None) -> SymmetricFactor:
    """The fastest factorisation installed that fits.

    Parameters
    ----------
    matrix : (n, n) sparse matrix
        Symmetric.
    definite : bool
        Whether it is likely positive definite; if it turns out not to be, pivots of both signs are taken.
    order : (n,) int array, optional
        The unknown in each place of an order of elimination with little fill, for CHOLMOD, which has none as good.

    Raises
    ------
    Singular
        If a pivot is zero.
    """
    if hasattr(matrix, "factorised"):  # one that several processes have knows how
        divided: SymmetricFactor = matrix.factorised(definite)
        return divided
    if definite and CHOLMOD.installed:
        half = Half.of(matrix, order)
        try:
            factor = Cholmod(*half[:3], ordered=order is not None, once=True).factorise()
        except Singular:
            pass  # not positive definite: the pivots below say how far
        else:
            return SymmetricFactor(half.solving(factor.solve), factor.count_negative, CHOLMOD.name)
        del half
    if RSLAB.installed:
        indptr, indices, data = Half.of(matrix)[:3]
        factor = Rslab(indptr, indices).factorise(data)
        return SymmetricFactor(factor.solve, factor.count_negative, RSLAB.name)
    if PARDISO.installed:
        indptr, indices, data = Half.of(matrix)[:3]
        factor = Pardiso(indptr, indices).factorise(data)
        return SymmetricFactor(factor.solve, factor.count_negative, PARDISO.name)
    if CHOLMOD.installed:
        half = Half.of(matrix, order)
        if order is not None:
            del matrix  # may be large, and is made again from its half
        found = _columns(half)
        if found is not None:
            return found
        if order is not None:
            matrix = _whole(half)
    return _superlu(matrix)


def counts(unknowns: int) -> bool:
    """Whether a library here counts eigenvalues of so large a matrix in reasonable time."""
    return RSLAB.installed or PARDISO.installed or CHOLMOD.installed or unknowns <= SUPERLU_UP_TO


def _columns(half: Half) -> SymmetricFactor | None:
    """L D L^T by CHOLMOD, D diagonal; None where it does not give a solution back."""
    scale = _scale(half.diagonal())
    scaled = half.scaled(scale)
    try:
        factor = CholmodColumns(*scaled[:2], scaled.order is not None).factorise(scaled.data, last=True)
    except Singular:
        return None
    if _miss(scaled.times, len(scale), factor.solve) > BELIEVED:
        return None
    solve = half.solving(_unscaled(factor.solve, scale))
    return SymmetricFactor(solve, factor.count_negative, CHOLMOD.name)


def _whole(half: Half) -> Any:
    """The matrix in the order of the unknowns."""
    import scipy.sparse as sp

    n = len(half.indptr) - 1
    upper = sp.csr_matrix((half.data, half.indices, half.indptr), shape=(n, n))
    whole = (upper + sp.triu(upper, 1).T).tocsr()
    if half.order is None:
        return whole
    place = np.argsort(half.order)
    return whole[place][:, place]


def _scale(diagonal: Floats) -> Floats:
    """(n,) scales that make a diagonal one of ones in size, and keep the inertia: meshes may be graded by 1e-6."""
    size = np.abs(diagonal)
    return np.asarray(1.0 / np.sqrt(np.where(size > 0.0, size, 1.0)))


def _scaled(matrix: Any) -> tuple[Floats, Any]:
    """S and S A S with a diagonal of ones in size."""
    import scipy.sparse as sp

    scale = _scale(matrix.diagonal())
    by = sp.diags(scale)
    return scale, (by @ matrix @ by).tocsr()


def _unscaled(solve: Callable[[Any], Any], scale: Floats) -> Callable[[Any], Any]:
    def both(rhs: Any) -> Any:
        s = scale if rhs.ndim == 1 else scale[:, None]
        return s * solve(s * rhs)

    return both


def _miss(times: Callable[[Any], Any], n: int, solve: Callable[[Any], Any]) -> float:
    """Relative residual of a solve; infinite where it overflows."""
    rhs = np.random.default_rng(0).standard_normal(n)
    with np.errstate(over="ignore", invalid="ignore"):
        miss = float(np.linalg.norm(times(solve(rhs)) - rhs) / np.linalg.norm(rhs))
    return miss if np.isfinite(miss) else float("inf")


def _superlu(matrix: Any) -> SymmetricFactor:
    scale, scaled = _scaled(matrix)
    lu = superlu(scaled)

    def count_negative() -> int | None:
        if not np.array_equal(lu.perm_r, lu.perm_c):
            return None
        if _miss(lambda x: scaled @ x, len(scale), lu.solve) > BELIEVED:
            return None
        return int(np.sum(lu.U.diagonal() < 0))

    return SymmetricFactor(_unscaled(lu.solve, scale), count_negative, SUPERLU.name)
