"""A stable equilibrium where Newton's method alone finds none: projected Newton steps with a line search.

The true tangent is taken where it is positive definite, so that the end is quadratic. Where it is not, the matrices
of the triangles lose their negative eigenvalues (Teran, Sifakis, Irving and Fedkiw, Proc. SCA 2005), which makes
every step one of descent. The line search looks at the slope along the step, not at differences of the energy: these
round away in thin shells, and loads that turn with the surface have no energy at hand.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.problem import Problem, State
from kshell.errors import SolveError

Floats = NDArray[np.float64]

MOST_ITERATIONS = 200
FINISHED = 1e-13
# slope at the end of a step that goes too far, against that at its begin, and how often it is made shorter
OVERSHOT, MOST_CUTS = 0.5, 25
# a shorter step, against the last
LEAST_CUT, MOST_CUT = 0.1, 0.5


def minimise(problem: Problem, state: State, factor: float, most_iterations: int = MOST_ITERATIONS) -> State:
    """A stable equilibrium at a load factor, downhill from a state, which may be far away.

    Raises
    ------
    SolveError
        If none is found.
    """
    basis = problem.reduction.basis
    x = state.x + problem.reduction.shift(state.factor, factor)
    for iteration in range(1, most_iterations + 1):
        energy, residual, growth = problem.evaluate(x, factor, 2, state.memory)
        if not np.isfinite(energy.value):
            break
        reduced = basis.T @ residual
        tangent = problem.factorise(energy.hessian)
        true = tangent.definite or tangent.negative == 0
        if not true:
            energy, _, _ = problem.evaluate(x, factor, 2, state.memory, projected=True)
            tangent = problem.factorise(energy.hessian)
        step = tangent.solve(reduced)
        work = float(reduced @ step)
        if not np.isfinite(work):
            break
        scale = problem.scale + abs(energy.value) + abs(factor * float(growth @ x))
        if true and work <= FINISHED * scale:
            found = State(factor, x + basis @ step, state.memory, iteration, 0, state.turned)
            return problem.settle(found)
        x = _along(problem, State(factor, x, state.memory), basis @ step, abs(work))
    raise SolveError(f"no stable equilibrium found at the load factor {factor:.6g} downhill", state=state)


def _along(problem: Problem, state: State, step: Floats, slope: float) -> Floats:
    """The unknowns after as much of a step as leads downhill.

    Parameters
    ----------
    slope : float
        Work of the residual on the whole step at its begin.
    """
    part = 1.0
    for _ in range(MOST_CUTS):
        x = state.x + part * step
        _, residual, _ = problem.evaluate(x, state.factor, 1, state.memory)
        left = float(residual @ step)
        if left >= -OVERSHOT * slope:
            return x
        secant = slope / (slope - left) if np.isfinite(left) else 0.0
        part *= min(max(secant, LEAST_CUT), MOST_CUT)
    raise SolveError(f"no way downhill at the load factor {state.factor:.6g}", state=state)
