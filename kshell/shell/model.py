"""The shell from scene to result."""

from __future__ import annotations

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
from kshell.shell.fields import ShellFields
from kshell.shell.linear import LinearSolution, solve_linear
from kshell.shell.problem import ShellProblem
from kshell.shell.scene_reactions import find_reactions

Floats = NDArray[np.float64]

UNBALANCED = 1e-6
# strain energy against that of stretching by all of the displacement, far below the thinnest shell in bending
NO_STRAIN = 1e-18
FRAME = "projection of global x (of y where x is normal) on the tangent plane"


def solve_shell(
    scene: Scene, mesh: Mesh, options: SolveOptions, progress: Stage | None = None, read_seconds: float = 0.0
) -> Result:
    """Small deflections of a Koiter shell under static loads.

    Parameters
    ----------
    scene : Scene
    mesh : Mesh
        Of the scene, as read.
    options : SolveOptions
    progress : function, optional
        Called with the name of each stage: assemble, solve, recover.
    read_seconds : float
        Time already spent on reading.

    Raises
    ------
    InputError
        If the scene does not fit, or the shell is not held.
    SolveError
        If no answer was reached.
    """
    clock = Clock(progress, read_seconds)
    if options.solver == "multigrid":
        raise InputError('solver = "multigrid" is for plates: shells are solved with "direct" or "auto"')
    with clock.stage("assemble"):
        choice: ModelChoice = choose_model(scene, mesh, options)
        problem = ShellProblem(scene, mesh, choice)
    with clock.stage("solve"):
        solution = solve_linear(problem.energy, problem.load, problem.reduction, problem.springs)
        if not np.isfinite(solution.x).all():
            raise SolveError(
                "the solution is not finite: check the magnitudes of stiffness and loads", state=solution.x
            )
    with clock.stage("recover"):
        result = _recover(scene, problem, solution)
    result.model = {
        "kind": "shell",
        "large_deflection": False,
        "element": choice.element,
        "order": choice.order,
        "reasons": [*problem.reasons(), *(f"mesh: {note}" for note in mesh.notes)],
    }
    result.solver = {
        "name": "direct",
        "why": "shells are factorised",
        "iterations": len(solution.corrections),
        "seconds": {**clock.seconds},
        "peak_memory_mb": peak_memory_mb(),
    }
    return result


def _recover(scene: Scene, problem: ShellProblem, solution: LinearSolution) -> Result:
    discretisation = problem.discretisation
    recovery = discretisation.recovery(problem.energy, solution.x)
    fields = ShellFields(problem.space, recovery, problem.section, scene.offset, *discretisation.patches())
    groups, balance = find_reactions(discretisation, problem.supports, solution, problem.loads.forces)
    energies = _energies(problem, recovery, solution)
    stretch = problem.energy.section.membrane.max() * np.abs(solution.x).max() ** 2
    if sum(energies.values()) <= NO_STRAIN * stretch:
        balance = 0.0  # moved along without strain: all forces are rounding
    warnings = problem.warnings()
    if balance > UNBALANCED:
        warnings.append(
            f"loads and reactions differ by {balance:.1e} of the larger: the solution has few correct digits; look "
            "for very small or very thin triangles (`kshell check`), or a shell that is hardly held"
        )
    probes, probe_warnings = probe_values(scene.probes, fields.at, problem.space, "shell")
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
