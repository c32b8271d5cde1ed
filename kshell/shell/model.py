"""The shell from scene to result."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from kshell.analysis.clock import Clock, Stage, peak_memory_mb
from kshell.analysis.model_choice import ModelChoice, choose_model
from kshell.equilibrium.linear import LinearSolution, solve_linear
from kshell.errors import InputError, Interrupted, SolveError
from kshell.mesh.mesh import Mesh
from kshell.result.result import Result
from kshell.scene.options import SolveOptions
from kshell.scene.scene import Scene
from kshell.shell.answer import answer_linear, answer_trace, probes_of, small_fields
from kshell.shell.imperfection import imperfect
from kshell.shell.large import Indicator, Trace, grow_load, indicate
from kshell.shell.problem import ShellProblem


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
        problem, known = ShellProblem(scene, mesh, choice), []
        if scene.imperfection is not None:
            problem, words = imperfect(problem, scene.imperfection)
            known.append(words)
    large = options.large_asked
    solution: LinearSolution | None = None
    indicator: Indicator | None = None
    trace: Trace | None = None
    answer: Callable[[], Result]
    with clock.stage("solve"):
        if not large:
            solution = _solve_small(problem)
            answer, iterations = partial(answer_linear, problem, solution), len(solution.corrections)
            if options.large_deflection == "auto":
                indicator = indicate(problem, solution, options.large_tolerance)
                large = indicator.matters
        if large:
            trace = grow_load(problem, options, progress, folder, resume)
            answer, iterations = partial(answer_trace, problem, trace), trace.iterations
    with clock.stage("recover"):
        result = answer()
        reasons = _reasons(problem, result, solution, indicator, large)
    if trace is None and indicator is not None:
        result.error["budget"]["large_deflection"] = indicator.change
    result.analysis = options.analysis
    result.model = {
        "kind": "shell",
        "large_deflection": large,
        "element": choice.element,
        "order": choice.order,
        "reasons": [*problem.reasons(), *known, *reasons, *(f"mesh: {note}" for note in mesh.notes)],
    }
    result.solver = {
        "name": "direct",
        "why": "shells are factorised",
        "iterations": iterations,
        **({} if trace is None else {"steps": len(trace.states) - 1}),
        "seconds": {**clock.seconds},
        "peak_memory_mb": peak_memory_mb(),
    }
    if trace is not None and trace.failure is not None:
        raise _failure(trace.failure, result, indicator)
    return result


def _solve_small(problem: ShellProblem) -> LinearSolution:
    solution = solve_linear(problem.energy, problem.load, problem.reduction, problem.springs)
    if not np.isfinite(solution.x).all():
        raise SolveError(
            "the solution is not finite: check the magnitudes of stiffness and loads", state=solution.x
        )
    return solution


def _reasons(
    problem: ShellProblem,
    result: Result,
    solution: LinearSolution | None,
    indicator: Indicator | None,
    large: bool,
) -> list[str]:
    """Why small or large deflections, with the displacement of each probe both ways where it was decided here."""
    if indicator is None or solution is None:
        asked = "large deflections" if large else "linear: only small deflections are computed"
        return [f"{asked}, as asked for"]
    if not large:
        return [indicator.words()]
    small, _ = probes_of(problem, small_fields(problem, solution.x))
    both = [
        f'probe "{name}": u = {_vector(values["u"])}, linear {_vector(small[name]["u"])}'
        for name, values in result.probes.items()
    ]
    return [f"{indicator.words()}; large_deflection = false keeps the linear solution", *both]


def _vector(u: np.ndarray) -> str:
    largest = float(np.abs(u).max())
    return "(" + ", ".join(f"{0.0 if abs(c) < 1e-9 * largest else c:.5g}" for c in u) + ")"


def _failure(
    failure: SolveError | Interrupted, result: Result, indicator: Indicator | None
) -> SolveError | Interrupted:
    """The same with the last good state, and with why large deflections were computed unless they were asked for."""
    if indicator is not None and isinstance(failure, SolveError):
        return SolveError(
            f"{failure}. {indicator.words()}; large_deflection = false answers with the linear solution",
            result,
        )
    failure.state = result
    return failure
