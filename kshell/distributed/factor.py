"""Factors of matrices of a team by MUMPS, with the count of negative pivots."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.distributed.matrix import Numbering, Reduced, Scattered
from kshell.distributed.team import Team
from kshell.equilibrium.reduction import Reduction
from kshell.errors import SolveError
from kshell.solvers.backends import Singular
from kshell.solvers.repeated import Factor
from kshell.solvers.symmetric import SymmetricFactor

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

# MUMPS: more room than foreseen, in percent, at first and when it did not suffice
ROOM = (40, 200, 1000)
TOO_SMALL = (-8, -9, -14, -15, -17, -20)  # codes of MUMPS for too little of it
NO_MEMORY = (-13, -19)
SINGULAR, INDEFINITE = -10, -40
NAME = "PETSc (MUMPS)"


class PetscFactoriser:
    """Factorises T^T K T for many K that a team has, as `kshell.equilibrium.factor.Factoriser` does alone.

    Parameters
    ----------
    team : Team
    reduction : Reduction
    owner : (unknowns,) int array
        The process of each unknown.
    symmetric : bool
        False for a tangent with follower loads.
    """

    def __init__(self, team: Team, reduction: Reduction, owner: Ints, symmetric: bool = True) -> None:
        self.team, self._symmetric = team, symmetric
        self.numbering = Numbering(team, reduction.basis, owner)
        self.reduced = Reduced(self.numbering, reduction, half=symmetric)
        self._solvers: dict[bool, Any] = {}

    def factorise(self, matrix: Scattered, definite: bool = True, last: bool = False) -> Factor:
        """The matrix in the free unknowns, factorised. The factor serves until the next call.

        Parameters
        ----------
        matrix : Scattered
        definite : bool
            False where it is likely not positive definite.
        last : bool
            Whether the matrix is needed no more: it makes room for the factors.

        Raises
        ------
        SolveError
            If the matrix is singular, holds numbers that are not finite, or the memory does not suffice.
        """
        try:
            return self.factors(matrix, definite, last)
        except Singular as error:
            raise SolveError("the tangent stiffness is singular") from error

    def factors(self, matrix: Scattered, definite: bool = True, last: bool = False) -> Factor:
        """The same; `Singular` where a pivot is zero."""
        if self.team.largest(0.0 if np.isfinite(matrix.local.data).all() else 1.0):
            raise SolveError("the stiffness is not finite: the step led too far away")
        if not self.numbering.size:
            return Factor(np.zeros_like, lambda: 0)
        if self.reduced.fill(matrix):
            self._forget()
        if last:
            matrix.local = sp.csr_matrix(matrix.shape)
        if self._symmetric and definite:
            code = self._set_up(True)
            if code == 0:
                return Factor(self._solver(True), lambda: 0, True)
            if code not in (SINGULAR, INDEFINITE):
                raise _failed(code)
        code = self._set_up(False)
        if code == SINGULAR:
            raise Singular("MUMPS: a pivot is zero")
        if code:
            raise _failed(code)
        return Factor(self._solver(False), self._count_negative)

    def _forget(self) -> None:
        for solver in self._solvers.values():
            solver.destroy()
        self._solvers = {}

    def _set_up(self, definite: bool) -> int:
        """Factorise; the code of MUMPS, 0 where all went well."""
        from petsc4py import PETSc

        mat = self.reduced.mat
        code = 0
        for room in ROOM:
            solver = self._solvers.get(definite)
            mat.setOption(PETSc.Mat.Option.SYMMETRIC, self._symmetric)
            mat.setOption(PETSc.Mat.Option.SPD, definite)
            if solver is None:
                solver = PETSc.KSP().create(self.team.communicator)
                solver.setOperators(mat)
                solver.setType("preonly")
                pc = solver.getPC()
                pc.setType("cholesky" if self._symmetric else "lu")
                pc.setFactorSolverType("mumps")
                pc.setFactorSetUpSolverType()
                factor = pc.getFactorMatrix()
                factor.setMumpsIcntl(14, room)
                if not definite:
                    factor.setMumpsIcntl(13, 1)  # all pivots are counted
                    factor.setMumpsIcntl(24, 1)
                self._solvers[definite] = solver
            try:
                solver.setOperators(mat)
                solver.setUp()
                code = int(solver.getPC().getFactorMatrix().getMumpsInfog(1))
            except PETSc.Error as error:
                raise SolveError(f"PETSc could not factorise the matrix ({error})") from None
            code = min(code, 0)
            if code not in TOO_SMALL:
                if code == 0 and not definite and self._null_pivots():
                    code = SINGULAR
                break
            self._solvers.pop(definite).destroy()
        if code:
            self._solvers.pop(definite).destroy()
        return code

    def _null_pivots(self) -> int:
        return int(self._solvers[False].getPC().getFactorMatrix().getMumpsInfog(28))

    def _count_negative(self) -> int:
        """Negative pivots, by MUMPS."""
        return int(self._solvers[False].getPC().getFactorMatrix().getMumpsInfog(12))

    def _solver(self, definite: bool) -> Any:
        solver, numbering, team = self._solvers[definite], self.numbering, self.team
        rhs, x = self.reduced.mat.createVecs()

        def solve(load: Floats) -> Floats:
            columns = np.asarray(load, dtype=float).reshape(numbering.size, -1)
            out = np.empty_like(columns)
            for k, column in enumerate(columns.T):
                rhs.setArray(column[numbering.own])
                solver.solve(rhs, x)
                out[:, k] = team.join(numbering.members, (), x.getArray)
            return out.reshape(np.shape(load))

        return solve


class Symmetric(Scattered):
    """A symmetric matrix on free unknowns, which factorises itself for those that know nothing of teams."""

    @classmethod
    def of(cls, matrix: Scattered, reduction: Reduction | None = None) -> Symmetric:
        """T^T K T of a matrix K on all unknowns; without a reduction K itself."""
        team, local, owner = matrix.team, matrix.local, matrix.owner
        if reduction is not None:
            basis = reduction.basis.tocsc()
            owner = owner[basis.indices[basis.indptr[:-1]]]
            whole, kept = local, reduction
            local = team.together(lambda: kept.reduce(whole))
        return cls(team, local, owner)

    def factorised(self, definite: bool) -> SymmetricFactor:
        """As `kshell.solvers.symmetric.factorise_symmetric`, by MUMPS."""
        factor = whole_factoriser(self).factors(self, definite)
        return SymmetricFactor(factor.solve, factor.count_negative, NAME)


def whole_factoriser(matrix: Scattered) -> PetscFactoriser:
    """For matrices on free unknowns."""
    return PetscFactoriser(matrix.team, whole_reduction(matrix.shape[0]), matrix.owner)


def whole_reduction(size: int) -> Reduction:
    """That of unknowns that are all free."""
    return Reduction(sp.identity(size, format="csc"), np.zeros(size), np.zeros(0, dtype=np.int64))


def _failed(code: int) -> SolveError:
    if code in NO_MEMORY:
        return SolveError(
            f"the factors do not fit into the memory of the machines (MUMPS, error {code}): take more processes on "
            "more machines, or a coarser mesh"
        )
    return SolveError(f"MUMPS could not factorise the matrix (error {code})")
