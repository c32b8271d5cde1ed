"""The load factor at which the path of large deflections becomes critical, beside that of linear buckling.

Steps of the load, large ones, until the tangent is no longer definite or no equilibrium is found; then shorter ones,
until the critical load lies within a small share of itself. Where a path is wanted, not one number, `kshell trace`
follows it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from kshell.analysis.membrane import held_in_plane
from kshell.analysis.run import Run
from kshell.equilibrium.finite_model import FiniteModel
from kshell.equilibrium.limit_points import distance
from kshell.equilibrium.load_steps import EASY, JUMP
from kshell.equilibrium.model import Model
from kshell.equilibrium.newton import correct
from kshell.equilibrium.path import PathFollower
from kshell.equilibrium.problem import Problem, State
from kshell.errors import InputError, SolveError
from kshell.scene.structure import Structure
from kshell.shell.koiter.model import KoiterModel

# of the linear factor: so far the path is followed, and the first step
FURTHER, FIRST = 1.5, 0.25
# the critical load lies within this share of itself
CLOSE = 0.02
# equilibria sought at most
ATTEMPTS = 24
# iterations of each: those that lead to one on the branch take 4 to 8, beyond a limit point they wander
ITERATIONS = 10
# unknowns up to which it is followed unasked: an equilibrium costs about as much as all modes
SMALL = 6_000
# order of the shell that a plate is taken as
ORDER = 2


class Bracket(NamedTuple):
    """Between which loads a path becomes critical: a stable state, and a factor at which none is found beyond it.

    `upper` is None where the path has no critical point.
    """

    state: State
    upper: float | None


def critical_on_path(model: Model, run: Run, factors: Sequence[float], first: float) -> dict[str, Any]:
    """The first critical point of the path under loads times factors, (load,), all of which grow.

    Parameters
    ----------
    model : Model
        Of the buckling analysis.
    first : float
        The linear factor.

    Returns
    -------
    dict
        `kind`: "limit", "bifurcation", "none" (up to `factor` the path has no critical point), "lost" (it could not
        be followed beyond `factor`) or "not followed"; `factor`: float, known to `CLOSE`, or None.
    """
    unknown = {"kind": "not followed", "factor": None}
    if model.unknowns > SMALL:
        return unknown
    try:
        shell = model if isinstance(model, FiniteModel) else _as_shell(run.structure)
        if shell.unknowns > SMALL:
            return unknown
        problem = shell.under(factors).equilibrium()
    except InputError:  # what large deflections do not have
        return unknown
    found = _bracketed(problem, first, run)
    if found is None:
        return unknown
    state, upper = found
    if upper is None:
        kind = "none" if state.factor >= FURTHER * first * (1.0 - 1e-12) else "lost"
        return {"kind": kind, "factor": float(state.factor)}
    try:
        kind = PathFollower(problem).softest_motion(state).kind
    except SolveError:
        kind = "lost"
    middle = 0.5 * (state.factor + upper)
    return {"kind": kind, "factor": float(state.factor if kind == "lost" else middle)}


def _bracketed(problem: Problem, first: float, run: Run) -> Bracket | None:
    """The first critical load, by steps of the load; None where not even a first one leads to an equilibrium."""
    state, until = problem.start(), FURTHER * first
    size, rate = FIRST * first, 0.0
    for _ in range(ATTEMPTS):
        left = until - state.factor
        if left <= 1e-12 * until:
            break
        size = min(size, left)
        found = _next(problem, state, size, rate)
        if found is not None:
            rate = distance(problem, found.x - state.x) / size
            state = found
            size *= 1.5 if found.iterations <= EASY else 1.0
            run.tell(f"bounds: path of large deflections at the load factor {state.factor:.4g}")
        elif size <= CLOSE * state.factor:
            return Bracket(state, state.factor + size)
        else:
            size *= 0.5
    return Bracket(state, None) if state.factor > 0.0 else None


def _next(problem: Problem, state: State, size: float, rate: float) -> State | None:
    """The stable equilibrium a step of the load further on the same branch; None where there is none.

    Parameters
    ----------
    rate : float
        Displacement over load in the last step, which grows suddenly where the iteration goes to another branch.
    """
    try:
        found = correct(problem, state, state.factor + size, ITERATIONS)
    except SolveError:
        return None
    moved = distance(problem, found.x - state.x) / size
    if found.negative or not found.forward or (rate > 0.0 and moved > JUMP * rate) or not np.isfinite(moved):
        return None
    return found


def path_words(found: dict[str, Any]) -> str:
    """What the path says, in words."""
    factor = found["factor"]
    match found["kind"]:
        case "limit" | "bifurcation":
            return f"the path of large deflections has a {found['kind']} point near the factor {factor:.3g}"
        case "none":
            return (
                f"the path of large deflections has no critical point up to the factor {factor:.4g}: it bends"
            )
        case "lost":
            return f"the path of large deflections could not be followed beyond the factor {factor:.4g}"
    return 'follow the load with `kshell trace` (analysis = "path")'


def _as_shell(structure: Structure) -> KoiterModel:
    """A plate as a shell, its loads in the plane and across."""
    return KoiterModel(replace(held_in_plane(structure), movable=False), ORDER)
