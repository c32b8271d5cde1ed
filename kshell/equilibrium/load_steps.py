"""Large deflections under a growing load: adaptive steps, and what to do where the load has a maximum.

A step that fails is halved, steps that converge easily grow. A step that ends with more negative eigenvalues
than it began with may have jumped to another branch of equilibria and is repeated with smaller steps. Where the
load cannot grow any more the path is followed by its length through the limit points, until the load is
beyond the maximum and the shell is stable again; or the shell jumps to the next stable state (relax.py).

All that the next step depends on is kept in a `March`: a path that is interrupted goes on from there as if
nothing had happened.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.newton import correct
from kshell.equilibrium.path import Arc, Critical, Path, PathFollower
from kshell.equilibrium.problem import Problem, State
from kshell.equilibrium.relax import relax
from kshell.errors import SolveError

Floats = NDArray[np.float64]
Limits = Literal["follow", "jump", "stop"]

# iterations of a step after which the next one is longer, and shorter
EASY, HARD = 5, 12
SMALLEST_STEP = 1e-4
# a step so small against the load so far ends the search for the limit point by halving
CLOSE = 2e-3
# steps of the load and of the arc length, all in all, besides twice those asked for
MOST_ATTEMPTS = 150
MOST_JUMPS = 4
# how far beyond the limit point the load is at which the jump ends, relative to the load there
BEYOND = 0.05
# a step that ends on an unstable branch is repeated with smaller steps down to this part of the first one
DOUBTFUL_STEP = 1.0 / 16.0
# growth of the displacement per load from one step to the next that tells a jump over a limit point
JUMP = 10.0
# steps along the path through limit points, and the length of the first against the deflection so far
MOST_ARC_STEPS = 40
FIRST_ARC = 0.2
MOST_BRANCH_STEPS = 120
# how far the last of these steps may go beyond the last load factor, and how often it is made again, shorter
OVERSHOOT, MOST_RETREATS = 0.05, 3


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
        Steps tried so far.
    jumps : int
        Made so far.
    branched : bool
        Whether a bifurcation was left along its mode.
    crossing : Crossing, optional
        On the way through limit points.
    """

    state: State
    size: float
    moved: float = 0.0
    rate: float = 0.0
    attempts: int = 0
    jumps: int = 0
    branched: bool = False
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
        self.problem, self.steps, self.until, self.limits = problem, max(steps, 1), until, limits
        self.span, self.branch, self.aside = until - start, branch, aside
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
        if march.attempts > MOST_ATTEMPTS + 2 * self.steps:
            raise SolveError(f"{march.attempts} steps did not reach the factor {self.until:g}", state=march)
        while march.crossing is None:
            state, left = march.state, self.until - march.state.factor
            size = float(np.sign(left) * min(abs(march.size), abs(left)))
            march = replace(march, attempts=march.attempts + 1)
            try:
                found = correct(self.problem, state, state.factor + size)
            except SolveError as error:
                march = replace(march, size=0.5 * size)
                if abs(march.size) < max(SMALLEST_STEP * abs(self.span), CLOSE * abs(state.factor)):
                    if self.limits == "jump":
                        return self._jump(march, error)
                    march = self._into_crossing(march, error)
                continue
            moved = _distance(self.problem, found.x - state.x)
            rate = moved / abs(size)
            jumped = march.rate > 0.0 and rate > JUMP * march.rate
            lost = found.negative > state.negative and abs(size) > DOUBTFUL_STEP * abs(self.span) / self.steps
            if lost or (jumped and abs(size) >= SMALLEST_STEP * abs(self.span)):
                march = replace(march, size=0.5 * size)  # the iteration may have gone to another branch
                continue
            critical = None
            if found.negative != state.negative and self.limits != "stop":
                critical = self._follower.critical(state, moved, None)
                if self.branch and not march.branched and critical.kind == "bifurcation":
                    return self._leave(march, critical), replace(critical, then="branched")
            if found.iterations <= EASY:
                size *= 1.5
            elif found.iterations > HARD:
                size *= 0.7
            return replace(march, state=found, size=size, moved=moved, rate=rate), critical
        return self._cross(march, march.crossing)

    def _leave(self, march: March, critical: Critical) -> March:
        """Onto the branch at a bifurcation: a step along its mode."""
        along = self.branch * (self.problem.reduction.basis.T @ critical.mode)
        length = self.aside * _distance(self.problem, critical.mode)
        try:
            state, arc, _ = self._follower.go_on(critical.state, Arc(length, length), along)
        except SolveError as error:
            raise SolveError(f"the branch at the bifurcation was not found: {error}", state=march) from error
        crossing = Crossing(arc, 0, critical.state.factor, march.state.negative)
        return replace(march, state=state, branched=True, crossing=crossing, size=self.span / self.steps)

    def _jump(self, march: March, error: SolveError) -> tuple[March, Critical]:
        """To a stable state at a larger load than any so far."""
        state, crossing = march.state, march.crossing
        if march.jumps >= MOST_JUMPS:
            raise SolveError(f"{error}, after {march.jumps} jumps", state=march) from error
        highest = state.factor if crossing is None else crossing.factor
        left, first = self.until - highest, self.span / self.steps
        further = max(BEYOND * abs(highest), DOUBTFUL_STEP * abs(first))
        factor = highest + float(np.sign(left)) * min(abs(left), further)
        try:
            found = relax(self.problem, state, factor)
        except SolveError as failure:
            raise SolveError(str(failure), state=march) from failure
        critical = self._follower.softest_motion(state)
        kind = critical.kind if crossing is None else "jump"
        critical = replace(critical, kind=kind, then="jumped")
        size = float(np.sign(left)) * further
        onward = March(found, size, attempts=march.attempts, jumps=march.jumps + 1, branched=march.branched)
        return onward, critical

    def _into_crossing(self, march: March, error: SolveError) -> March:
        if self.limits == "stop" or march.rate == 0.0 or self.span < 0:
            raise SolveError(str(error), state=march) from error
        state = march.state
        length = max(march.moved, FIRST_ARC * _distance(self.problem, state.x))
        crossing = Crossing(Arc(length, length), 0, state.factor, state.negative)
        return replace(march, size=self.span / self.steps, crossing=crossing)

    def _cross(self, march: March, crossing: Crossing) -> tuple[March, Critical | None]:
        """One step through limit points."""
        before = march.state
        lost = crossing.steps > 0 and before.factor < -crossing.factor
        if lost or crossing.steps >= (MOST_BRANCH_STEPS if march.branched else MOST_ARC_STEPS):
            return self._jump(march, SolveError("the path behind the maximum does not lead to a larger load"))
        try:
            state, arc, critical = self._follower.go_on(before, crossing.arc)
            for _ in range(MOST_RETREATS):
                too_far = (state.factor - self.until) / self.span
                if too_far <= OVERSHOOT:
                    break
                share = (self.until - before.factor) / (state.factor - before.factor)
                shorter = replace(crossing.arc, length=arc.made * max(share, 0.1))
                state, arc, critical = self._follower.go_on(before, shorter)
        except SolveError as error:
            return self._jump(march, error)
        moved = _distance(self.problem, state.x - before.x)
        rate = moved / max(abs(state.factor - before.factor), 1e-300)
        next_crossing: Crossing | None = replace(crossing, arc=arc, steps=crossing.steps + 1)
        beyond = state.factor > crossing.factor * (1 + 1e-6) and state.negative <= crossing.negative
        # a branch is close to the path it left for long: steps of the load could fall back on it
        if state.factor >= self.until if march.branched else beyond:
            next_crossing = None
        onward = replace(march, state=state, moved=moved, rate=rate, attempts=march.attempts + 1)
        return replace(onward, crossing=next_crossing), critical


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


def _distance(problem: Problem, x: Floats) -> float:
    """Root mean square displacement of the nodes."""
    return float(np.linalg.norm(x * np.sqrt(problem.energy.translation_weights())))
