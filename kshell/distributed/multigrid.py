"""The multigrid of plates on a team: kshell's interpolations in PETSc's PCMG.

Interpolations are found by the first process and dealt out by rows; the coarse matrices are products of PETSc. A
W-cycle with one symmetric sweep of Gauss-Seidel inside each process, MUMPS on the coarsest level.
"""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.distributed.calls import Shared, on_all
from kshell.distributed.factor import NAME, free_dropped, whole_reduction
from kshell.distributed.matrix import Scattered, Terms
from kshell.distributed.numbering import Assembled, Basis, Numbering
from kshell.distributed.prepared import PetscFactorisation
from kshell.distributed.team import Team
from kshell.solvers.multigrid.galerkin import entries
from kshell.solvers.multigrid.hierarchy import prolongations
from kshell.solvers.multigrid.pcg import Run, conjugate_gradients
from kshell.solvers.multigrid.solver import ARGYRIS_TOLERANCE, TIGHTEST, Multigrid
from kshell.solvers.system import Floats, PlateSpace, Product, Progress, Solution

Doubles = NDArray[np.float64]
Ints = NDArray[np.integer]


class Levels(Shared):
    """What each process has of PCMG.

    Parameters
    ----------
    team : Team
    terms, known :
        The matrix, as of `Scattered`.
    chain : list of sparse CSR
        Interpolations from the finest to the coarsest level; of the first process alone.
    """

    def __init__(
        self, team: Team, terms: Terms, known: sp.csr_matrix | None, chain: list[sp.csr_matrix]
    ) -> None:
        from petsc4py import PETSc

        super().__init__(team)
        free_dropped(team)
        share = terms.share
        basis = Basis(team, whole_reduction(share.count), share)
        owner, kept = basis.free.owner, None
        self._fine = here = Numbering(team, owner)
        self._assembled = Assembled(basis, here, half=False)
        self._assembled.fill(terms, known)
        mat = self._assembled.mat
        mat.setOption(PETSc.Mat.Option.SPD, True)
        steps = []
        for number in range(team.once(lambda: len(chain))):
            step = None
            if team.rank == 0:
                step, chain[number] = chain[number], None
                step = step if kept is None else step[kept]
                row = np.repeat(np.arange(step.shape[0], dtype=np.int32), np.diff(step.indptr))
                first = np.full(step.shape[1], -1, dtype=np.int32)
                first[step.indices[::-1]] = row[::-1]
                del row
                kept = np.flatnonzero(first >= 0)  # the others are forbidden by supports
                owner = owner[first[kept]]
                renamed = np.cumsum(first >= 0) - 1
                given = (step.data, renamed[step.indices], step.indptr)
                step = sp.csr_matrix(given, shape=(step.shape[0], len(kept)))
                del given
            there = Numbering(team, owner)
            steps.append(_rows(step, here, there))
            here = there
        pc = PETSc.PC().create(team.communicator)
        pc.setOperators(mat)
        pc.setType("mg")
        pc.setMGLevels(len(steps) + 1)
        pc.setMGCycleType(PETSc.PC.MGCycleType.W)
        for k, step in enumerate(steps):
            pc.setMGInterpolation(len(steps) - k, step)
        prefix = f"kshell_{self.key}_"
        options = PETSc.Options()
        words = {
            "pc_mg_galerkin": "both",
            "mg_levels_ksp_type": "richardson",
            "mg_levels_ksp_max_it": 1,
            "mg_levels_pc_type": "sor",
            "mg_levels_pc_sor_local_symmetric": None,
            "mg_coarse_ksp_type": "preonly",
            "mg_coarse_pc_type": "cholesky",
            "mg_coarse_pc_factor_mat_solver_type": "mumps",
        }
        for key, value in words.items():
            options[prefix + key] = value
        if (
            team.size > 1
        ):  # coarse matrices row by row: they take two fifths of the room, and a sixth more time
            options["matptap_via"] = "allatonce"
        pc.setOptionsPrefix(prefix)
        pc.setFromOptions()
        pc.setUp()
        for key in words:
            options.delValue(prefix + key)
        options.delValue("matptap_via")
        self._pc, self._vectors = pc, mat.createVecs()

    @on_all
    def cycle(self, residual: Doubles) -> Doubles:
        """One cycle from zero."""
        mine = self._fine.own.spread(residual)

        def applied() -> Doubles:
            right, left = self._vectors
            right.setArray(mine)
            self._pc.apply(right, left)
            return np.asarray(left.getArray())

        return self._fine.own.collect(applied)


class PetscMultigrid(Multigrid):
    """Conjugate gradients with PCMG.

    Parameters
    ----------
    matrix : Scattered
    space : PlateSpace
    why : str
    """

    def __init__(self, matrix: Scattered, space: PlateSpace, why: str) -> None:
        begin = time.perf_counter()
        self.matrix, self.element, self.space = matrix, space.element, space
        blocks, _, notes, _ = prolongations(space)
        chain: list[Any] = []
        while blocks:
            chain.append(sp.csr_matrix(entries(blocks.pop(0))))
        team = matrix.team
        self._levels: Levels = team.calls.run(Levels, team, matrix.terms, matrix.known, chain)
        self.name, self.why = f"{NAME.partition(' ')[0]} (multigrid)", why
        self.warnings = tuple(notes)
        self.setup_seconds = time.perf_counter() - begin
        self._factorisation: Any = None
        self._unused = True

    def precondition(self, residual: Floats) -> Floats:
        """One cycle from zero."""
        return self._levels.cycle(np.asarray(residual, dtype=float))

    def _run(
        self, rhs: Floats, tolerance: float | None, progress: Progress | None, product: Product | None
    ) -> Run:
        if not rhs.any():
            return Run(np.zeros_like(rhs), (0.0,), True, 0.0)
        if tolerance is None:
            tolerance = ARGYRIS_TOLERANCE if self.element == "argyris" else TIGHTEST
        run = conjugate_gradients(self.matrix, rhs, self.precondition, tolerance, None, progress)
        return run if product is None else self._refined(run, rhs, tolerance, product)

    def _rescue(
        self, solution: Solution, rhs: Floats, tolerance: float | None, product: Product | None
    ) -> Solution:
        if self._factorisation is None:
            self._factorisation = PetscFactorisation(self.matrix, "multigrid stalled", self.space)
        rescued: Solution = self._factorisation.solve(rhs, tolerance, None, product)
        seconds = {name: rescued.seconds[name] + solution.seconds[name] for name in solution.seconds}
        warning = f"multigrid stalled after {solution.iterations} iterations: MUMPS took over"
        return replace(rescued, seconds=seconds, warnings=(*self.warnings, warning))


def _rows(step: sp.csr_matrix, fine: Numbering, coarse: Numbering) -> Any:
    """What this process has of an interpolation, in PETSc; the first one knows it."""
    from petsc4py import PETSc

    def part(rank: int) -> sp.csr_matrix:
        own = step[fine.own.of_all[rank]].tocsr()
        own = sp.csr_matrix((own.data, coarse.place[own.indices], own.indptr), shape=own.shape)
        own.sort_indices()
        return own

    own = fine.team.deal(part)
    size = ((fine.mine, fine.size), (coarse.mine, coarse.size))
    kind = PETSc.IntType
    csr = (own.indptr.astype(kind), own.indices.astype(kind), np.ascontiguousarray(own.data))
    matrix = PETSc.Mat().createAIJ(size, csr=csr, comm=fine.team.communicator)
    matrix.assemble()
    return matrix
