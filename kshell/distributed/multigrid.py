"""The multigrid of plates on a team: kshell's interpolations in PETSc's PCMG.

Interpolations are found by the first process, one level at a time, and dealt out by rows; the coarse matrices are
products of PETSc. A W-cycle, smoothed by Chebyshev's iteration of degree 3 on symmetric sweeps of Gauss-Seidel inside
each process; every process factorises the coarsest matrix, which is small and visited often.

Tried and left out: the sweeps alone, whose corrections beside borders of processes may be too long by more than 2, so
that the cycle was indefinite on four processes; degree 2, as quick, with two more iterations on four processes than on
one; MUMPS on the coarsest level, which waits for messages five times as long.
"""

from __future__ import annotations

import time
from dataclasses import replace
from functools import partial, reduce
from operator import matmul
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
from kshell.solvers.memory import give_back
from kshell.solvers.multigrid.galerkin import entries
from kshell.solvers.multigrid.hierarchy import Descent
from kshell.solvers.multigrid.pcg import Run, conjugate_gradients
from kshell.solvers.multigrid.solver import STOP, Multigrid
from kshell.solvers.multigrid.vertex_space import take_rows
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
    descent : Descent
        Of the first process alone.
    """

    def __init__(self, team: Team, terms: Terms, known: sp.csr_matrix | None, descent: Descent) -> None:
        from petsc4py import PETSc

        super().__init__(team)
        free_dropped(team)
        share = terms.share
        basis = Basis(team, whole_reduction(share.count), share)
        self._fine = here = Numbering(team, basis.free.owner)
        self._assembled = Assembled(basis, here, half=False)
        self._assembled.fill(terms, known)
        mat = self._assembled.mat
        mat.setOption(PETSc.Mat.Option.SPD, True)
        steps, chain, kept = [], iter(()) if team.rank else iter(descent), None
        while True:
            factors = team.together(partial(next, chain, None)) if team.rank == 0 else team.together(_nothing)
            if not team.communicator.bcast(factors is not None):
                break
            step, here, kept = _interpolation(factors, here, kept)
            del factors
            steps.append(step)
        pc = PETSc.PC().create(team.communicator)
        prefix = f"kshell_{self.key}_"
        pc.setOptionsPrefix(prefix)  # before there are levels, which take it then
        pc.setOperators(mat)
        pc.setType("mg")
        pc.setMGLevels(len(steps) + 1)
        pc.setMGCycleType(PETSc.PC.MGCycleType.W)
        for k, step in enumerate(steps):
            pc.setMGInterpolation(len(steps) - k, step)
        options = PETSc.Options()
        words = {
            "pc_mg_galerkin": "both",
            "mg_levels_ksp_type": "chebyshev",
            "mg_levels_ksp_max_it": 3,
            "mg_levels_pc_type": "sor",
            "mg_levels_pc_sor_local_symmetric": None,
            "mg_coarse_ksp_type": "preonly",
            "mg_coarse_pc_type": "redundant",
        }
        for key, value in words.items():
            options[prefix + key] = value
        if team.size > 1:  # coarse matrices row by row take two fifths of the room, and a sixth more time
            options["matptap_via"] = "allatonce"
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
        team, descent = matrix.team, Descent(space)
        give_back()
        self._levels: Levels = team.calls.run(Levels, team, matrix.terms, matrix.known, descent)
        give_back()
        self.name, self.why = f"{NAME.partition(' ')[0]} (multigrid)", why
        self.warnings = tuple(descent.notes)
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
            tolerance = STOP[self.element]
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


def _nothing() -> None:
    return None


def _interpolation(factors: Any, fine: Numbering, kept: Ints | None) -> tuple[Any, Numbering, Ints]:
    """What this process has of an interpolation, in PETSc, and the numbers of the coarser level.

    Unknowns that supports forbid have zero columns, and are left out.

    Parameters
    ----------
    factors : tuple of BSR matrices
        Their product; of the first process alone.
    fine : Numbering
    kept : (n,) int array or None
        Rows that are not left out, all if None; of the first process alone.

    Returns
    -------
    matrix : petsc4py.PETSc.Mat
    coarse : Numbering
    kept : (n,) int array
        Columns that are not left out; none on other processes.
    """
    from petsc4py import PETSc

    team = fine.team
    whole = None if team.rank or factors[0].blocksize[0] == 1 else entries(factors[0]).tocsr()
    count = 0 if team.rank else factors[-1].shape[1]
    columns: dict[int, Ints] = {}
    owner, most = np.zeros(count // 3, dtype=np.int32), np.zeros(count // 3, dtype=np.int64)

    def part(rank: int) -> sp.csr_matrix:
        rows = fine.own.of_all[rank] if kept is None else kept[fine.own.of_all[rank]]
        if whole is not None:
            own = whole[rows]
        else:
            own = entries(reduce(matmul, factors[1:], take_rows(factors[0], rows, sp)))
        own.eliminate_zeros()
        # the three unknowns of a vertex are of the process that has most of what hangs on them
        here = np.bincount(own.indices // 3, minlength=count // 3)
        owner[here > most] = rank
        np.maximum(most, here, out=most)
        columns[rank], place = np.unique(own.indices, return_inverse=True)
        return sp.csr_matrix(
            (own.data, place.astype(np.int32), own.indptr), shape=(len(rows), len(columns[rank]))
        )

    own = team.deal(part)
    used = np.zeros(count, dtype=bool)
    for found in columns.values():
        used[found] = True
    kept = np.flatnonzero(used)
    coarse = Numbering(team, owner[kept // 3])
    renamed = np.full(count, -1, dtype=np.int32)
    renamed[kept] = coarse.place
    place: Ints = team.deal(lambda rank: renamed[columns[rank]])
    own = sp.csr_matrix((own.data, place[own.indices], own.indptr), shape=(own.shape[0], coarse.size))
    own.sort_indices()
    size = ((fine.mine, fine.size), (coarse.mine, coarse.size))
    kind = PETSc.IntType
    csr = (own.indptr.astype(kind), own.indices.astype(kind), np.ascontiguousarray(own.data))
    matrix = PETSc.Mat().createAIJ(size, csr=csr, comm=team.communicator)
    matrix.assemble()
    return matrix, coarse, kept
