"""Work of loads and prescribed motions along a path.

    W = sum over steps of int g . dx,

g the forces that hold the state: loads and, where motions are prescribed, reactions. Over a step of the load factor f
of length h, g is taken linear and x cubic with the slopes x' = dx/df at both ends, which gives

    1/2 (g0 + g1) . (x1 - x0) + h/12 (g1 - g0) . (x1' - x0').

For dead loads g is linear indeed. Where the slopes are of no use, as near limit points, the first term stands alone,
the trapezoidal rule.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.problem import Problem, State
from kshell.errors import SolveError

Floats = NDArray[np.float64]

# part of the first term that the second must not exceed
LARGEST_CORRECTION = 0.5


def external_work(problem: Problem, states: list[State]) -> list[float]:
    """Work from the first state to each."""
    total = [0.0]
    force, slope = _force_and_slope(problem, states[0])
    for before, after in pairwise(states):
        next_force, next_slope = _force_and_slope(problem, after)
        moved = (after.x + after.turned) - (before.x + before.turned)
        work = 0.5 * float((force + next_force) @ moved)
        if slope is not None and next_slope is not None:
            step = after.factor - before.factor
            more = step / 12.0 * float((next_force - force) @ (next_slope - slope))
            if before.negative == after.negative and abs(more) <= LARGEST_CORRECTION * abs(work):
                work += more
        total.append(total[-1] + work)
        force, slope = next_force, next_slope
    return total


def _force_and_slope(problem: Problem, state: State) -> tuple[Floats, Floats | None]:
    """Forces that hold the state, (unknowns,), and dx/df, None where the tangent is singular."""
    given, basis = problem.reduction.rate(state.factor), problem.reduction.basis
    energy, _, growth = problem.evaluate(state.x, state.factor, 2, state.memory)
    # what holds the shell: loads and reactions are in equilibrium with it
    force = energy.gradient if problem.springs is None else energy.gradient + problem.springs @ state.x
    if np.any(given):
        growth = growth - energy.hessian @ given
    try:
        slope = basis @ problem.factorise(energy.hessian, state.negative == 0).solve(basis.T @ growth) + given
    except SolveError:
        return force, None
    return force, slope if np.isfinite(slope).all() else None
