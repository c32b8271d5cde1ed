"""Where the load has passed its maximum: the next stable equilibrium, reached as through a viscous fluid.

A real shell jumps there. The jump is followed slowly, M dx/dt = forces(x) with M the weights of the translations, by
implicit Euler steps, each of them one equilibrium with springs M / dt that pull to the last place, solved as any
other (newton.py). Steps grow until no spring is needed. Every step has an answer if it is short enough, so that
unlike Newton's method alone this does not depend on a good guess.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kshell.equilibrium.minimise import minimise
from kshell.equilibrium.newton import correct
from kshell.equilibrium.problem import Problem, State
from kshell.errors import SolveError

MOST_STEPS = 80
MOST_ITERATIONS = 12
# springs against those of the first step: when to try without, and when to give up
SOFT, STIFFEST = 1e-2, 1e8
# iterations of a step after which the springs are made softer by half, and by some
EASY, HARD = 4, 7


def relax(problem: Problem, state: State, factor: float) -> State:
    """A stable equilibrium at a load factor at which the state is none.

    Returns
    -------
    State
        Its iterations are those of the whole way.

    Raises
    ------
    SolveError
        If none is found.
    """
    weights = problem.energy.translation_weights()
    spring = _first_spring(problem, state, factor)
    softest, stiffest = SOFT * spring, STIFFEST * spring
    iterations = 0
    for _ in range(MOST_STEPS):
        try:
            held = problem.pulled(spring * weights, state.x)
            moved = correct(held, state, factor, MOST_ITERATIONS)
        except SolveError:
            spring *= 3.0
            if spring > stiffest:
                break
            continue
        iterations += moved.iterations
        if moved.negative:
            spring *= 4.0  # not a minimum with these springs: the step went too far
            continue
        state = moved
        if spring <= softest:
            try:
                found = correct(problem, state, factor, MOST_ITERATIONS)
            except SolveError:
                found = None
            if found is not None and not found.negative:
                return replace(found, iterations=iterations + found.iterations)
        spring *= 0.5 if moved.iterations <= EASY else 0.8 if moved.iterations <= HARD else 1.2
    try:
        found = minimise(problem, state, factor)
    except SolveError:
        raise SolveError(
            f"no stable equilibrium found at the load factor {factor:.6g} beyond the limit point", state=state
        ) from None
    return replace(found, iterations=iterations + found.iterations)


def _first_spring(problem: Problem, state: State, factor: float) -> float:
    """Stiffness against the mean displacement so far."""
    moved = float(problem.energy.translation_weights() @ state.x**2)
    energy, _, growth = problem.evaluate(state.x, state.factor, 1, state.memory)
    work = abs(state.factor * float(growth @ state.x))
    if moved > 0.0 and work > 0.0:
        return work / moved
    pull = float(np.linalg.norm(problem.reduction.basis.T @ (factor * growth)))
    if pull > 0.0:
        return pull
    # prescribed motion alone: what the shell stores
    return energy.value / moved if moved > 0.0 else 1.0
