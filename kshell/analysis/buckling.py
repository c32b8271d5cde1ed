"""Linear buckling: the factors by which loads may grow until the stiffness they change is singular.

    (K + G_fixed) phi = -f G phi

G the geometric stiffness of the loads that grow, G_fixed that of loads that do not. Good where the structure hardly
deflects across its surface before it buckles.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.analysis.critical_load import critical_on_path, path_words
from kshell.analysis.intervals import Interval, unknown
from kshell.analysis.membrane import membrane_state
from kshell.analysis.modal_result import modal_result
from kshell.analysis.models import bending_only
from kshell.analysis.prestress import Stressed, plate_geometric, stressed
from kshell.analysis.run import Run, described
from kshell.equilibrium.model import Model
from kshell.error.buckling import lower_bounds
from kshell.errors import InputError, SolveError
from kshell.plate.model import PlateModel
from kshell.result.result import Result
from kshell.scene.structure import Structure
from kshell.scene.supports import Symmetry
from kshell.solvers.critical import CriticalPencil, factors
from kshell.solvers.eigenbasis import clusters
from kshell.solvers.pencil import Spectrum

Floats = NDArray[np.float64]

COUNT = 3
# factors closer than this, relative, are told as a cluster
CLUSTER = 0.01
# deflection across the surface before buckling, against the thickness, from which the linear factor is doubtful
SMALL = 0.3
# relative variation of a membrane force that is rounding
UNIFORM = 1e-9


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
    count = COUNT if options.count is None else options.count
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
        pencil = CriticalPencil(stiffness, state.geometric)
        if not any(still):
            pencil = pencil._replace(energy=model.energies)
        found = _factors(pencil, count, any(still))
    with run.clock.stage("bounds"):
        of, reasons = _intervals(model, run, state, found, any(still))
    with run.clock.stage("recover"):
        result = modal_result(model, found.vectors, largest_one=True)
        result.eigen = [
            {"value": value, "frequency": None, "lower": i.lower, "upper": i.upper, "kind": i.kind}
            for value, i in zip(found.values.tolist(), of, strict=True)
        ]
    result.error["kind"] = of[0].kind if of else "none"
    result.warnings += [*found.notes, *_warnings(run, found.values)]
    with run.clock.stage("bounds"):
        result.warnings += _bending_before(model, run, state, found.values, grows, result)
    if len(found.values) < count:
        result.warnings.append(
            f"only {len(found.values)} factors exist, not {count}: the loads change the stiffness of no more motions"
        )
    solver = {"name": found.solver, "why": "Lanczos' method on the factor of K", "iterations": found.solves}
    return described(result, model, run, reasons, solver, large=False)


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


def _intervals(
    model: Model, run: Run, state: Stressed, found: Spectrum, fixed: bool
) -> tuple[list[Interval], list[str]]:
    """Guaranteed for plates in a uniform state without tension, else estimated from another order."""
    count = len(found.values)
    if run.options.error == "off" or fixed:
        return unknown(count).of, []
    if isinstance(model, PlateModel):
        return _plate_intervals(model, run, state, found)
    return _shell_intervals(model, run, found)


def _shell_intervals(model: Model, run: Run, found: Spectrum) -> tuple[list[Interval], list[str]]:
    from kshell.shell.koiter.model import KoiterModel

    if not isinstance(model, KoiterModel) or model.order < 2:
        return unknown(len(found.values)).of, []
    other = KoiterModel(model.structure, model.order - 1, model.reasons)
    every = [float(g) for g in growing(run.structure)]
    try:
        state = stressed(other, run.structure, every[:-1], every[-1])
        values = factors(
            CriticalPencil(other.stiffness(), state.geometric, other.energies), len(found.values)
        ).values
    except SolveError:
        return unknown(len(found.values)).of, []
    words = f"intervals of factors: estimated from orders {model.order} and {model.order - 1}"
    return _apart(found.values, values), [words]


def _apart(values: Floats, other: Floats) -> list[Interval]:
    """As far to both sides as the factor of the same sign and number of another order is away."""
    out = []
    for k, value in enumerate(values.tolist()):
        rank = int(np.sum(np.sign(values[:k]) == np.sign(value)))
        same = other[np.sign(other) == np.sign(value)]
        if rank >= len(same):
            out.append(Interval(None, None, "none"))
            continue
        half = abs(value - float(same[rank]))
        out.append(Interval(value - half, value + half, "estimated"))
    return out


def _plate_intervals(
    model: PlateModel, run: Run, state: Stressed, found: Spectrum
) -> tuple[list[Interval], list[str]]:
    from kshell.analysis.intervals import finer, premises

    assert state.membrane is not None
    count = len(found.values)
    grows = [float(g) for g in growing(run.structure)]
    if model.element == "argyris":
        structure = finer(run.structure, run)
        other = PlateModel(bending_only(structure), "morley")
    else:
        structure = run.structure
        other = PlateModel(bending_only(structure), "argyris")
    membrane = membrane_state(structure, grows[:-1], grows[-1])
    values = factors(CriticalPencil(other.stiffness(), plate_geometric(other, membrane)), count)
    lacking = premises(model)
    force = membrane.nodes.reshape(-1, 2, 2)
    mean = force.mean(axis=0)
    if np.abs(force - mean).max() > UNIFORM * np.abs(mean).max():
        lacking.append("the membrane forces are not uniform")
    elif np.linalg.eigvalsh(mean)[1] > UNIFORM * np.abs(mean).max():
        lacking.append("the membrane forces are tensile in some direction")
    if not (values.checked and found.checked):
        lacking.append("that no factor was missed is not confirmed")
    if lacking or len(values.values) < count:
        words = f"intervals of factors: estimated from Morley and Argyris elements, not proven: {'; '.join(lacking)}"
        return _apart(found.values, values.values), [words]
    morley, argyris = (values, found) if model.element == "argyris" else (found, values)
    below = other if model.element == "argyris" else model
    lower = lower_bounds(below.problem, morley, -mean)
    upper = argyris.values * (1.0 + 1e-9)
    words = "intervals of factors: guaranteed, from Ritz values of Argyris elements and a bound from Morley elements"
    return [Interval(float(a), float(b), "guaranteed") for a, b in zip(lower, upper, strict=True)], [words]


def _warnings(run: Run, values: Floats) -> list[str]:
    out = []
    if not np.any(values > 0):
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
    if any(isinstance(placed.item, Symmetry) for placed in run.structure.supports):
        out.append("planes of symmetry hold the motion: shapes that are not symmetric to them are left out")
    return out


def _bending_before(
    model: Model, run: Run, state: Stressed, values: Floats, grows: list[bool], result: Result
) -> list[str]:
    """A warning where the structure bends before it buckles, with the factor of the path of large deflections."""
    positive = values[values > 0]
    first = float(positive.min()) if len(positive) else float(np.abs(values).min(initial=0.0))
    deflection, thickness = _deflection(model, run, state)
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
    every = np.arange(len(structure.space.triangles))
    centres = structure.space.points[structure.space.triangles].mean(axis=1)[:, None]
    thickness = float(structure.section.thickness(every, centres).min())
    if state.solved is not None:
        fields = model.motion_fields(state.solved.x)
        across = np.einsum("vx,vx->v", fields["displacement"], fields["normal"])
        return float(np.ptp(across)), thickness
    across_only = tuple(
        placed
        for placed, grows in zip(structure.loads, growing(structure)[:-1], strict=True)
        if grows and not placed.item.stretches(placed.vertices(structure.space))
    )
    if not across_only:
        return 0.0, thickness
    bent = PlateModel(replace(structure, loads=across_only), model.element)
    w = bent.motion_fields(bent.solve().x)["displacement"][:, 2]
    return float(np.ptp(w)), thickness
