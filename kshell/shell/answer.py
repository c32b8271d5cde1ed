"""Results of a shell: of a linear solution, and of one state of large deflections."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.linear import LinearSolution
from kshell.equilibrium.problem import State
from kshell.result.deferred import Deferred
from kshell.result.probing import Probed, probe_values
from kshell.result.result import Result, no_error_estimate
from kshell.result.sampled import Sampled
from kshell.shell.fields import ShellFields
from kshell.shell.group_reactions import find_reactions
from kshell.shell.problem import ShellProblem

Floats = NDArray[np.float64]

UNBALANCED = 1e-6
# strain energy against that of stretching by all of the displacement, far below the thinnest shell in bending
NO_STRAIN = 1e-18
# motion by rounding over the largest displacement that is worth saying
DRIFT = 1e-3
NODAL_VALUES = (
    "forces, moments and stresses at vertices are means over the triangles around, by their angles and as tensors in "
    "space, within each smooth piece of a sheet with one section; each piece has a row of its own there"
)
FRAME = "projection of global x (of y where x is normal) on the tangent plane"


def answer_linear(problem: ShellProblem, solution: LinearSolution) -> Result:
    """The result of small deflections."""
    return _answer(
        problem, solution, small_fields(problem, solution.x, problem.loads.initial), problem.loads.forces
    )


def answer_motion(problem: ShellProblem, x: Floats, work: float, inertia: Floats) -> Result:
    """The result of small deflections in motion, to which the loads did some work.

    Parameters
    ----------
    inertia : (unknowns,)
        Forces of inertia and damping, which act as loads.
    """
    energy, initial = problem.energy, problem.loads.initial
    strain = energy.linear_strain(x)
    stress = energy.stress(strain if initial is None else strain - initial)
    forces = energy.linear_forces(stress) - problem.load - inertia
    if problem.springs is not None:
        forces = forces + problem.springs @ x
    solution = LinearSolution(x, forces, stress, ())
    loads = [*problem.loads.forces, inertia]
    result = _answer(problem, solution, small_fields(problem, x, initial), loads, pushed=True)
    result.external_work = work
    return result


def answer_state(problem: ShellProblem, state: State, work: float, inertia: Floats | None = None) -> Result:
    """The result of one state of large deflections, to which the loads did some work.

    Parameters
    ----------
    inertia : (unknowns,), optional
        Forces of inertia and damping, which act as loads.
    """
    _, residual, _ = problem.equilibrium().evaluate(state.x, state.factor, 1, state.memory)
    loads = problem.forces_at(state)
    if inertia is not None:
        residual, loads = residual + inertia, [*loads, inertia]
    solution = LinearSolution(state.x, -residual, np.zeros(0), ())
    fields = state_fields(problem, state)
    result = _answer(problem, solution, fields, loads, state.x, pushed=inertia is not None)
    result.external_work = work
    return result


def probes_of(problem: ShellProblem, fields: ShellFields) -> Probed:
    """Values at the probes of the scene, and warnings about them."""
    return probe_values(problem.structure.probes, fields, problem.space, "shell")


def small_fields(problem: ShellProblem, x: Floats, initial: Floats | None = None) -> ShellFields:
    """Fields of small displacements (unknowns,), with strains without stress (triangle, r)."""
    recovery = problem.discretisation.recovery(problem.energy, x, initial=initial)
    return _fields(problem, recovery, None if initial is None else 1.0)


def state_fields(problem: ShellProblem, state: State) -> ShellFields:
    """Fields of a state of finite deformation."""
    initial = problem.loads.initial
    if initial is not None:
        initial = state.factor * initial
    recovery = problem.discretisation.recovery(problem.energy, state.x, True, state.memory, initial)
    return _fields(problem, recovery, state.factor)


def _fields(problem: ShellProblem, recovery: Any, warmed: float | None) -> ShellFields:
    """`warmed`: by what part of the temperatures; None where they do not act."""
    left = None if warmed is None or not problem.loads.warmth else problem.left_stress(warmed)
    offset = problem.structure.offset
    _, angles = problem.discretisation.patches()
    find, pieces, rows = problem.locator.find, problem.pieces, problem.rows
    return ShellFields(problem.space, recovery, problem.section, offset, pieces, rows, angles, find, left)


def _answer(
    problem: ShellProblem,
    solution: LinearSolution,
    fields: ShellFields,
    loads: list[Floats],
    moved: Floats | None = None,
    pushed: bool = False,
) -> Result:
    """Result of any solution; forces act at places displaced by `moved`; `pushed`: others than loads act, too."""
    initial, energy = problem.loads.initial, problem.energy
    held_back = None if initial is None else energy.linear_forces(energy.stress(initial))
    points = [
        placed.place.members
        for placed in problem.structure.loads
        if placed.place is not None and placed.place.dimension == 0
    ]
    groups, balance, along = find_reactions(
        problem.discretisation,
        problem.supports,
        solution,
        loads,
        problem.reduction,
        moved,
        held_back,
        np.concatenate(points) if points else None,
    )
    energies = _energies(problem, fields.recovery, solution)
    largest = float(np.abs(solution.x / problem.discretisation.unknown_sizes()).max())
    stretch = problem.energy.section.membrane.max() * largest**2
    if sum(energies.values()) <= NO_STRAIN * stretch and not pushed:
        balance = 0.0  # moved along without strain: all forces are rounding
    warnings = problem.warnings()
    if balance > UNBALANCED:
        warnings.append(
            f"loads and reactions differ by {balance:.1e} of the larger: {problem.discretisation.unbalanced()}"
        )
    warnings += _drift_warning(problem, solution, fields)
    probed = probes_of(problem, fields)
    error = no_error_estimate()
    error["budget"]["algebra"] = solution.corrections[-1] if len(solution.corrections) > 1 else 0.0
    return Result(
        mesh=problem.space,
        fields=fields.vertex_fields,
        rows=fields.rows,
        nodal_values=NODAL_VALUES,
        edge_fields=Deferred({"displacement": lambda: fields.edge_displacement}),
        cell_fields=fields.cell_fields,
        unknowns=problem.reduction.basis.shape[1],
        model={"kind": "shell"},
        title=problem.structure.title,
        frame=FRAME,
        probes=probed.values,
        sheets=probed.sheets,
        probe_triangles=probed.triangles,
        probe_motions=probed.motions,
        reactions=groups,
        along_supports=along,
        balance=balance,
        strain_energy=sum(energies.values()),
        energies=energies,
        external_work=_work(problem, solution),
        evaluate=fields.at,
        sampled=Sampled(fields.sampled),
        error=error,
        warnings=warnings + probed.warnings,
    )


def _drift_warning(problem: ShellProblem, solution: LinearSolution, fields: ShellFields) -> list[str]:
    """Of a shell that hangs on springs so soft that the rounding of its loads moves it."""
    if not problem.hanging:
        return []
    springs = 0.0 if problem.springs is None else problem.springs @ solution.x
    inside = solution.forces + problem.load - springs  # of the stresses
    forces = np.maximum(np.abs(inside), np.abs(problem.load))
    drift = max(part.moved_by_rounding(forces) for part in problem.hanging)
    largest = float(np.linalg.norm(fields.vertex_fields["displacement"], axis=1).max())
    if drift <= DRIFT * largest:
        return []
    return [
        f"springs alone keep the shell in place, so soft that rounding of its loads may move it by about {drift:.1g} "
        f"as a whole, of displacements up to {largest:.3g}; strains and stresses are right. Hold six freedoms, or take "
        "stiffer springs"
    ]


def _energies(problem: ShellProblem, recovery: Any, solution: LinearSolution) -> dict[str, float]:
    membrane, bending = (float(part.sum()) for part in recovery.energies())
    out = {"membrane": membrane, "bending": bending}
    if problem.springs is not None:
        out["springs"] = 0.5 * float(solution.x @ (problem.springs @ solution.x))
    return out


def _work(problem: ShellProblem, solution: LinearSolution) -> float:
    """Of loads and of prescribed motion, applied slowly."""
    return 0.5 * float(problem.load @ solution.x + solution.forces @ problem.reduction.given)
