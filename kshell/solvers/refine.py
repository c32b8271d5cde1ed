"""Iterative refinement: one to four more digits for the price of a few triangular solves."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from kshell.solvers.system import Floats, Progress

STEPS = 3
# a relative correction below which there is rounding only: a further one gained less than a digit on plates and shells
ROUNDING = 2e-13


def refine(
    product: Callable[[Floats], Floats],
    rhs: Floats,
    solve: Callable[[Floats], Floats],
    progress: Progress | None = None,
) -> tuple[Floats, tuple[float, ...], int, Floats]:
    """Solve and refine.

    The correction d = M r that a step adds is the error that stood before it, up to the (small) error of the
    factorisation M, so sqrt(r.M r / b.x) is the relative energy error before that step.

    Parameters
    ----------
    product : function
        (n, load) -> A x.
    rhs : (n, load) float array

    Returns
    -------
    x : (n, load) float array
    history : tuple of float
        Relative energy error before each step, of the worst load; the last entry belongs to `x`.
    steps : int
        Corrections applied.
    residual : (n, load) float array
        rhs - A x.
    """
    x = solve(rhs)
    history: list[float] = []
    best, left = x, rhs
    for _ in range(STEPS + 1):
        residual = rhs - product(x)
        correction = solve(residual)
        energy = np.abs(np.sum(rhs * x, axis=0))
        error = np.sqrt(np.abs(np.sum(residual * correction, axis=0)) / np.where(energy > 0, energy, 1.0))
        worst = float(np.max(error, initial=0.0))
        if history and not worst < 0.5 * history[-1]:  # nothing gained: rounding of the residual itself
            if worst < history[-1]:
                history.append(worst)
                best, left = x, residual
            break
        history.append(worst)
        best, left = x, residual
        if progress is not None:
            progress(len(history) - 1, worst)
        if worst < ROUNDING or len(history) > STEPS:
            break
        x = x + correction
    return best, tuple(history), len(history) - 1, left
