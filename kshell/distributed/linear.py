"""Small and large deflections of Koiter shells on a team: the same algorithms on what is divided."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from functools import cached_property
from typing import Any, cast

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.distributed.factor import NAME, PetscFactoriser, Symmetric
from kshell.distributed.koiter import PartedDiscretisation, PartedKoiter
from kshell.distributed.matrix import Scattered
from kshell.distributed.team import Team
from kshell.equilibrium.linear import LinearSolver
from kshell.equilibrium.model import NO_DENSITY, Solved
from kshell.equilibrium.problem import Problem
from kshell.equilibrium.reduction import Reduction
from kshell.equilibrium.sparsity import Added
from kshell.errors import InputError
from kshell.scene.structure import Structure
from kshell.shell.koiter.model import KoiterModel

Floats = NDArray[np.float64]


class PetscLinearSolver(LinearSolver):
    """One shell of a team for any number of loads: factorised once by MUMPS."""

    def __init__(
        self, elastic: PartedKoiter, reduction: Reduction, springs: sp.spmatrix | None = None
    ) -> None:
        self.elastic, self.reduction, self.springs = elastic, reduction, springs
        stiffness = elastic.linear_stiffness()
        stiffness = stiffness if springs is None else stiffness + springs
        self._factoriser = PetscFactoriser(elastic.team, reduction, elastic.piece.unknowns)
        self._diagonal = stiffness.diagonal()
        elastic.piece.forget()
        self._solve = self._factoriser.factorise(stiffness, last=True).solve
        self._require_held()


class ScatteredAdded(Added):
    """Adds matrices that all processes know to one that is divided."""

    def to(self, matrix: Any, other: sp.csr_matrix, factor: float = 1.0) -> Any:
        return cast(Scattered, matrix).plus(other, factor)


class PartedProblem(Problem):
    """An equilibrium of a team."""

    @cached_property
    def _load_added(self) -> Added:
        return ScatteredAdded()

    @cached_property
    def _springs_added(self) -> Added:
        return ScatteredAdded()

    @cached_property
    def _factoriser(self) -> Any:
        energy = cast(PartedKoiter, self.energy)
        return PetscFactoriser(energy.team, self.reduction, energy.piece.unknowns, self._symmetric())


class PartedKoiterModel(KoiterModel):
    """A Koiter shell of a team.

    Parameters
    ----------
    team : Team
    structure, order, reasons :
        As of `KoiterModel`.
    """

    def __init__(self, team: Team, structure: Structure, order: int, reasons: Sequence[str] = ()) -> None:
        self.team = team
        super().__init__(structure, order, reasons)

    def _discretised(self, *given: Any) -> PartedDiscretisation:
        return PartedDiscretisation(self.team, *given)

    def _linear_solver(self) -> LinearSolver:
        problem = self.problem
        return PetscLinearSolver(problem.energy, problem.reduction, problem.springs)

    def solve(self, solver: str = "auto") -> Solved:
        found = super().solve(solver)
        why = (
            f"shells are factorised, on {self.team.size} {'process' if self.team.size == 1 else 'processes'}"
        )
        return Solved(found.x, NAME, why, found.iterations, found.own)

    def of_order(self, order: int) -> KoiterModel:
        return PartedKoiterModel(self.team, self.structure, order, self.reasons)

    def stiffness(self) -> Any:
        problem, stiffness = self.problem, self.problem.energy.linear_stiffness()
        stiffness = stiffness if problem.springs is None else stiffness + problem.springs
        return Symmetric.of(stiffness, problem.reduction)

    def mass(self) -> Any:
        whole = self.full_mass()
        if not whole.diagonal().any():
            raise InputError(NO_DENSITY)
        return Symmetric.of(whole, self.problem.reduction)

    def full_mass(self) -> Any:
        problem, energy = self.problem, cast(PartedKoiter, self.problem.energy)
        every = np.arange(len(problem.space.triangles))
        points, _ = problem.discretisation.interior_points(every)
        found = energy.mass(problem.section.mass(every, points))
        return found if problem.added_mass is None else found.plus(problem.added_mass)

    def near_rest(self) -> Problem:
        whole = super().near_rest()
        return PartedProblem(**{f.name: getattr(whole, f.name) for f in fields(whole)})

    def alike(self, near: Problem) -> Problem:
        return near
