"""Plates of a team: every process has the triangles of its own with their element matrices, PETSc solves.

The first process has the whole plate too. Forms along supports and lines, few triangles have them, are its own; forms
over areas are divided. Large plates are solved by conjugate gradients with the multigrid of kshell as PCMG, all others
by MUMPS.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any, cast

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.distributed.calls import Shared, on_all
from kshell.distributed.factor import Symmetric
from kshell.distributed.matrix import Terms
from kshell.distributed.multigrid import PetscMultigrid
from kshell.distributed.piece import Piece, members_of
from kshell.distributed.plate_piece import PartForm, PlateData, PlatePart, PlatePlaces, dealt_forms
from kshell.distributed.prepared import PetscFactorisation
from kshell.distributed.team import Team
from kshell.equilibrium.model import NO_DENSITY, Solved
from kshell.errors import InputError
from kshell.plate.assembly import Assembled, assemble, assemble_fixed, assemble_load, assemble_terms
from kshell.plate.forms import AreaForm, Form
from kshell.plate.linear_form import LinearForm
from kshell.plate.model import PlateModel
from kshell.plate.pattern import FullPattern, Pattern
from kshell.plate.planes import take_planes_off
from kshell.plate.problem import PlateProblem
from kshell.scene.structure import Structure
from kshell.solvers.auto import MANY_THIN, MULTIGRID_FROM, thin_share
from kshell.solvers.memory import give_back
from kshell.solvers.system import Prepared

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

BACKEND = "cholmod"  # in the table of measurements the one that is as fast as MUMPS


class PlatePiece(Piece):
    """The triangles of each process.

    Parameters
    ----------
    team : Team
    members : list of int arrays
        The triangles of each process, ascending.
    problem : PlateProblem
        The whole plate, which the first process alone looks at.

    Attributes
    ----------
    part : PlatePart
        The triangles of this process, on their unknowns.
    """

    def __init__(self, team: Team, members: Sequence[Ints], problem: PlateProblem) -> None:
        first = team.rank == 0
        places = [PlatePlaces.of(problem, some) for some in members] if first else []
        super().__init__(team, places, problem.reduction.count if first else 0)
        element, data = self.dealt(lambda mine: (problem.element, PlateData.of(problem, mine)))
        self.part = team.together(lambda: PlatePart(element, data))


class PlateForms(Shared):
    """Forms over areas in the triangles of each process.

    Parameters
    ----------
    team : Team
    piece : PlatePiece
    forms : list of AreaForm
        On the whole plate, which the first process alone looks at.
    """

    def __init__(self, team: Team, piece: PlatePiece, forms: list[AreaForm]) -> None:
        super().__init__(team)
        self.piece = piece
        given = piece.dealt(lambda mine: dealt_forms(forms, mine))
        self.forms = [PartForm(piece.part, bends, batches) for bends, batches in given]

    @on_all
    def terms(self) -> Terms:
        """Their sum."""
        part = self.piece.part

        def matrix() -> sp.csr_matrix:
            pattern = Pattern(part.reduction)
            found: sp.csr_matrix = assemble(self.forms, [], part.domain, part.reduction, pattern).matrix
            part.domain.forget()
            return found

        return self.piece.terms(matrix)

    @on_all
    def product(self, q: Floats) -> Floats:
        """Their sum times (unknown,) or (unknown, k), bending through strains: see `kshell.plate.product`."""
        own = self.piece.unknowns.spread(q)
        return self.piece.unknowns.collect(
            lambda: self._product(own.reshape(len(own), -1)).reshape(own.shape)
        )

    def _product(self, q: Floats) -> Floats:
        domain, layout, reduction = self.piece.part.domain, self.piece.part.layout, self.piece.part.reduction
        known = np.concatenate([q, np.zeros((1, q.shape[1]))])  # -1, a fixed column, takes the last row
        out = np.zeros_like(known)
        for form in self.forms:
            for _, triangles in form.blocks():
                dofs = layout.triangle_dofs(triangles)
                every = np.broadcast_to(np.eye(dofs.shape[1]), (*dofs.shape, dofs.shape[1]))
                maps, unknown = reduction.local_transform(triangles, dofs, every)
                motion = maps @ known[unknown]  # (triangle, dof, k)
                if form.bends:
                    for column in np.moveaxis(motion, 2, 0):
                        take_planes_off(domain, layout, triangles, column)
                transform = layout.element.transformation(domain.affine(triangles))
                strained, places = transform @ motion, np.where(unknown < 0, len(q), unknown)
                for k in range(q.shape[1]):
                    force = form.products(triangles, transform, strained[:, :, k : k + 1])
                    force = (force[:, None] @ maps)[:, 0]
                    out[:, k] += np.bincount(places.ravel(), force.ravel(), len(out))
        domain.forget()
        return out[:-1]


class Divided:
    """A sum of forms: over areas on all processes, along supports and lines on the first.

    Parameters
    ----------
    team : Team
    problem : PartedPlateProblem
    forms : sequence of Form
    """

    def __init__(self, team: Team, problem: PartedPlateProblem, forms: Sequence[Form]) -> None:
        areas = [form for form in forms if isinstance(form, AreaForm)]
        others = [form for form in forms if not isinstance(form, AreaForm)]
        self.areas: PlateForms = team.calls.run(PlateForms, team, problem.piece, areas)
        self.known = assemble_terms(others, problem.domain, problem.reduction) if others else None

    def matrix(self) -> Symmetric:
        """On the unknowns."""
        return Symmetric(self.areas.terms(), self.known)

    def product(self, q: Floats) -> Floats:
        """The matrix times (unknown,) or (unknown, k), bending through strains."""
        found = self.areas.product(q)
        return found if self.known is None else found + self.known @ q


class PartedPlateProblem(PlateProblem):
    """A plate whose matrix is divided.

    Parameters
    ----------
    team : Team
    structure, element :
        As of `PlateProblem`.

    Attributes
    ----------
    piece : PlatePiece
    stiffness : Divided
    """

    small = False  # a dense matrix is not divided

    def __init__(self, team: Team, structure: Structure, element: Any) -> None:
        super().__init__(structure, element)
        self.team = team
        self.piece: PlatePiece = team.calls.run(PlatePiece, team, members_of(team, self.mesh), self)
        self.stiffness = Divided(team, self, self.forms)

    def _assemble(self, pattern: Pattern | FullPattern | None = None) -> Assembled:
        loads: list[LinearForm] = [*self.loads.forms, *self.supports.hold_loads]
        load, work = assemble_load(loads, self.domain, self.reduction)
        fixed_load, fixed_energy = assemble_fixed(self.forms, self.domain, self.reduction)
        return Assembled(self.stiffness.matrix(), load, work, fixed_load, fixed_energy)

    @cached_property
    def assembled(self) -> Assembled:
        """Matrix and loads on the unknowns, and the share of prescribed motion."""
        return self._assemble()

    @property
    def system(self) -> Assembled:
        """The same."""
        return self.assembled


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
        super().__init__(structure, element, reasons)

    def _posed(self, structure: Structure, element: Any) -> PartedPlateProblem:
        return PartedPlateProblem(self.team, structure, element)

    @property
    def _parted(self) -> PartedPlateProblem:
        return cast(PartedPlateProblem, self.problem)

    def like(self, structure: Structure, element: str) -> PlateModel:
        return PartedPlateModel(self.team, structure, element)

    def mass(self) -> Any:
        found = Divided(self.team, self._parted, self.problem.inertia).matrix()
        if not found.diagonal().any():
            raise InputError(NO_DENSITY)
        return found

    def product(self) -> Callable[[Floats], Floats]:
        return self._parted.stiffness.product

    def _prepare(self, solver: str) -> Prepared:
        matrix, space = self.problem.assembled.matrix, self.problem.space
        why = f"{self.unknowns} unknowns, on {_processes(self.team)}"
        if solver != "multigrid":
            limit = MULTIGRID_FROM[space.element, BACKEND]
            many = self.unknowns >= limit and thin_share(space) <= MANY_THIN
            if solver == "direct" or not many:
                return PetscFactorisation(matrix, why, space)
        return PetscMultigrid(matrix, space, why)

    def solve_ahead(self, models: Sequence[PlateModel], solver: str = "auto") -> None:
        return  # one load after the other

    def solve(self, solver: str = "auto") -> Solved:
        found = super().solve("auto" if solver == "petsc" else solver)
        give_back()  # before values and errors are found
        return found


def _processes(team: Team) -> str:
    return f"{team.size} {'process' if team.size == 1 else 'processes'}"
