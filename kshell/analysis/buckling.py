"""Linear buckling: the factors by which loads may grow until the stiffness they change is singular.

    (K + G_fixed) phi = -f G phi

G the geometric stiffness of the loads that grow, G_fixed that of loads that do not. Good where the structure hardly
deflects across its surface before it buckles.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.analysis.buckling_intervals import factor_bounds
from kshell.analysis.critical_load import critical_on_path, path_words
from kshell.analysis.modal_result import entry, finished, modal_result
from kshell.analysis.narrowing import Stage, held_to, narrowed
from kshell.analysis.prestress import Stressed, stressed
from kshell.analysis.run import Run
from kshell.analysis.shear import account_for_shear_of_modes
from kshell.equilibrium.model import Model
from kshell.errors import InputError, SolveError
from kshell.plate.model import PlateModel
from kshell.result.result import Result
from kshell.scene.loads import Pressure
from kshell.scene.structure import Structure
from kshell.solvers.critical import CriticalPencil, factors, smallest_positive
from kshell.solvers.eigenbasis import clusters
from kshell.solvers.pencil import Spectrum

Floats = NDArray[np.float64]

COUNT = 3
# factors closer than this, relative, are told as a cluster
CLUSTER = 0.01
# deflection across the surface before buckling, against the thickness, from which the linear factor is doubtful
SMALL = 0.3
# factors beyond those asked for, from which sharp bounds choose their trial functions
TRIALS = 5


def analyse(model: Model, run: Run) -> Result:
    """The smallest load factors in size.

    Raises
    ------
    InputError
        If there is no load that grows, or options contradict each other.
    SolveError
        If nothing buckles.
    """
    options, structure = run.options, run.structure
    if options.prestress:
        raise InputError(
            "prestress is for vibration: in buckling, loads that do not grow have fixed = true, leave prestress out"
        )
    if options.range is not None:
        raise InputError("range is for vibration: buckling has the factors of smallest size, give count")
    grows = growing(run.structure)
    if not any(grows):
        raise InputError(
            "no load grows: buckling needs loads without fixed = true, or a prescribed motion"
            if structure.loads
            else "there is no load: buckling needs loads that press the structure in its surface"
        )
    if options.tolerance is not None:
        run = held_to(run, model)
    stage, fixed = _stage(run, model)
    with run.clock.stage("bounds"):
        wanted = COUNT if options.count is None else options.count
        count = min(wanted, len(stage.found.values))
        grown = [float(g) for g in grows]
        bound = factor_bounds(stage, count, grown, fixed)
        known, stage = narrowed(stage, bound, lambda finer, model: _stage(finer, model)[0], count)
        stage.run = replace(stage.run, clock=run.clock)
        count = min(count, len(stage.found.values))
        known = known.only(count)
    values = stage.found.values[:count]
    with run.clock.stage("recover"):
        result = modal_result(stage.model, stage.found.vectors[:, :count], largest_one=True)
        result.eigen = [entry(value, i) for value, i in zip(values.tolist(), known.of, strict=True)]
    with run.clock.stage("bounds"):
        account_for_shear_of_modes(result, stage.model, stage.found.vectors[:, :count], options)
        behind = None if np.any(values > 0) else smallest_positive(stage.pencil, float(np.abs(values).min()))
        looked = values if behind is None else np.append(values, behind)
        warnings = [*_warnings(values, behind), *_bending_before(stage, looked, grows, result)]
    if count < wanted:
        warnings.append(
            f"only {count} factors exist, not {wanted}: the loads change the stiffness of no more motions"
        )
    return finished(result, stage, known, _reasons(stage), warnings, "Lanczos' method on the factor of K")


def _stage(run: Run, model: Model) -> tuple[Stage, bool]:
    """The eigenproblem of a model, solved, and whether some loads do not grow."""
    structure, options = run.structure, run.options
    grows = growing(structure)
    with run.clock.stage("assemble"):
        stiffness = model.stiffness()
        state = stressed(model, structure, [float(g) for g in grows[:-1]], float(grows[-1]))
        still = [1.0 - float(g) for g in grows]
        if not _moves(structure):
            still[-1] = 0.0
        if any(still):
            base = stressed(model, structure, still[:-1], still[-1])
            stiffness = (stiffness + base.geometric).tocsr()
    with run.clock.stage("solve"):
        pencil = CriticalPencil(stiffness, state.geometric, order=cache(model.elimination))
        if not any(still):
            pencil = pencil._replace(energy=model.energies)
        count = COUNT if options.count is None else options.count
        found = _factors(pencil, count + (0 if options.tolerance is None else TRIALS), any(still))
    return Stage(run, model, pencil, found, state), any(still)


def _reasons(stage: Stage) -> list[str]:
    """How pressures act while the structure buckles."""
    pressures = [placed.item for placed in stage.run.structure.loads if isinstance(placed.item, Pressure)]
    if stage.model.kind == "plate" or not any(not load.follower for load in pressures):
        return []
    return [
        "pressure keeps its direction while the structure buckles; follower = true lets it turn with the surface, as "
        "that of a fluid does"
    ]


def growing(structure: Structure) -> list[bool]:
    """For each load, and last for the prescribed motion, whether it grows.

    Raises
    ------
    InputError
        If some prescribed motions grow and others do not.
    """
    loads = [not placed.item.fixed for placed in structure.loads]
    moved = {placed.item.fixed for placed in structure.supports if placed.item.moves}
    if len(moved) > 1:
        raise InputError(
            "some prescribed motions have fixed = true and others not: either all of them grow or none"
        )
    return [*loads, moved == {False}]


def _moves(structure: Structure) -> bool:
    return any(placed.item.moves for placed in structure.supports)


def _factors(pencil: CriticalPencil, count: int, fixed: bool) -> Spectrum:
    try:
        return factors(pencil, count)
    except SolveError as error:
        if fixed and "not positive definite" in str(error):
            raise SolveError("the loads with fixed = true alone are beyond buckling: reduce them") from error
        raise


def _warnings(values: Floats, behind: float | None) -> list[str]:
    """Of factors without a positive one, but for one `behind` them, and of clusters."""
    out = []
    if behind is not None:
        out.append(
            f"the {len(values)} factors of smallest size are negative, they belong to reversed loads; the loads as "
            f"given buckle the structure at the factor {behind:.5g}: a larger count has it in the list"
        )
    elif not np.any(values > 0):
        out.append(
            "no factor is positive: the loads as given never buckle the structure, they press nowhere; the factors "
            "found belong to reversed loads"
        )
    for begin, end in clusters(np.abs(values), CLUSTER):
        if end - begin > 1 and not np.ptp(np.sign(values[begin:end])):
            out.append(
                f"factors {begin + 1} to {end} lie within {CLUSTER:.0%} of their neighbours, a cluster: each of its "
                "shapes is one of many, and small imperfections decide which of them a real structure takes"
            )
    return out


def _bending_before(stage: Stage, values: Floats, grows: list[bool], result: Result) -> list[str]:
    """A warning where the structure bends before it buckles, with the factor of the path of large deflections."""
    model, run = stage.model, stage.run
    positive = values[values > 0]
    first = float(positive.min()) if len(positive) else float(np.abs(values).min(initial=0.0))
    deflection, thickness = _deflection(model, run, stage.state)
    if first * deflection <= SMALL * thickness:
        return []
    found: dict[str, Any] = {"kind": "not followed", "factor": None}
    whole = all(grows[:-1]) and not _moves(run.structure)
    if len(positive) and whole and run.options.error != "off":
        found = critical_on_path(model, run, [1.0] * len(run.structure.loads), first)
    result.modal["path"] = found
    return [
        f"before it buckles at the factor {first:.4g} the structure bends: its deflection across the surface varies "
        f"by {first * deflection / thickness:.2g} times the thickness, which linear buckling leaves out; "
        f"{path_words(found)}"
    ]


def _deflection(model: Model, run: Run, state: Stressed) -> tuple[float, float]:
    """How far displacements across the surface lie apart in the linear solution at the factor 1, and a thickness.

    A uniform one, as that of a sphere or of a ring, changes no angles.
    """
    structure = run.structure
    thickness = float(structure.thickness.min())
    if state.solved is not None:
        fields = model.motion_fields(state.solved.x)
        across = np.einsum("vx,vx->v", fields["displacement"], fields["normal"])
        return float(np.ptp(across)), thickness
    across_only = tuple(
        placed
        for placed, grows in zip(structure.loads, growing(structure)[:-1], strict=True)
        if grows and not placed.item.stretches(placed.places(structure.space))
    )
    if not across_only:
        return 0.0, thickness
    bent = PlateModel(replace(structure, loads=across_only), model.element)
    w = bent.motion_fields(bent.solve().x)["displacement"][:, 2]
    return float(np.ptp(w)), thickness
