"""A stable equilibrium where Newton's method alone finds none: projected Newton steps with a line search.

The true tangent is taken where it is positive definite, so that the end is quadratic. Where it is not, it is mixed with
one whose matrices of triangles and of pairs in contact have lost their negative eigenvalues (Teran, Sifakis, Irving and
Fedkiw, Proc. SCA 2005), by the smallest share that makes it positive definite, and every step one of descent. That one
alone is too stiff along a direction in which the structure buckles, and leaves an unstable state in many small steps.
The line search looks at the slope along the step, not at differences of the energy: these round away in thin shells,
and loads that turn with the surface have no energy at hand. With contact steps stop before surfaces meet.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.problem import Problem, State
from kshell.errors import SolveError
from kshell.solvers.repeated import Factor

Floats = NDArray[np.float64]

MOST_ITERATIONS = 200
FINISHED = 1e-13
# change of x at which a step with contact is done, against the distance within which surfaces feel each other
CLOSE = 1e-4
# slope at the end of a step that goes too far, against that at its begin, and how often it is made shorter
OVERSHOT, MOST_CUTS = 0.5, 30
# a shorter step, against the last
LEAST_CUT, MOST_CUT = 0.1, 0.5
# least share of the matrices without negative eigenvalues, and how it grows where it does not do
LEAST_SHARE, MORE = 1.0 / 64.0, 4.0
# iterations downhill from the rest, and what they may move against linear theory; a membrane takes eleven
MOST_STIFFENED, LESS = 25, 0.5


def minimise(
    problem: Problem,
    state: State,
    factor: float,
    most_iterations: int = MOST_ITERATIONS,
    close: float = CLOSE,
) -> State:
    """A stable equilibrium at a load factor, downhill from a state, which may be far away.

    Parameters
    ----------
    close : float
        Change of x at which an equilibrium with contact is found, against the distance of contact.

    Raises
    ------
    SolveError
        If none is found.
    """
    basis, touching = problem.reduction.basis, problem.touching
    x, share = _shifted(problem, state, factor), 0.0
    for iteration in range(1, most_iterations + 1):
        arrived = touching is None or touching.advance(x)
        energy, residual, growth = problem.evaluate(x, factor, 2, state.memory)
        if not np.isfinite(energy.value):
            break
        reduced = basis.T @ residual
        tangent, share = _descending(problem, x, factor, state.memory, energy.hessian, share)
        true = share == 0.0
        free = tangent.solve(reduced)
        work, step = float(reduced @ free), basis @ free
        if not np.isfinite(work):
            break
        part = 1.0 if touching is None else touching.largest_step(x, step)
        scale = problem.scale + abs(energy.value) + abs(factor * float(growth @ x))
        if arrived and part == 1.0:
            near = touching is not None and touching.moved(step) <= close
            if near or (true and work <= FINISHED * scale):
                if touching is not None:
                    touching.require_free(x + step)
                found = State(factor, x + step, state.memory, iteration, 0, state.turned)
                return problem.settle(found)
        x = _along(problem, State(factor, x, state.memory), step, abs(work), part)
    raise SolveError(f"no stable equilibrium found at the load factor {factor:.6g} downhill", state=state)


def _descending(
    problem: Problem, x: Floats, factor: float, memory: Any, true: sp.csr_matrix, last: float
) -> tuple[Factor, float]:
    """A positive definite tangent, and the share in it of matrices without negative eigenvalues, after the last one.

    Parameters
    ----------
    true : (unknowns, unknowns)
        The tangent.
    """
    found = problem.positive(true)
    if found is not None:
        return found, 0.0
    energy, _, _ = problem.evaluate(x, factor, 2, memory, projected=True)
    added, share = energy.hessian - true, max(last / MORE, LEAST_SHARE)
    while share < 1.0:
        found = problem.positive(true + share * added)
        if found is not None:
            return found, share
        share *= MORE
    return problem.factorise(energy.hessian), 1.0


def stiffened(problem: Problem, state: State, factor: float) -> State | None:
    """The equilibrium at a load factor of what gets stiffer as it deflects, such as a membrane, from its rest.

    There Newton's method fails at any load under which the linear deflection is many times the thickness, and starts so
    small as to be of use would look like a limit point at the load zero. What moves less than half as far as linear
    theory has it has passed no maximum of the load, and needs no small steps.

    Returns
    -------
    State or None
        None where none is found downhill, or one that moves farther, and with contact.
    """
    if problem.touching is not None:
        return None
    basis = problem.reduction.basis
    shift = problem.reduction.shift(state.factor, factor)
    energy, residual, _ = problem.evaluate(state.x, factor, 2, state.memory)
    pull = energy.hessian @ shift if np.any(shift) else 0.0
    linear = shift + basis @ problem.factorise(energy.hessian).solve(basis.T @ (residual - pull))
    try:
        found = minimise(problem, state, factor, MOST_STIFFENED)
    except SolveError:
        return None
    size = np.sqrt(problem.energy.translation_weights())
    moved = found.x + found.turned - state.x - state.turned
    return found if np.linalg.norm(size * moved) < LESS * np.linalg.norm(size * linear) else None


def _shifted(problem: Problem, state: State, factor: float) -> Floats:
    """The unknowns after prescribed motions."""
    shift = problem.reduction.shift(state.factor, factor)
    touching = problem.touching
    if touching is not None and np.any(shift) and touching.largest_step(state.x, shift) < 1.0:
        raise SolveError("a prescribed motion brings surfaces together within the step", state=state)
    return state.x + shift


def _along(problem: Problem, state: State, step: Floats, slope: float, part: float) -> Floats:
    """The unknowns after as much of a step as leads downhill, from a part of it on.

    Parameters
    ----------
    slope : float
        Work of the residual on the whole step at its begin.
    """
    for _ in range(MOST_CUTS):
        x = state.x + part * step
        _, residual, _ = problem.evaluate(x, state.factor, 1, state.memory)
        left = float(residual @ step)
        if left >= -OVERSHOT * slope:
            return x
        secant = slope / (slope - left) if np.isfinite(left) else 0.0
        part *= min(max(secant, LEAST_CUT), MOST_CUT)
    raise SolveError(f"no way downhill at the load factor {state.factor:.6g}", state=state)
