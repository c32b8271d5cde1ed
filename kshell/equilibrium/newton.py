"""One equilibrium under large deflections: Newton's method with extrapolated stress.

In thin shells plain Newton needs many iterations because membrane stress is linear in the strain but the
strain is quadratic in the rotations: an iterate slightly off the inextensional path has a huge, wrong
stress in its tangent. Magisano, Leonetti and Garcea (Int. J. Numer. Meth. Engng 2017) take the stress in the
tangent, an independent unknown, from its own linear update; the residual keeps the true stress. The
limit is the same, the way there is several times shorter.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.problem import Problem, State
from kshell.errors import SolveError
from kshell.solvers.repeated import Factor

Floats = NDArray[np.float64]

MOST_ITERATIONS = 25
# work of the last residual on the last correction, against the work of the load; the error is its square
FINISHED = 1e-13
# energy of a state moved rigidly by its supports, against that of the same motion as one of small deflections, that is
# rounding of the strains
STRESS_FREE = 1e-12
# work below which the tangent has all but settled: it serves again while the work falls at such a rate
SETTLED = 1e-5
KEPT = 1e-3
# growth of that work over its first two values, after which an iteration is given up; the second may be (L / t)^2
# times the first, because the first step bends the shell and stretches it on the way
DIVERGED = 1e5
# iterations without a new smallest work, after which it is given up: near a limit point it wanders for ever
PATIENCE = 6


def correct(problem: Problem, state: State, factor: float, most_iterations: int = MOST_ITERATIONS) -> State:
    """Equilibrium at a load factor, from a state nearby.

    Raises
    ------
    SolveError
        If the iteration does not converge; its `state` is the state it started from.
    """
    basis = problem.reduction.basis
    x, stress = state.x, None
    shift = problem.reduction.shift(state.factor, factor)
    moved = bool(np.any(shift))
    first, work, definite = 0.0, np.inf, state.negative == 0
    least = 0.0  # scale of the work where the state sought is free of stress
    best, best_at = np.inf, 0
    tangent: Factor | None = None
    for iteration in range(1, most_iterations + 1):
        energy, residual, growth = problem.evaluate(
            x, factor, 2 if tangent is None else 1, state.memory, stress
        )
        if not np.isfinite(energy.value):
            break
        if iteration == 1:
            least = abs(energy.value)
        if iteration == 1 and moved:
            pull = energy.hessian @ shift
            least = max(least, STRESS_FREE * abs(float(shift @ pull)))
            residual = residual - pull
        reduced = basis.T @ residual
        if tangent is None:
            tangent = problem.factorise(energy.hessian, definite)
            definite = tangent.definite
        step = tangent.solve(reduced)
        before, work = work, abs(float(reduced @ step))
        change = basis @ step
        if iteration == 1 and moved:
            change = change + shift
        if iteration == 1:
            pointed = problem.energy.translation_weights() * change
        stress = problem.energy.extrapolated_stress(energy.linear, change)
        x = x + change
        scale = max(problem.scale + abs(energy.value) + abs(factor * float(growth @ x)), least)
        if iteration > 1 and work <= FINISHED * scale:
            forward = bool(pointed @ (x - state.x) >= 0.0)
            found = State(factor, x, state.memory, iteration, tangent.negative, state.turned, forward)
            return problem.settle(found)
        if not np.isfinite(work) or (iteration > 2 and work > DIVERGED * first):
            break
        first = max(first, work)
        if work < best * scale:
            best, best_at = work / scale, iteration
        elif iteration - best_at > PATIENCE:
            break
        if scale == 0.0 and not np.any(change):  # nothing loads or moves the shell
            return problem.settle(State(factor, x, state.memory, iteration, tangent.negative, state.turned))
        if not (work <= SETTLED * scale and work <= KEPT * before):
            tangent = None
    raise SolveError(
        f"no equilibrium found at the load factor {factor:.6g} from {state.factor:.6g} in {iteration} iterations",
        state=state,
    )
