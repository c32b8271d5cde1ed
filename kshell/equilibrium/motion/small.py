"""Time steps of small deflections: one linear system a step, factorised once for every size of the steps.

With the constants of `schemes.py` and the strain rate by backward differences of order 2 (of order 1 in a first step
and with implicit Euler, whose own order that is), x' = p x1 - x_p, a step solves

    T^T ((w c + d_g d) M + (1 + tau p) K + S) x1 = T^T (f1 + w M a_k + d_g M v_k + tau K x_p + r),

d_g the drag. `em` is the rule of the middle, which keeps the energy of what is linear to rounding:

    T^T ((2 / h^2 + d_g / h) M + (1/2 + tau / h) K + S / 2) x1
      = T^T (f + M ((2 / h^2 + d_g / h) x0 + 2 / h v0) + (tau / h - 1/2) K x0 - S x0 / 2).

Forces f0 of strains without stress come with K x: the elastic strain is what is viscous.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.motion.integrator import Integrator
from kshell.equilibrium.motion.schemes import Euler, earlier
from kshell.equilibrium.motion.state import Before, Motion
from kshell.equilibrium.oscillator import Oscillator
from kshell.equilibrium.problem import State
from kshell.solvers import prepare

Floats = NDArray[np.float64]

# share of step^2 times the stiffness beside the mass in the first acceleration of what is bent by hand: beta of alpha
UNRESOLVED = 0.31
# factors that are kept, of the sizes of steps used last
FACTORS = 8


@dataclass(frozen=True)
class _Rate:
    """x' = p x1 - (q0 x0 + q1 x_before)."""

    p: float
    q0: float
    q1: float = 0.0


class SmallIntegrator(Integrator):
    """Time steps of a structure under small deflections.

    Parameters
    ----------
    loaded : function of the time
        Matrices, loads and prescribed motion.
    scheme : "alpha", "em", "bdf2" or "euler"
    viscosity, drag : float
        As for `Integrator`.

    Attributes
    ----------
    factorised : int
        Matrices factorised so far.
    """

    few_sizes = True  # every other one is another factorisation

    def __init__(
        self,
        loaded: Callable[[float], Oscillator],
        scheme: str = "alpha",
        viscosity: float = 0.0,
        drag: float = 0.0,
    ) -> None:
        self.loaded, self._first = loaded, loaded(0.0)
        super().__init__(self._first.mass, self._first.basis, scheme, viscosity, drag)
        self._factors: dict[tuple[float, float, float], Callable[[Floats], Floats]] = {}
        self.factorised = 0

    def start(self, momentum: Floats | None = None, x: Floats | None = None, size: float = 0.0) -> Motion:
        now = self.loaded(0.0)
        still = np.zeros(len(now.load))
        velocity = still if momentum is None else self.by_mass(momentum)
        place = self._placed(now, still if x is None else self.reached(x))
        motion = self._finished(0.0, place, velocity, still, None, None)
        if x is None:
            return replace(motion, acceleration=self.by_mass(motion.force))
        share = UNRESOLVED * size**2
        smooth = self._basis @ self._solution(1.0, share, share, self._basis.T @ motion.force)
        return replace(motion, acceleration=np.where(self.massive, smooth, 0.0))

    def _placed(self, now: Oscillator, x: Floats) -> Floats:
        """(unknowns,) x where there is mass, the rest in equilibrium."""
        rest = np.setdiff1d(np.arange(self._basis.shape[1]), self._moving)
        if not len(rest):
            return x
        from scipy.sparse.linalg import spsolve

        turning = self._basis.tocsc()[:, rest]
        matrix = now.stiffness if now.springs is None else now.stiffness + now.springs
        left = turning.T @ (now.load - now.forces(x))
        turned: Floats = turning @ spsolve((turning.T @ matrix @ turning).tocsc(), left)
        return x + turned

    def step(self, motion: Motion, size: float, patient: bool = False) -> Motion:
        return (self._middle if self.scheme is None else self._end)(motion, size)

    def _end(self, motion: Motion, size: float) -> Motion:
        assert self.scheme is not None
        now, tau, drag = self.loaded(motion.time + size), self.viscosity, self.drag
        rule, rate = self.scheme.rule(motion, size, self.mass), self._rate(motion, size)
        known = now.load + self.mass @ (rule.w * rule.acceleration + drag * rule.velocity) + rule.rest
        if tau:
            known = known + tau * (now.stiffness @ _past(rate, motion))
            known = known + tau * self._initial_rate(motion.time, size, now)
        x = self._found(now, (rule.w * rule.c + drag * rule.d, 1.0 + tau * rate.p, 1.0), known)
        velocity = np.where(self.massive, rule.d * x - rule.velocity, 0.0)
        acceleration = np.where(self.massive, rule.c * x - rule.acceleration, 0.0)
        strained = rate.p * x - _past(rate, motion) if tau else None
        before = earlier(motion, size)
        return self._finished(motion.time + size, x, velocity, acceleration, before, strained)

    def _middle(self, motion: Motion, size: float) -> Motion:
        middle, now = self.loaded(motion.time + 0.5 * size), self.loaded(motion.time + size)
        x0, tau, drag = motion.x, self.viscosity, self.drag
        inertia = 2.0 / size**2 + drag / size
        known = middle.load + self.mass @ (inertia * x0 + 2.0 / size * motion.velocity)
        known = known + (tau / size - 0.5) * (now.stiffness @ x0)
        if now.springs is not None:
            known = known - 0.5 * (now.springs @ x0)
        if tau:
            known = known + tau * self._initial_rate(motion.time, size, now)
        x = self._found(now, (inertia, 0.5 + tau / size, 0.5), known)
        velocity = np.where(self.massive, 2.0 / size * (x - x0) - motion.velocity, 0.0)
        acceleration = (velocity - motion.velocity) / size
        strained = (x - x0) / size if tau else None
        before = earlier(motion, size)
        return self._finished(motion.time + size, x, velocity, acceleration, before, strained)

    def _rate(self, motion: Motion, size: float) -> _Rate:
        """The strain rate at the end of a step."""
        before = motion.before
        if before is None or isinstance(self.scheme, Euler):
            return _Rate(1.0 / size, 1.0 / size)
        ratio = size / before.step
        last = ratio**2 / (1.0 + ratio) / size
        return _Rate((1.0 + 2.0 * ratio) / (1.0 + ratio) / size, (1.0 + ratio) / size, -last)

    def _initial_rate(self, time: float, size: float, now: Oscillator) -> Floats | float:
        """(unknowns,) f0' in a step from a time."""
        then = self.loaded(time).initial
        if now.initial is None and then is None:
            return 0.0
        first, last = (0.0 if part is None else part for part in (then, now.initial))
        return np.asarray((last - first) / size)

    def _found(self, now: Oscillator, shares: tuple[float, float, float], known: Floats) -> Floats:
        """(unknowns,) the place where shares of mass, stiffness and springs balance known forces."""
        mass, stiff, springs = shares
        if np.any(now.given):
            pull = mass * (self.mass @ now.given) + stiff * (now.stiffness @ now.given)
            known = known - (pull if now.springs is None else pull + springs * (now.springs @ now.given))
        q = self._solution(mass, stiff, springs, self._basis.T @ known)
        return np.asarray(self._basis @ q + now.given)

    def _solution(self, mass: float, stiff: float, springs: float, rhs: Floats) -> Floats:
        """(free,) with the matrix of shares of mass, stiffness and springs."""
        if not len(rhs):
            return rhs
        key = (mass, stiff, springs)
        solve = self._factors.pop(key, None)
        if solve is None:
            while len(self._factors) >= FACTORS:
                del self._factors[next(iter(self._factors))]
            of_mass, of_stiffness, of_springs = self._matrices
            matrix = mass * of_mass + stiff * of_stiffness
            prepared: Any = prepare(
                matrix if of_springs is None else matrix + springs * of_springs, method="direct"
            )
            solve, self.factorised = prepared.apply, self.factorised + 1
        self._factors[key] = solve  # the last is the one used last
        return solve(rhs)

    @cached_property
    def _matrices(self) -> tuple[sp.csr_matrix, sp.csr_matrix, sp.csr_matrix | None]:
        """Mass, stiffness and springs in the free motions."""
        first, basis = self._first, self._basis

        def reduced(matrix: sp.csr_matrix) -> sp.csr_matrix:
            return (basis.T @ matrix @ basis).tocsr()

        springs = None if first.springs is None else reduced(first.springs)
        return reduced(self.mass), reduced(first.stiffness), springs

    def _finished(
        self,
        time: float,
        x: Floats,
        velocity: Floats,
        acceleration: Floats,
        before: Before | None,
        strained: Floats | None,
    ) -> Motion:
        """The motion at the end of a step, with the rate of the unknowns that strains the material."""
        now = self.loaded(time)
        damping = self.drag * (self.mass @ velocity)
        if strained is not None and before is not None:
            damping = damping + self.viscosity * (
                now.stiffness @ strained - self._initial_rate(time - before.step, before.step, now)
            )
        force = np.where(self.massive, now.load - now.forces(x) - damping, 0.0)
        nothing = np.zeros(0)
        state = State(1.0, x, None, 0 if before is None else 1)
        return Motion(
            time,
            state,
            velocity,
            acceleration,
            force,
            now.load if now.initial is None else now.load - now.initial,
            damping,
            np.zeros_like(x),
            now.energy(x),
            nothing,
            before,
        )


def _past(rate: _Rate, motion: Motion) -> Floats:
    """(unknowns,) what the rate takes from the steps before."""
    past = rate.q0 * motion.x
    return past if motion.before is None else past + rate.q1 * motion.before.x
