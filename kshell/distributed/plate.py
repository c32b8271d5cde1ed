"""Plates of a team: every process has the element matrices of its own triangles, PETSc solves.

Large plates are solved by conjugate gradients with the multigrid of kshell as PCMG, all others by MUMPS.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.distributed.factor import Symmetric
from kshell.distributed.matrix import Terms
from kshell.distributed.multigrid import PetscMultigrid
from kshell.distributed.partition import partition
from kshell.distributed.prepared import PetscFactorisation
from kshell.distributed.shares import Share
from kshell.distributed.team import Team
from kshell.equilibrium.model import NO_DENSITY, Solved
from kshell.errors import InputError
from kshell.plate.assembly import Assembled, assemble_load, assemble_part
from kshell.plate.forms import Form
from kshell.plate.model import PlateModel
from kshell.plate.pattern import FullPattern, Pattern
from kshell.plate.problem import PlateProblem
from kshell.plate.product import part_product
from kshell.scene.structure import Structure
from kshell.solvers.auto import MANY_THIN, MULTIGRID_FROM, thin_share
from kshell.solvers.system import Prepared

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

BACKEND = "cholmod"  # in the table of measurements the one that is as fast as MUMPS


class PartedPlateProblem(PlateProblem):
    """A plate whose matrix is divided.

    Parameters
    ----------
    team : Team
    structure, element :
        As of `PlateProblem`.
    """

    small = False  # a dense matrix is not divided

    def __init__(self, team: Team, structure: Structure, element: Any) -> None:
        self.team = team
        super().__init__(structure, element)
        mesh = self.mesh
        part = team.once(lambda: partition(mesh, team.size))
        self.own = part == team.rank
        starts = np.concatenate([[0], np.cumsum(self.reduction.sizes)])
        nodes = np.concatenate([mesh.triangles, len(mesh.points) + mesh.triangle_edges], axis=1)

        def unknowns_of(rank: int) -> Ints:
            some = np.unique(nodes[part == rank])
            counts = self.reduction.sizes[some]
            first = np.repeat(starts[some] - (np.cumsum(counts) - counts), counts)
            return first + np.arange(len(first))

        every = [unknowns_of(rank) for rank in range(team.size)]
        self.share = Share(team, every, self.reduction.count)

    def terms(self, forms: Sequence[Form]) -> Symmetric:
        """The sum of forms."""
        return Symmetric(
            _terms(
                self, self.team.together(lambda: assemble_part(forms, self.domain, self.reduction, self.own))
            )
        )

    def _assemble(self, pattern: Pattern | FullPattern | None = None) -> Assembled:
        team = self.team
        own = team.together(lambda: assemble_part(self.forms, self.domain, self.reduction, self.own))
        load, work = assemble_load(
            [*self.loads.forms, *self.supports.hold_loads], self.domain, self.reduction
        )
        return Assembled(
            Symmetric(_terms(self, own)),
            load,
            work,
            team.sum((self.reduction.count,), lambda: own.fixed_load),
            team.number(lambda: own.fixed_energy),
        )

    @cached_property
    def assembled(self) -> Assembled:
        """Matrix and loads on the unknowns, and the share of prescribed motion."""
        return self._assemble()

    @property
    def system(self) -> Assembled:
        """The same."""
        return self.assembled


def _terms(problem: PartedPlateProblem, own: Assembled) -> Terms:
    """What the triangles of this process give, on their unknowns."""
    mine = problem.share.mine
    return Terms(problem.team, problem.share, own.matrix[mine][:, mine])


class PartedPlateModel(PlateModel):
    """A Kirchhoff plate of a team.

    Parameters
    ----------
    team : Team
    structure, element, reasons :
        As of `PlateModel`.
    """

    def __init__(self, team: Team, structure: Structure, element: str, reasons: Sequence[str] = ()) -> None:
        self.team = team
        team.calls.alongside()  # every process has all of a plate
        super().__init__(structure, element, reasons)

    def _posed(self, structure: Structure, element: Any) -> PartedPlateProblem:
        return PartedPlateProblem(self.team, structure, element)

    def like(self, structure: Structure, element: str) -> PlateModel:
        return PartedPlateModel(self.team, structure, element)

    def mass(self) -> Any:
        problem = self.problem
        assert isinstance(problem, PartedPlateProblem)
        found = problem.terms(problem.inertia)
        if not found.diagonal().any():
            raise InputError(NO_DENSITY)
        return found

    def product(self) -> Callable[[Floats], Floats]:
        problem = self.problem
        assert isinstance(problem, PartedPlateProblem)
        own: Any = part_product(problem, problem.own)
        return lambda q: self.team.sum(np.shape(q), lambda: own(q))

    def _prepare(self, solver: str) -> Prepared:
        problem = self.problem
        assert isinstance(problem, PartedPlateProblem)
        matrix, space = problem.assembled.matrix, problem.space
        if solver != "multigrid":
            limit = MULTIGRID_FROM[space.element, BACKEND]
            many = self.unknowns >= limit and thin_share(space) <= MANY_THIN
            if solver == "direct" or not many:
                return PetscFactorisation(
                    matrix, f"{self.unknowns} unknowns, on {_processes(self.team)}", space
                )
        return PetscMultigrid(matrix, space, f"{self.unknowns} unknowns, on {_processes(self.team)}")

    def solve_ahead(self, models: Sequence[PlateModel], solver: str = "auto") -> None:
        return  # one load after the other

    def solve(self, solver: str = "auto") -> Solved:
        return super().solve("auto" if solver == "petsc" else solver)


def _processes(team: Team) -> str:
    return f"{team.size} {'process' if team.size == 1 else 'processes'}"
