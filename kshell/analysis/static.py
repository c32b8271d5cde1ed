"""Deflection under the loads as they are, small or large as asked for or as it matters."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from kshell.analysis.missed_loads import largest_displacement, missed_loads
from kshell.analysis.run import Run, described
from kshell.analysis.shear import account_for_shear
from kshell.equilibrium.finite_model import FiniteModel
from kshell.equilibrium.model import Model, Solved
from kshell.error.assess import DUALS, assess
from kshell.error.assessment import Assessment
from kshell.error.infinite import without_infinite
from kshell.errors import InputError, SolveError
from kshell.result.result import Result
from kshell.scene.options import TOLERANCE
from kshell.scene.structure import Structure
from kshell.scene.supports import Elastic, RigidLink, SimplySupported

if TYPE_CHECKING:  # small deflections need none of it
    from kshell.analysis.large import Indicator
    from kshell.analysis.path import Trace
    from kshell.equilibrium.problem import State

# deflection over thickness up to which no plate stretches by as much as matters
SMALL = 0.07
# larger plates are not taken for shells without being asked
MOST_TRIANGLES = 20_000
# deflection over the size of the plate from which the scene is a matter of scale, not of large deflections
ABSURD = 10.0


@dataclass(frozen=True)
class Answered:
    """A static answer before anything is said of its error.

    Attributes
    ----------
    result : Result
    model : Model
        What answered, which may be another one than was asked.
    state : Solved or State
        Its solution, or the end state of large deflections.
    """

    result: Result
    model: Model
    state: Solved | State


def analyse(model: Model, run: Run) -> Result:
    """The static answer, with intervals of what it says.

    Raises
    ------
    InputError
        If the structure can move freely.
    SolveError
        If no answer was reached; of large deflections its `state` is the result of the last good step.
    Interrupted
        If the user stopped a growing load; its `state` as above.
    """
    answered = answer_once(model, run)
    if isinstance(answered.model, FiniteModel) and answered.model.yields:
        answered.result.error["why_not"] = "the shell yields, and estimates are those of elastic ones"
    elif run.options.error != "off":
        estimated(answered, run)
    return answered.result


def estimated(answered: Answered, run: Run, names: list[str] | None = None) -> Assessment:
    """The estimate of an answer, filled into its result; of the first probes, or of those named."""
    result = answered.result
    with run.clock.stage("estimate"):
        duals = DUALS if names is None else 3 * len(names)
        found = assess(answered.model, answered.state, result, duals, names)
        found.with_share(result.error["budget"]["algebra"] or 0.0)
        found.with_shape()
        if answered.model.structure.missed_under(run.factors):
            size = largest_displacement(result)
            found.with_loads(missed_loads(answered.model, run, size, result.strain_energy), size)
        without_infinite(found, answered.model, answered.state, run.factors)
        found.document(result, run.options.quantity)
        if isinstance(answered.state, Solved):
            account_for_shear(result, answered.model, answered.state, run.options, found.duals)
    result.solver["seconds"] = {**run.clock.seconds}
    return found


def answer_once(model: Model, run: Run, solved: Solved | None = None) -> Answered:
    """The static answer on the mesh as it is; see `analyse`. Of a plate, ``solved`` where it is at hand."""
    options = run.options
    if not isinstance(model, FiniteModel):
        return _linear_only(model, run, solved)
    indicator: Indicator | None = None
    trace: Trace | None = None
    with run.clock.stage("solve"):
        if not options.large_asked and not model.yields:
            solved = model.solve(options.solver)
            if options.large_deflection == "auto":
                from kshell.analysis.large import indicate

                indicator = indicate(model, solved.own, TOLERANCE)
        matters = indicator is not None and indicator.matters
        if matters and model.small_only and options.element == "auto":
            return _other_element(model, run)
        linked = next((p.item for p in model.structure.supports if isinstance(p.item, RigidLink)), None)
        limited = f"{linked} has small turns only" if linked is not None else model.small_only
        if solved is None or (matters and not limited):
            from kshell.analysis.path import grow_load

            trace = grow_load(model, run)
    with run.clock.stage("recover"):
        if trace is not None:
            from kshell.analysis.path import answer_trace

            result = answer_trace(model, trace)
            reasons = _why_large(model, result, solved, indicator)
        else:
            assert solved is not None  # without it there is a trace
            result = model.recover(solved)
            reasons = [_ASKED if indicator is None else indicator.words()]
    if trace is None:
        assert solved is not None
        if indicator is not None:
            result.error["budget"]["large_deflection"] = indicator.change
        described(result, model, run, reasons, _solver(solved), large=False, warmth=model.warmth())
        if indicator is not None and indicator.matters:
            result.warnings.append(
                f"{indicator.words()}, but {limited}: the answer is linear all the same; "
                "large_deflection = false keeps it without this warning"
            )
        return Answered(result, model, solved)
    if indicator is not None and isinstance(trace.failure, SolveError):
        trace.failure = SolveError(
            f"{trace.failure}. {indicator.words()}; large_deflection = false answers with the linear solution"
        )
    from kshell.analysis.path import described_trace

    return Answered(described_trace(model, run, result, trace, reasons), model, trace.states[-1])


def _other_element(model: FiniteModel, run: Run) -> Answered:
    """The answer of Koiter elements, which have large deflections of everything."""
    again = run.with_options(element="koiter")
    answered = answer_once(again.model(), again)
    reasons = [words for words in answered.result.model["reasons"] if not words.startswith("element ")]
    answered.result.model["reasons"] = [f"element koiter: {model.small_only}", *reasons]
    return answered


_LINEAR = "linear: only small deflections are computed"
_ASKED = f"{_LINEAR}, as asked for"


def _solver(solved: Solved | None) -> dict[str, Any]:
    assert solved is not None
    return {"name": solved.name, "why": solved.why, "iterations": solved.iterations}


def _why_large(
    model: FiniteModel, result: Result, solved: Solved | None, indicator: Indicator | None
) -> list[str]:
    """Why large deflections, with the displacement of each probe both ways where it was decided here."""
    if model.yields:
        return ["large deflections: the section yields, so the loads grow step by step"]
    if indicator is None or solved is None:
        return ["large deflections, as asked for"]
    small = model.linear_probes(solved)
    both = [
        f'probe "{name}": u = {_vector(values["u"])}, linear {_vector(small[name]["u"])}'
        for name, values in result.probes.items()
    ]
    return [f"{indicator.words()}; large_deflection = false keeps the linear solution", *both]


def _vector(u: NDArray[np.float64]) -> str:
    largest = float(np.abs(u).max())
    return "(" + ", ".join(f"{0.0 if abs(c) < 1e-9 * largest else c:.5g}" for c in u) + ")"


def _linear_only(model: Model, run: Run, solved: Solved | None) -> Answered:
    """The answer of a model without finite deformation, or of one that has it, where the deflection is not small.

    A clamped circular plate with an immovable edge deflects less by about 0.47 (w / t)^2 of w, a simply supported one
    by 1.85 (w / t)^2 (Timoshenko & Woinowsky-Krieger, chapter 13): below SMALL that is less than 1 percent. Plates
    free to move in their plane stretch less, which the shell tells.

    A simple support of a plate says nothing of motion in its plane, that of a shell forbids it: as this decides how
    much stiffer the plate gets, it is the user's to say, and the plate is warned of instead.
    """
    options = run.options
    if solved is None:
        with run.clock.stage("solve"):
            solved = model.solve(options.solver)
    with run.clock.stage("recover"):
        plate = model.recover(solved)
    described(plate, model, run, [_LINEAR], _solver(solved), large=False, warmth=model.warmth())
    thickness = float(plate.cell_fields["thickness"].max())
    ratio = _bent(plate, run.structure) / thickness
    words = f"the largest deflection is {ratio:.2g} times the thickness"
    answered = Answered(plate, model, solved)
    plate.error["budget"]["large_deflection"] = (
        TOLERANCE * (ratio / SMALL) ** 2
    )  # where supports hold it in its plane
    if ratio <= SMALL or options.large_deflection is False:
        plate.model["reasons"].append(f"linear: {words}")
        return answered
    doubt = f"{words}: it is stiffer than this linear answer where its edges cannot move in its plane"
    asked = options.model == model.kind or options.element != "auto" or options.solver == "multigrid"
    mesh = run.structure.space
    ambiguous = any(isinstance(support.item, SimplySupported) for support in run.structure.supports)
    if ambiguous:
        doubt += f" (a disk so held would deflect by {_held_in_plane(ratio):.0%} of that)"
    absurd = ratio * thickness > ABSURD * mesh.size
    if asked or ambiguous or absurd or len(mesh.triangles) > MOST_TRIANGLES:
        plate.model["reasons"].append(f"linear: {doubt}")
        plate.warnings.append(
            f'{doubt}; large_deflection = true computes that (model and element "auto"), false keeps this'
        )
        return answered
    again = run.with_options(model="shell")
    try:
        stretching = again.model()
    except InputError as error:  # a plate may be free to move in its plane, a shell must be held there
        plate.model["reasons"].append(f"linear: {doubt}")
        plate.warnings.append(f"{doubt}; large deflections would tell, but {error}")
        return answered
    shell = answer_once(stretching, again)
    found = shell.result
    if found.model["large_deflection"]:
        found.model["reasons"][0] = f"kind shell: {words}"
        return shell
    plate.error["budget"]["large_deflection"] = found.error["budget"]["large_deflection"]
    plate.model["reasons"] += [f"linear: {words}", *(r for r in found.model["reasons"] if "linear" in r)]
    return answered


def _bent(plate: Result, structure: Structure) -> float:
    """The largest deflection; of a plate that supports move, or springs alone hold, without its rigid part."""
    holding = [
        p.item for p in structure.supports if "z" in p.item.freedoms and not isinstance(p.item, Elastic)
    ]
    if holding and not any(placed.item.moves for placed in structure.supports):
        return float(np.abs(plate.fields["displacement"][:, 2]).max())
    w = np.asarray(plate.fields["displacement"])[:, 2]
    x = np.asarray(plate.points)[:, :2]
    rows = np.column_stack([np.ones(len(x)), x - x.mean(axis=0)])
    return float(np.abs(w - rows @ np.linalg.lstsq(rows, w, rcond=None)[0]).max())


def _held_in_plane(ratio: float) -> float:
    """Share of the linear deflection of a simply supported disk whose edge cannot move in its plane.

    The real root s of s + 1.85 ratio^2 s^3 = 1, after Timoshenko & Woinowsky-Krieger, chapter 13.
    """
    k = 1.85 * ratio**2
    half = math.sqrt(0.25 / k**2 + 1 / (27 * k**3)) + 0.5 / k
    return math.cbrt(half) - 1 / (3 * k * math.cbrt(half))
