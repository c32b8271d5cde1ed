"""The load factor at which the path of large deflections becomes critical, beside that of linear buckling."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from kshell.analysis.membrane import held_in_plane
from kshell.analysis.run import Run
from kshell.equilibrium.finite_model import FiniteModel
from kshell.equilibrium.load_steps import LoadSteps
from kshell.equilibrium.model import Model
from kshell.errors import InputError, SolveError
from kshell.scene.structure import Structure
from kshell.shell.koiter.model import KoiterModel

# of the linear factor: so far the path is followed
FURTHER = 1.5
STEPS = 12
# steps tried at most
ATTEMPTS = 40
# unknowns up to which it is followed unasked
SMALL = 15_000
# order of the shell that a plate is taken as
ORDER = 2


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
        be followed beyond `factor`) or "not followed"; `factor`: float or None.
    """
    unknown = {"kind": "not followed", "factor": None}
    if model.unknowns > SMALL:
        return unknown
    try:
        shell = model if isinstance(model, FiniteModel) else _as_shell(run.structure)
        if shell.unknowns > SMALL:
            return unknown
        loaded = shell.under(factors)
        problem = loaded.equilibrium()
    except InputError:  # what large deflections do not have
        return unknown
    marching = LoadSteps(problem, STEPS, until=FURTHER * first, limits="follow")
    march = marching.begin(problem.start())
    try:
        while not marching.ended(march):
            if march.attempts > ATTEMPTS:
                return {"kind": "lost", "factor": float(march.state.factor)}
            march, critical = marching.go_on(march)
            if critical is not None:
                return {"kind": critical.kind, "factor": float(critical.state.factor)}
            run.tell(f"bounds: path of large deflections at the load factor {march.state.factor:.4g}")
    except SolveError as error:
        state = getattr(error, "state", None)
        reached = march.state if state is None else getattr(state, "state", march.state)
        return {"kind": "lost", "factor": float(reached.factor)}
    return {"kind": "none", "factor": FURTHER * first}


def path_words(found: dict[str, Any]) -> str:
    """What the path says, in words."""
    factor = found["factor"]
    match found["kind"]:
        case "limit" | "bifurcation":
            return f"the path of large deflections has a {found['kind']} point at the factor {factor:.4g}"
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
