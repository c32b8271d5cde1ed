"""The shell from scene to result."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.clock import Clock, Stage, peak_memory_mb
from kshell.errors import InputError, SolveError
from kshell.mesh.mesh import Mesh
from kshell.modelling import ModelChoice, choose_model
from kshell.options import SolveOptions
from kshell.probing import probe_values
from kshell.result import Result, no_error_estimate
from kshell.scene import Scene
from kshell.shell.equilibrium import State
from kshell.shell.fields import ShellFields
from kshell.shell.large import Trace, grow_load, indicate
from kshell.shell.linear import LinearSolution, solve_linear
from kshell.shell.problem import ShellProblem
from kshell.shell.scene_reactions import find_reactions

Floats = NDArray[np.float64]

UNBALANCED = 1e-6
# strain energy against that of stretching by all of the displacement, far below the thinnest shell in bending
NO_STRAIN = 1e-18
FRAME = "projection of global x (of y where x is normal) on the tangent plane"


def solve_shell(
    scene: Scene,
    mesh: Mesh,
    options: SolveOptions,
    progress: Stage | None = None,
    read_seconds: float = 0.0,
    folder: Path | None = None,
    resume: bool = False,
) -> Result:
    """Deflection of a Koiter shell, small or large as asked for or as it matters.

    Parameters
    ----------
    scene : Scene
    mesh : Mesh
        Of the scene, as read.
    options : SolveOptions
    progress : function, optional
        Called with the name of each stage: assemble, solve, recover; and after each load step.
    read_seconds : float
        Time already spent on reading.
    folder : Path, optional
        Where each converged load step is written.
    resume : bool
        Go on after the last step in the folder.

    Raises
    ------
    InputError
        If the scene does not fit, or the shell is not held.
    SolveError
        If no answer was reached; of a growing load its `state` is the result of the last good step.
    Interrupted
        If the user stopped a growing load; its `state` as above.
    """
    clock = Clock(progress, read_seconds)
    if options.solver == "multigrid":
        raise InputError('solver = "multigrid" is for plates: shells are solved with "direct" or "auto"')
    with clock.stage("assemble"):
        choice: ModelChoice = choose_model(scene, mesh, options)
        problem = ShellProblem(scene, mesh, choice)
    reason = "linear: only small deflections are computed, as asked for"
    large, change = options.large_asked, None
    trace: Trace | None = None
    with clock.stage("solve"):
        if large:
            reason = "large deflections: as asked for"
        else:
            solution = solve_linear(problem.energy, problem.load, problem.reduction, problem.springs)
            if not np.isfinite(solution.x).all():
                raise SolveError(
                    "the solution is not finite: check the magnitudes of stiffness and loads",
                    state=solution.x,
                )
            if options.large_deflection == "auto":
                indicator = indicate(problem, solution)
                large, change, reason = indicator.matters, indicator.change, indicator.words()
        if large:
            steps = options.steps if options.steps != "auto" else (10 if options.analysis == "path" else 1)
            trace = grow_load(problem, steps, progress, folder, resume)
    with clock.stage("recover"):
        if trace is None:
            result = _recover(scene, problem, solution)
            result.error["budget"]["large_deflection"] = change
        else:
            result = recover_trace(scene, problem, trace)
    result.analysis = options.analysis
    result.model = {
        "kind": "shell",
        "large_deflection": large,
        "element": choice.element,
        "order": choice.order,
        "reasons": [*problem.reasons(), reason, *(f"mesh: {note}" for note in mesh.notes)],
    }
    result.solver = {
        "name": "direct",
        "why": "shells are factorised",
        "iterations": len(solution.corrections) if trace is None else trace.iterations,
        **({} if trace is None else {"steps": len(trace.states) - 1}),
        "seconds": {**clock.seconds},
        "peak_memory_mb": peak_memory_mb(),
    }
    if trace is not None and trace.failure is not None:
        trace.failure.state = result
        raise trace.failure
    return result


def recover_trace(scene: Scene, problem: ShellProblem, trace: Trace) -> Result:
    """The result of the last state, with the path to it."""
    result = recover_state(scene, problem, trace.states[-1])
    for number, state in enumerate(trace.states):
        last = number == len(trace.states) - 1
        values = result.probes if last else _probes(scene, problem, _fields(scene, problem, state))[0]
        entry = {
            "factor": state.factor,
            "probes": {name: {**p, "frame": FRAME} for name, p in values.items()},
        }
        entry |= {"iterations": state.iterations, "stable": state.negative == 0}
        result.path.append(entry)
        result.series.append((state.factor, partial(recover_state, scene, problem, state)))
    for number, (step, critical) in enumerate(trace.critical, 1):
        result.critical.append(
            {"kind": critical.kind, "factor": float(critical.state.factor), "before_step": step}
        )
        mode = ShellFields(
            problem.space,
            problem.discretisation.recovery(problem.energy, critical.mode),
            problem.section,
            scene.offset,
            *problem.discretisation.patches(),
        )
        result.fields[f"mode_{number}"] = mode.vertex_fields["displacement"]
        result.warnings.append(
            f"the load passes a {critical.kind} point at the factor {critical.state.factor:.6g}: a real shell "
            "jumps there to the next stable state"
        )
    unstable = next((state for state in trace.states if state.negative > 0), None)
    if unstable is not None and trace.states[-1].negative > 0:
        result.warnings.append(
            f"the equilibrium is unstable: from the load factor {unstable.factor:.6g} on a small disturbance "
            "makes the shell buckle"
        )
    return result


def recover_state(scene: Scene, problem: ShellProblem, state: State) -> Result:
    """The result of one state of large deflections."""
    _, residual, _ = problem.equilibrium().evaluate(state.x, state.factor, 1, state.memory)
    loads = problem.forces_at(state)
    solution = LinearSolution(state.x, -residual, np.zeros(0), ())
    result = _recover(scene, problem, solution, state, loads)
    # loads that grow slowly from rest do the work that is stored; at edges their rotations are not kept
    result.external_work = result.strain_energy
    return result


def _fields(scene: Scene, problem: ShellProblem, state: State | None, x: Floats | None = None) -> ShellFields:
    discretisation = problem.discretisation
    if state is None:
        recovery = discretisation.recovery(problem.energy, x)
    else:
        if problem.loads.initial is not None:
            problem.energy.initial = state.factor * problem.loads.initial
        recovery = discretisation.recovery(problem.energy, state.x, True, state.memory)
    return ShellFields(problem.space, recovery, problem.section, scene.offset, *discretisation.patches())


def _probes(
    scene: Scene, problem: ShellProblem, fields: ShellFields
) -> tuple[dict[str, dict[str, Any]], list[str]]:
    return probe_values(scene.probes, fields.at, problem.space, "shell")


def _recover(
    scene: Scene,
    problem: ShellProblem,
    solution: LinearSolution,
    state: State | None = None,
    loads: list[Floats] | None = None,
) -> Result:
    fields = _fields(scene, problem, state, solution.x)
    groups, balance = find_reactions(
        problem.discretisation,
        problem.supports,
        solution,
        problem.loads.forces if loads is None else loads,
        None if state is None else state.x,
    )
    energies = _energies(problem, fields.recovery, solution)
    stretch = problem.energy.section.membrane.max() * np.abs(solution.x).max() ** 2
    if sum(energies.values()) <= NO_STRAIN * stretch:
        balance = 0.0  # moved along without strain: all forces are rounding
    warnings = problem.warnings()
    if balance > UNBALANCED:
        warnings.append(
            f"loads and reactions differ by {balance:.1e} of the larger: the solution has few correct digits; look "
            "for very small or very thin triangles (`kshell check`), or a shell that is hardly held"
        )
    probes, probe_warnings = _probes(scene, problem, fields)
    vertex_fields = fields.vertex_fields
    error = no_error_estimate()
    error["budget"]["algebra"] = solution.corrections[-1] if len(solution.corrections) > 1 else 0.0
    return Result(
        mesh=problem.space,
        fields=vertex_fields,
        edge_fields={"displacement": fields.edge_displacement},
        cell_fields=fields.cell_fields,
        unknowns=problem.reduction.basis.shape[1],
        model={"kind": "shell"},
        title=scene.title,
        frame=FRAME,
        probes=probes,
        reactions=groups,
        balance=balance,
        strain_energy=sum(energies.values()),
        energies=energies,
        external_work=_work(problem, solution),
        extremes=_extremes(problem.space, vertex_fields),
        evaluate=fields.at,
        error=error,
        warnings=warnings + probe_warnings,
        scene=scene,
    )


def _energies(problem: ShellProblem, recovery: Any, solution: LinearSolution) -> dict[str, float]:
    membrane, bending = (float(part.sum()) for part in recovery.energies())
    out = {"membrane": membrane, "bending": bending}
    if problem.springs is not None:
        out["springs"] = 0.5 * float(solution.x @ (problem.springs @ solution.x))
    return out


def _work(problem: ShellProblem, solution: LinearSolution) -> float:
    """Of loads and of prescribed motion, applied slowly."""
    return 0.5 * float(problem.load @ solution.x + solution.forces @ problem.reduction.given)


def _extremes(mesh: Mesh, fields: dict[str, Floats]) -> dict[str, dict[str, Any]]:
    """Largest displacement in size, and largest von Mises stress on any face, each with its vertex."""
    size = np.linalg.norm(fields["displacement"], axis=1)
    stress = np.max([fields[f"von_mises_{face}"] for face in ("top", "middle", "bottom")], axis=0)
    out = {}
    for name, values in (("deflection", size), ("von_mises", stress)):
        place = int(np.argmax(values))
        out[name] = {"value": float(values[place]), "at": mesh.points[place].tolist()}
    return out
