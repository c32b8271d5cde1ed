"""The result of a plate from its solution."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.material.section import Section
from kshell.material.tensors import principal, von_mises
from kshell.plate.domain import Domain
from kshell.plate.loads import Loads
from kshell.plate.problem import PlateProblem
from kshell.plate.reactions import ReactionFinder
from kshell.plate.recovery import Fields
from kshell.result.deferred import Deferred
from kshell.result.probing import probe_values
from kshell.result.result import Result, no_error_estimate
from kshell.solvers import Solution

Floats = NDArray[np.float64]
UNBALANCED = 1e-6


def recover(problem: PlateProblem, d: Floats, solution: Solution) -> Result:
    """Fields, probes, reactions and energies.

    Parameters
    ----------
    d : (dof,)
        Physical degrees of freedom.
    """
    mesh = problem.mesh
    fields = Fields(problem.domain, problem.layout, problem.bending, problem.section, problem.loads, d)
    finder = ReactionFinder(
        problem.domain, problem.layout, problem.reduction, problem.supports, problem.bending
    )
    reactions = finder.find(d, problem.loads.forms, fields)
    warnings = [*problem.warnings(), *solution.warnings]
    if reactions.balance > UNBALANCED:
        warnings.append(
            f"loads and reactions differ by {reactions.balance:.1e} of the larger: the solution has few correct "
            "digits; look for very small or very thin triangles (`kshell check`)"
        )

    def evaluate(points: Floats) -> dict[str, Floats]:
        values = fields.at(points)
        values["distance"] = np.hypot(values["distance"], points[:, 2] - mesh.points[0, 2])
        return values

    probes, probe_warnings = probe_values(problem.structure.probes, evaluate, mesh, "plate")
    strain_energy, work = problem.energies(np.asarray(solution.x, dtype=np.float64))
    error = no_error_estimate()
    error["budget"]["algebra"] = float(solution.energy_error)
    return Result(
        mesh=mesh,
        fields=vertex_fields(fields),
        cell_fields=_cell_fields(problem.section, problem.domain, fields),
        unknowns=problem.reduction.count,
        model={},
        title=problem.structure.title,
        frame="global x, y",
        probes=probes,
        reactions=reactions.groups,
        balance=reactions.balance,
        strain_energy=strain_energy,
        external_work=work,
        evaluate=fields.at,
        error=error,
        warnings=warnings + probe_warnings,
    )


def motion_fields(problem: PlateProblem, d: Floats) -> Deferred[Floats]:
    """Fields at vertices of a motion without loads."""
    return vertex_fields(Fields(problem.domain, problem.layout, problem.bending, problem.section, Loads(), d))


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
