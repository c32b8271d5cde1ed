"""Static answers to a tolerance: the mesh is refined until what is asked for is known that well.

Plates with straight edges go by guaranteed bounds of energies and deflections, which need nothing but the factors of
two discretisations; everything else by estimates. The first mesh has places of probes and single loads as vertices,
and is graded toward corners whose exponents are known. Then: solve, estimate, stop or mark, cut.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.analysis.first_mesh import plate_start, shell_start
from kshell.analysis.levels import (
    SHARE_JUMPS,
    Level,
    Refinement,
    blocked,
    by_loads,
    keep_shapes,
    next_mesh,
    share_of_shape,
    too_coarse,
)
from kshell.analysis.missed_loads import largest_displacement, missed_loads
from kshell.analysis.plate_choice import chosen
from kshell.analysis.refined_mesh import Refiner, shape_is_known
from kshell.analysis.refined_result import kind_of, refined_result
from kshell.analysis.run import Run
from kshell.analysis.stalled import why_stalled
from kshell.analysis.static import Answered, answer_once
from kshell.equilibrium.model import Model, Solved
from kshell.error.assess import assess
from kshell.error.assessment import ENERGY, PROBES
from kshell.error.bounds import PlatePair
from kshell.error.infinite import infinite_energy, without_infinite
from kshell.error.plates import assess_pair, geometry_share
from kshell.error.shells import share_when_cut
from kshell.error.sizes import MOST_GROWTH
from kshell.errors import InputError, Interrupted, SolveError
from kshell.mesh.mesh import Mesh
from kshell.mesh.refine import longest_first
from kshell.plate.hhj.model import HHJModel
from kshell.plate.model import PlateModel
from kshell.result.result import Result
from kshell.scene.options import SolveOptions
from kshell.shell.koiter.model import KoiterModel
from kshell.shell.koiter.recovery import energies
from kshell.solvers.memory import SHARE, available_bytes, peak_bytes
from kshell.values.naming import listing, suggestion

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

GROWTH = 2.5  # of unknowns, time and memory from one level to the next, to be expected
MOST_LEVELS = 60
STALLED = 0.8  # a level that leaves more of the half width than this, with half as many unknowns more, gains nothing
LITTLE = (
    2.0  # times what the shape of the first mesh leaves, is a half width that finer ones narrow by little
)
GRADED = (20, 10, 0)  # halvings of the first mesh toward corners, where it cannot be solved with more
GAINLESS = 3  # such levels in a row, after which refining ends
GAINLESS_JUMPS = 6  # the same where loads jump: what rules miss of them is a matter of luck
BYTES, BYTES_MORLEY = 30e3, 4e3  # memory of a solve and its estimate for each unknown, about


def analyse(model: Model, run: Run) -> Result:
    """The static answer to a tolerance.

    Raises
    ------
    InputError
        If the quantity is none of the scene, or the model has no estimate.
    SolveError
        If no answer was reached on the first mesh.
    Interrupted
        If the user stopped it; its `state` is the result of the last level.
    """
    begin = time.perf_counter()
    names = _names(run)
    if _is_auto_chart(model, run):
        run = run.with_options(element="koiter")
        model = run.model()
    first: Answered | None = None
    if not (isinstance(model, PlateModel | HHJModel) and run.options.large_deflection is False):
        first = answer_once(model, run)  # which decides between plate and shell, small and large deflections
        model = first.model
    model, why = chosen(model, run)
    large = first is not None and bool(first.result.model["large_deflection"])
    quartics = (
        isinstance(model, KoiterModel)
        and (run.scene.chart is not None and not large)
        and (model.order, run.options.order) == (3, "auto")
    )
    held: dict[str, Any] = {"model": model.kind, "element": model.element}
    if model.element == "hhj":  # whose order is that of the number of triangles otherwise
        held["order"] = model.order
    elif quartics:
        held["order"] = 4
    run = run.with_options(**held, large_deflection=large)
    given = mesh = longest_first(model.structure.parameters)
    loop = Refinement(
        run, names, False, begin, Refiner(run.scene, model, run.allow_system), quartics=quartics, why=why
    )
    followed = loop.refiner.followed
    if isinstance(model, PlateModel | HHJModel):
        mesh, loop.pair = plate_start(model, given, names, run, loop.refiner)
    elif isinstance(model, KoiterModel):
        assert first is not None
        mesh = shell_start(run, mesh, _membrane(model, first))
    if followed is not None:
        loop.frozen = geometry_share(followed.first)
    elif first is not None and not shape_is_known(run.scene) and not loop.pair:
        loop.frozen = assess(first.model, first.state, first.result, 0).geometry or 0.0
        if isinstance(model, KoiterModel) and isinstance(first.state, Solved):
            loop.cut = share_when_cut(model, model.problem.energy.linear_strain(first.state.x))
    # toward corners triangles may be so small that the matrix has no digits left, as if the plate were loose
    for most in GRADED:
        try:
            _refine(loop, mesh)
            return refined_result(loop, first)
        except SolveError:
            if not isinstance(model, PlateModel | HHJModel):
                raise
            mesh, loop.pair = plate_start(model, given, names, run, loop.refiner, most)
    _refine(loop, mesh)
    return refined_result(loop, first)


def _names(run: Run) -> list[str]:
    """The probes whose displacement is asked for; empty for the energy."""
    probes, quantity = list(run.structure.probes), run.options.quantity
    if quantity == ENERGY and ENERGY not in probes:
        return []
    if quantity is None or (quantity == PROBES and PROBES not in probes):
        if quantity == PROBES and not probes:
            raise InputError(
                'quantity = "probes", but the scene has no probe: name a point, or take "energy"'
            )
        return probes
    if quantity not in probes:
        raise InputError(
            f'quantity = "{quantity}": no such probe; {suggestion(quantity, probes)}the probes are {listing(probes)}; '
            '"energy" and "probes" are quantities, too'
        )
    return [quantity]


def _is_auto_chart(model: Model, run: Run) -> bool:
    return model.kind == "shell" and model.element == "argyris" and run.options.element == "auto"


def _refine(loop: Refinement, mesh: Mesh) -> None:
    """Levels until the tolerance is met, or a reason not to go on is found."""
    tolerance = float(loop.run.options.tolerance)
    stalled = 0
    growth = GROWTH
    while True:
        before = time.perf_counter()
        try:
            if loop.levels:
                mesh = next_mesh(loop, loop.levels[-1], tolerance, growth)
            level = _solved(loop, mesh, before)
        except KeyboardInterrupt:
            if not loop.levels:
                raise
            words = (
                f"interrupted at level {len(loop.levels) + 1}: the result is that of level {len(loop.levels)}"
            )
            raise Interrupted(words, refined_result(loop, None)) from None
        except (SolveError, InputError, MemoryError) as error:
            if not loop.levels:
                raise
            loop.why_not = f"the next mesh could not be solved ({error or 'out of memory'})"
            return
        if loop.levels:
            loop.levels[-1].pair = None  # its factors are of no use any more
        loop.levels.append(level)
        loop.run.tell(
            f"level {len(loop.levels)}: {level.unknowns} unknowns, within {100 * level.half_width:.2g} % "
            f"({kind_of(loop, level)}), {time.perf_counter() - loop.begin:.2g} s"
        )
        if level.half_width <= tolerance and not too_coarse(loop, level):
            return
        if len(loop.levels) > 1:
            last = loop.levels[-2]
            gained = level.half_width <= STALLED * last.half_width * (last.unknowns / level.unknowns) ** 0.5
            stalled = 0 if gained else stalled + 1
        growth = _room(loop, level)
        loop.why_not = _why_stop(loop, level, stalled)
        if loop.why_not:
            return


def _solved(loop: Refinement, mesh: Mesh, before: float) -> Level:
    run = loop.run.on_mesh(mesh)
    wanted = loop.names or [ENERGY]
    answered = pair = None
    shape = 0.0
    if loop.pair:
        from kshell.analysis.models import build_model

        model = build_model(run.structure, run.options)
        assert isinstance(model, PlateModel)
        pair = PlatePair(model.problem)
        found = assess_pair(pair, loop.names, _strain_energy(pair))
        if model.structure.missed_under(run.factors):
            energy, size = abs(found.energy.value) if found.energy else 0.0, pair.conforming.largest()
            found.with_loads(missed_loads(model, run, size, energy), size)
        found.without_energy(infinite_energy(model.structure, run.factors))
        unknowns = model.unknowns
    else:
        answered = answer_once(run.model(), run)
        model, result = answered.model, answered.result
        found = assess(model, answered.state, result, 3 * len(loop.names), loop.names, marks=True)
        if found.energy is None:
            raise InputError(f"tolerance: {found.why_not}")
        found.with_share(result.error["budget"]["algebra"] or 0.0)
        known = max(found.relative(name) for name in wanted)
        found.geometry = share_of_shape(loop, model, found)
        keep_shapes(loop, found)
        found.with_shape()
        if found.geometry > 0.0:
            adds = max(found.relative(name) for name in wanted) - known
            shape = adds * max(loop.frozen, loop.cut) / found.geometry
        if model.structure.missed_under(run.factors):
            size = largest_displacement(result)
            found.with_loads(missed_loads(model, run, size, result.strain_energy), size)
        without_infinite(found, model, answered.state, run.factors)
        unknowns = result.unknowns
    half = max(found.relative(name) for name in wanted)
    return Level(run, model, found, unknowns, half, time.perf_counter() - before, answered, pair, shape)


def _strain_energy(pair: PlatePair) -> float | None:
    if pair.at_rest:
        return None
    return float(pair.problem.energies(pair.conforming.unknowns)[0])


def _room(loop: Refinement, level: Level) -> float:
    """By how much the unknowns of the next level may grow, with the time and the memory that are left."""
    options, spent = loop.run.options, time.perf_counter() - loop.begin
    left = (options.time_limit - spent) / max(level.seconds, 1e-9)
    bytes_left = (_allowed(options) - peak_bytes()) / (_bytes(level) * level.unknowns)
    return float(np.clip(min(left, bytes_left), GROWTH, MOST_GROWTH))


def _allowed(options: SolveOptions) -> float:
    return min(options.memory_limit, SHARE * available_bytes() + peak_bytes())


def _bytes(level: Level) -> float:
    return BYTES_MORLEY if level.model.element == "morley" else BYTES


def _why_stop(loop: Refinement, level: Level, stalled: int) -> str:
    """Why refining ends before the tolerance, in words; empty to go on."""
    options, spent = loop.run.options, time.perf_counter() - loop.begin
    if spent + GROWTH * level.seconds > options.time_limit:
        return f"the limit of {options.limit} would be passed by the next level"
    if peak_bytes() + GROWTH * _bytes(level) * level.unknowns > _allowed(options):
        return f"the memory would not do for the next level, about {GROWTH * level.unknowns:.0f} unknowns"
    known = not level.assessment.told or np.isfinite(level.half_width)
    if level.assessment.infinite and not (loop.names and known):
        return level.assessment.infinite
    if level.assessment.told and not np.isfinite(level.half_width):
        return "what is asked for does not move, so no error of it is small"
    if level.shape > float(options.tolerance) and level.half_width <= LITTLE * level.shape:
        shape = max(loop.frozen, loop.cut)
        cure = (
            "give its geometry, or a chart"
            if loop.refiner.followed is None
            else "begin with more nodes along its curved edges"
        )
        return f"the shape of the mesh is known to {shape:.1e} only, and refining adds nothing: {cure}"
    limit = blocked(loop, level)
    if limit:
        return limit
    if by_loads(loop, level) > SHARE_JUMPS * float(options.tolerance):
        if stalled >= GAINLESS_JUMPS:
            return (
                f"further levels gain nothing: the loads jump or peak, and {level.assessment.loads:.1e} of them is "
                "missed"
            )
    elif stalled >= GAINLESS:
        return why_stalled(loop, level)
    if len(loop.levels) >= MOST_LEVELS:
        return f"{MOST_LEVELS} levels were not enough"
    return ""


def _membrane(model: Model, first: Answered) -> float:
    """Share of the membrane in the energy of a shell; 1 where it is not known."""
    if not isinstance(model, KoiterModel) or not isinstance(first.state, Solved):
        return 1.0
    problem = model.problem
    membrane, bending = energies(problem.energy, problem.energy.linear_strain(first.state.x))
    total = float((membrane + bending).sum())
    return float(membrane.sum()) / total if total > 0.0 else 1.0
