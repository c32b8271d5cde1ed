"""Factors of matrices of a team by MUMPS, with the count of negative pivots."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.distributed.calls import Shared, on_all
from kshell.distributed.matrix import Scattered, Terms
from kshell.distributed.numbering import Assembled, Basis, Numbering, reduced
from kshell.distributed.shares import Share
from kshell.distributed.team import Team
from kshell.equilibrium.reduction import Reduction
from kshell.errors import SolveError
from kshell.solvers.backends import Singular
from kshell.solvers.repeated import Factor
from kshell.solvers.symmetric import SymmetricFactor

Floats = NDArray[np.float64]

# MUMPS: more room than foreseen, in percent, at first and when it did not suffice
ROOM = (40, 200, 1000)
TOO_SMALL = (-8, -9, -14, -15, -17, -20)  # codes of MUMPS for too little of it
NO_MEMORY = (-13, -19)
SINGULAR, INDEFINITE = -10, -40
NAME = "PETSc (MUMPS)"


class Mumps(Shared):
    """What each process has of the factors.

    Parameters
    ----------
    team : Team
    reduction : Reduction
        Looked at by the first process alone.
    share : Share
        Of all unknowns.
    symmetric : bool
    """

    def __init__(self, team: Team, reduction: Reduction, share: Share, symmetric: bool) -> None:
        super().__init__(team)
        free_dropped(team)
        self.symmetric = symmetric
        basis = Basis(team, reduction, share)
        self.numbering = Numbering(team, basis.free.owner)
        self.assembled = Assembled(basis, self.numbering, half=symmetric)
        self._solvers: dict[bool, Any] = {}

    @on_all
    def fill(self, terms: Terms, known: sp.csr_matrix | None, last: bool) -> None:
        """Take another matrix; `last` as for `PetscFactoriser.factorise`."""
        if self.assembled.fill(terms, known, last):
            for solver in self._solvers.values():
                solver.destroy()
            self._solvers = {}

    @on_all
    def factorise(self, definite: bool) -> int:
        """Factorise; the code of MUMPS, 0 where all went well."""
        from petsc4py import PETSc

        mat, code = self.assembled.mat, 0
        for room in ROOM:
            solver = self._solvers.get(definite)
            mat.setOption(PETSc.Mat.Option.SYMMETRIC, self.symmetric)
            mat.setOption(PETSc.Mat.Option.SPD, definite)
            if solver is None:
                solver = self._solvers[definite] = self._new(definite, room)
            try:
                solver.setOperators(mat)
                solver.setUp()
                code = int(solver.getPC().getFactorMatrix().getMumpsInfog(1))
            except PETSc.Error as error:
                raise self.team.alike(SolveError(f"PETSc could not factorise the matrix ({error})")) from None
            code = min(code, 0)
            if code not in TOO_SMALL:
                if code == 0 and not definite and self._told(definite, 28):
                    code = SINGULAR  # null pivots
                break
            self._solvers.pop(definite).destroy()
        if code:
            self._solvers.pop(definite).destroy()
        return code

    def _new(self, definite: bool, room: int) -> Any:
        from petsc4py import PETSc

        solver = PETSc.KSP().create(self.team.communicator)
        solver.setOperators(self.assembled.mat)
        solver.setType("preonly")
        pc = solver.getPC()
        pc.setType("cholesky" if self.symmetric else "lu")
        pc.setFactorSolverType("mumps")
        pc.setFactorSetUpSolverType()
        factor = pc.getFactorMatrix()
        factor.setMumpsIcntl(14, room)
        if not definite:
            factor.setMumpsIcntl(13, 1)  # all pivots are counted
            factor.setMumpsIcntl(24, 1)
        return solver

    def _told(self, definite: bool, what: int) -> int:
        return int(self._solvers[definite].getPC().getFactorMatrix().getMumpsInfog(what))

    def negative(self) -> int:
        """Negative pivots."""
        return self._told(False, 12)

    @on_all
    def solve(self, definite: bool, load: Floats) -> Floats:
        """(free,) or (free, k) unknowns under loads."""
        own, solver = self.numbering.own, self._solvers[definite]
        loads = own.spread(load)

        def mine() -> Floats:
            rhs, x = self.assembled.mat.createVecs()
            out = np.empty_like(loads)
            for k in range(1 if loads.ndim == 1 else loads.shape[1]):
                here: Any = ... if loads.ndim == 1 else (slice(None), k)
                rhs.setArray(loads[here])
                solver.solve(rhs, x)
                out[here] = x.getArray()
            rhs.destroy()
            x.destroy()
            return out

        return own.collect(mine)


def free_dropped(team: Team) -> None:
    """Free what PETSc keeps of factors and matrices that no process holds any more: it waits to be told by all."""
    from petsc4py import PETSc

    cleanup = getattr(PETSc, "garbage_cleanup", None)  # older ones free at once
    if cleanup is not None:
        cleanup(team.communicator)


class PetscFactoriser:
    """Factorises T^T K T for many K that a team has, as `kshell.equilibrium.factor.Factoriser` does alone.

    Parameters
    ----------
    team : Team
    reduction : Reduction
    share : Share
        Of all unknowns.
    symmetric : bool
        False for a tangent with follower loads.
    """

    def __init__(self, team: Team, reduction: Reduction, share: Share, symmetric: bool = True) -> None:
        self._reduction, self._symmetric = reduction, symmetric
        self.mumps: Mumps = team.calls.run(Mumps, team, reduction, share, symmetric)

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

    def positive(self, matrix: Scattered) -> Factor | None:
        """The matrix in the free unknowns, factorised if it is positive definite, else None.

        Raises
        ------
        SolveError
            As `factorise`.
        """
        try:
            found = self.factors(matrix)
        except Singular:
            return None
        return found if found.definite or found.negative == 0 else None

    def near_rest(self, evaluate: Any, springs: Any = None) -> None:
        """As that of `Factoriser`; here no tangent is put together quicker."""
        return None

    def factors(self, matrix: Scattered, definite: bool = True, last: bool = False) -> Factor:
        """The same; `Singular` where a pivot is zero."""
        known, mumps = matrix.known, self.mumps
        if not matrix.terms.finite() or (known is not None and not np.isfinite(known.data).all()):
            raise SolveError("the stiffness is not finite: the step led too far away")
        if not mumps.numbering.size:
            return Factor(np.zeros_like, lambda: 0)
        mumps.fill(matrix.terms, None if known is None else self._reduction.reduce(known), last)
        if self._symmetric and definite:
            code = mumps.factorise(True)
            if code == 0:
                return Factor(lambda load: mumps.solve(True, load), lambda: 0, True)
            if code not in (SINGULAR, INDEFINITE):
                raise _failed(code)
        code = mumps.factorise(False)
        if code == SINGULAR:
            raise Singular("MUMPS: a pivot is zero")
        if code:
            raise _failed(code)
        return Factor(lambda load: mumps.solve(False, load), mumps.negative)


class Symmetric(Scattered):
    """A symmetric matrix on free unknowns, which factorises itself for those that know nothing of teams."""

    @classmethod
    def of(cls, matrix: Scattered, reduction: Reduction) -> Symmetric:
        """T^T K T of a matrix K on all unknowns."""
        found = reduced(matrix, reduction)
        return cls(found.terms, found.known)

    def factorised(self, definite: bool) -> SymmetricFactor:
        """As `kshell.solvers.symmetric.factorise_symmetric`, by MUMPS."""
        factor = whole_factoriser(self).factors(self, definite)
        return SymmetricFactor(factor.solve, factor.count_negative, NAME)


def whole_factoriser(matrix: Scattered) -> PetscFactoriser:
    """For matrices on free unknowns."""
    return PetscFactoriser(matrix.team, whole_reduction(matrix.shape[0]), matrix.share)


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
