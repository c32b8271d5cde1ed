"""Where a shell comes to rest that touches itself and obstacles, under loads that are there.

First the equilibrium is sought downhill, as any other. Where that has no answer, as for a sheet that still falls, the
shell moves as through a viscous fluid, M dx/dt = forces(x) with M the weights of the translations, by implicit Euler
steps whose springs M / dt pull to the last place. The springs get softer, and go.

Rest: an equilibrium without springs, or one whose springs pull with next to nothing, as where nothing hinders a shell
from turning on a ball. Either way what is left of all forces is less than a millionth of the loads.

Friction holds by what slides since the last of these steps; its normal forces are those of the state itself, found by
taking them anew until the state stays.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.contact.barrier import Barrier
from kshell.equilibrium.minimise import minimise
from kshell.equilibrium.problem import Problem, State
from kshell.errors import SolveError

Floats = NDArray[np.float64]

MOST_STEPS = 150
# iterations of a step, and of an equilibrium without springs
MOST_ITERATIONS, MOST_FREE = 60, 40
# change of x at which a step on the way, and the last one, is done, against the distance of contact
ON_THE_WAY, AT_REST = 1e-2, 1e-7
# move of the first step against the size of the shell, and how far it may get from where it was
FIRST_MOVE, LOST = 0.02, 10.0
# what may be left of all forces, against loads and forces of contact
NONE = 1e-6
# iterations of a step after which the springs are made softer, and by how much; after a failure they get stiffer
EASY, HARD = 8, 20
SOFTER, SOFT, HARDER, STIFFER = 0.4, 0.7, 1.5, 6.0
# springs against those of the first step: when to look for an equilibrium without, and when to give up
WEAK, STIFFEST = 0.1, 1e8
# times normal forces are taken anew for friction, and change of x that ends it, against the distance of contact
MOST_LAGS, SETTLED = 12, 1e-5
NOTHING_STOPS = "nothing stops the shell: it moves on and on under its loads"


class Lost(SolveError):
    """Nothing stops the shell, however small the loads."""


def come_to_rest(
    problem: Problem,
    barrier: Barrier,
    state: State,
    times: tuple[float, float],
    tell: Callable[[str], None] | None = None,
) -> State:
    """The state of rest at the factor 1, from a state at the factor 0, with obstacles that move in between.

    Parameters
    ----------
    times : (float, float)
        Between which obstacles move.
    tell : function, optional
        Called with words after each step on the way.

    Returns
    -------
    State
        Its iterations are those of the whole way.

    Raises
    ------
    SolveError
        If there is none.
    """
    touching = replace(problem, touching=barrier)
    size, slip = _size(barrier), min(barrier.touch.speed, barrier.touch.distance)
    barrier.begin(state.x, *times, slip=slip)
    try:
        return _free(touching, barrier, state, size)
    except SolveError:
        pass
    weights = problem.energy.translation_weights()
    spring = _first_spring(touching, barrier, state, times, size)
    stiffest, weak = STIFFEST * spring, WEAK * spring
    now, iterations, arrived = state, 0, False
    for step in range(1, MOST_STEPS + 1):
        barrier.begin(now.x, *times, arrived=arrived, slip=slip)
        held = touching.pulled(spring * weights, now.x)
        try:
            moved = minimise(held, now, 1.0, MOST_ITERATIONS, ON_THE_WAY)
        except SolveError as error:
            spring *= STIFFER
            if spring > stiffest:
                raise SolveError(f"no rest found: {error}", state=state) from error
            continue
        pull = float(np.linalg.norm(spring * weights * (moved.x - now.x)))
        iterations += moved.iterations
        arrived, now = True, replace(moved, factor=1.0)
        if np.abs(now.x[: 3 * barrier.surfaces.count]).max(initial=0.0) > LOST * size:
            raise Lost(NOTHING_STOPS, state=state)
        if tell is not None:
            tell(f"solve: coming to rest, step {step}, springs pull with {pull:.2g}")
        if spring <= weak:
            barrier.begin(now.x, *times, arrived=True, slip=slip)
            try:
                found = _free(touching, barrier, now, size)
                return replace(found, iterations=iterations + found.iterations)
            except SolveError:
                pass
            if _balanced(touching, barrier, now):
                return replace(now, iterations=iterations)
            weak *= SOFTER**2
        easy, hard = moved.iterations <= EASY, moved.iterations > HARD
        spring *= SOFTER if easy else HARDER if hard else SOFT
    raise SolveError(
        f"the shell is not at rest after {MOST_STEPS} steps through a viscous fluid", state=state
    )


def _free(problem: Problem, barrier: Barrier, state: State, size: float) -> State:
    """The equilibrium without springs, normal forces of friction being its own."""
    found = minimise(problem, state, 1.0, MOST_FREE, AT_REST)
    iterations = found.iterations
    if barrier.touch.friction > 0.0:
        for _ in range(MOST_LAGS):
            barrier.press_again(found.x)
            again = minimise(problem, replace(found, factor=1.0), 1.0, MOST_FREE, AT_REST)
            iterations += again.iterations
            change, found = barrier.moved(again.x - found.x), again
            if change <= SETTLED:
                break
        else:
            raise SolveError("normal forces and friction do not settle", state=state)
    if np.abs(found.x - state.x)[: 3 * barrier.surfaces.count].max(initial=0.0) > LOST * size:
        raise Lost(NOTHING_STOPS, state=state)
    if not _balanced(problem, barrier, found):
        raise SolveError("forces of contact do not settle", state=state)
    return replace(found, iterations=iterations)


def _size(barrier: Barrier) -> float:
    points = barrier.surfaces.rest[: barrier.surfaces.count]
    return float(np.linalg.norm(np.ptp(points, axis=0)))


def _balanced(problem: Problem, barrier: Barrier, state: State) -> bool:
    """Whether next to nothing is left of all forces."""
    _, residual, growth = problem.evaluate(state.x, 1.0, 1, state.memory)
    loads = float(np.linalg.norm(growth) + np.linalg.norm(barrier.gradient(state.x)))
    return float(np.linalg.norm(problem.reduction.basis.T @ residual)) <= NONE * loads


def _first_spring(
    problem: Problem, barrier: Barrier, state: State, times: tuple[float, float], size: float
) -> float:
    """Stiffness with which the loads move the shell by a small part of its size, or what holds it where it is."""
    _, residual, _ = problem.evaluate(state.x, 1.0, 1, state.memory)
    nodes = 3 * barrier.surfaces.count
    force = float(np.abs((problem.reduction.basis @ (problem.reduction.basis.T @ residual))[:nodes]).sum())
    if force > 0.0:
        return force / (FIRST_MOVE * size)
    travel = max(float(np.abs(barrier.surfaces.travel(*times)).max(initial=0.0)), FIRST_MOVE * size)
    return barrier.touch.stiffness * size**2 / travel
