"""Factorisation of tangent matrices that need not be positive definite, with the count of negative pivots."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.condensed import Condensed
from kshell.equilibrium.energy import StrainEnergy
from kshell.equilibrium.free_pattern import FreePattern
from kshell.equilibrium.reduced import ReducedPattern
from kshell.equilibrium.reduction import Reduction
from kshell.errors import SolveError
from kshell.solvers.backends import CHOLMOD, PARDISO, RSLAB, Singular
from kshell.solvers.memory import give_back
from kshell.solvers.nearest import picked
from kshell.solvers.repeated import Cholmod, Factor, Pardiso, Rslab, SuperLU, dense_factor

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

DENSE_UP_TO = 400  # unknowns up to which full matrices are quicker than to look for what is not zero
# free unknowns from which CHOLMOD is quicker in the order of dissection than in one of its own, and takes less memory:
# of 1e6 two thirds of the time
DISSECTED_FROM = 60_000


class Factoriser:
    """Factorises the matrices of one structure, T^T K T with the basis T of its free motions.

    Cholesky by CHOLMOD where it is installed and the matrix is positive definite. Otherwise pivots of both signs, by
    rslab, PARDISO, or, where these are not installed or find no pivots, by SuperLU in the order of nested dissection.
    Pattern and order are kept from one matrix to the next.

    Parameters
    ----------
    reduction : Reduction
    energy : StrainEnergy
        Tells a good order of elimination, for SuperLU.
    symmetric : bool
        False for a tangent with follower loads, which is symmetric only up to terms on free edges.
    """

    def __init__(self, reduction: Reduction, energy: StrainEnergy, symmetric: bool = True) -> None:
        self._basis, self._energy, self._symmetric = reduction.basis, energy, symmetric
        self._patterns: dict[bool, ReducedPattern] = {}
        self._solvers: dict[type, Any] = {}

    @cached_property
    def _place(self) -> Ints:
        """(free,) place of each free unknown: that of the first unknown it moves."""
        order = np.argsort(
            self._energy.elimination[self._basis.indices[self._basis.indptr[:-1]]], kind="stable"
        )
        place = np.empty(len(order), dtype=np.int32)
        place[order] = np.arange(len(order), dtype=np.int32)
        return place

    def factorise(self, matrix: sp.csr_matrix, definite: bool = True) -> Factor:
        """The matrix in the free unknowns, factorised. The factor serves until the next call.

        Parameters
        ----------
        matrix : (unknowns, unknowns) sparse CSR
        definite : bool
            False where it is likely not positive definite, which saves the attempt at Cholesky factors.

        Raises
        ------
        SolveError
            If the matrix is singular or holds numbers that are not finite.
        """
        if not np.all(np.isfinite(matrix.data)):
            raise SolveError("the stiffness is not finite: the step led too far away")
        return self._first(lambda kind: self._with(kind, matrix), definite)

    def positive(self, matrix: sp.csr_matrix) -> Factor | None:
        """The matrix in the free unknowns, factorised if it is positive definite, else None.

        Raises
        ------
        SolveError
            If the matrix holds numbers that are not finite.
        """
        if not np.all(np.isfinite(matrix.data)):
            raise SolveError("the stiffness is not finite: the step led too far away")
        if not self._basis.shape[1]:
            return Factor(np.zeros_like, lambda: 0, True)
        kind: type = Cholmod if self._symmetric and CHOLMOD.installed else SuperLU
        try:
            found = self._with(kind, matrix)
        except Singular:
            return None
        return found if found.definite or found.negative == 0 else None

    def factorise_at_rest(self, springs: sp.spmatrix | None = None) -> tuple[Factor, Floats]:
        """The stiffness of the state at rest with that of springs, factorised, and its diagonal (unknowns,).

        Straight from the elements where conditions do not couple their groups of unknowns.

        Raises
        ------
        SolveError
            If the matrix is singular or holds numbers that are not finite.
        """
        energy, basis = self._energy, sp.csc_matrix(self._basis)
        if basis.shape[1] and energy.unknowns <= DENSE_UP_TO:
            stiffness = energy.dense_stiffness()
            if springs is not None:
                stiffness += springs.toarray()
            rows = picked(basis)
            if rows is not None and (basis.data == 1.0).all():
                factor = dense_factor(stiffness[np.ix_(rows, rows)])
            else:
                factor = dense_factor(basis.T @ np.ascontiguousarray((basis.T @ stiffness).T))
            if factor is not None:
                return factor, np.diagonal(stiffness)
        if not (basis.shape[1] and FreePattern.possible(energy.sparsity, basis)):
            stiffness = energy.linear_stiffness()
            if springs is not None:
                stiffness = stiffness + springs
            return self.factorise(stiffness), stiffness.diagonal()
        diagonal: list[Floats] = []
        condensed: Condensed | None = None
        if springs is None and len(energy.inner):
            found = Condensed(energy.triangle_unknowns, energy.inner, basis)
            if found.possible:
                condensed, basis = found, found.outer

        def made(kind: type) -> Factor:
            dissected = kind is SuperLU or (kind is Cholmod and basis.shape[1] > DISSECTED_FROM)
            place = energy.group_places if dissected else None
            pattern = FreePattern(energy.sparsity, basis, place)
            entries, own = energy.free_stiffness(pattern, condensed)
            if not np.all(np.isfinite(entries)):
                raise SolveError("the stiffness is not finite: the step led too far away")
            diagonal[:] = [own if springs is None else own + springs.diagonal()]
            number, indptr, indices = pattern.number, pattern.indptr, pattern.indices
            if springs is not None or kind is SuperLU:
                lower = sp.csc_matrix((entries, indices, indptr), shape=(pattern.size,) * 2)
                if springs is not None:
                    moved = basis[:, np.argsort(number)]
                    lower = sp.csc_matrix(lower + sp.tril(moved.T @ springs @ moved))
                if kind is SuperLU:
                    lower = sp.csc_matrix(lower + sp.tril(lower, -1).T)
                lower.sort_indices()
                entries, indices, indptr = lower.data, lower.indices, lower.indptr
                del lower
            del pattern  # what is not needed any more leaves room for the factor
            if energy.unknowns > energy.kept:
                energy.forget()
                give_back()
            if kind is Cholmod:
                solver = Cholmod(indptr, indices, entries, dissected, once=True)
                del indptr, indices, entries
                return _renumbered(solver.factorise(), number)
            return _renumbered(kind(indptr, indices).factorise(entries), number)

        factor = self._first(made, True)
        if condensed is not None:
            factor = factor._replace(solve=condensed.solving(factor.solve))
        return factor, diagonal[0]

    def _first(self, factorised: Callable[[type], Factor], definite: bool) -> Factor:
        """The factor by the first library that there is and that the matrix suits."""
        if not self._basis.shape[1]:
            return Factor(np.zeros_like, lambda: 0)
        kinds: list[type] = []
        if self._symmetric:
            kinds += [Cholmod] * (CHOLMOD.installed and definite)
            kinds += [Rslab] if RSLAB.installed else [Pardiso] * PARDISO.installed
        for kind in kinds:
            try:
                return factorised(kind)
            except Singular:
                pass  # not positive definite, or no pivots that it trusts: the next ones say how far
        try:
            return factorised(SuperLU)
        except Singular as error:
            raise SolveError("the tangent stiffness is singular") from error

    def reduced(self, matrix: sp.csr_matrix, lower: bool = True) -> tuple[ReducedPattern, Floats]:
        """Pattern and entries of the matrix in the free unknowns: its lower triangle, or all of it."""
        pattern = self._patterns.get(lower)
        if pattern is None or not pattern.fits(matrix):
            pattern = ReducedPattern(matrix, self._basis, None if lower else self._place, lower)
            self._patterns[lower] = pattern
            self._solvers = {
                kind: solver for kind, solver in self._solvers.items() if (kind is SuperLU) == lower
            }
        return pattern, pattern.entries(matrix)

    def _with(self, kind: type, matrix: sp.csr_matrix) -> Factor:
        lower = kind is not SuperLU
        pattern, entries = self.reduced(matrix, lower)
        if kind not in self._solvers:
            self._solvers[kind] = kind(pattern.indptr, pattern.indices)
        factor: Factor = self._solvers[kind].factorise(entries)
        return factor if lower else _renumbered(factor, self._place)


def _renumbered(factor: Factor, number: Ints) -> Factor:
    """The factor of a matrix as that of the matrix whose unknowns have these numbers in it."""

    def solve(rhs: Floats) -> Floats:
        moved = np.empty_like(rhs)
        moved[number] = rhs
        return np.asarray(factor.solve(moved))[number]

    return Factor(solve, factor.count_negative, factor.definite)
