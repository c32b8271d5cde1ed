"""The plate from scene to result."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.analysis.clock import Clock, Stage, peak_memory_mb
from kshell.analysis.model_choice import choose_model
from kshell.errors import SolveError
from kshell.material.section import Section
from kshell.material.tensors import principal, von_mises
from kshell.mesh.check import plate_problems
from kshell.mesh.mesh import Mesh
from kshell.plate.domain import Domain
from kshell.plate.problem import PlateProblem, choose_element
from kshell.plate.product import strain_product
from kshell.plate.reactions import ReactionFinder
from kshell.plate.recovery import Fields
from kshell.result.deferred import Deferred
from kshell.result.probing import probe_values
from kshell.result.result import Result, no_error_estimate
from kshell.scene.options import SolveOptions
from kshell.scene.scene import Scene
from kshell.solvers import Solution, solve_system
from kshell.solvers.dense import solve_dense

Floats = NDArray[np.float64]
ROUNDED_FROM = 20_000  # unknowns from which rounding of the matrix exceeds 1e-10 of the deflection
UNBALANCED = 1e-6


def solve_plate(
    scene: Scene,
    mesh: Mesh,
    options: SolveOptions,
    progress: Stage | None = None,
    read_seconds: float = 0.0,
    why: tuple[str, ...] | None = None,
) -> Result:
    """Deflection of a Kirchhoff plate under static loads.

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
    why : tuple of str, optional
        The reasons for a plate, where they are known.

    Raises
    ------
    InputError
        If the scene cannot be a plate, or it is not held.
    SolveError
        If no answer was reached.
    """
    clock = Clock(progress, read_seconds)
    with clock.stage("assemble"):
        plate_problems(mesh)
        choice = choose_element(options, mesh)
        problem = PlateProblem(scene, mesh, choice.element)
        system = problem.system
    with clock.stage("solve"):
        solution = _solve(problem, system.fixed_load + system.load, options)
        d = problem.reduction.expand(np.asarray(solution.x, dtype=np.float64))
        if not np.isfinite(d).all():
            raise SolveError(
                "the solution is not finite: check the magnitudes of stiffness and loads", state=d
            )
    with clock.stage("recover"):
        result = _recover(scene, problem, d, solution)
    reasons = [
        *(choose_model(scene, mesh, options).reasons if why is None else why),
        choice.reason,
        "linear: only small deflections are computed",
        *(f"mesh: {note}" for note in mesh.notes),
    ]
    result.model = {
        "kind": "plate",
        "large_deflection": False,
        "element": choice.element.name,
        "order": choice.element.maxdeg,
        "reasons": reasons,
    }
    result.solver = {
        "name": solution.name,
        "why": solution.why,
        "iterations": solution.iterations,
        "seconds": {**clock.seconds},
        "peak_memory_mb": peak_memory_mb(),
    }
    return result


def _solve(problem: PlateProblem, rhs: Floats, options: SolveOptions) -> Solution:
    if problem.reduction.count == 0:
        none = np.zeros(0)
        return Solution(none, "none", "the supports hold every degree of freedom", 0, (0.0,), 0.0, 0.0)
    if problem.small and options.solver != "multigrid":
        found = solve_dense(problem.system.matrix, rhs)
        if found is not None:
            return found
    # rounding of the matrix costs quintics digits on fine meshes: residuals through strains keep them
    fine = problem.element.maxdeg > 2 and problem.reduction.count > ROUNDED_FROM
    product = strain_product(problem) if fine else None
    return solve_system(problem.assembled.matrix, rhs, problem.space, options.solver, product=product)


def _recover(scene: Scene, problem: PlateProblem, d: Floats, solution: Solution) -> Result:
    mesh = problem.mesh
    fields = Fields(problem.domain, problem.layout, problem.bending, problem.section, problem.loads, d)
    finder = ReactionFinder(
        problem.domain, problem.layout, problem.reduction, problem.supports, problem.bending
    )
    reactions = finder.find(d, problem.loads.forms, fields)
    section, domain = problem.section, problem.domain
    warnings = [*problem.warnings(), *solution.warnings]
    if reactions.balance > UNBALANCED:
        warnings.append(
            f"loads and reactions differ by {reactions.balance:.1e} of the larger: the solution has few correct "
            "digits; look for very small or very thin triangles (`kshell check`)"
        )
    probes, probe_warnings = _probes(scene, mesh, fields)
    strain_energy, work = problem.energies(np.asarray(solution.x, dtype=np.float64))
    error = no_error_estimate()
    error["budget"]["algebra"] = float(solution.energy_error)
    return Result(
        mesh=mesh,
        fields=vertex_fields(fields),
        cell_fields=_cell_fields(section, domain, fields),
        unknowns=problem.reduction.count,
        model={},
        title=scene.title,
        frame="global x, y",
        probes=probes,
        reactions=reactions.groups,
        balance=reactions.balance,
        strain_energy=strain_energy,
        external_work=work,
        evaluate=fields.at,
        error=error,
        warnings=warnings + probe_warnings,
        scene=scene,
    )


def vertex_fields(fields: Fields) -> Deferred[Floats]:
    """All fields at vertices, with stresses and principal values derived from the moments."""
    return Deferred(
        {
            "displacement": lambda: fields.vertex_displacement,
            "rotation": lambda: fields.vertex_rotation,
            "moment": lambda: fields.vertex_forces[0],
            "shear": lambda: fields.vertex_forces[1],
            "stress_top": lambda: fields.vertex_stresses[0],
            "stress_bottom": lambda: fields.vertex_stresses[1],
            "von_mises_top": lambda: von_mises(fields.vertex_stresses[0]),
            "von_mises_bottom": lambda: von_mises(fields.vertex_stresses[1]),
            "principal_moments": lambda: principal(fields.vertex_forces[0]),
        }
    )


def _cell_fields(section: Section, domain: Domain, fields: Fields) -> Deferred[NDArray[Any]]:
    mesh = domain.mesh

    def thickness() -> Floats:
        centroids = mesh.points[mesh.triangles].mean(axis=1)[:, None]
        return section.thickness(np.arange(len(mesh.triangles)), centroids)[:, 0]

    return Deferred({"thickness": thickness, "moment": lambda: fields.centroid_moments})


def _probes(scene: Scene, mesh: Mesh, fields: Fields) -> tuple[dict[str, dict[str, Any]], list[str]]:
    def evaluate(points: Floats) -> dict[str, Floats]:
        values = fields.at(points)
        values["distance"] = np.hypot(values["distance"], points[:, 2] - mesh.points[0, 2])
        return values

    return probe_values(scene.probes, evaluate, mesh, "plate")
