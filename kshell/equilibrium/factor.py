"""Factorisation of tangent matrices that need not be positive definite, with the count of negative pivots."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.energy import StrainEnergy
from kshell.equilibrium.reduced import ReducedPattern
from kshell.equilibrium.reduction import Reduction
from kshell.errors import SolveError
from kshell.solvers.backends import CHOLMOD, PARDISO, Singular
from kshell.solvers.repeated import Cholmod, Factor, Pardiso, SuperLU

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


class Factoriser:
    """Factorises the matrices of one structure, T^T K T with the basis T of its free motions.

    Cholesky by CHOLMOD where it is installed and the matrix is positive definite. Otherwise pivots of both signs,
    by PARDISO or else by SuperLU in the order of nested dissection. Pattern and order are kept from one matrix to
    the next.

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
        if not self._basis.shape[1]:
            return Factor(np.zeros_like, lambda: 0)
        try:
            if self._symmetric and CHOLMOD.installed and definite:
                try:
                    return self._with(Cholmod, matrix)
                except Singular:
                    pass  # not positive definite: the pivots below say how far
            return self._with(Pardiso if self._symmetric and PARDISO.installed else SuperLU, matrix)
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
        if lower:
            return factor
        place = self._place

        def solve(rhs: Floats) -> Floats:
            moved = np.empty_like(rhs)
            moved[place] = rhs
            return np.asarray(factor.solve(moved))[place]

        return Factor(solve, factor.count_negative)
