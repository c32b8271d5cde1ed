"""Load steps under large deflections: Newton's method with extrapolated stress, and adaptive steps.

In thin shells plain Newton needs many iterations because membrane stress is linear in the strain but the
strain is quadratic in the rotations: an iterate slightly off the inextensional path has a huge, wrong
stress in its tangent. Magisano, Leonetti and Garcea (Int. J. Numer. Meth. Engng 2017) take the stress in the
tangent, an independent unknown, from its own linear update; the residual keeps the true stress. The
limit is the same, the way there is several times shorter.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kshell.errors import SolveError
from kshell.shell.equilibrium import Problem, State

Floats = NDArray[np.float64]

MOST_ITERATIONS = 25
# work of the last residual on the last correction, against the work of the load; the error is its square
FINISHED = 1e-13
# growth of that work over its first value, after which an iteration is given up
DIVERGED = 1e8
# iterations of a step after which the next one is longer, and shorter
EASY, HARD = 5, 12
SMALLEST_STEP = 1e-4
MOST_ATTEMPTS = 300
# a step that ends on an unstable branch is repeated with smaller steps down to this part of the first one
DOUBTFUL_STEP = 1.0 / 16.0


def correct(problem: Problem, state: State, factor: float) -> State:
    """Equilibrium at a load factor, from a state nearby.

    Raises
    ------
    SolveError
        If the iteration does not converge; its `state` is the state it started from.
    """
    basis, given = problem.reduction.basis, problem.reduction.given
    x, stress = state.x, None
    shift = (factor - state.factor) * given
    moved = bool(np.any(shift))
    first = 0.0
    for iteration in range(1, MOST_ITERATIONS + 1):
        energy, residual, growth = problem.evaluate(x, factor, 2, state.memory, stress)
        if not np.isfinite(energy.value):
            break
        if iteration == 1 and moved:
            residual = residual - energy.hessian @ shift
        reduced = basis.T @ residual
        tangent = problem.factorise(energy.hessian)
        step = tangent.solve(reduced)
        work = abs(float(reduced @ step))
        change = basis @ step
        if iteration == 1 and moved:
            change = change + shift
        stress = problem.energy.extrapolated_stress(x, change, state.memory)
        x = x + change
        scale = abs(energy.value) + abs(factor * float(growth @ x))
        if iteration > 1 and work <= FINISHED * scale:
            return problem.settle(State(factor, x, state.memory, iteration, tangent.negative))
        if not np.isfinite(work) or (first > 0.0 and work > DIVERGED * first):
            break
        first = max(first, work)
        if scale == 0.0:
            return problem.settle(State(factor, x, state.memory, iteration, tangent.negative))
    raise SolveError(
        f"no equilibrium found at the load factor {factor:.6g} from {state.factor:.6g} in {iteration} iterations",
        state=state,
    )


def load_path(
    problem: Problem,
    steps: int = 10,
    until: float = 1.0,
    start: State | None = None,
    record: Callable[[State], None] | None = None,
) -> list[State]:
    """Follow the equilibrium while the load factor grows.

    A step that fails is halved; steps that converge easily grow.

    Parameters
    ----------
    steps : int
        First guess of the number of steps.
    until : float
        Last load factor.
    start : State, optional
        The rest state if absent.
    record : callable, optional
        Called with every converged state.

    Returns
    -------
    list of State
        The start, and every converged step.

    Raises
    ------
    SolveError
        If steps become too small: a limit point, or no equilibrium; `state` is the list so far.
    """
    state = problem.start() if start is None else start
    path = [state]
    span = until - state.factor
    size = span / max(steps, 1)
    attempts = 0
    while abs(until - state.factor) > 1e-12 * abs(span):
        attempts += 1
        size = np.sign(span) * min(abs(size), abs(until - state.factor))
        try:
            found = correct(problem, state, state.factor + size)
        except SolveError as error:
            size *= 0.5
            if abs(size) < SMALLEST_STEP * abs(span):
                raise _stuck(path, str(error)) from error
            continue
        if attempts > MOST_ATTEMPTS + steps:
            raise _stuck(path, f"{attempts} steps did not reach the factor {until:g}")
        if found.negative > state.negative and abs(size) > DOUBTFUL_STEP * abs(span) / steps:
            size *= 0.5  # the iteration may have jumped to another branch
            continue
        state = found
        path.append(state)
        if record is not None:
            record(state)
        if state.iterations <= EASY:
            size *= 1.5
        elif state.iterations > HARD:
            size *= 0.7
    return path


def _stuck(path: list[State], why: str) -> SolveError:
    unstable = next((s.factor for s in path if s.negative > 0), None)
    hint = "" if unstable is None else f"; the equilibrium is unstable from the factor {unstable:.6g} on"
    return SolveError(
        f"the load cannot be increased beyond the factor {path[-1].factor:.6g}: the equilibrium ends or turns back "
        f"there ({why}){hint}; follow it with the analysis 'path'",
        state=path,
    )
