"""Large deflections under a growing load: adaptive steps, and what to do where the load has a maximum.

A step that fails is halved, steps that converge easily grow. A step that ends with more negative eigenvalues
than it began with may have jumped to another branch of equilibria and is repeated with smaller steps. What is done
where the load cannot grow any more stands in limit_points.py.

All that the next step depends on is kept in a `March`: a path that is interrupted goes on from there as if
nothing had happened.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.limit_points import (
    Course,
    Limits,
    cross,
    distance,
    into_crossing,
    jump,
    leave,
    leave_unstable,
)
from kshell.equilibrium.march import March
from kshell.equilibrium.minimise import stiffened
from kshell.equilibrium.newton import correct
from kshell.equilibrium.path import Critical, Path, PathFollower
from kshell.equilibrium.problem import Problem, State
from kshell.errors import SolveError

Floats = NDArray[np.float64]

# iterations of a step after which the next one is longer, and shorter
EASY, HARD = 5, 12
SMALLEST_STEP = 1e-4
# a step so small against the load so far ends the search for the limit point by halving
CLOSE = 2e-3
# steps of the load and of the arc length, all in all, besides twice those asked for
MOST_ATTEMPTS = 250
# a step that ends on an unstable branch is repeated with smaller steps down to this part of the first one
DOUBTFUL_STEP = 1.0 / 16.0
# growth of the displacement per load from one step to the next that tells a jump over a limit point
JUMP = 10.0


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
    limits : "follow", "jump" or "stop"
        What to do at a limit point: follow the path, whose states in between have smaller loads; jump to the next
        stable state, as a real shell does; or give up.
    branch : -1, 0 or 1
        What to do at the first bifurcation: stay on the path, or leave it along the mode times this.
    aside : float
        Largest displacement of the first step onto a branch.
    """

    def __init__(
        self,
        problem: Problem,
        steps: int = 10,
        until: float = 1.0,
        start: float = 0.0,
        limits: Limits = "follow",
        branch: int = 0,
        aside: float = 0.0,
    ) -> None:
        self.problem, self.steps, self.until, self.span = problem, max(steps, 1), until, until - start
        self._course = Course(
            problem, PathFollower(problem), self.steps, until, self.span, limits, branch, aside
        )

        following = problem.reduction.following
        self._longest = np.inf if following is None else following.longest

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
        course = self._course
        if march.attempts > MOST_ATTEMPTS + 2 * self.steps:
            raise SolveError(f"{march.attempts} steps did not reach the factor {self.until:g}", state=march)
        while march.crossing is None:
            state, left = march.state, self.until - march.state.factor
            size = float(np.sign(left) * min(abs(march.size), abs(left), self._longest))
            march = replace(march, attempts=march.attempts + 1)
            try:
                found = correct(self.problem, state, state.factor + size)
            except SolveError as error:
                first = (
                    stiffened(self.problem, state, state.factor + size)
                    if march.attempts == 1 and not state.negative
                    else None
                )
                if first is not None:
                    moved = distance(self.problem, first.x - state.x)
                    return replace(march, state=first, size=size, moved=moved, rate=moved / abs(size)), None
                march = replace(march, size=0.5 * size)
                if abs(march.size) < max(SMALLEST_STEP * abs(self.span), CLOSE * abs(state.factor)):
                    if course.limits == "jump":
                        return jump(course, march, error)
                    march = into_crossing(course, march, error)
                continue
            moved = distance(self.problem, found.x - state.x)
            rate = moved / abs(size)
            jumped = march.rate > 0.0 and rate > JUMP * march.rate
            least = max(SMALLEST_STEP * abs(self.span), CLOSE * abs(state.factor))
            if not found.forward and abs(size) >= least:
                march = replace(march, size=0.5 * size)  # against its own tangent: on another branch
                continue
            lost = found.negative > state.negative and abs(size) > DOUBTFUL_STEP * abs(self.span) / self.steps
            if lost or (jumped and abs(size) >= SMALLEST_STEP * abs(self.span)):
                march = replace(march, size=0.5 * size)  # the iteration may have gone to another branch
                continue
            critical = None
            if found.negative != state.negative and course.limits != "stop":
                critical, low = course.follower.bracketed(state, moved)
                if low is not None and abs(size) >= least:
                    # stable all along the path: that step ended on another branch
                    made = low.factor - state.factor
                    if not least <= np.sign(left) * made <= abs(left):
                        march = replace(march, size=0.5 * size)
                        continue
                    moved = distance(self.problem, low.x - state.x)
                    return replace(march, state=low, size=made, moved=moved, rate=moved / abs(made)), None
                if course.branch and not march.branched and critical.kind == "bifurcation":
                    return leave(course, march, critical), replace(critical, then="branched")
            if course.limits == "jump" and found.negative and found.factor == self.until:
                stable = leave_unstable(course, found)
                if stable is not None:
                    critical, found = stable
            if found.iterations <= EASY:
                size *= 1.5
            elif found.iterations > HARD:
                size *= 0.7
            return replace(march, state=found, size=size, moved=moved, rate=rate), critical
        return cross(course, march, march.crossing)


def load_path(
    problem: Problem,
    steps: int = 10,
    until: float = 1.0,
    start: State | None = None,
    record: Callable[[State], None] | None = None,
    limits: Limits = "follow",
) -> Path:
    """Follow the equilibrium while the load factor grows.

    Parameters
    ----------
    steps, until, limits :
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
    marching = LoadSteps(problem, steps, until, first.factor, limits)
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
