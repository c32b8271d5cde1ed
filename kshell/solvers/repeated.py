"""Factorisations of many symmetric matrices with one pattern: what depends on the pattern alone is done once.

Each class is made from the pattern, compressed columns of the lower triangle (SuperLU: of the whole matrix), and
turns entries into a `Factor`. A factor serves until the next one is made from the same pattern.
"""

from __future__ import annotations

import copy
import weakref
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.solvers.backends import Singular, rslab_factor, rslab_solve
from kshell.solvers.system import Floats

Ints = NDArray[np.integer]

# digits of a pivot, against the largest, below which PARDISO changes it. Its own choice of 8 would change
# the bending stiffness of shells thinner than 1e-4 of an element.
PARDISO_PIVOT_DIGITS = 15


class Factor(NamedTuple):
    """A factorised symmetric matrix.

    Attributes
    ----------
    solve : callable
        (n,) or (n, load) to the same.
    count_negative : callable
        The number of negative eigenvalues, by the signs of the pivots.
    definite : bool
        Whether it is known to be positive definite without counting.
    """

    solve: Callable[[Any], Any]
    count_negative: Callable[[], int]
    definite: bool = False

    @property
    def negative(self) -> int:
        """Negative eigenvalues."""
        return self.count_negative()


def _none() -> int:
    return 0


def dense_factor(matrix: Floats) -> Factor | None:
    """Cholesky factor of a full matrix; None where it is not positive definite."""
    from scipy.linalg.lapack import dpotrf, dpotrs

    factor, info = dpotrf(matrix, lower=1)
    if info != 0 or not np.isfinite(factor).all():
        return None
    return Factor(lambda rhs: np.asarray(dpotrs(factor, rhs, lower=1)[0]).reshape(rhs.shape), _none, True)


def renumbered(factor: Factor, number: Ints) -> Factor:
    """The factor of a matrix as that of the matrix whose unknowns have these numbers in it."""

    def solve(rhs: Floats) -> Floats:
        moved = np.empty_like(rhs)
        moved[number] = rhs
        return np.asarray(factor.solve(moved))[number]

    return Factor(solve, factor.count_negative, factor.definite)


class Cholmod:
    """Cholesky factors by CHOLMOD; `Singular` where the matrix is not positive definite.

    Parameters
    ----------
    indptr, indices : int arrays
    entries : array, optional
        Of the first matrix, which `factorise` need not be given then.
    ordered : bool
        Whether the unknowns are in a good order of elimination; else it looks for one.
    once : bool
        Whether there is one matrix only, which is not kept beside its factor.
    """

    def __init__(
        self,
        indptr: Ints,
        indices: Ints,
        entries: Floats | None = None,
        ordered: bool = False,
        once: bool = False,
    ) -> None:
        from cvxopt import cholmod, spmatrix
        from cvxopt import matrix as dense

        self._cholmod, self._dense, self._once, self._size = cholmod, dense, once, len(indptr) - 1
        self._matrix: Any = None
        self._fill(spmatrix, indptr, indices, entries)
        order = {"p": dense(np.arange(self._size, dtype=np.int64))} if ordered else {}
        self._symbolic = cholmod.symbolic(self._matrix, uplo="L", **order)

    def _fill(self, spmatrix: Any, indptr: Ints, indices: Ints, entries: Floats | None = None) -> None:
        n, dense = self._size, self._dense
        row = dense(indices.astype(np.int64))
        column = dense(np.repeat(np.arange(n, dtype=np.int64), np.diff(indptr)))
        self._matrix = spmatrix(1.0 if entries is None else dense(entries), row, column, (n, n))

    def another(self, indptr: Ints, indices: Ints) -> Cholmod:
        """For further matrices of this pattern, in the order of elimination of the first; its factor stays."""
        from cvxopt import spmatrix

        other = copy.copy(self)
        other._once = False
        if other._matrix is None:
            other._fill(spmatrix, indptr, indices)
        place = self._dense(np.arange(self._size, dtype=np.float64))
        self._cholmod.solve(self._symbolic, place, sys=7)  # P x
        order = self._dense(np.array(place).ravel().astype(np.int64))
        options, methods = self._cholmod.options, self._cholmod.options.get("nmethods")
        options["nmethods"] = 1  # the order that is given, and no look at others
        try:
            other._symbolic = self._cholmod.symbolic(other._matrix, uplo="L", p=order)
        finally:
            del options["nmethods"]
            if methods is not None:
                options["nmethods"] = methods
        return other

    def factorise(self, entries: Floats | None = None) -> Factor:
        if entries is not None:
            self._matrix.V = self._dense(entries)
        try:
            self._cholmod.numeric(self._matrix, self._symbolic)
        except ArithmeticError as error:
            raise Singular(f"CHOLMOD: the pivot of unknown {error} is not positive") from error
        if self._once:
            self._matrix = None
        return Factor(self._solve, _none, True)

    def _solve(self, rhs: Floats) -> Floats:
        x = self._dense(np.asfortranarray(rhs))
        self._cholmod.solve(self._symbolic, x)
        return np.array(x).reshape(rhs.shape)


class CholmodColumns:
    """L D L^T by CHOLMOD, column by column, D diagonal and of any signs: there is no choice of pivots.

    Parameters
    ----------
    indptr, indices : int arrays
    ordered : bool
        Whether the unknowns are in a good order of elimination; else it looks for one.
    """

    def __init__(self, indptr: Ints, indices: Ints, ordered: bool = False) -> None:
        from cvxopt import cholmod, spmatrix
        from cvxopt import matrix as dense

        n = len(indptr) - 1
        column = np.repeat(np.arange(n, dtype=np.int64), np.diff(indptr))
        self._matrix = spmatrix(1.0, dense(indices.astype(np.int64)), dense(column), (n, n))
        before = cholmod.options.get("supernodal", 2)
        cholmod.options["supernodal"] = 0
        try:
            order = {"p": dense(np.arange(n, dtype=np.int64))} if ordered else {}
            self._symbolic = cholmod.symbolic(self._matrix, uplo="L", **order)
        finally:
            cholmod.options["supernodal"] = before
        self._cholmod, self._dense, self._count = cholmod, dense, n

    def factorise(self, entries: Floats, last: bool = False) -> Factor:
        """The matrix with these entries; `last`: there is no other one, and it is not kept beside its factor."""
        self._matrix.V = self._dense(entries)
        try:
            self._cholmod.numeric(self._matrix, self._symbolic)
        except ArithmeticError as error:
            raise Singular(f"CHOLMOD: the pivot of unknown {error} is zero") from error
        if last:
            del self._matrix
        inverse = self._dense(np.ones(self._count))
        self._cholmod.solve(self._symbolic, inverse, sys=6)  # D x = 1
        negative = int(np.sum(np.array(inverse) < 0.0))
        return Factor(self._solve, lambda: negative)

    def _solve(self, rhs: Floats) -> Floats:
        x = self._dense(np.asfortranarray(rhs))
        self._cholmod.solve(self._symbolic, x)
        return np.array(x).reshape(rhs.shape)


class Rslab:
    """L D L^T by rslab with pivots of one or two unknowns, also of indefinite matrices."""

    def __init__(self, indptr: Ints, indices: Ints) -> None:
        n = len(indptr) - 1
        self._lower = sp.csc_matrix((np.ones(len(indices)), indices, indptr), shape=(n, n))
        self._analysis: Any = None

    def another(self, indptr: Ints, indices: Ints) -> Rslab:
        """For further matrices of this pattern: factors are independent of each other."""
        return self

    def factorise(self, entries: Floats) -> Factor:
        self._lower.data = np.ascontiguousarray(entries, dtype=np.float64)
        factor, self._analysis = rslab_factor(self._lower, self._analysis)
        negative = int(factor.inertia[1])
        return Factor(lambda rhs: rslab_solve(factor, rhs), lambda: negative, negative == 0)


class Pardiso:
    """L D L^T by PARDISO with pivots of one or two unknowns, also of indefinite matrices."""

    def __init__(self, indptr: Ints, indices: Ints) -> None:
        from pypardiso import PyPardisoSolver

        n = len(indptr) - 1
        # compressed columns of the lower triangle are compressed rows of the upper one
        self._matrix = sp.csr_matrix((np.ones(len(indices)), indices, indptr), shape=(n, n))
        self._solver = PyPardisoSolver(mtype=-2)
        self._solver.set_iparm(1, 1)  # the numbers below hold, not the defaults
        self._solver.set_iparm(2, 2)  # nested dissection
        self._solver.set_iparm(10, PARDISO_PIVOT_DIGITS)
        self._solver.set_iparm(21, 1)  # Bunch and Kaufman
        self._analysed = False
        weakref.finalize(self, self._solver.free_memory, True)

    def another(self, indptr: Ints, indices: Ints) -> Pardiso:
        """For further matrices of this pattern, whose factors leave those of this one alone."""
        return Pardiso(indptr, indices)

    def factorise(self, entries: Floats) -> Factor:
        from pypardiso.pardiso_wrapper import PyPardisoError

        self._matrix.data = entries
        self._solver.set_phase(22 if self._analysed else 12)
        try:
            self._solver._call_pardiso(self._matrix, np.zeros((self._matrix.shape[0], 1)))
        except PyPardisoError as error:
            if error.value not in (-4, -7):
                raise
            raise Singular(f"PARDISO: zero pivot (error {error.value})") from error
        self._analysed = True
        if self._solver.get_iparm(14) > 0:
            raise Singular("PARDISO: pivots of the size of rounding")
        negative = int(self._solver.get_iparm(23))
        return Factor(self._solve, lambda: negative)

    def _solve(self, rhs: Floats) -> Floats:
        self._solver.set_phase(33)
        x = self._solver._call_pardiso(self._matrix, np.asfortranarray(rhs))
        return np.asarray(x).reshape(rhs.shape)


class SuperLU:
    """LU by SuperLU with pivots on the diagonal, in the order of the unknowns: they should come well ordered."""

    def __init__(self, indptr: Ints, indices: Ints) -> None:
        n = len(indptr) - 1
        self._matrix = sp.csc_matrix((np.ones(len(indices)), indices, indptr), shape=(n, n))

    def another(self, indptr: Ints, indices: Ints) -> SuperLU:
        """For further matrices of this pattern: factors are independent of each other."""
        return self

    def factorise(self, entries: Floats) -> Factor:
        from scipy.sparse.linalg import splu

        self._matrix.data = entries
        options = {"SymmetricMode": True}
        try:
            lu: Any = splu(self._matrix, permc_spec="NATURAL", diag_pivot_thresh=0.0, options=options)
        except RuntimeError as error:
            if "singular" not in str(error):
                raise
            raise Singular(str(error)) from error
        return Factor(lu.solve, lambda: int(np.sum(lu.U.diagonal() < 0)))
