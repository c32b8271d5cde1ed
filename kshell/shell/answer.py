"""Results of a shell: of a linear solution, of one state of large deflections, and of a path with its states."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.linear import LinearSolution
from kshell.equilibrium.path import Critical
from kshell.equilibrium.problem import State
from kshell.equilibrium.work import external_work
from kshell.mesh.mesh import Mesh
from kshell.result.deferred import Deferred
from kshell.result.probing import probe_values
from kshell.result.result import Result, no_error_estimate
from kshell.shell.fields import ShellFields
from kshell.shell.large import Trace
from kshell.shell.problem import ShellProblem
from kshell.shell.scene_reactions import find_reactions

Floats = NDArray[np.float64]

UNBALANCED = 1e-6
# strain energy against that of stretching by all of the displacement, far below the thinnest shell in bending
NO_STRAIN = 1e-18
FRAME = "projection of global x (of y where x is normal) on the tangent plane"


def answer_linear(problem: ShellProblem, solution: LinearSolution) -> Result:
    """The result of small deflections."""
    return _answer(problem, solution, small_fields(problem, solution.x), problem.loads.forces)


def answer_state(problem: ShellProblem, state: State, work: float) -> Result:
    """The result of one state of large deflections, to which the loads did some work."""
    _, residual, _ = problem.equilibrium().evaluate(state.x, state.factor, 1, state.memory)
    solution = LinearSolution(state.x, -residual, np.zeros(0), ())
    result = _answer(problem, solution, _state_fields(problem, state), problem.forces_at(state), state.x)
    # fields refer to the strains of this state, of which the energy keeps one at a time
    result.fields, result.cell_fields = dict(result.fields), dict(result.cell_fields)
    result.external_work = work
    return result


def answer_trace(problem: ShellProblem, trace: Trace) -> Result:
    """The result of the last state, with the path to it."""
    works = external_work(problem.equilibrium(), trace.states)
    result = answer_state(problem, trace.states[-1], works[-1])
    for number, state in enumerate(trace.states):
        last = number == len(trace.states) - 1
        values = result.probes if last else probes_of(problem, _state_fields(problem, state))[0]
        entry = {
            "factor": float(state.factor),
            "probes": {name: {**p, "frame": FRAME} for name, p in values.items()},
        }
        entry |= {"iterations": state.iterations, "stable": state.negative == 0}
        result.path.append(entry)
        result.series.append((state.factor, partial(answer_state, problem, state, works[number])))
    for number, (step, critical) in enumerate(trace.critical, 1):
        factor = float(critical.state.factor)
        result.critical.append({"kind": critical.kind, "factor": factor, "before_step": step})
        result.critical[-1] |= {"then": critical.then}
        mode = small_fields(problem, critical.mode)
        result.fields[f"mode_{number}"] = mode.vertex_fields["displacement"]
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
    passes = f"the load passes a {critical.kind} point at the factor {factor:.6g}"
    if critical.then == "branched":
        return f"{passes}: the path goes on along the branch that leaves there"
    if critical.then == "jumped":
        return f"{passes}: the shell jumps there to another stable state, here at the factor {after:.6g}"
    return f"{passes}: a real shell jumps there to the next stable state"


def probes_of(problem: ShellProblem, fields: ShellFields) -> tuple[dict[str, dict[str, Any]], list[str]]:
    """Values at the probes of the scene, and warnings about them."""
    return probe_values(problem.scene.probes, fields.at, problem.space, "shell")


def small_fields(problem: ShellProblem, x: Floats) -> ShellFields:
    """Fields of small displacements (unknowns,)."""
    return _fields(problem, problem.discretisation.recovery(problem.energy, x))


def _state_fields(problem: ShellProblem, state: State) -> ShellFields:
    if problem.loads.initial is not None:
        problem.energy.initial = state.factor * problem.loads.initial
    return _fields(problem, problem.discretisation.recovery(problem.energy, state.x, True, state.memory))


def _fields(problem: ShellProblem, recovery: Any) -> ShellFields:
    offset = problem.scene.offset
    patches, angles = problem.discretisation.patches()
    find = problem.locator.find
    return ShellFields(problem.space, recovery, problem.section, offset, patches, angles, find)


def _answer(
    problem: ShellProblem,
    solution: LinearSolution,
    fields: ShellFields,
    loads: list[Floats],
    moved: Floats | None = None,
) -> Result:
    """Result of any solution; forces act at places displaced by `moved`."""
    groups, balance = find_reactions(
        problem.discretisation, problem.supports, solution, loads, problem.reduction, moved
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
    probes, probe_warnings = probes_of(problem, fields)
    vertex_fields = fields.vertex_fields
    error = no_error_estimate()
    error["budget"]["algebra"] = solution.corrections[-1] if len(solution.corrections) > 1 else 0.0
    return Result(
        mesh=problem.space,
        fields=vertex_fields,
        edge_fields=Deferred({"displacement": lambda: fields.edge_displacement}),
        cell_fields=fields.cell_fields,
        unknowns=problem.reduction.basis.shape[1],
        model={"kind": "shell"},
        title=problem.scene.title,
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
        scene=problem.scene,
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


def _extremes(mesh: Mesh, fields: Mapping[str, Floats]) -> Deferred[dict[str, Any]]:
    """Largest displacement in size, and largest von Mises stress on any face, each with its vertex."""

    def extreme(values: Floats) -> dict[str, Any]:
        place = int(np.argmax(values))
        return {"value": float(values[place]), "at": mesh.points[place].tolist()}

    faces = [f"von_mises_{face}" for face in ("top", "middle", "bottom")]
    return Deferred(
        {
            "deflection": lambda: extreme(np.linalg.norm(fields["displacement"], axis=1)),
            "von_mises": lambda: extreme(np.max([fields[name] for name in faces], axis=0)),
        }
    )
