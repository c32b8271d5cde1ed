"""The plate as analyses need it."""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from typing import Any, ClassVar, Literal

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.elements import PlateElement
from kshell.equilibrium.model import NO_DENSITY, Solved
from kshell.equilibrium.moving_model import MovingModel
from kshell.equilibrium.oscillator import Oscillator
from kshell.equilibrium.rigid_modes import Participation, RigidModes
from kshell.errors import InputError, SolveError
from kshell.plate import vibration
from kshell.plate.answer import motion_at, motion_fields, recover, recover_motion
from kshell.plate.assembly import assemble, assemble_load
from kshell.plate.moving import PlateMotion, fingerprint, probe_row
from kshell.plate.pattern import Pattern
from kshell.plate.problem import ELEMENTS, PlateProblem
from kshell.plate.product import strain_product
from kshell.result.deferred import Deferred
from kshell.result.result import Result
from kshell.scene.loads import Load
from kshell.scene.placed import Placed
from kshell.scene.structure import Structure
from kshell.solvers import Prepared, Solution, prepare
from kshell.solvers.dense import DenseFactor, solve_dense
from kshell.solvers.direct import Factorisation
from kshell.solvers.dissection import dissected

Floats = NDArray[np.float64]

ROUNDED_FROM = 20_000  # unknowns from which rounding of the matrix exceeds 1e-10 of the deflection
# size of the plate over the height of its triangles: rounding grows with its fourth power, on a slender ring sector of
# 2,048 triangles (ratio 1300) to 2e-4 of the loads; a square with the unknowns above has 65
SLENDER_FROM = 65.0
MOST_TOGETHER = 4_000_000  # unknowns of all loads that are solved together: 32 MB in each of some arrays
DUAL_TOLERANCE = 1e-8  # of duals in energy, which estimates take to a few digits


class PlateModel(MovingModel):
    """A Kirchhoff plate; x are its physical degrees of freedom.

    Parameters
    ----------
    structure : Structure
        Its mesh in a plane of constant z.
    element : "morley" or "argyris"
    reasons : sequence of str
        Why this model.

    Raises
    ------
    InputError
        If a support, load, material or thickness does not fit, or the plate is not held.
    """

    kind: ClassVar[Literal["plate", "shell"]] = "plate"

    def __init__(self, structure: Structure, element: str, reasons: Sequence[str] = ()) -> None:
        self.structure = structure
        self.problem = self._posed(structure, ELEMENTS[element]())
        self.element, self.order = element, self.problem.element.maxdeg
        self.reasons = list(reasons)
        self._prepared: dict[str, Prepared] = {}  # by solver, for further loads and duals
        self._dense: list[DenseFactor] = []  # the same of few unknowns, once it is made
        self._ahead: dict[str, Solved] = {}  # by solver, what `solve_ahead` found
        # what `solve_ahead` found for all loads, deflections (dof,), whose errors may be estimated together
        self.together: list[tuple[PlateProblem, Floats]] = []
        # by probe: dual solution (dof,) and its estimate by triangle; the same under all loads
        self.duals: dict[str, tuple[Floats, Floats]] = {}
        self.estimates: list[tuple[Floats, Floats]] = []  # by triangle, of deflections (dof,) under loads
        self._motion = PlateMotion(self.problem)  # the same under all loads

    def _posed(self, structure: Structure, element: PlateElement) -> PlateProblem:
        return PlateProblem(structure, element)

    def like(self, structure: Structure, element: str) -> PlateModel:
        """Another plate, computed in the same way."""
        return PlateModel(structure, element)

    @property
    def unknowns(self) -> int:
        return self.problem.reduction.count

    def warnings(self) -> list[str]:
        return self.problem.warnings()

    def singular(self) -> dict[int, str]:
        return self.problem.singular

    def warmth(self) -> list[Placed[Load]]:
        return [placed for _, placed in self.problem.loads.warmth]

    def stiffness(self) -> sp.csr_matrix:
        return self.problem.assembled.matrix

    def product(self) -> Callable[[Floats], Floats]:
        product: Callable[[Any], Any] = strain_product(self.problem)
        return product

    def load_vectors(self) -> Floats:
        problem = self.problem
        vectors = [
            assemble_load(problem.loads.of(number), problem.domain, problem.reduction)[0]
            for number in range(len(problem.structure.loads))
        ]
        return np.array(vectors).reshape(len(vectors), self.unknowns)

    def motion_vector(self) -> Floats:
        problem = self.problem
        holds, _ = assemble_load(problem.supports.hold_loads, problem.domain, problem.reduction)
        return problem.system.fixed_load + holds

    def elimination(self) -> NDArray[np.integer]:
        mesh, nodes = self.problem.mesh, len(self.problem.mesh.points)
        members = np.concatenate([mesh.triangles, nodes + mesh.triangle_edges], axis=1)
        centres = self.problem.domain.points[mesh.triangles].mean(axis=1)
        place = dissected(centres, members, nodes + len(mesh.edges))
        return np.argsort(np.repeat(place, self.problem.reduction.sizes), kind="stable")

    def expand(self, q: Floats) -> Floats:
        return np.asarray(self.problem.space.reduction @ q)

    def mass(self) -> sp.csr_matrix:
        problem = self.problem
        pattern = Pattern(problem.reduction)
        found = assemble(problem.inertia, [], problem.domain, problem.reduction, pattern).matrix
        if self.unknowns and not found.diagonal().any():
            raise InputError(NO_DENSITY)
        return found

    def rigid_modes(self, mass: sp.csr_matrix) -> RigidModes:
        return vibration.rigid_modes_of(self.problem, mass)

    def participation(self, vectors: Floats) -> Participation:
        return vibration.participation(self.problem, vectors)

    def energies(self, vectors: Floats) -> Floats:
        return vibration.energies(self.problem, vectors)

    def under(self, factors: Sequence[float], motion: float = 1.0) -> PlateModel:
        out = copy.copy(self)
        out.problem = self.problem.under(factors, motion)
        out._ahead = {}
        return out

    def prepare(self) -> None:
        self.problem.system  # noqa: B018 - assembled when it is first looked at

    def solve(self, solver: str = "auto") -> Solved:
        system = self.problem.system
        known = self._ahead.get(solver)
        return known or self._solved(self._solve(system.fixed_load + system.load, solver))

    def _solved(self, solution: Solution) -> Solved:
        d = self.problem.reduction.expand(np.asarray(solution.x, dtype=np.float64))
        if not np.isfinite(d).all():
            raise SolveError(
                "the solution is not finite: check the magnitudes of stiffness and loads", state=d
            )
        return Solved(d, solution.name, solution.why, solution.iterations, solution)

    def solve_ahead(self, models: Sequence[PlateModel], solver: str = "auto") -> None:
        if self.unknowns == 0 or len(models) < 2 or solver == "multigrid":
            return
        if not self.problem.small and not isinstance(self._ready(solver), Factorisation):
            return
        systems = [model.problem.system for model in models]
        loads = np.stack([system.fixed_load + system.load for system in systems], axis=1)
        if loads.size > MOST_TOGETHER or not loads.any(axis=0).all():
            return
        solution = self._solve(loads, solver)
        found = [model._solved(solution.column(number)) for number, model in enumerate(models)]
        for model, solved in zip(models, found, strict=True):
            model._ahead[solver] = solved
        self.together[:] = [(model.problem, solved.x) for model, solved in zip(models, found, strict=True)]

    def _solve(self, rhs: Floats, solver: str) -> Solution:
        problem = self.problem
        if self.unknowns == 0:
            none = np.zeros(0)
            return Solution(none, "none", "the supports hold every degree of freedom", 0, (0.0,), 0.0, 0.0)
        quintic = problem.element.maxdeg > 2
        slender = quintic and problem.size_over_height > SLENDER_FROM
        if problem.small and solver != "multigrid" and not slender:
            if not self._dense:
                self._dense.append(DenseFactor(problem.system.matrix))
            found = solve_dense(self._dense[0], rhs)
            if found is not None:
                return found
        # rounding of the matrix costs quintics digits on fine meshes: residuals through strains keep them
        fine = quintic and (slender or self.unknowns > ROUNDED_FROM)
        product: Any = self.product() if fine else None
        return self._ready(solver).solve(rhs, product=product)

    def _ready(self, solver: str) -> Prepared:
        prepared = self._prepared.get(solver)
        if prepared is None:
            prepared = self._prepared[solver] = self._prepare(solver)
        return prepared

    def _prepare(self, solver: str) -> Prepared:
        return prepare(self.problem.assembled.matrix, self.problem.space, solver)

    def respond(self, load: Floats) -> Floats:
        if self.unknowns == 0:
            return np.zeros_like(load)
        known: list[Any] = [*(factor for factor in self._dense if factor.good), *self._prepared.values()]
        for factor in known[:1]:
            if not isinstance(factor, Factorisation | DenseFactor):
                return np.asarray(factor.solve(load, DUAL_TOLERANCE).x, dtype=np.float64)
            x = np.asarray(factor.apply(load), dtype=np.float64)
            product, work = factor.matrix @ x, np.abs(np.sum(load * x, axis=0))
            if (np.abs(np.sum(x * (load - product), axis=0)) <= DUAL_TOLERANCE * work).all():
                return x
        # refined as the solution itself, as far as that goes
        return np.asarray(self._solve(load, next(iter(self._prepared), "auto")).x, dtype=np.float64)

    def recover(self, solved: Solved) -> Result:
        return recover(self.problem, solved.x, solved.own)

    def motion_at(self, x: Floats, points: Floats) -> Floats:
        return motion_at(self.problem, x, points)

    def motion_fields(self, x: Floats) -> Deferred[Floats]:
        return motion_fields(self.problem, x)

    # motion in time

    def oscillator(self) -> Oscillator:
        return self._motion.oscillator(self.problem)

    def loaded(self, structure: Structure, factor: float = 1.0) -> PlateModel:
        out = copy.copy(self)
        out.structure, out.problem = structure, self.problem.loaded(structure, factor)
        out._ahead = {}
        return out

    def full_mass(self) -> sp.csr_matrix:
        return self._motion.mass

    @property
    def thickness(self) -> float:
        mesh = self.problem.mesh
        found = self.problem.section.thickness_per_triangle
        return float(mesh.areas @ found / mesh.areas.sum())

    def probe_row(self, name: str, component: str) -> Floats:
        return probe_row(self.problem, name, component)

    def rigid_motions(self, x: Floats) -> Floats:
        return self._motion.rigid

    def recover_motion(self, x: Floats, work: float, inertia: Floats) -> Result:
        return recover_motion(self.problem, x, (self.oscillator().energy(x), work), inertia)

    def fingerprint(self) -> str:
        return fingerprint(self.problem)
