"""Loads grown from zero to their full size, or a displacement to its last value, through limit points."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import partial
from typing import Protocol

import numpy as np

from kshell.analysis.run import Run, described
from kshell.equilibrium.checkpoint import Checkpoints
from kshell.equilibrium.controlled import ControlledSteps
from kshell.equilibrium.finite_model import FiniteModel
from kshell.equilibrium.limit_points import Limits
from kshell.equilibrium.load_steps import LoadSteps, stuck
from kshell.equilibrium.march import March
from kshell.equilibrium.model import Model
from kshell.equilibrium.path import Critical
from kshell.equilibrium.problem import Problem, State
from kshell.equilibrium.work import external_work
from kshell.errors import InputError, Interrupted, SolveError
from kshell.result.result import Result
from kshell.scene.options import SolveOptions
from kshell.values.naming import listing, suggestion

# part of a displacement left free by supports that is rounding of their directions
HELD = 1e-9


def analyse(model: Model, run: Run) -> Result:
    """The path of the loads, or of a displacement.

    Raises
    ------
    InputError
        If the model has no finite deformation, or the options do not fit it.
    SolveError
        If the path ends early; its `state` is the result of the last good step.
    Interrupted
        If the user stopped it; its `state` as above.
    """
    if not isinstance(model, FiniteModel):
        raise InputError(f"a path needs finite deformation, which a {model.kind} does not have")
    with run.clock.stage("solve"):
        trace = grow_load(model, run)
    with run.clock.stage("recover"):
        result = answer_trace(model, trace)
    return described_trace(model, run, result, trace, ["large deflections, as asked for"])


def described_trace(model: Model, run: Run, result: Result, trace: Trace, reasons: list[str]) -> Result:
    """The result of a trace with what the run did; raises the failure of the trace with it."""
    solver = {"name": "direct", "why": "shells are factorised", "iterations": trace.iterations}
    solver["steps"] = len(trace.states) - 1
    factor = trace.states[-1].factor
    warmth = [replace(placed, item=placed.item.times(factor)) for placed in model.warmth()]
    described(result, model, run, reasons, solver, large=True, warmth=warmth)
    if trace.failure is not None:
        trace.failure.state = result
        raise trace.failure
    return result


@dataclass
class Trace:
    """The states of a growing load.

    Attributes
    ----------
    states : list of State
        From rest on.
    critical : list of (int, Critical)
        Each with the number of the state that came after it.
    failure : SolveError or Interrupted, optional
        Why the load is not at its full size.
    """

    states: list[State]
    critical: list[tuple[int, Critical]] = field(default_factory=list)
    failure: SolveError | Interrupted | None = None

    @property
    def iterations(self) -> int:
        """Of all steps."""
        return sum(state.iterations for state in self.states)


class Marching(Protocol):
    """Steps along a path: of the load, or of a displacement."""

    def begin(self, state: State) -> March:
        """The march from a state."""

    def ended(self, march: March) -> bool:
        """Whether the path is complete."""

    def go_on(self, march: March) -> tuple[March, Critical | None]:
        """The next state, and the critical point passed on the way; SolveError if there is none."""


def marching_of(model: FiniteModel, problem: Problem, options: SolveOptions) -> Marching:
    """How the options want the path to be followed.

    Raises
    ------
    InputError
        If the probe to be controlled does not exist, or does not move.
    """
    path = options.analysis == "path"
    steps = options.steps if options.steps != "auto" else (10 if path or model.yields else 1)
    if options.control is None:
        limits: Limits = "follow" if path else "jump"
        return LoadSteps(problem, steps, limits=limits, branch=options.branch, aside=0.5 * model.thickness)
    name, letter = options.control.probe, options.control.component
    probes = model.structure.probes
    if name not in probes:
        hint = suggestion(name, probes)
        raise InputError(f'control: no probe "{name}": {hint}the probes are {listing(probes)}')
    row, reduction = model.probe_row(name, letter), problem.reduction
    felt = np.abs(reduction.basis.T @ row).max(initial=0.0) > HELD * np.abs(row).max()
    if not felt and row @ reduction.given == 0.0:
        raise InputError(
            f'control: the supports hold probe "{name}" along {letter}: control another displacement'
        )
    return ControlledSteps(problem, row, options.control.to, steps)


def grow_load(model: FiniteModel, run: Run) -> Trace:
    """Grow the loads to their full size, or a displacement to its last value.

    Raises
    ------
    InputError
        If the folder of the run cannot be written, or what it holds is of another problem.
    """
    options, equilibrium = run.options, model.equilibrium()
    marching = marching_of(model, equilibrium, options)
    march = marching.begin(equilibrium.start())
    trace = Trace([march.state])
    saved = None if run.folder is None else Checkpoints(run.folder, _fingerprint(model, options))
    if saved is not None:
        for march, critical in saved.read(equilibrium.energy.rest) if run.resume else saved.clear():
            _add(trace, march, critical)
    try:
        while not marching.ended(march):
            march, critical = marching.go_on(march)
            _add(trace, march, critical)
            if saved is not None:
                saved.write(len(trace.states) - 1, march, critical)
            run.tell(_words(trace, march))
    except SolveError as error:
        way = options.control is None
        trace.failure = stuck(trace.states, str(error), None) if way else SolveError(str(error))
    except KeyboardInterrupt:
        trace.failure = Interrupted(f"interrupted at the load factor {trace.states[-1].factor:.6g}")
    return trace


def _add(trace: Trace, march: March, critical: Critical | None) -> None:
    trace.states.append(march.state)
    if critical is not None:
        trace.critical.append((len(trace.states) - 1, critical))


def _words(trace: Trace, march: March) -> str:
    state = march.state
    after = f"next step {march.size:.3g}" if march.crossing is None else "through a limit point"
    return (
        f"solve: load factor {state.factor:.4g}, step {len(trace.states) - 1}, {state.iterations} iterations, "
        f"{after}"
    )


def _fingerprint(model: FiniteModel, options: SolveOptions) -> str:
    """Tells paths apart: model and steps."""
    way = (options.analysis, options.steps, options.control, options.branch)
    return f"{model.fingerprint()} {way}"


def answer_trace(model: FiniteModel, trace: Trace) -> Result:
    """The result of the last state, with the path to it."""
    works = external_work(model.equilibrium(), trace.states)
    result = model.recover_state(trace.states[-1], works[-1])
    for number, state in enumerate(trace.states):
        last = number == len(trace.states) - 1
        values = result.probes if last else model.state_probes(state)
        entry = {
            "factor": float(state.factor),
            "probes": {name: {**p, "frame": model.frame} for name, p in values.items()},
        }
        entry |= {"iterations": state.iterations, "stable": state.negative == 0}
        result.path.append(entry)
        result.series.append((state.factor, partial(model.recover_state, state, works[number])))
    for number, (step, critical) in enumerate(trace.critical, 1):
        factor = float(critical.state.factor)
        result.critical.append({"kind": critical.kind, "factor": factor, "before_step": step})
        result.critical[-1] |= {"then": critical.then}
        result.fields[f"mode_{number}"] = model.motion_fields(critical.mode)["displacement"]
        result.warnings.append(_what_happens(critical, trace.states[step].factor))
    unstable = next((state for state in trace.states if state.negative > 0), None)
    if unstable is not None and trace.states[-1].negative > 0:
        result.warnings.append(
            f"the equilibrium is unstable: from the load factor {unstable.factor:.6g} on a small disturbance "
            "makes the shell buckle"
        )
    return result


def _what_happens(critical: Critical, after: float) -> str:
    """At a critical point, in words."""
    factor = critical.state.factor
    if critical.kind == "jump":
        return (
            f"the path could not be followed beyond the factor {factor:.6g}: from there the shell jumps to a stable "
            f"state at the factor {after:.6g}"
        )
    if critical.kind == "unstable":
        return (
            f"the equilibrium at the load factor {factor:.6g} is unstable, a small disturbance makes the shell buckle: "
            "this is a stable state that it goes to; where loads and supports are symmetric the mirror image is another"
        )
    passes = f"the load passes a {critical.kind} point at the factor {factor:.6g}"
    if critical.then == "branched":
        return f"{passes}: the path goes on along the branch that leaves there"
    if critical.then == "jumped":
        return f"{passes}: the shell jumps there to another stable state, here at the factor {after:.6g}"
    return f"{passes}: a real shell jumps there to the next stable state"
