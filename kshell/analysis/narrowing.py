"""Intervals around eigenvalues narrowed to a tolerance, on one mesh after the other.

Where intervals say which triangles make them wide, those are cut; elsewhere all are, and the interval is estimated from
how far the values still move.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.analysis.interval import Known, apart
from kshell.analysis.refined_mesh import Refiner, shape_is_known
from kshell.analysis.run import Run
from kshell.analysis.shape_share import Shape
from kshell.equilibrium.model import Model
from kshell.errors import InputError, SolveError
from kshell.mesh.mesh import Mesh
from kshell.mesh.refine import cuttable, longest_first
from kshell.mesh.words import place
from kshell.solvers.pencil import Spectrum

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

# triangles, and unknowns, up to which a mesh is refined for a tolerance
FINEST, MOST_UNKNOWNS = 20_000, 200_000
# share of the width of the intervals whose triangles are cut, and share of triangles from which all are
BULK = 0.9
EVERYWHERE = 0.5
# share of the width around one vertex from which its triangles are halved up to so many times more; in meshes of more
# than a few triangles
CORNER, DEEPER, FEW = 0.2, 4, 100
# stages that an estimate looks back on
LOOKED_BACK = 3
# levels that must narrow the intervals to this share, or nothing is gained any more
STALLED, GAIN = 3, 0.8
# share of the width that comes from the mesh, below which rounding is the rest
OF_MESH = 0.1
# share of its last step that a value may still move per step, for an estimate from the last two steps
SLOWEST = 0.9


@dataclass
class Stage:
    """An eigenproblem solved on one mesh.

    Attributes
    ----------
    run : Run
        With the structure of that mesh.
    model : Model
    pencil : Pencil or CriticalPencil
    found : Spectrum
    state : object
        Of the loads, where there is one.
    """

    run: Run
    model: Model
    pencil: Any
    found: Spectrum
    state: Any = None


def narrowed(
    first: Stage,
    bound: Callable[[Stage], Known],
    again: Callable[[Run, Model], Stage],
    count: int,
) -> tuple[Known, Stage]:
    """Intervals of the first `count` values, and the stage they belong to: with a tolerance, on a finer mesh.

    Parameters
    ----------
    bound : function
        What is known on one mesh.
    again : function
        From the run on a finer mesh, and its model, to the stage there.

    Raises
    ------
    InputError, SolveError
        As the models, on the first mesh; a finer one that cannot be solved ends the refinement.
    """
    options = first.run.options
    if options.tolerance is None:
        shape = Shape.of(first.model, first.found.vectors, shape_is_known(first.run.scene))
        known = shape.widened(bound(first), first.model, first.found.vectors)
        if known.of and known.width is None and not known.reasons and options.error != "off":
            known.reasons.append(
                "intervals: none from one mesh alone; with a tolerance finer ones estimate them"
            )
        return known, first
    tolerance, begin = float(options.tolerance), time.perf_counter()
    levels: list[dict[str, Any]] = []
    turned = first.run.on_mesh(longest_first(first.run.structure.parameters))
    clock = time.process_time()
    stages = [_again(first, turned, again)]  # triangles are cut at their first edge
    refiner = Refiner(turned.scene, stages[0].model, turned.allow_system)
    start = stages[0]
    shape = Shape.of(start.model, start.found.vectors, shape_is_known(first.run.scene), refiner.followed)
    widths: list[float] = []
    why = ""
    while True:
        stage = stages[-1]
        known = bound(stage)
        if known.misfit is None:
            _estimate(known, stages)
        narrow = known.only(count).width
        known = shape.widened(known, stage.model, stage.found.vectors, refiner.followed)
        width = known.only(count).width
        widths.append(np.inf if width is None else width)
        unknowns = stage.model.unknowns
        levels.append({"unknowns": unknowns, "half_width": None if width is None else 0.5 * width})
        levels[-1]["seconds"] = time.process_time() - clock
        if len(widths) == 1 or widths[-1] <= min(widths):
            best = known, stage
        if widths[-1] <= tolerance:
            break
        why = _why_stop(first.run, widths, time.perf_counter() - begin) or _stalled(widths, stage, known)
        why = why or shape.limits(tolerance, narrow)
        mesh = None if why else _next_mesh(stage, known, refiner, widths[-1] / tolerance)
        if refiner.lost and not len(shape.frozen[shape.frozen > 0.0]):
            shape = Shape.of(stage.model, stage.found.vectors, False)
        if mesh is not None and _too_many(stage, mesh):
            why = "the mesh is not refined further"
        if why or mesh is None:
            break
        wide = "" if width is None else f"intervals {width:.1e} wide, "
        first.run.tell(f"bounds: {wide}{unknowns} unknowns; the mesh is refined")
        clock = time.process_time()
        try:
            finer = _again(first, stage.run.on_mesh(mesh), again)
        except (SolveError, InputError, MemoryError) as error:
            why = f"the next mesh could not be solved ({error or 'out of memory'})"
            break
        stages = [*stages[1 - LOOKED_BACK :], finer]
    known, stage = best
    if why:
        wide = f"{min(widths):.1e} wide" if np.isfinite(min(widths)) else "unknown"
        known.why_not = (
            f"tolerance = {tolerance:g} is not reached: the intervals are {wide} with {stage.model.unknowns} "
            f"unknowns, and {why}"
        )
        known.warnings.append(known.why_not)
    if len(levels) > 1:
        known.reasons.append(
            f"the mesh was refined {len(levels) - 1} times for the tolerance of {tolerance:g}"
        )
    known.levels = levels
    return known, stage


def _again(first: Stage, run: Run, again: Callable[[Run, Model], Stage]) -> Stage:
    """The stage on another mesh, of a model that was chosen for the first one."""
    stage = again(run, run.model())
    stage.model.reasons = first.model.reasons
    return stage


def _why_stop(run: Run, widths: list[float], seconds: float) -> str:
    """Why no finer mesh is worth while, in words; empty to go on."""
    if seconds > run.options.time_limit:
        return f"the limit of {run.options.limit} is reached"
    return ""


def _stalled(widths: list[float], stage: Stage, known: Known) -> str:
    """Why finer meshes gain nothing, in words; empty where they do."""
    if len(widths) <= STALLED or min(widths[-STALLED:]) <= GAIN * min(widths[:-STALLED]):
        return ""
    nothing = "further meshes gain nothing: "
    if not np.isfinite(widths[-1]):
        return f"{nothing}there are no intervals"
    if known.misfit is None:
        return f"{nothing}the values still move by as much"
    if np.ptp(known.misfit) == 0.0:
        return f"{nothing}sharp bounds need a gap above the values, which finer meshes have not shown"
    if float(known.misfit.sum()) < OF_MESH * widths[-1]:
        return f"{nothing}rounding sets the limit"
    mesh = stage.run.structure.space
    worst = mesh.triangles[int(np.argmax(known.misfit))]
    return f"{nothing}what is left is largest near {place(mesh.points[worst].mean(axis=0))}"


def _too_many(stage: Stage, mesh: Mesh) -> bool:
    """Whether a mesh has too many triangles, or its model would have too many unknowns."""
    now, then = len(stage.run.structure.parameters.triangles), len(mesh.triangles)
    return then > FINEST or stage.model.unknowns * then > MOST_UNKNOWNS * now


def held_to(run: Run, model: Model) -> Run:
    """The run with its element and order as they are, whatever finer meshes would get."""
    changes: dict[str, Any] = {"model": model.kind, "element": model.element}
    if model.element == "koiter":
        changes["order"] = model.order
    return replace(run, options=run.options.updated(**changes))


def _estimate(known: Known, stages: list[Stage]) -> None:
    """From how far values moved between meshes, where there are several."""
    if len(stages) < 2:
        return
    last, before = stages[-1].found, stages[-2].found
    if last.first != before.first:
        return
    wider = 1.0
    if len(stages) > 2:
        values = [stage.found.values for stage in stages[-3:]]
        n = min(len(v) for v in values)
        steps = [np.abs(b[:n] - a[:n]) for a, b in pairwise(values)]
        # values that move by a share q of their last step go on by q + q^2 + ...
        q = (
            min(float(np.max(steps[1] / np.maximum(steps[0], 1e-300))), SLOWEST)
            if steps[0].max() > 0
            else 0.0
        )
        wider = max(1.0, q / (1.0 - q))
    known.of = apart(last.values, before.values, wider)
    known.reasons = [
        "intervals: estimated, not proven, from how far the values move when all triangles are cut into four"
    ]


def _next_mesh(stage: Stage, known: Known, refiner: Refiner, excess: float) -> Mesh:
    """Cut where most of the width comes from; everywhere, where it comes from everywhere or that is not known."""
    mesh, misfit = stage.run.structure.parameters, known.misfit
    count = len(mesh.triangles)
    if misfit is None:
        return refiner.refined(mesh, np.arange(count))
    order = np.argsort(-misfit, kind="stable")
    most = int(np.searchsorted(np.cumsum(misfit[order]), BULK * misfit.sum())) + 1
    marked: Ints = np.arange(count) if most > EVERYWHERE * count else order[:most]
    corners = _corners(mesh, misfit)
    mesh = refiner.refined(mesh, marked)
    # moments like r^-s at a corner with s near 1 gain little by every halving; far from the tolerance take several
    deeper = int(min(DEEPER, np.ceil(np.log2(excess) / 2))) if len(corners) else 0
    for _ in range(deeper):
        around = np.isin(mesh.triangles, corners).any(axis=1) & cuttable(mesh)
        if not around.any():
            break
        mesh = refiner.refined(mesh, np.flatnonzero(around))
    return mesh


def _corners(mesh: Mesh, misfit: Floats) -> Ints:
    """Vertices around which most of the width comes from: corners where moments grow without bound."""
    flat = mesh.triangles.astype(np.int64).ravel()
    around = np.bincount(flat, np.repeat(misfit, 3), len(mesh.points))
    return (
        np.flatnonzero(around > CORNER * misfit.sum()) if len(misfit) > FEW else np.zeros(0, dtype=np.int64)
    )
