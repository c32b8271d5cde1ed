"""Large deflections under a growing load: adaptive steps, and what to do where the load has a maximum.

A step that fails is halved, steps that converge easily grow. A step that ends with more negative eigenvalues
than it began with may have jumped to another branch of equilibria and is repeated with smaller steps. Where the
load cannot grow any more the path is followed by its length through the limit points, until the load is
beyond the maximum and the shell is stable again.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kshell.errors import SolveError
from kshell.shell.equilibrium import Problem, State
from kshell.shell.newton import correct
from kshell.shell.path import Path, follow

Floats = NDArray[np.float64]

# iterations of a step after which the next one is longer, and shorter
EASY, HARD = 5, 12
SMALLEST_STEP = 1e-4
MOST_ATTEMPTS = 300
# a step that ends on an unstable branch is repeated with smaller steps down to this part of the first one
DOUBTFUL_STEP = 1.0 / 16.0
# growth of the displacement per load from one step to the next that tells a jump over a limit point
JUMP = 10.0
# steps along the path through limit points, and the length of the first against the deflection so far
MOST_ARC_STEPS = 60
FIRST_ARC = 0.1


def load_path(
    problem: Problem,
    steps: int = 10,
    until: float = 1.0,
    start: State | None = None,
    record: Callable[[State], None] | None = None,
    cross_limits: bool = True,
) -> Path:
    """Follow the equilibrium while the load factor grows.

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
    cross_limits : bool
        Whether to go on behind a limit point. The states in between have smaller loads; a real shell jumps.

    Returns
    -------
    Path
        The start, every converged step, and the critical points that were crossed by following the path.

    Raises
    ------
    SolveError
        If the load cannot grow to the last factor; `state` is the `Path` so far.
    """
    path = Path([problem.start() if start is None else start], [])
    span = until - path.states[0].factor
    size = span / max(steps, 1)
    attempts = 0
    while abs(until - path.states[-1].factor) > 1e-12 * abs(span):
        attempts += 1
        state = path.states[-1]
        left = until - state.factor
        size = np.sign(left) * min(abs(size), abs(left))
        try:
            found = correct(problem, state, state.factor + size)
        except SolveError as error:
            size *= 0.5
            if abs(size) >= SMALLEST_STEP * abs(span):
                continue
            if not cross_limits or len(path.states) < 2 or span < 0:
                raise _stuck(path, str(error)) from error
            _cross(problem, path, record)
            size = span / max(steps, 1)
            continue
        if attempts > MOST_ATTEMPTS + steps:
            raise _stuck(path, f"{attempts} steps did not reach the factor {until:g}")
        jumped = len(path.states) > 1 and _rate(problem, state, found) > JUMP * _rate(
            problem, path.states[-2], state
        )
        lost = found.negative > state.negative and abs(size) > DOUBTFUL_STEP * abs(span) / steps
        if lost or (jumped and abs(size) >= SMALLEST_STEP * abs(span)):
            size *= 0.5  # the iteration may have gone to another branch
            continue
        path.states.append(found)
        if record is not None:
            record(found)
        if found.iterations <= EASY:
            size *= 1.5
        elif found.iterations > HARD:
            size *= 0.7
    return path


def _rate(problem: Problem, before: State, after: State) -> float:
    """Root mean square displacement of the nodes per growth of the load."""
    return _distance(problem, after.x - before.x) / abs(after.factor - before.factor)


def _distance(problem: Problem, x: Floats) -> float:
    return float(np.linalg.norm(x * np.sqrt(problem.energy.translation_weights())))


def _cross(problem: Problem, path: Path, record: Callable[[State], None] | None) -> None:
    """Add the states through limit points to the path, up to one with a larger load that is as stable."""
    last = path.states[-1]

    passed: list[State] = []

    def beyond(state: State) -> bool:
        return bool(state.factor > last.factor * (1 + 1e-6) and state.negative <= last.negative)

    def ended(state: State) -> bool:
        return beyond(state) or state.factor < -last.factor  # lost on the way back

    def note(state: State) -> None:
        passed.append(state)
        if record is not None:
            record(state)

    length = max(_distance(problem, last.x - path.states[-2].x), FIRST_ARC * _distance(problem, last.x))
    try:
        arc = follow(problem, length, ended, last, most_steps=MOST_ARC_STEPS, record=note)
    except SolveError as error:
        path.states.extend(passed)
        raise _stuck(path, str(error)) from error
    path.states.extend(passed)
    path.critical.extend(arc.critical)
    if not beyond(path.states[-1]):
        raise _stuck(path, "the path behind the maximum does not lead to a larger load")


def _stuck(path: Path, why: str) -> SolveError:
    highest = max(s.factor for s in path.states)
    unstable = next((s.factor for s in path.states if s.negative > 0), None)
    hint = "" if unstable is None else f"; the equilibrium is unstable from the factor {unstable:.6g} on"
    return SolveError(
        f"the load cannot be increased beyond the factor {highest:.6g}: the equilibrium ends or turns back there "
        f"({why}){hint}; follow it with the analysis 'path'",
        state=path,
    )
