"""What both shells have in common as analyses need them."""

from __future__ import annotations

import copy
import hashlib
from collections.abc import Callable, Sequence
from typing import Any, ClassVar, Literal

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.finite_model import FiniteModel
from kshell.equilibrium.linear import LinearSolver
from kshell.equilibrium.model import NO_DENSITY, Solved
from kshell.equilibrium.oscillator import Oscillator
from kshell.equilibrium.problem import Problem, State
from kshell.equilibrium.rigid_modes import Participation, RigidModes
from kshell.errors import InputError, SolveError
from kshell.mesh.closest import Locator
from kshell.result.deferred import Deferred
from kshell.result.result import Result
from kshell.scene.loads import Load
from kshell.scene.placed import Placed
from kshell.scene.places import ProbePoint
from kshell.scene.structure import Structure
from kshell.shell import vibration
from kshell.shell.answer import (
    FRAME,
    answer_linear,
    answer_motion,
    answer_state,
    probes_of,
    small_fields,
    state_fields,
)
from kshell.shell.corners import re_entrant_corners
from kshell.shell.problem import ShellProblem

Floats = NDArray[np.float64]

# relative asymmetry of the stiffness of a load up to which the surface is closed or held: planes of symmetry on a
# coarse mesh of a chart leave 2e-4, a free edge 1.6
SYMMETRIC = 1e-3


class ShellModel(FiniteModel):
    """A Koiter shell of either discretisation; x are displacements and rotations, or displacements and derivatives.

    Parameters
    ----------
    problem : ShellProblem
    reasons : sequence of str
        Why this model.
    """

    kind: ClassVar[Literal["plate", "shell"]] = "shell"
    frame = FRAME

    def __init__(self, problem: ShellProblem, reasons: Sequence[str]) -> None:
        self.problem, self.structure, self.reasons = problem, problem.structure, list(reasons)
        self.element, self.order = problem.discretisation.name, problem.discretisation.order
        self._solver: LinearSolver | None = None  # kept for further loads, and duals
        # what estimates of small deflections find once, whatever the loads: averages, and duals by probe and axis
        self.estimates: dict[Any, Any] = {}
        self._in_motion: dict[str, sp.csr_matrix] = {}  # mass and stiffness, the same under all loads

    @property
    def unknowns(self) -> int:
        return int(self.problem.reduction.basis.shape[1])

    def warnings(self) -> list[str]:
        return self.problem.warnings()

    def warmth(self) -> list[Placed[Load]]:
        return [placed for _, placed in self.problem.loads.warmth]

    def singular(self) -> dict[int, str]:
        shared = self.problem.shared
        if "singular" not in shared:
            patches, _ = self.problem.discretisation.patches()
            shared["singular"] = re_entrant_corners(self.problem.space, patches)
        found: dict[int, str] = shared["singular"]
        return found

    def stiffness(self) -> sp.csr_matrix:
        problem, stiffness = self.problem, self.problem.energy.linear_stiffness()
        return problem.reduction.reduce(stiffness if problem.springs is None else stiffness + problem.springs)

    def product(self) -> Callable[[Floats], Floats]:
        basis = self.problem.reduction.basis
        return lambda q: basis.T @ self._forces(basis @ q)

    def _forces(self, x: Floats) -> Floats:
        """K x on all unknowns, through strains."""
        energy, springs = self.problem.energy, self.problem.springs
        forces = energy.linear_forces(energy.stress(energy.linear_strain(x)))
        return forces if springs is None else forces + springs @ x

    def load_vectors(self) -> Floats:
        problem, loads = self.problem, self.problem.loads
        out = np.zeros((len(self.structure.loads), problem.discretisation.unknowns))
        for number, force in zip(loads.numbers, loads.forces, strict=True):
            out[number] += force
        for number, strain in loads.strains:
            out[number] += problem.energy.linear_forces(problem.energy.stress(strain))
        return np.asarray(out @ problem.reduction.basis)

    def motion_vector(self) -> Floats:
        return -(self.problem.reduction.basis.T @ self._forces(self.problem.reduction.given))

    def elimination(self) -> NDArray[np.integer]:
        basis = sp.csc_matrix(self.problem.reduction.basis)
        first = basis.indices[basis.indptr[:-1]]  # the first unknown that each free one moves
        return np.argsort(self.problem.energy.elimination[first], kind="stable")

    def expand(self, q: Floats) -> Floats:
        return np.asarray(self.problem.reduction.basis @ q)

    def mass(self) -> sp.csr_matrix:
        mass = self.full_mass()
        if not mass.diagonal().any():
            raise InputError(NO_DENSITY)
        return self.problem.reduction.reduce(mass)

    def oscillator(self) -> Oscillator:
        problem, energy, kept = self.problem, self.problem.energy, self._in_motion
        if not kept:
            kept |= {"mass": self.full_mass(), "stiffness": energy.linear_stiffness()}
        reduction, free = problem.reduction, problem.loads.initial
        mass, stiffness, springs = kept["mass"], kept["stiffness"], problem.springs
        if free is None:
            return Oscillator(mass, stiffness, springs, reduction.basis, reduction.given, problem.load)
        stress = energy.stress(free)
        initial, held = energy.linear_forces(stress), 0.5 * float(np.sum(free * stress))
        load = problem.load + initial
        return Oscillator(mass, stiffness, springs, reduction.basis, reduction.given, load, initial, held)

    def full_mass(self) -> sp.csr_matrix:
        every = np.arange(len(self.problem.space.triangles))
        points, _ = self.problem.discretisation.interior_points(every)
        mass = self.problem.discretisation.mass(self.problem.section.mass(every, points))
        added = self.problem.added_mass
        return mass if added is None else (mass + added).tocsr()

    def rigid_modes(self, mass: sp.csr_matrix) -> RigidModes:
        return vibration.rigid_modes_of(self.problem, mass)

    def participation(self, vectors: Floats) -> Participation:
        return vibration.participation_of(self.problem, self.full_mass(), vectors)

    def energies(self, vectors: Floats) -> Floats:
        return vibration.energies(self.problem, vectors)

    def geometric_stiffness(self, solved: Solved) -> sp.csr_matrix:
        problem = self.problem
        problem.require_no_links()
        out = problem.reduction.reduce(problem.energy.geometric_stiffness(solved.own.stress))
        if not problem.loads.followers:
            return out
        still = np.zeros(problem.discretisation.unknowns)
        turning = sum(follow(still)[1] for follow in problem.loads.followers.values())
        reduced = problem.reduction.reduce(turning)
        if abs(reduced - reduced.T).max() > SYMMETRIC * abs(reduced).max():
            raise InputError(
                "the stiffness of a pressure that turns with the surface is not symmetric where the edge of the "
                "surface is free: leave follower out, or hold the edge"
            )
        return (out - 0.5 * (reduced + reduced.T)).tocsr()

    def under(self, factors: Sequence[float], motion: float = 1.0) -> ShellModel:
        if self._solver is None:
            self._solver = self._linear_solver()
        out = copy.copy(self)
        out.problem = self.problem.under(factors, motion)
        return out

    def loaded(self, structure: Structure, factor: float = 1.0) -> ShellModel:
        out = copy.copy(self)
        out.structure, out.problem = structure, self.problem.loaded(structure, factor)
        return out

    def _linear_solver(self) -> LinearSolver:
        problem = self.problem
        return LinearSolver(problem.energy, problem.reduction, problem.springs)

    def solve(self, solver: str = "auto") -> Solved:
        problem = self.problem
        if self._solver is None:
            self._solver = self._linear_solver()
        solution = self._solver.solve(problem.load, problem.reduction.given, problem.loads.initial)
        if not np.isfinite(solution.x).all():
            raise SolveError(
                "the solution is not finite: check the magnitudes of stiffness and loads", state=solution.x
            )
        return Solved(solution.x, "direct", "shells are factorised", len(solution.corrections), solution)

    def respond(self, load: Floats) -> Floats:
        if self._solver is None:
            self._solver = self._linear_solver()
        return self._solver.respond(load)

    def recover(self, solved: Solved) -> Result:
        return answer_linear(self.problem, solved.own)

    def motion_at(self, x: Floats, points: Floats) -> Floats:
        return np.asarray(small_fields(self.problem, x).at(points)["u"])

    def motion_fields(self, x: Floats) -> Deferred[Floats]:
        return small_fields(self.problem, x).vertex_fields

    def equilibrium(self) -> Problem:
        self.problem.require_no_links()
        return self.near_rest()

    def near_rest(self) -> Problem:
        return self.problem.equilibrium()

    def alike(self, near: Problem) -> Problem:
        # a tangent with loads that turn may not be symmetric
        if self._solver is None or near.follower is not None:
            return near
        return near.factorised_by(self._solver.factoriser)

    @property
    def thickness(self) -> float:
        section = self.problem.energy.section
        return float(np.sqrt(12.0 * np.abs(section.bending).max() / np.abs(section.membrane).max()))

    def probe_row(self, name: str, component: str) -> Floats:
        given = self.structure.probes[name]
        at = np.array([given], dtype=float)
        if isinstance(given, ProbePoint):
            found = Locator.on(self.problem.space, given.on, at)
        else:
            found = self.problem.locator.find(at)
        axis = "xyz".index(component)
        row: Floats = self.problem.discretisation.translation_row(int(found.triangles[0]), found.xi[0], axis)
        return row

    def linear_probes(self, solved: Solved) -> dict[str, dict[str, Any]]:
        fields = small_fields(self.problem, solved.x, self.problem.loads.initial)
        return dict(probes_of(self.problem, fields).values)

    def recover_state(self, state: State, work: float, inertia: Floats | None = None) -> Result:
        return answer_state(self.problem, state, work, inertia)

    def recover_motion(self, x: Floats, work: float, inertia: Floats) -> Result:
        return answer_motion(self.problem, x, work, inertia)

    def rigid_motions(self, x: Floats) -> Floats:
        return self.problem.discretisation.rigid_motions(np.zeros(3), 1.0, x)

    def state_probes(self, state: State) -> dict[str, dict[str, Any]]:
        return dict(probes_of(self.problem, state_fields(self.problem, state)).values)

    def fingerprint(self) -> str:
        problem = self.problem
        digest = hashlib.sha256(f"{self.element} {self.order}".encode())
        basis = problem.reduction.basis.tocsc()
        arrays = [problem.space.points, problem.space.triangles, problem.load, problem.reduction.given]
        arrays += [basis.indptr, basis.indices, basis.data, problem.energy.stiffness]
        arrays += [strain for _, strain in problem.loads.strains]
        digest.update(repr(self.structure.section.inelastic()).encode())
        for array in arrays:
            digest.update(np.ascontiguousarray(array).tobytes())
        return digest.hexdigest()
