"""Intervals around buckling factors.

Guaranteed for plates with straight edges under uniform membrane forces that are nowhere tensile: Ritz values of Argyris
elements from above, Morley elements from below, with a tolerance the method of Lehmann and Goerisch. Under other
membrane forces estimated from moments in equilibrium; others from two elements, two orders, or two meshes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from kshell.analysis.interval import Interval, Known, apart, unknown
from kshell.analysis.intervals import finer, premises
from kshell.analysis.membrane import ALIKE, ORDER, MembraneState, membrane_state
from kshell.analysis.models import bending_only
from kshell.analysis.narrowing import Stage
from kshell.analysis.prestress import plate_geometric, stressed
from kshell.error import buckling, frequencies, goerisch
from kshell.error.plate_trial import hhj_system, pressed_of
from kshell.errors import SolveError
from kshell.plate.model import PlateModel
from kshell.plate.vibration import energies
from kshell.solvers.critical import CriticalPencil, factors

Floats = NDArray[np.float64]

# order of membrane forces on a finer mesh, whose triangles are a quarter as large at most
LOWER = 2
# orders of moments in equilibrium with uniform membrane forces, and with quadratic ones
UNIFORM_ORDER, QUADRATIC_ORDER = 6, 8


def factor_bounds(first: Stage, count: int, grows: Sequence[float], fixed: bool) -> Callable[[Stage], Known]:
    """What is known about factors on one mesh, as `narrowed` asks for it.

    Parameters
    ----------
    grows : (load + 1,)
        1 for loads that grow, last the prescribed motion.
    fixed : bool
        Whether some loads do not.
    """
    run, model = first.run, first.model
    if run.options.error == "off" or fixed:
        return lambda stage: unknown(len(stage.found.values))
    if not isinstance(model, PlateModel):
        return lambda stage: _of_shell(stage, grows)
    lacking = premises(model)
    if lacking or run.options.tolerance is None or model.element != "argyris":
        return lambda stage: _two_elements(stage, grows)
    state = first.state.membrane
    rough = None
    if not _doubts(state):
        rough = _morley_bounds(_other(first, grows, len(first.found.values)), state)  # serves all meshes
    return lambda stage: _sharp(stage, grows, count, rough)


def _of_shell(stage: Stage, grows: Sequence[float]) -> Known:
    """From the order below, on the same mesh."""
    from kshell.shell.koiter.model import KoiterModel

    model, found = stage.model, stage.found
    if not isinstance(model, KoiterModel) or model.order < 2:
        return unknown(len(found.values))
    other = KoiterModel(model.structure, model.order - 1, model.reasons)
    try:
        state = stressed(other, stage.run.structure, grows[:-1], grows[-1])
        pencil = CriticalPencil(other.stiffness(), state.geometric, other.energies)
        values = factors(pencil, len(found.values)).values
    except SolveError:
        return unknown(len(found.values))
    words = f"intervals of factors: estimated from orders {model.order} and {model.order - 1}"
    return Known(apart(found.values, values), [words])


def _other(stage: Stage, grows: Sequence[float], count: int) -> Stage:
    """The factors of the other element: Morley's on a finer mesh, Argyris' on the same."""
    run, model = stage.run, stage.model
    argyris = model.element == "argyris"
    structure = finer(run.structure, run) if argyris else run.structure
    other = PlateModel(bending_only(structure), "morley" if argyris else "argyris")
    membrane = stage.state.membrane.uniform
    if membrane is None:
        order = LOWER if structure is not run.structure else ORDER
        membrane = membrane_state(structure, grows[:-1], grows[-1], order)
    pencil = CriticalPencil(other.stiffness(), plate_geometric(other, membrane))
    return Stage(run, other, pencil, factors(pencil, count), membrane)


def _doubts(state: MembraneState) -> list[str]:
    """Why membrane forces are not those of a proof, in words."""
    uniform = state.uniform
    if uniform is None:
        return ["the membrane forces are not uniform"]
    if np.linalg.eigvalsh(uniform.force)[1] > ALIKE * np.abs(uniform.force).max():
        return ["the membrane forces are tensile in some direction"]
    return []


def _morley_bounds(coarse: Stage, state: MembraneState) -> Floats | None:
    """Lower bounds; None where a count has not confirmed that none was missed."""
    assert isinstance(coarse.model, PlateModel)
    if not coarse.found.checked:
        return None
    uniform = state.uniform
    assert uniform is not None  # the premise of the bound
    return buckling.lower_bounds(coarse.model.problem, coarse.found, -uniform.force)


def _two_elements(stage: Stage, grows: Sequence[float]) -> Known:
    model, found = stage.model, stage.found
    assert isinstance(model, PlateModel)
    count = len(found.values)
    other = _other(stage, grows, count)
    lacking = [*premises(model), *_doubts(stage.state.membrane)]
    if not (other.found.checked and found.checked):
        lacking.append("that no factor was missed is not confirmed")
    if lacking or len(other.found.values) < count:
        words = f"intervals of factors: estimated from Morley and Argyris elements, not proven: {'; '.join(lacking)}"
        return Known(apart(found.values, other.found.values), [words])
    morley, argyris = (other, stage) if model.element == "argyris" else (stage, other)
    lower = _morley_bounds(morley, stage.state.membrane)
    assert lower is not None
    upper = argyris.found.values * (1.0 + _rounding(argyris))
    words = (
        "intervals of factors: guaranteed, from Ritz values of Argyris elements and a bound from Morley elements; a "
        "tolerance narrows them"
    )
    return Known(
        [Interval(float(a), float(b), "guaranteed") for a, b in zip(lower, upper, strict=True)], [words]
    )


def _sharp(stage: Stage, grows: Sequence[float], count: int, rough: Floats | None) -> Known:
    """From moments in equilibrium: proven above rough bounds, else estimated."""
    model, found, state = stage.model, stage.found, stage.state.membrane
    assert isinstance(model, PlateModel)
    uniform = state.uniform is not None
    system = hhj_system(
        model.problem, UNIFORM_ORDER if uniform else QUADRATIC_ORDER, np.zeros((model.unknowns, 0))
    )
    pressed = pressed_of(model.problem, stage.pencil, found, state.at)
    bounds = buckling.from_moments(system, pressed)
    known = Known([], misfit=bounds.misfit[:count].sum(axis=0))
    trials = None
    if rough is not None and found.checked and np.all(found.values > 0):
        trials = goerisch.trial_count(found.values, rough, count)
    if trials is not None:
        assert rough is not None
        lower = buckling.sharp_bounds(pressed, bounds, trials, float(rough[trials]))
        small = _rounding(stage)[:trials]
        lower = np.maximum(lower * (1.0 - small), rough[:trials])
        upper = found.values[:trials] * (1.0 + small)
        known.of = [Interval(float(a), float(b), "guaranteed") for a, b in zip(lower, upper, strict=True)]
        known.of += unknown(len(found.values) - trials).of
        known.reasons.append(
            "intervals of factors: guaranteed, from Ritz values of Argyris elements and the method of Lehmann and "
            f"Goerisch with {trials} trial functions and moments of degree {UNIFORM_ORDER - 1}"
        )
        return known
    half = buckling.estimated(found.values, bounds)
    if not uniform:
        half = half + _share_of_forces(stage, grows)
    sizes = np.abs(found.values) * half
    known.of = [
        Interval(float(v - s), float(v + s), "estimated") for v, s in zip(found.values, sizes, strict=True)
    ]
    why = (
        "; ".join(_doubts(state))
        or "that no factor was missed is not confirmed, or no gap was found behind them"
    )
    known.reasons.append(
        f"intervals of factors: estimated from moments of degree {system.order - 1} in equilibrium, not proven: {why}"
    )
    return known


def _rounding(stage: Stage) -> Floats:
    """(mode,) of Ritz values, relative, and how far their energies by entries are off."""
    assert isinstance(stage.model, PlateModel)
    problem, x = stage.model.problem, stage.found.vectors
    entries = (x * (stage.pencil.stiffness @ x)).sum(axis=0)
    strains = np.diag(energies(problem, x, strains=True))
    return np.asarray(
        frequencies.evaluation(problem, stage.pencil.geometric, x) + np.abs(entries / strains - 1.0)
    )


def _share_of_forces(stage: Stage, grows: Sequence[float]) -> Floats:
    """(mode,) relative change of factors with membrane forces of the order below."""
    model, found = stage.model, stage.found
    assert isinstance(model, PlateModel)
    other = membrane_state(stage.run.structure, grows[:-1], grows[-1], ORDER - 1)
    x = found.vectors
    own, changed = (
        (x * (matrix @ x)).sum(axis=0) for matrix in (stage.pencil.geometric, plate_geometric(model, other))
    )
    return np.asarray(np.abs(changed - own) / np.abs(own))
