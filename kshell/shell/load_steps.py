"""Large deflections under a growing load: adaptive steps, and what to do where the load has a maximum.

A step that fails is halved, steps that converge easily grow. A step that ends with more negative eigenvalues
than it began with may have jumped to another branch of equilibria and is repeated with smaller steps. Where the
load cannot grow any more the path is followed by its length through the limit points, until the load is
beyond the maximum and the shell is stable again.

All that the next step depends on is kept in a `March`: a path that is interrupted goes on from there as if
nothing had happened.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kshell.errors import SolveError
from kshell.shell.equilibrium import Problem, State
from kshell.shell.newton import correct
from kshell.shell.path import Arc, Critical, Path, PathFollower

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


@dataclass(frozen=True)
class Crossing:
    """The way through limit points.

    Attributes
    ----------
    arc : Arc
    steps : int
        Steps made along it.
    factor, negative : float, int
        Of the state where it began: it ends beyond that load, as stable as there.
    """

    arc: Arc
    steps: int
    factor: float
    negative: int


@dataclass(frozen=True)
class March:
    """A state and how to go on from it.

    Attributes
    ----------
    state : State
    size : float
        Of the next load step.
    moved : float
        Root mean square displacement of the nodes in the last step, 0 before the first.
    rate : float
        The same per growth of the load.
    attempts : int
        Load steps tried so far.
    crossing : Crossing, optional
        On the way through limit points.
    """

    state: State
    size: float
    moved: float = 0.0
    rate: float = 0.0
    attempts: int = 0
    crossing: Crossing | None = None


class LoadSteps:
    """Steps of a growing load.

    Parameters
    ----------
    problem : Problem
    steps : int
        First guess of the number of steps.
    until : float
        Last load factor.
    start : float
        First load factor.
    cross_limits : bool
        Whether to go on behind a limit point. The states in between have smaller loads; a real shell jumps.
    """

    def __init__(
        self,
        problem: Problem,
        steps: int = 10,
        until: float = 1.0,
        start: float = 0.0,
        cross_limits: bool = True,
    ) -> None:
        self.problem, self.steps, self.until, self.cross_limits = problem, max(steps, 1), until, cross_limits
        self.span = until - start
        self._follower = PathFollower(problem)

    def begin(self, state: State) -> March:
        """The march from a state."""
        return March(state, self.span / self.steps)

    def ended(self, march: March) -> bool:
        """Whether the last load factor is reached."""
        return march.crossing is None and abs(self.until - march.state.factor) <= 1e-12 * abs(self.span)

    def go_on(self, march: March) -> tuple[March, Critical | None]:
        """The next converged state, and the critical point passed on the way through limit points, if any.

        Raises
        ------
        SolveError
            If there is none; its `state` is the march so far.
        """
        while march.crossing is None:
            if march.attempts > MOST_ATTEMPTS + self.steps:
                raise SolveError(
                    f"{march.attempts} steps did not reach the factor {self.until:g}", state=march
                )
            state, left = march.state, self.until - march.state.factor
            size = float(np.sign(left) * min(abs(march.size), abs(left)))
            march = replace(march, attempts=march.attempts + 1)
            try:
                found = correct(self.problem, state, state.factor + size)
            except SolveError as error:
                march = replace(march, size=0.5 * size)
                if abs(march.size) < SMALLEST_STEP * abs(self.span):
                    march = self._into_crossing(march, error)
                continue
            moved = _distance(self.problem, found.x - state.x)
            rate = moved / abs(size)
            jumped = march.rate > 0.0 and rate > JUMP * march.rate
            lost = found.negative > state.negative and abs(size) > DOUBTFUL_STEP * abs(self.span) / self.steps
            if lost or (jumped and abs(size) >= SMALLEST_STEP * abs(self.span)):
                march = replace(march, size=0.5 * size)  # the iteration may have gone to another branch
                continue
            if found.iterations <= EASY:
                size *= 1.5
            elif found.iterations > HARD:
                size *= 0.7
            return replace(march, state=found, size=size, moved=moved, rate=rate), None
        return self._cross(march, march.crossing)

    def _into_crossing(self, march: March, error: SolveError) -> March:
        if not self.cross_limits or march.rate == 0.0 or self.span < 0:
            raise SolveError(str(error), state=march) from error
        state = march.state
        length = max(march.moved, FIRST_ARC * _distance(self.problem, state.x))
        crossing = Crossing(Arc(length, length), 0, state.factor, state.negative)
        return replace(march, size=self.span / self.steps, crossing=crossing)

    def _cross(self, march: March, crossing: Crossing) -> tuple[March, Critical | None]:
        """One step through limit points."""
        before = march.state
        lost = crossing.steps > 0 and before.factor < -crossing.factor
        if lost or crossing.steps >= MOST_ARC_STEPS:
            raise SolveError("the path behind the maximum does not lead to a larger load", state=march)
        try:
            state, arc, critical = self._follower.go_on(before, crossing.arc)
        except SolveError as error:
            raise SolveError(str(error), state=march) from error
        moved = _distance(self.problem, state.x - before.x)
        rate = moved / max(abs(state.factor - before.factor), 1e-300)
        next_crossing: Crossing | None = replace(crossing, arc=arc, steps=crossing.steps + 1)
        if state.factor > crossing.factor * (1 + 1e-6) and state.negative <= crossing.negative:
            next_crossing = None
        return replace(march, state=state, moved=moved, rate=rate, crossing=next_crossing), critical


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
    steps, until, cross_limits :
        As for `LoadSteps`.
    start : State, optional
        The rest state if absent.
    record : callable, optional
        Called with every converged state.

    Returns
    -------
    Path
        The start, every converged step, and the critical points that were crossed by following the path.

    Raises
    ------
    SolveError
        If the load cannot grow to the last factor; `state` is the `Path` so far.
    """
    first = problem.start() if start is None else start
    path = Path([first], [])
    marching = LoadSteps(problem, steps, until, first.factor, cross_limits)
    march = marching.begin(first)
    while not marching.ended(march):
        try:
            march, critical = marching.go_on(march)
        except SolveError as error:
            raise stuck(path.states, str(error), path) from error
        path.states.append(march.state)
        if critical is not None:
            path.critical.append(critical)
        if record is not None:
            record(march.state)
    return path


def stuck(states: list[State], why: str, so_far: object) -> SolveError:
    """The error that says where the load could not grow any more."""
    highest = max(s.factor for s in states)
    unstable = next((s.factor for s in states if s.negative > 0), None)
    hint = "" if unstable is None else f"; the equilibrium is unstable from the factor {unstable:.6g} on"
    return SolveError(
        f"the load cannot be increased beyond the factor {highest:.6g}: the equilibrium ends or turns back there "
        f"({why}){hint}; the states up to there are kept",
        state=so_far,
    )


def _distance(problem: Problem, x: Floats) -> float:
    """Root mean square displacement of the nodes."""
    return float(np.linalg.norm(x * np.sqrt(problem.energy.translation_weights())))
