"""Intervals around frequencies: proven where the premises of a proof hold, else estimated from two orders.

Plates: Ritz values of the Argyris element from above, the bound of Carstensen and Gallistl from the Morley element on a
finer mesh from below, and with a tolerance that of Lehmann and Goerisch (`kshell.error.goerisch`).
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from kshell.analysis.models import bending_only
from kshell.analysis.run import Run
from kshell.equilibrium.model import Model
from kshell.error import frequencies, goerisch
from kshell.error.plate_trial import hhj_system, trial_of
from kshell.errors import InputError, SolveError
from kshell.mesh.halve import halved
from kshell.mesh.mesh import Mesh
from kshell.mesh.refine import bisect, longest_first
from kshell.plate.model import PlateModel
from kshell.scene.structure import Structure, resolve
from kshell.solvers.eigen import smallest
from kshell.solvers.pencil import Pencil, Spectrum

Floats = NDArray[np.float64]

# unknowns of the Morley element up to which the mesh is halved for lower bounds
FINE_ENOUGH = 20_000
# triangles up to which the mesh is halved for a tolerance
FINEST = 20_000
# share of the width of the intervals whose triangles are cut, and share of triangles from which all are
BULK = 0.9
EVERYWHERE = 0.5
# order of the HHJ element: moments of degree 5, as the Argyris functions
HHJ_ORDER = 6


@dataclass(frozen=True)
class Interval:
    """Of one eigenvalue; None where nothing is known."""

    lower: float | None
    upper: float | None
    kind: Literal["guaranteed", "estimated", "none"]


@dataclass
class Known:
    """What is known about all of them.

    Attributes
    ----------
    of : list of Interval
    width : float or None
        Largest width, relative.
    """

    of: list[Interval]
    reasons: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    why_not: str = ""
    levels: list[dict[str, Any]] = field(default_factory=list)

    @property
    def kind(self) -> str:
        """The weakest of all."""
        kinds = {interval.kind for interval in self.of}
        return next((kind for kind in ("none", "estimated", "guaranteed") if kind in kinds), "none")

    @property
    def width(self) -> float | None:
        widths = [(i.upper - i.lower) / i.upper for i in self.of if i.lower is not None and i.upper]
        return max(widths) if len(widths) == len(self.of) and widths else None

    def only(self, count: int) -> Known:
        """The first ones."""
        return replace(self, of=self.of[:count])


def unknown(count: int) -> Known:
    """Nothing known about so many."""
    return Known([Interval(None, None, "none")] * count)


def two_orders(values: Floats, other: Floats) -> list[Interval]:
    """Estimated: as far to both sides as an answer of another order is away; None where it has no such mode."""
    out = []
    for k, value in enumerate(values.tolist()):
        if k >= len(other):
            out.append(Interval(None, None, "none"))
            continue
        half = abs(value - float(other[k]))
        out.append(Interval(value - half, value + half, "estimated"))
    return out


def shell_intervals(model: Model, found: Spectrum) -> Known:
    """From the order below, on the same mesh; none for order 1 and for Argyris functions on a chart."""
    from kshell.shell.koiter.model import KoiterModel

    count = len(found.values)
    if not isinstance(model, KoiterModel) or model.order < 2 or found.first is None:
        return unknown(count)
    lower = KoiterModel(model.structure, model.order - 1, model.reasons)
    mass = lower.mass()
    pencil = Pencil(lower.stiffness(), mass, lower.rigid_modes(mass).vectors, lower.energies)
    try:
        other = smallest(pencil, found.first + count).values[found.first :]
    except (InputError, SolveError):
        return unknown(count)
    known = Known(two_orders(found.values, other))
    known.reasons.append(
        f"intervals of frequencies: estimated from orders {model.order} and {model.order - 1}"
    )
    return known


@dataclass
class Plate:
    """A plate with its modes on one mesh: what intervals are found from.

    Attributes
    ----------
    model : PlateModel
    pencil : Pencil
    found : Spectrum
    """

    model: PlateModel
    pencil: Pencil
    found: Spectrum


def modes_of(model: PlateModel, count: int) -> Plate:
    """The first modes of a plate."""
    mass = model.mass()
    pencil = Pencil(model.stiffness(), mass, model.rigid_modes(mass).vectors, model.energies)
    return Plate(model, pencil, smallest(pencil, count))


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


def plate_intervals(plate: Plate, run: Run, count: int) -> tuple[Known, Plate]:
    """Of the first `count` modes, and the plate they belong to: with a tolerance, on a finer mesh.

    Raises
    ------
    InputError, SolveError
        As the models.
    """
    lacking = premises(plate.model)
    if plate.model.structure.masses:
        lacking.append("masses are added")
    tolerance = run.options.tolerance
    if plate.found.first != 0 or lacking or tolerance is None:
        return _rough(plate, run, lacking), plate
    levels: list[dict[str, Any]] = []
    mesh = longest_first(plate.model.structure.space)
    coarse = _morley(plate.model, run, len(plate.found.values))  # serves all meshes
    while True:
        begin = time.process_time()
        known, misfit = _sharp(plate, coarse, run, count)
        width = known.only(count).width
        unknowns = plate.model.unknowns
        levels.append({"unknowns": unknowns, "half_width": None if width is None else 0.5 * width})
        levels[-1]["seconds"] = time.process_time() - begin
        known.levels = levels
        if width is None or width <= tolerance:
            break
        mesh = _refined(mesh, misfit)
        if len(mesh.triangles) > FINEST:
            known.why_not = (
                f"tolerance = {tolerance:g} is not reached: the intervals are {width:.1e} wide with {unknowns} "
                "unknowns, and the mesh is not refined further"
            )
            known.warnings.append(known.why_not)
            break
        run.tell(f"bounds: intervals {width:.1e} wide, {unknowns} unknowns; the mesh is refined")
        structure = bending_only(replace(resolve(run.scene, mesh), movable=True))
        model = PlateModel(structure, plate.model.element, plate.model.reasons)
        plate = modes_of(model, len(plate.found.values))
    if len(levels) > 1:
        known.reasons.append(
            f"the mesh was refined {len(levels) - 1} times for the tolerance of {tolerance:g}"
        )
    return known, plate


def _rough(plate: Plate, run: Run, lacking: list[str]) -> Known:
    """Ritz values of Argyris elements above, Morley elements below."""
    model, values = plate.model, plate.found.values
    if plate.found.first is None:
        return unknown(len(values))
    count = plate.found.first + len(values)
    if model.element == "morley":
        coarse, below = plate, values
        above = modes_of(PlateModel(model.structure, "argyris"), count)
        other = above.found.values[plate.found.first :]
    else:
        above = plate
        coarse = _morley(plate.model, run, count)
        below = other = coarse.found.values[plate.found.first :]
    checked = plate.found.checked and coarse.found.checked and above.found.checked
    if not checked:
        lacking = [*lacking, "that no mode was missed is not confirmed"]
    if lacking or plate.found.first != 0 or len(other) < len(values):
        known = Known(two_orders(values, other))
        why = "; ".join(lacking) or "they do not begin with the first mode"
        known.reasons.append(
            f"intervals of frequencies: estimated from Morley and Argyris elements, not proven: {why}"
        )
        return known
    lower = _morley_bounds(coarse)[: len(below)]
    upper = above.found.values * (1.0 + frequencies.rounding(above.pencil, above.found))
    known = Known(
        [
            Interval(float(a), float(b), "guaranteed")
            for a, b in zip(lower, upper[: len(values)], strict=False)
        ]
    )
    known.reasons.append(
        "intervals of frequencies: guaranteed, from Ritz values of Argyris elements and the bounds of Carstensen and "
        f"Gallistl from {coarse.model.unknowns} unknowns of Morley elements; a tolerance narrows them"
    )
    return known


def finer(structure: Structure, run: Run) -> Structure:
    """The structure on its mesh halved while that is cheap for Morley elements; not with curved edges."""
    mesh = structure.space
    while mesh.midpoints is None and 8 * len(mesh.triangles) <= FINE_ENOUGH:
        mesh = halved(mesh)
    if mesh is structure.space:
        return structure
    return replace(resolve(run.scene, mesh), movable=structure.movable)


def _morley(model: PlateModel, run: Run, count: int) -> Plate:
    """The modes of Morley elements on a finer mesh."""
    return modes_of(PlateModel(bending_only(finer(model.structure, run)), "morley"), count)


def _morley_bounds(plate: Plate) -> Floats:
    problem = plate.model.problem
    centres = problem.mesh.points[problem.mesh.triangles].mean(axis=1)[:, None]
    mass = problem.section.mass(np.arange(len(centres)), centres)[:, 0]
    constant = frequencies.interpolation_constant(problem.mesh, problem.section.bending_per_triangle(), mass)
    return frequencies.lower_bounds(
        plate.found.values, frequencies.rounding(plate.pencil, plate.found), constant
    )


def _refined(mesh: Mesh, misfit: Floats) -> Mesh:
    """Cut where most of the width of the intervals comes from; everywhere, where it comes from everywhere.

    Parameters
    ----------
    misfit : (triangle,) array
    """
    order = np.argsort(-misfit, kind="stable")
    most = int(np.searchsorted(np.cumsum(misfit[order]), BULK * misfit.sum())) + 1
    if most > EVERYWHERE * len(misfit):
        return bisect(mesh, np.arange(len(misfit))).mesh
    return bisect(mesh, order[:most]).mesh


def _sharp(plate: Plate, coarse: Plate, run: Run, count: int) -> tuple[Known, Floats]:
    """With the lower bounds of Lehmann and Goerisch, above rough ones from Morley elements; and where they are wide."""
    even = np.ones(len(plate.model.structure.space.triangles))
    model, found = plate.model, plate.found
    if model.element != "argyris":
        return _rough(plate, run, []), even
    if not (coarse.found.checked and found.checked):
        return _rough(plate, run, ["that no mode was missed is not confirmed"]), even
    rough = _morley_bounds(coarse)
    rigid = plate.pencil.rigid.shape[1]
    still = np.zeros(rigid)
    values = np.concatenate([still, found.values])
    trials = goerisch.trial_count(values, np.concatenate([still, rough]), rigid + count)
    if trials is None:
        known = _rough(plate, run, [])
        known.reasons.append(
            "no gap was found behind the modes: their lower bounds are those of Morley elements"
        )
        return known, even
    rho = float(rough[trials - rigid])
    trial = trial_of(model.problem, plate.pencil, values[:trials], found.vectors[:, : trials - rigid])
    system = hhj_system(model.problem, HHJ_ORDER, plate.pencil.rigid)
    small = frequencies.rounding(plate.pencil, found)[: trials - rigid]
    found_bounds = goerisch.lower_bounds(system, trial, rho)
    sharp = found_bounds.values[rigid:]
    lower = np.maximum(sharp * (1.0 - small), rough[: len(sharp)])
    upper = found.values[: len(sharp)] * (1.0 + small)
    known = Known([Interval(float(a), float(b), "guaranteed") for a, b in zip(lower, upper, strict=True)])
    known.of += [Interval(None, None, "none")] * (len(found.values) - len(sharp))
    known.reasons.append(
        f"intervals of frequencies: guaranteed, from Ritz values of Argyris elements and the method of Lehmann and "
        f"Goerisch with {trials} trial functions and moments of degree {HHJ_ORDER - 1}"
    )
    return known, found_bounds.misfit[rigid : rigid + count].sum(axis=0)
