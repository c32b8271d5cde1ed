"""Intervals around frequencies: proven where the premises of a proof hold, else estimated.

Plates: Ritz values of the Argyris element from above, the bound of Carstensen and Gallistl from the Morley element on a
finer mesh from below, and with a tolerance that of Lehmann and Goerisch (`kshell.error.goerisch`). Others from two
elements, two orders, or two meshes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from kshell.analysis.interval import NOTHING, Interval, Known, apart, unknown
from kshell.analysis.models import bending_only
from kshell.analysis.narrowing import Stage
from kshell.analysis.run import Run
from kshell.error import frequencies, goerisch
from kshell.error.plate_trial import hhj_system, trial_of
from kshell.errors import InputError, SolveError
from kshell.mesh.halve import halved
from kshell.plate.model import PlateModel
from kshell.scene.structure import Structure, resolve
from kshell.solvers.eigen import smallest
from kshell.solvers.pencil import Pencil

Floats = NDArray[np.float64]

# unknowns of the Morley element up to which the mesh is halved for lower bounds
FINE_ENOUGH = 20_000
# times the difference of both elements: where Morley values lie above, too (springs), the truth is beyond the other one
BOTH_ABOVE = 1.25
# order of the HHJ element: moments of degree 5, as the Argyris functions
HHJ_ORDER = 6


def frequency_bounds(first: Stage, count: int) -> Callable[[Stage], Known]:
    """What is known about frequencies on one mesh, as `narrowed` asks for it."""
    run, model = first.run, first.model
    if first.state is not None or run.options.error == "off":
        return lambda stage: unknown(len(stage.found.values))
    if not isinstance(model, PlateModel):
        return shell_intervals
    lacking = premises(model)
    if model.structure.masses:
        lacking.append("masses are added")
    if first.found.first != 0 or lacking or run.options.tolerance is None:
        return lambda stage: _rough(stage, lacking)
    coarse = _morley(model, run, len(first.found.values))  # serves all meshes
    return lambda stage: _sharp(stage, coarse, count)


def shell_intervals(stage: Stage) -> Known:
    """From the order below, on the same mesh; none for order 1 and for Argyris functions on a chart."""
    from kshell.shell.koiter.model import KoiterModel

    model, found, count = stage.model, stage.found, len(stage.found.values)
    if not isinstance(model, KoiterModel) or model.order < 2 or found.first is None:
        return unknown(count)
    lower = model.of_order(model.order - 1)
    mass = lower.mass()
    pencil = Pencil(lower.stiffness(), mass, lower.rigid_modes(mass).vectors, lower.energies)
    try:
        other = smallest(pencil, found.first + count).values[found.first :]
    except (InputError, SolveError):
        return unknown(count)
    words = f"intervals of frequencies: estimated from orders {model.order} and {model.order - 1}"
    return Known(apart(found.values, other), [words])


def modes_of(model: PlateModel, run: Run, count: int) -> Stage:
    """The first modes of a plate."""
    mass = model.mass()
    pencil = Pencil(model.stiffness(), mass, model.rigid_modes(mass).vectors, model.energies)
    return Stage(run, model, pencil, smallest(pencil, count))


def premises(model: PlateModel) -> list[str]:
    """What a proof does not cover, in words; empty where it holds."""
    problem = model.problem
    out = []
    if problem.domain.boundary.curved.any() or problem.mesh.midpoints is not None:
        out.append("edges are curved")
    if len(problem.domain.bent):
        out.append("lines inside are curved")
    if problem.supports.springs:
        out.append("supports are elastic")
    if not problem.section.constant_per_triangle:
        out.append("the thickness varies inside triangles")
    if any(group.turned for group in problem.supports.held):
        out.append("the rotation is held at a point")
    return out


def _rough(stage: Stage, lacking: list[str]) -> Known:
    """Ritz values of Argyris elements above, Morley elements below."""
    model, run, values = stage.model, stage.run, stage.found.values
    assert isinstance(model, PlateModel)
    first = stage.found.first
    if first is None:
        return unknown(len(values))
    count = first + len(values)
    if model.element == "morley":
        coarse, below = stage, values
        above = modes_of(model.like(model.structure, "argyris"), run, count)
        other = above.found.values[first:]
    else:
        above = stage
        coarse = _morley(model, run, count)
        below = other = coarse.found.values[first:]
    if not (stage.found.checked and coarse.found.checked and above.found.checked):
        lacking = [*lacking, "that no mode was missed is not confirmed"]
    if lacking or first != 0 or len(other) < len(values):
        why = "; ".join(lacking) or "they do not begin with the first mode"
        words = f"intervals of frequencies: estimated from Morley and Argyris elements, not proven: {why}"
        return Known(apart(values, other, BOTH_ABOVE), [words])
    lower = _morley_bounds(coarse)[: len(below)]
    upper = above.found.values * (1.0 + frequencies.rounding(above.pencil, above.found))
    pairs = zip(lower, upper[: len(values)], strict=False)
    words = (
        "intervals of frequencies: guaranteed, from Ritz values of Argyris elements and the bounds of Carstensen and "
        f"Gallistl from {coarse.model.unknowns} unknowns of Morley elements; a tolerance narrows them"
    )
    return Known([Interval(float(a), float(b), "guaranteed") for a, b in pairs], [words])


def finer(structure: Structure, run: Run) -> Structure:
    """The structure on its mesh halved while that is cheap for Morley elements; not with curved edges."""
    mesh = structure.space
    while mesh.midpoints is None and 8 * len(mesh.triangles) <= FINE_ENOUGH:
        mesh = halved(mesh)
    if mesh is structure.space:
        return structure
    return replace(resolve(run.scene, mesh), movable=structure.movable)


def _morley(model: PlateModel, run: Run, count: int) -> Stage:
    """The modes of Morley elements on a finer mesh."""
    return modes_of(model.like(bending_only(finer(model.structure, run)), "morley"), run, count)


def _morley_bounds(stage: Stage) -> Floats:
    assert isinstance(stage.model, PlateModel)
    problem = stage.model.problem
    centres = problem.mesh.points[problem.mesh.triangles].mean(axis=1)[:, None]
    mass = problem.section.mass(np.arange(len(centres)), centres)[:, 0]
    constant = frequencies.interpolation_constant(problem.mesh, problem.section.bending_per_triangle(), mass)
    rounding = frequencies.rounding(stage.pencil, stage.found)
    return frequencies.lower_bounds(stage.found.values, rounding, constant)


def _sharp(stage: Stage, coarse: Stage, count: int) -> Known:
    """With the lower bounds of Lehmann and Goerisch, above rough ones from Morley elements; and where they are wide."""
    model, found, pencil = stage.model, stage.found, stage.pencil
    assert isinstance(model, PlateModel)
    if model.element != "argyris":
        return _evenly(stage, _rough(stage, []))
    if not (coarse.found.checked and found.checked):
        return _evenly(stage, _rough(stage, ["that no mode was missed is not confirmed"]))
    rough = _morley_bounds(coarse)
    rigid = pencil.rigid.shape[1]
    still = np.zeros(rigid)
    values = np.concatenate([still, found.values])
    trials = goerisch.trial_count(values, np.concatenate([still, rough]), rigid + count)
    if trials is None:
        known = _evenly(stage, _rough(stage, []))
        known.reasons.append(
            "no gap was found behind the modes: their lower bounds are those of Morley elements"
        )
        return known
    rho = float(rough[trials - rigid])
    trial = trial_of(model.problem, pencil, values[:trials], found.vectors[:, : trials - rigid])
    system = hhj_system(model.problem, HHJ_ORDER, pencil.rigid)
    x = found.vectors[:, : trials - rigid]
    small = frequencies.evaluation(model.problem, pencil.mass, x)
    small = small + np.abs((x * (pencil.stiffness @ x)).sum(axis=0) / np.diag(trial.energy)[rigid:] - 1.0)
    bounds = goerisch.lower_bounds(system, trial, rho)
    sharp = bounds.values[rigid:]
    lower = np.maximum(sharp * (1.0 - small), rough[: len(sharp)])
    upper = found.values[: len(sharp)] * (1.0 + small)
    known = Known([Interval(float(a), float(b), "guaranteed") for a, b in zip(lower, upper, strict=True)])
    known.of += [NOTHING] * (len(found.values) - len(sharp))
    known.reasons.append(
        f"intervals of frequencies: guaranteed, from Ritz values of Argyris elements and the method of Lehmann and "
        f"Goerisch with {trials} trial functions and moments of degree {HHJ_ORDER - 1}"
    )
    known.misfit = bounds.misfit[rigid : rigid + count].sum(axis=0)
    return known


def _evenly(stage: Stage, known: Known) -> Known:
    """Wide everywhere alike."""
    known.misfit = np.ones(len(stage.model.structure.space.triangles))
    return known
