"""What becomes of a growing load where it has a maximum, or where another path leaves.

The path is followed by its length through the limit points, until the load is beyond the maximum and the shell is
stable again; or the shell jumps to the next stable state (relax.py); or it leaves along the mode of a bifurcation.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.march import Crossing, March
from kshell.equilibrium.path import Arc, Critical, PathFollower
from kshell.equilibrium.problem import Problem, State
from kshell.equilibrium.relax import relax
from kshell.errors import SolveError

Floats = NDArray[np.float64]
Limits = Literal["follow", "jump", "stop"]

# the last of these goes to the last load factor at once
MOST_JUMPS = 4
# how far beyond the limit point the load is at which the jump ends, relative to the load there, and at least this
# part of the first step
BEYOND, LEAST_BEYOND = 0.05, 1.0 / 16.0
# steps along the path through limit points, and the length of the first against the deflection so far
MOST_ARC_STEPS = 40
FIRST_ARC = 0.2
MOST_BRANCH_STEPS = 120
# how far the last of these steps may go beyond the last load factor, and how often it is made again, shorter
OVERSHOOT, MOST_RETREATS = 0.05, 3


@dataclass(frozen=True)
class Course:
    """What a path of loads is to do. See `LoadSteps`.

    Attributes
    ----------
    problem : Problem
    follower : PathFollower
    steps : int
    until : float
        Last load factor.
    span : float
        Growth of the load factor in all.
    limits : "follow", "jump" or "stop"
    branch : -1, 0 or 1
    aside : float
    """

    problem: Problem
    follower: PathFollower
    steps: int
    until: float
    span: float
    limits: Limits
    branch: int
    aside: float


def leave(course: Course, march: March, critical: Critical) -> March:
    """Onto the branch at a bifurcation: a step along its mode."""
    along = course.branch * (course.problem.reduction.basis.T @ critical.mode)
    length = course.aside * distance(course.problem, critical.mode)
    try:
        state, arc, _ = course.follower.go_on(critical.state, Arc(length, length), along)
    except SolveError as error:
        raise SolveError(f"the branch at the bifurcation was not found: {error}", state=march) from error
    crossing = Crossing(arc, 0, critical.state.factor, march.state.negative)
    return replace(march, state=state, branched=True, crossing=crossing, size=course.span / course.steps)


def jump(course: Course, march: March, error: SolveError) -> tuple[March, Critical]:
    """To a stable state at a larger load than any so far."""
    state, crossing = march.state, march.crossing
    if march.jumps >= MOST_JUMPS:
        raise SolveError(f"{error}, after {march.jumps} jumps", state=march) from error
    highest = state.factor if crossing is None else crossing.factor
    left, first = course.until - highest, course.span / course.steps
    further = max(BEYOND * abs(highest), LEAST_BEYOND * abs(first))
    if (
        march.jumps == MOST_JUMPS - 1 and course.limits == "jump"
    ):  # the states between are many, the end is asked for
        further = abs(left)
    factor = highest + float(np.sign(left)) * min(abs(left), further)
    try:
        found = relax(course.problem, state, factor)
    except SolveError as failure:
        raise SolveError(str(failure), state=march) from failure
    critical = course.follower.softest_motion(state)
    kind = critical.kind if crossing is None else "jump"
    critical = replace(critical, kind=kind, then="jumped")
    size = float(np.sign(left)) * further
    onward = March(found, size, attempts=march.attempts, jumps=march.jumps + 1, branched=march.branched)
    return onward, critical


def leave_unstable(course: Course, found: State) -> tuple[Critical, State] | None:
    """From an unstable last state, pushed along its softest motion, to a stable one; None where none is found."""
    critical = course.follower.softest_motion(found)
    pushed = replace(found, x=found.x + course.aside * critical.mode)
    try:
        stable = relax(course.problem, pushed, found.factor)
    except SolveError:
        return None
    return replace(critical, kind="unstable", then="jumped"), stable


def into_crossing(course: Course, march: March, error: SolveError) -> March:
    """On, by the length of the path, from where the load could not grow any more because of `error`."""
    if course.limits == "stop" or march.rate == 0.0 or course.span < 0:
        raise SolveError(str(error), state=march) from error
    state = march.state
    length = max(march.moved, FIRST_ARC * distance(course.problem, state.x))
    crossing = Crossing(Arc(length, length), 0, state.factor, state.negative)
    return replace(march, size=course.span / course.steps, crossing=crossing)


def cross(course: Course, march: March, crossing: Crossing) -> tuple[March, Critical | None]:
    """One step through limit points."""
    before = march.state
    lost = crossing.steps > 0 and before.factor < -crossing.factor
    if lost or crossing.steps >= (MOST_BRANCH_STEPS if march.branched else MOST_ARC_STEPS):
        return jump(course, march, SolveError("the path behind the maximum does not lead to a larger load"))
    try:
        state, arc, critical = course.follower.go_on(before, crossing.arc)
        for _ in range(MOST_RETREATS):
            too_far = (state.factor - course.until) / course.span
            if too_far <= OVERSHOOT:
                break
            share = (course.until - before.factor) / (state.factor - before.factor)
            shorter = replace(crossing.arc, length=arc.made * max(share, 0.1))
            state, arc, critical = course.follower.go_on(before, shorter)
    except SolveError as error:
        return jump(course, march, error)
    moved = distance(course.problem, state.x - before.x)
    rate = moved / max(abs(state.factor - before.factor), 1e-300)
    next_crossing: Crossing | None = replace(crossing, arc=arc, steps=crossing.steps + 1)
    beyond = state.factor > crossing.factor * (1 + 1e-6) and state.negative <= crossing.negative
    # a branch is close to the path it left for long: steps of the load could fall back on it
    if state.factor >= course.until if march.branched else beyond:
        next_crossing = None
    onward = replace(march, state=state, moved=moved, rate=rate, attempts=march.attempts + 1)
    return replace(onward, crossing=next_crossing), critical


def distance(problem: Problem, x: Floats) -> float:
    """Root mean square displacement of the nodes."""
    return float(np.linalg.norm(x * np.sqrt(problem.energy.translation_weights())))
