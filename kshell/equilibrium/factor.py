"""Factorisation of tangent matrices that need not be positive definite, with the count of negative pivots."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, partial
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.energy import Put, StrainEnergy
from kshell.equilibrium.free_matrices import FreeMatrices
from kshell.equilibrium.reduced import ReducedPattern
from kshell.equilibrium.reduction import Reduction
from kshell.errors import SolveError
from kshell.solvers.backends import CHOLMOD, PARDISO, RSLAB, Singular
from kshell.solvers.frontal import Frontal, Fronts
from kshell.solvers.frontal import installed as fronts_installed
from kshell.solvers.repeated import Cholmod, Factor, Pardiso, Rslab, SuperLU, renumbered

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

# free unknowns from which fronts in the order of dissection are quicker than CHOLMOD: from 1e4 on two thirds of the
# time of a solution at rest, from 1e3 on nine tenths
FRONTS_FROM = 1000


class Factoriser:
    """Factorises the matrices of one structure, T^T K T with the basis T of its free motions.

    Cholesky where the matrix is positive definite: by fronts near rest, where kshell was compiled, else by CHOLMOD
    where it is installed. Otherwise pivots of both signs, by rslab, PARDISO, or, where these are not installed or find
    no pivots, by SuperLU in the order of nested dissection. Pattern and order are kept from one matrix to the next.

    Parameters
    ----------
    reduction : Reduction
    energy : StrainEnergy
        Tells a good order of elimination, for fronts and SuperLU.
    symmetric : bool
        False for a tangent with follower loads, which is symmetric only up to terms on free edges.
    """

    def __init__(self, reduction: Reduction, energy: StrainEnergy, symmetric: bool = True) -> None:
        self._basis, self._energy, self._symmetric = reduction.basis, energy, symmetric
        self._patterns: dict[bool, ReducedPattern] = {}
        self._solvers: dict[type, Any] = {}
        self._free: FreeMatrices | None = None  # and the springs in them
        self._springs: sp.spmatrix | None = None

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

        Straight from the elements where conditions do not couple their groups of unknowns. The factor stays.

        Raises
        ------
        SolveError
            If the matrix is singular or holds numbers that are not finite.
        """
        energy, matrices = self._energy, self._matrices(springs)
        if matrices.small:
            found = matrices.dense(energy.put_stiffness)
            if found is not None:
                return found.factor, found.diagonal
        if not matrices.possible:
            stiffness = energy.linear_stiffness()
            if springs is not None:
                stiffness = stiffness + springs
            return self.factorise(stiffness), stiffness.diagonal()
        diagonal: list[Floats] = []

        def made(kind: type) -> Factor:
            # beside fronts there is no copy of the matrix: strains have room, which refinement needs afterwards anyway
            put = partial(energy.put_stiffness, keep=True) if kind is Frontal else energy.put_stiffness
            summed = matrices.factorise(kind, put)
            diagonal[:] = [summed.diagonal]
            return summed.factor

        return self._first(made, True, True), diagonal[0]

    def near_rest(
        self, evaluate: Callable[[Put], Any], springs: sp.spmatrix | None = None
    ) -> tuple[Any, Factor] | None:
        """A tangent near rest, factorised with what is known of the stiffness; None where it is not positive definite.

        The factor serves until the next call.

        Parameters
        ----------
        evaluate : callable
            Puts the matrices of the triangles, see `FreeMatrices.factorise`; what it returns comes with the factor.
        springs : (unknowns, unknowns) sparse, optional
            The same as at rest.

        Raises
        ------
        SolveError
            If the matrix holds numbers that are not finite.
        """
        matrices = self._matrices(springs)
        if not self._symmetric or not (matrices.small or matrices.possible):
            return None
        if matrices.small:
            summed = matrices.dense(evaluate)
            return None if summed is None else (summed.found, summed.factor)
        kind = self._kinds(True, True)[0]
        try:
            summed = matrices.factorise(kind, evaluate, definite=True)
        except Singular:
            return None
        definite = summed.factor.definite or summed.factor.negative == 0
        return (summed.found, summed.factor) if definite else None

    def fronts(self) -> Fronts | None:
        """What the factor at rest looks like, from the pattern alone; None where a library makes it, or it is full."""
        matrices = self._matrices(None)
        if matrices.small or not matrices.possible or self._kinds(True, True)[0] is not Frontal:
            return None
        return matrices.fronts()

    def _matrices(self, springs: sp.spmatrix | None) -> FreeMatrices:
        if self._free is None or self._springs is not springs:
            self._free, self._springs = FreeMatrices(self._energy, self._basis, springs), springs
        return self._free

    def _first(self, factorised: Callable[[type], Factor], definite: bool, near_rest: bool = False) -> Factor:
        """The factor by the first library that there is and that the matrix suits."""
        if not self._basis.shape[1]:
            return Factor(np.zeros_like, lambda: 0)
        *kinds, last = self._kinds(definite, near_rest)
        for kind in kinds:
            try:
                return factorised(kind)
            except Singular:
                pass  # not positive definite, or no pivots that it trusts: the next ones say how far
        try:
            return factorised(last)
        except Singular as error:
            raise SolveError("the tangent stiffness is singular") from error

    def _kinds(self, definite: bool, near_rest: bool = False) -> list[type]:
        """What factorises, in the order in which it is tried; `near_rest`: matrices that come in any order."""
        kinds: list[type] = []
        if self._symmetric:
            large = self._basis.shape[1] >= FRONTS_FROM or not CHOLMOD.installed
            if definite and near_rest and large and fronts_installed():
                kinds += [Frontal]
            else:
                kinds += [Cholmod] * (CHOLMOD.installed and definite)
            kinds += [Rslab] if RSLAB.installed else [Pardiso] * PARDISO.installed
        return [*kinds, SuperLU]

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
        return factor if lower else renumbered(factor, self._place)
