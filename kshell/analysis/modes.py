"""Natural frequencies and modes, of plates with bounds, also of structures that are free or under load.

    K phi = lambda M phi,      lambda = (2 pi f)^2,      phi^T M phi = 1

K the stiffness at rest; under prestress that of the loaded state, K + G with the geometric stiffness G of its stresses,
or the tangent at the end of a path of large deflections.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.analysis.intervals import frequency_bounds
from kshell.analysis.modal_result import entry, finished, modal_result
from kshell.analysis.narrowing import Stage, held_to, narrowed
from kshell.analysis.prestress import Prestress, prestressed
from kshell.analysis.run import Run
from kshell.analysis.shear import account_for_shear_of_modes
from kshell.equilibrium.model import Model
from kshell.equilibrium.rigid_modes import RigidModes
from kshell.errors import InputError
from kshell.mesh.words import place
from kshell.result.result import Result
from kshell.solvers.eigen import in_range, smallest
from kshell.solvers.pencil import Pencil, Spectrum

Floats = NDArray[np.float64]

COUNT = 6
# so many modes in a range are refused
MOST = 500
# energy of a mode, against that of its unknowns one by one, that is rounding squared; thinnest shells have 1e-15
MECHANISM = 1e-18
# Ritz values beyond those asked for, from which sharp bounds choose their trial functions
TRIALS = 7


def analyse(model: Model, run: Run) -> Result:
    """The modes of a model.

    Raises
    ------
    InputError
        If there is no mass, options contradict each other, or there are fewer modes than asked for.
    SolveError
        If no answer was reached.
    """
    if run.options.tolerance is not None:
        run = held_to(run, model)
    stage = _stage(run, model)
    with run.clock.stage("bounds"):
        count = count_of(stage.found, run)
        bound = frequency_bounds(stage, count)
        known, stage = narrowed(stage, bound, lambda finer, model: _stage(finer, model), count)
        stage.run = replace(stage.run, clock=run.clock)
        count = min(count, len(stage.found.values))
        known = known.only(count)
    model, found, state = stage.model, stage.found, stage.state
    with run.clock.stage("recover"):
        rigid = model.rigid_modes(stage.pencil.mass).names if stage.pencil.rigid.shape[1] else []
        vectors = np.concatenate([stage.pencil.rigid, found.vectors[:, :count]], axis=1)
        values = np.concatenate([np.zeros(len(rigid)), found.values[:count]])
        result = modal_result(model, vectors)
        share = model.participation(vectors)
        for k, value in enumerate(values.tolist()):
            one = entry(value, known.of[k - len(rigid)] if k >= len(rigid) else None)
            one["frequency"] = float(np.sqrt(value)) / (2 * np.pi) if value >= 0 else None
            if k < len(rigid):
                one |= {"name": rigid[k], "lower": 0.0, "upper": 0.0, "kind": "guaranteed"}
            one["participation"] = share.factors[k].tolist()
            one["effective_mass"] = share.effective_mass[k].tolist()
            result.eigen.append(one)
        result.modal = {
            "total_mass": share.total.tolist(),
            "effective_mass": share.effective_mass.sum(axis=0).tolist(),
        }
    with run.clock.stage("bounds"):
        account_for_shear_of_modes(result, model, found.vectors[:, :count], run.options)
    reasons, warnings = ([], []) if state is None else (state.reasons, state.warnings)
    warnings = [*warnings, *_warnings(run, values)]
    return finished(result, stage, known, reasons, warnings, "shift and invert, by Lanczos' method")


def _stage(run: Run, model: Model) -> Stage:
    """The eigenproblem of a model, solved."""
    options = run.options
    with run.clock.stage("assemble"):
        mass = model.mass()
        state: Prestress | None = None
        stiffness = model.stiffness()
        if options.prestress:
            state = prestressed(model, run)
            stiffness = state.stiffness
        free = np.zeros((model.unknowns, 0))
        rigid = RigidModes(free, []) if state is not None else model.rigid_modes(mass)
    with run.clock.stage("solve"):
        pencil = Pencil(stiffness, mass, rigid.vectors, order=cache(model.elimination))
        if state is None:
            pencil = pencil._replace(energy=model.energies, product=_columns(model))
        found = solve_pencil(pencil, run)
        if state is None:
            _require_stiff(model, pencil, found)
        return Stage(run, model, pencil, found, state)


def _require_stiff(model: Model, pencil: Pencil, found: Spectrum) -> None:
    """Refuse a mechanism, which swings with no frequency: its energy through strains is rounding squared."""
    if not len(found.values):
        return
    x = found.vectors[:, 0]
    if found.values[0] > MECHANISM * float(x @ (pencil.stiffness.diagonal() * x)):
        return
    moved = np.linalg.norm(model.motion_fields(model.expand(x))["displacement"], axis=1)
    at = place(model.structure.space.points[int(np.argmax(moved[: len(model.structure.space.points)]))])
    raise InputError(
        f"the {model.kind} can move freely, and not as a rigid body (it moves most near {at}): a mechanism has no "
        "frequency; look for hinges in a row and parts that hang together at a vertex, or add supports there"
    )


def solve_pencil(pencil: Pencil, run: Run) -> Spectrum:
    """The modes that options ask for, and some more for sharp bounds."""
    options = run.options
    if options.range is not None:
        if options.count is not None:
            raise InputError("count and range given: a range has all modes in it, leave one of them out")
        low, high = ((2 * np.pi * f) ** 2 for f in options.range)
        return in_range(pencil, low, high, MOST)
    count = COUNT if options.count is None else options.count
    if options.tolerance is None:
        return smallest(pencil, count)
    try:
        return smallest(pencil, count + TRIALS)
    except InputError:
        return smallest(pencil, count)


def count_of(found: Spectrum, run: Run) -> int:
    """How many of the modes found were asked for."""
    if run.options.range is not None:
        return len(found.values)
    return min(COUNT if run.options.count is None else run.options.count, len(found.values))


def _columns(model: Model) -> Any:
    product = model.product()

    def apply(x: Floats) -> Floats:
        return np.column_stack([product(column) for column in x.T])

    return apply


def _warnings(run: Run, values: Floats) -> list[str]:
    out = []
    if run.options.range is not None and not len(values):
        low, high = run.options.range
        out.append(f"range: no mode lies between {low:g} and {high:g}")
    if np.any(values < 0):
        out.append(
            f"{int((values < 0).sum())} modes have no frequency (value < 0): under its loads the structure is beyond "
            "buckling and not stable there"
        )
    structure = run.structure
    moved = any(placed.item.moves for placed in structure.supports)
    if (structure.loads or moved) and not run.options.prestress:
        what = (
            "the loads" if not moved else "prescribed motions" if not structure.loads else "loads and motions"
        )
        out.append(
            f"{what} do not act in this analysis: prestress = true lets them act before the structure vibrates"
        )
    return out
