"""Sparse factorisations found at run time: SuperLU of scipy always, CHOLMOD, rslab and PARDISO where installed.

A back end is a function from a symmetric positive definite CSR matrix to a function that solves for
(n,) or (n, load). All of them raise `Singular` when a pivot breaks down.
"""

from __future__ import annotations

import importlib.util
import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from kshell.errors import InputError
from kshell.solvers.system import Floats

Solver = Callable[[Floats], Floats]


class Singular(Exception):
    """A pivot broke down: the matrix is singular, or not positive definite."""


@dataclass(frozen=True)
class Backend:
    """One library for sparse factorisation.

    Attributes
    ----------
    key : str
        What a user writes, e.g. method="cholmod".
    name : str
        What a result says.
    modules : tuple of str
        Must be importable; the first is the package to install.
    factorise : function
        CSR matrix -> (solve function, entries of the factor or 0 where the library does not say).
    loads : function, optional
        Whether a library that its modules load can be loaded; asked only when they are found.
    """

    key: str
    name: str
    modules: tuple[str, ...]
    factorise: Callable[[Any], tuple[Solver, int]]
    loads: Callable[[], bool] | None = None

    @property
    def installed(self) -> bool:
        """Whether its modules can be found, and, where it needs a library besides, that one too."""
        return _found(self.modules) and (self.loads is None or self.loads())


@cache
def _found(modules: tuple[str, ...]) -> bool:
    return all(importlib.util.find_spec(name) is not None for name in modules)


def superlu(matrix: Any) -> Any:
    """The factor of a symmetric matrix by SuperLU, its pivots on the diagonal where they can be.

    Raises
    ------
    Singular
        If the matrix is.
    MemoryError
        If the factor does not fit.
    """
    from scipy.sparse.linalg import splu

    try:
        # symmetric minimum degree, pivots on the diagonal: half the fill of the unsymmetric default
        return splu(
            matrix.tocsc(),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except RuntimeError as error:
        if "singular" not in str(error):
            raise
        raise Singular(str(error)) from error
    except SystemError as error:  # how SuperLU reports that the factor outgrew its 32-bit counters
        raise MemoryError(f"SuperLU: {error}") from error


def _superlu(matrix: Any) -> tuple[Solver, int]:
    factor = superlu(matrix)
    return factor.solve, int(factor.nnz)


def _cholmod(matrix: Any) -> tuple[Solver, int]:
    from cvxopt import cholmod, spmatrix
    from cvxopt import matrix as dense

    lower = _lower_triangle(matrix)
    n = matrix.shape[0]
    row = dense(lower.indices.astype(np.int64))
    column = dense(np.repeat(np.arange(n, dtype=np.int64), np.diff(lower.indptr)))
    a = spmatrix(dense(lower.data), row, column, (n, n))
    del row, column, lower
    factor = cholmod.symbolic(a, uplo="L")
    try:
        cholmod.numeric(a, factor)
    except ArithmeticError as error:
        raise Singular(f"CHOLMOD: the pivot of unknown {error} is not positive") from error

    def solve(rhs: Floats) -> Floats:
        x = dense(np.asfortranarray(rhs))
        cholmod.solve(factor, x)
        return np.array(x).reshape(rhs.shape)

    return solve, 0


def _pypardiso() -> tuple[Any, Any]:
    """Its solver and its error.

    Raises
    ------
    ImportError
        Where the package, or MKL, which it loads when it is imported, cannot be loaded.
    """
    try:
        from pypardiso import PyPardisoSolver
        from pypardiso.pardiso_wrapper import PyPardisoError
    except OSError as error:
        raise ImportError(f"pypardiso: {error}") from error
    return PyPardisoSolver, PyPardisoError


@cache
def _loads_mkl() -> bool:
    try:
        _pypardiso()
    except ImportError:
        return False
    return True


def _pardiso(matrix: Any) -> tuple[Solver, int]:
    PyPardisoSolver, PyPardisoError = _pypardiso()

    upper = _lower_triangle(matrix).T.tocsr()  # CSC of the lower triangle is CSR of the upper one
    solver = PyPardisoSolver(mtype=2)  # real symmetric positive definite
    try:
        solver.factorize(upper)
    except PyPardisoError as error:
        if error.value not in (-4, -7):
            raise
        raise Singular(f"PARDISO: zero or negative pivot (error {error.value})") from error
    entries = int(solver.get_iparm(18))

    def solve(rhs: Floats) -> Floats:
        return np.asarray(solver.solve(upper, np.asfortranarray(rhs))).reshape(rhs.shape)

    return solve, entries


def rslab_factor(lower: Any, analysis: Any = None) -> tuple[Any, Any]:
    """L D L^T of a symmetric matrix by rslab, with pivots of one or two unknowns, and its analysis for further ones.

    Parameters
    ----------
    lower : (n, n) sparse CSC
        Its lower triangle.

    Raises
    ------
    Singular
        If the matrix is.
    """
    import rslab

    if analysis is None:
        # of its orders this one is quickest on the whole, and the only one that is on plates of 1e6 unknowns
        threads = int(os.environ.get("OMP_NUM_THREADS") or os.cpu_count() or 1)
        analysis = rslab.analyze(lower, path="ldlt", ordering="amf", nemin=32, threads=threads)
    try:
        factor = analysis.factor(lower)
    except RuntimeError as error:
        raise Singular(f"rslab: {error}") from error
    if factor.inertia[2]:
        raise Singular("rslab: zero pivots")
    return factor, analysis


def rslab_solve(factor: Any, rhs: Floats) -> Floats:
    """The solution for (n,) or (n, load)."""
    if rhs.ndim == 1:
        return np.asarray(factor.solve(np.ascontiguousarray(rhs, dtype=np.float64)))
    return np.asarray(factor.solve_many(np.ascontiguousarray(rhs, dtype=np.float64)))


def _rslab(matrix: Any) -> tuple[Solver, int]:
    factor, _ = rslab_factor(_lower_triangle(matrix))
    if factor.inertia[1]:
        raise Singular(f"rslab: {factor.inertia[1]} negative pivots")
    return lambda rhs: rslab_solve(factor, rhs), int(factor.factor_nnz)


def _lower_triangle(matrix: Any) -> Any:
    """The lower triangle as CSC, taken from the rows of the symmetric matrix (its upper triangle as CSR)."""
    import scipy.sparse as sp

    n = matrix.shape[0]
    rows = np.repeat(np.arange(n, dtype=np.int32), np.diff(matrix.indptr))
    keep = matrix.indices >= rows
    pointer = np.concatenate([[0], np.cumsum(np.bincount(rows[keep], minlength=n))])
    return sp.csc_matrix((matrix.data[keep], matrix.indices[keep], pointer), shape=matrix.shape)


SUPERLU = Backend("superlu", "SuperLU (scipy)", ("scipy",), _superlu)
CHOLMOD = Backend("cholmod", "CHOLMOD (cvxopt)", ("cvxopt",), _cholmod)
PARDISO = Backend("pardiso", "PARDISO (pypardiso)", ("pypardiso",), _pardiso, _loads_mkl)
RSLAB = Backend("rslab", "LDL^T (rslab)", ("rslab",), _rslab)
BACKENDS = (CHOLMOD, RSLAB, PARDISO, SUPERLU)  # in the order of preference of the table in auto.py


def preferred_backend() -> Backend:
    """The first back end present here; SuperLU always is. Those after it are not looked for."""
    return next(backend for backend in BACKENDS if backend.installed)


def installed_backends() -> tuple[Backend, ...]:
    """The back ends present here, the preferred one first; SuperLU is always among them."""
    return tuple(backend for backend in BACKENDS if backend.installed)


def backend_named(key: str) -> Backend:
    """The back end a user asked for by name.

    Raises
    ------
    InputError
        If it is unknown, or not installed.
    """
    for backend in BACKENDS:
        if backend.key == key:
            if not backend.installed:
                raise InputError(
                    f"solver {key!r} is not installed here: pip install {backend.modules[0]}, or use 'direct'"
                )
            return backend
    raise InputError(f"unknown solver {key!r}")
