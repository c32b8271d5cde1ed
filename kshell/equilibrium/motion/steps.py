"""One time step after another.

Every step is an equilibrium with springs and a constant force that stand for inertia, solved as any other (newton.py).
Rotations of edges have no mass and follow at once.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.contact.barrier import Barrier
from kshell.equilibrium.energy import inelastic_of
from kshell.equilibrium.minimise import MOST_ITERATIONS, minimise
from kshell.equilibrium.motion.energies import Fading, Middle, Shifted, stored
from kshell.equilibrium.motion.integrator import MOST_TOUCHING, Integrator
from kshell.equilibrium.motion.schemes import earlier
from kshell.equilibrium.motion.state import Before, Motion
from kshell.equilibrium.newton import correct
from kshell.equilibrium.problem import Problem, State
from kshell.errors import SolveError

Floats = NDArray[np.float64]

# share of step^2 times the stiffness beside the mass in the first acceleration of what is bent by hand: beta of alpha
UNRESOLVED = 0.31
# what the factorisation and patterns of one step leave for the next
KEPT = ("_factoriser", "_springs_added", "_load_added")


class FiniteIntegrator(Integrator):
    """Time steps of a structure under finite deformation.

    Parameters
    ----------
    loaded : function of the time
        The equilibrium under the loads and prescribed motions of that time, all at the factor 1.
    mass : (unknowns, unknowns) CSR matrix
    scheme : "alpha", "em", "bdf2" or "euler"
    viscosity : float
        Time tau of a material of Kelvin and Voigt: its stress is that of the strain plus tau times the strain rate.
    drag : float
        Force on mass and velocity, per time.
    barrier : Barrier, optional
        Of contact; not with "em".
    """

    def __init__(
        self,
        loaded: Callable[[float], Problem],
        mass: sp.csr_matrix,
        scheme: str = "alpha",
        viscosity: float = 0.0,
        drag: float = 0.0,
        barrier: Barrier | None = None,
    ) -> None:
        first = loaded(0.0)
        super().__init__(mass, first.reduction.basis, scheme, viscosity, drag)
        self.loaded, self.barrier = loaded, barrier
        self._kept: dict[str, Any] = {}
        self._most = MOST_ITERATIONS
        self._relaxes = bool(getattr(first.energy, "relaxation", ()))

    def start(self, momentum: Floats | None = None, x: Floats | None = None, size: float = 0.0) -> Motion:
        problem = self.loaded(0.0)
        still = np.zeros(problem.energy.unknowns)
        velocity = still if momentum is None else self.by_mass(momentum)
        state = problem.start() if x is None else self._displaced(problem, x)
        motion = self._finished(problem, 0.0, state, velocity, still, None, None)
        if x is None:
            return replace(motion, acceleration=self.by_mass(motion.force))
        energy, _, _ = problem.evaluate(state.x, 1.0, 2, state.memory)
        tangent = problem.factorise((self.mass + UNRESOLVED * size**2 * energy.hessian).tocsr())
        smooth = self._basis @ tangent.solve(self._basis.T @ motion.force)
        return replace(motion, acceleration=np.where(self.massive, smooth, 0.0))

    def _displaced(self, problem: Problem, x: Floats) -> State:
        """The state with displacements x, rotations in equilibrium."""
        basis, reached = self._basis.tocsc(), self.reached(x)
        rest = np.setdiff1d(np.arange(basis.shape[1]), self._moving)
        turning = problem.reduction._replace(basis=basis[:, rest], given=np.zeros_like(x), following=None)
        state = State(0.0, reached, problem.energy.rest)
        return replace(minimise(replace(problem, reduction=turning), state, 1.0), iterations=0)

    def step(self, motion: Motion, size: float, patient: bool = False) -> Motion:
        self._most = MOST_ITERATIONS if patient else MOST_TOUCHING
        return (self._middle if self.scheme is None else self._end)(motion, size)

    def _end(self, motion: Motion, size: float) -> Motion:
        assert self.scheme is not None
        problem = self.loaded(motion.time + size)
        rule = self.scheme.rule(motion, size, self.mass)
        coefficient = rule.w * rule.c + self.drag * rule.d
        known = self.mass @ (rule.w * rule.acceleration + self.drag * rule.velocity) + rule.rest
        energy: Any = problem.energy
        fading = None
        if self._relaxes:
            fading = Fading(problem.energy, motion.state.memory, size, motion.before is None)
        if self.viscosity or fading is not None:
            energy = Shifted(energy, motion.strain, self.viscosity / size, fading)
        found = self._correct(problem, motion, energy, problem.springs, coefficient, known, size)
        moved = found.x + (found.turned - motion.state.turned)
        velocity = np.where(self.massive, rule.d * moved - rule.velocity, 0.0)
        acceleration = np.where(self.massive, rule.c * moved - rule.acceleration, 0.0)
        return self._finished(
            problem, motion.time + size, found, velocity, acceleration, earlier(motion, size), motion.strain
        )

    def _middle(self, motion: Motion, size: float) -> Motion:
        problem = self.loaded(motion.time + 0.5 * size)
        end = self.loaded(motion.time + size)
        x = motion.x
        energy = Middle(problem.energy, motion.strain, self.viscosity / size, x)
        coefficient = 2.0 / size**2 + self.drag / size
        known = self.mass @ (coefficient * x + 2.0 / size * motion.velocity)
        springs = problem.springs
        if springs is not None:
            springs = 0.5 * springs
            known = known - springs @ x
        if problem.follower is not None:
            follower = problem.follower

            def halfway(there: Floats) -> tuple[Floats, sp.csr_matrix]:
                force, stiffness = follower(0.5 * (x + there))
                return force, 0.5 * stiffness

            problem = replace(problem, follower=halfway)
        problem = replace(problem, reduction=end.reduction, initial=end.initial)
        found = self._correct(problem, motion, energy, springs, coefficient, known, size)
        moved = found.x + (found.turned - motion.state.turned)
        velocity = np.where(self.massive, 2.0 / size * (moved - x) - motion.velocity, 0.0)
        acceleration = (velocity - motion.velocity) / size
        return self._finished(
            end, motion.time + size, found, velocity, acceleration, earlier(motion, size), motion.strain
        )

    def _correct(
        self,
        problem: Problem,
        motion: Motion,
        energy: Any,
        springs: sp.spmatrix | None,
        coefficient: float,
        known: Floats,
        size: float,
    ) -> State:
        """The equilibrium of a step, from the state before it."""
        inertia = coefficient * self.mass
        constant = known if problem.constant is None else known + problem.constant
        before = self.loaded(motion.time).reduction.given
        step = replace(
            problem,
            energy=energy,
            # prescribed motions grow from where they are; the factor counts from 0 to 1 in every step
            reduction=problem.reduction._replace(given=problem.reduction.given - before, following=None),
            springs=inertia if springs is None else (springs + inertia).tocsr(),
            constant=constant,
            scale=0.5 * float(motion.velocity @ (self.mass @ motion.velocity)),
        )
        step.__dict__.update(self._kept)
        before_it = replace(motion.state, factor=0.0, negative=0)
        if self.barrier is None:
            found = self._converged(step, before_it)
        else:
            self.barrier.begin(motion.x, motion.time, motion.time + size)
            found = minimise(replace(step, touching=self.barrier), before_it, 1.0, self._most)
        self._kept = {key: step.__dict__[key] for key in KEPT if key in step.__dict__}
        return found

    def _converged(self, step: Problem, state: State) -> State:
        """By Newton's method with extrapolated stress, downhill where that has no answer."""
        try:
            return correct(step, state, 1.0)
        except SolveError:
            if self.scheme is None:  # the equilibrium in the middle of a step is not that of an energy
                raise
        return minimise(step, state, 1.0)

    def _finished(
        self,
        problem: Problem,
        time: float,
        state: State,
        velocity: Floats,
        acceleration: Floats,
        before: Before | None,
        strain: Floats | None,
    ) -> Motion:
        """The motion at the end of a step that began with an elastic strain (triangle, r)."""
        energy = problem.energy.energy(state.x, 1, state.memory, None, problem.initial)
        internal, value = energy.gradient, energy.value
        strains, stays = energy.linear.strain, inelastic_of(state.memory)
        if stays is not None:
            strains = strains + stays
        if self._relaxes:
            value = stored(problem.energy, state.memory)
        damping = self.drag * (self.mass @ velocity)
        if self.viscosity and before is not None:
            rate = (strains - strain) / before.step
            stress = problem.energy.stress(self.viscosity * rate)
            damping = damping + problem.energy.forces(energy.linear, stress)
        load = problem.load
        if problem.follower is not None:
            load = load + problem.follower(state.x)[0]
        if problem.springs is not None:
            pull = problem.springs @ state.x
            internal, value = internal + pull, value + 0.5 * float(state.x @ pull)
        contact = np.zeros_like(load) if self.barrier is None else -self.barrier.gradient(state.x)
        force = np.where(self.massive, load + contact - internal - damping, 0.0)
        return Motion(
            time, state, velocity, acceleration, force, load, damping, contact, value, strains, before
        )
