"""The equilibrium of a step with contact: projected Newton steps that stop before surfaces meet, with a line search.

The true tangent is taken where it is positive definite, so that the end is quadratic; elsewhere the matrices of
triangles and of pairs in contact lose their negative eigenvalues (Teran, Sifakis, Irving and Fedkiw, Proc. SCA 2005).
The line search looks at the slope along the step, not at differences of the potential, which round away.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.motion.contact import Barrier
from kshell.equilibrium.problem import Problem, State
from kshell.errors import SolveError

Floats = NDArray[np.float64]

MOST_ITERATIONS = 150
# change of x at which a step is done, against the distance within which surfaces feel each other
DONE = 1e-4
# slope at the end of a step that goes too far, against that at its begin; how often it is made shorter, and by how much
OVERSHOT, MOST_CUTS, LEAST_CUT, MOST_CUT = 0.5, 30, 0.1, 0.5


def downhill(problem: Problem, barrier: Barrier, state: State) -> State:
    """The equilibrium at the factor 1 from a state at the factor 0.

    Raises
    ------
    SolveError
        If none is found.
    """
    basis = problem.reduction.basis
    x = state.x
    shift = problem.reduction.shift(0.0, 1.0)
    if np.any(shift):
        if barrier.largest_step(x, shift) < 1.0:
            raise SolveError("a prescribed motion brings surfaces together within the step", state=state)
        x = x + shift
    close = DONE * barrier.touch.distance
    translations = 3 * barrier.surfaces.count
    for iteration in range(1, MOST_ITERATIONS + 1):
        arrived = barrier.advance(x)
        reduced = basis.T @ _residual(problem, barrier, x, state)
        for projected in (False, True):
            energy, _, _ = problem.evaluate(x, 1.0, 2, state.memory, projected=projected)
            touching = barrier.hessian(x, projected)
            tangent = problem.factorise(energy.hessian if touching is None else energy.hessian + touching)
            if tangent.definite or tangent.negative == 0:
                break
        free = tangent.solve(reduced)
        slope, change = float(reduced @ free), basis @ free
        if not np.isfinite(slope):
            break
        part = barrier.largest_step(x, change)
        if arrived and part == 1.0 and np.abs(change[:translations]).max(initial=0.0) <= close:
            barrier.require_free(x + change)
            found = State(1.0, x + change, state.memory, iteration, 0, state.turned)
            return problem.settle(found)
        x = _along(problem, barrier, State(1.0, x, state.memory), free, part, abs(slope))
    raise SolveError(f"no equilibrium with contact in {iteration} iterations", state=state)


def _residual(problem: Problem, barrier: Barrier, x: Floats, state: State) -> Floats:
    _, residual, _ = problem.evaluate(x, 1.0, 1, state.memory)
    return residual - barrier.gradient(x)


def _along(
    problem: Problem, barrier: Barrier, state: State, free: Floats, part: float, slope: float
) -> Floats:
    """The unknowns after as much of a step of the free ones as leads downhill, from a part of it on."""
    basis = problem.reduction.basis
    change = basis @ free
    for _ in range(MOST_CUTS):
        x = state.x + part * change
        left = float((basis.T @ _residual(problem, barrier, x, state)) @ free)
        if left >= -OVERSHOT * slope:
            return x
        secant = slope / (slope - left) if np.isfinite(left) else 0.0
        part *= min(max(secant, LEAST_CUT), MOST_CUT)
    raise SolveError("no way downhill", state=state)
