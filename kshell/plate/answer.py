"""The result of a plate from its solution."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.material.section import Section
from kshell.material.tensors import principal, von_mises
from kshell.mesh.mesh import Mesh
from kshell.plate.assembly import Part, residual
from kshell.plate.loads import Loads
from kshell.plate.problem import PlateProblem
from kshell.plate.reactions import ReactionFinder
from kshell.plate.recovery import Fields
from kshell.plate.sampled import sampled
from kshell.result.deferred import Deferred
from kshell.result.probing import probe_values
from kshell.result.result import Result, no_error_estimate
from kshell.result.sampled import Sampled
from kshell.solvers import Solution

Floats = NDArray[np.float64]
UNBALANCED = 1e-6
NODAL_VALUES = (
    "moments, shear forces and stresses at vertices are means over the triangles around, by area, within each piece "
    "between lines across which moments may jump; each piece has a row of its own there"
)


def recover(problem: PlateProblem, d: Floats, solution: Solution) -> Result:
    """Fields, probes, reactions and energies.

    Parameters
    ----------
    d : (dof,)
        Physical degrees of freedom.
    """
    energies = problem.energies(np.asarray(solution.x, dtype=np.float64))
    result = _recovered(problem, d, energies, list(solution.warnings))
    result.error["budget"]["algebra"] = float(solution.energy_error)
    return result


def recover_motion(
    problem: PlateProblem, d: Floats, energies: tuple[float, float], inertia: Floats
) -> Result:
    """The same of a plate in motion.

    Parameters
    ----------
    energies : tuple of float
        Strain energy, and the work of loads up to there.
    inertia : (dof,)
        Forces of inertia and damping, which act as loads.
    """
    return _recovered(problem, d, energies, [], inertia)


def _recovered(
    problem: PlateProblem,
    d: Floats,
    energies: tuple[float, float],
    warnings: list[str],
    inertia: Floats | None = None,
) -> Result:
    mesh = problem.mesh
    fields = problem.fields(d)
    finder = ReactionFinder(
        problem.domain, problem.layout, problem.reduction, problem.supports, problem.bending, problem.shared
    )
    reactions = finder.find(d, problem.loads.forms, fields, inertia)
    warnings = [*problem.warnings(), *warnings]
    if problem.hanging:
        warnings += problem.drift(
            float(np.abs(fields.vertex_displacement).max()), problem.loads, reactions.left
        )
    if reactions.balance > UNBALANCED:
        warnings.append(
            f"loads and reactions differ by {reactions.balance:.1e} of the larger: the solution has few correct "
            "digits; look for very small or very thin triangles (`kshell check`)"
        )

    probed = probe_values(problem.structure.probes, Above(fields, mesh), mesh, "plate")
    strain_energy, work = energies
    springs = [form for _, form in problem.supports.springs]
    parts = {}
    if springs:
        whole = Part(problem.domain, problem.every)
        parts["springs"] = 0.5 * float(d @ residual(springs, [], problem.reduction, d, whole))
        parts["bending"] = strain_energy - parts["springs"]
    return Result(
        mesh=mesh,
        fields=vertex_fields(fields),
        rows=fields.rows,
        nodal_values=NODAL_VALUES,
        cell_fields=cell_fields(problem.section, fields),
        unknowns=problem.reduction.count,
        model={},
        title=problem.structure.title,
        frame="global x, y",
        probes=probed.values,
        sheets=probed.sheets,
        probe_triangles=probed.triangles,
        probe_motions=probed.motions,
        reactions=reactions.groups,
        along_supports=reactions.along,
        balance=reactions.balance,
        strain_energy=strain_energy,
        energies=parts,
        external_work=work,
        evaluate=fields.all_at,
        sampled=Sampled(partial(sampled, fields)),
        error=no_error_estimate(),
        warnings=warnings + probed.warnings,
    )


class Above:
    """Values of a plate at points in space, whose distance counts along z, too."""

    def __init__(self, fields: Fields, mesh: Mesh) -> None:
        self.fields, self.height = fields, float(mesh.points[0, 2])

    @property
    def has_sheets(self) -> bool:
        """Whether moments or stresses may differ between the sides of a line."""
        return self.fields.lines.may_jump

    def at(self, points: Floats) -> dict[str, Floats]:
        """At the nearest points."""
        return self._measured(self.fields.at(points), points)

    def motion(self, points: Floats) -> Floats:
        """(n, 3) the displacement u of `at` alone."""
        return self.fields.motion(points)

    def on(self, points: Floats, group: str) -> dict[str, Floats]:
        """At the nearest points of a surface group."""
        return self._measured(self.fields.values_at(self.fields.lines.on(points, group)), points)

    def sheets(self, point: Floats) -> dict[str, dict[str, Any]]:
        """At one point on every side of a line."""
        sides = self.fields.lines.each_side(np.asarray(point, dtype=float))
        names = self.fields.rows.names_of([triangle for triangle, _ in sides])
        values = [self.fields.values_at(found) for _, found in sides]
        out = {
            name: {key: part[0] for key, part in each.items()}
            for name, each in zip(names, values, strict=True)
        }
        return out if len(out) > 1 else {}

    def _measured(self, values: dict[str, Floats], points: Floats) -> dict[str, Floats]:
        values["distance"] = np.hypot(values["distance"], points[:, 2] - self.height)
        return values


def motion_at(problem: PlateProblem, d: Floats, points: Floats) -> Floats:
    """(n, 3) displacement of a motion without loads at points (n, 3)."""
    fields = Fields(problem.domain, problem.layout, problem.bending, problem.section, Loads(), d)
    return np.asarray(fields.at(points)["u"])


def motion_fields(problem: PlateProblem, d: Floats) -> Deferred[Floats]:
    """Fields at vertices of a motion without loads."""
    return vertex_fields(Fields(problem.domain, problem.layout, problem.bending, problem.section, Loads(), d))


def vertex_fields(fields: Fields) -> Deferred[Floats]:
    """All fields at the rows of vertices, with stresses and principal values derived from the moments."""
    vertex = fields.rows.vertex
    makers: dict[str, Callable[[], Floats]] = {
        "displacement": lambda: fields.vertex_displacement[vertex],
        "rotation": lambda: fields.vertex_rotation[vertex],
        "moment": lambda: fields.fan_forces[0],
        "shear": lambda: fields.fan_forces[1],
    }
    if fields.section.has_stress:
        makers |= {
            "stress_top": lambda: fields.fan_stresses[0],
            "stress_bottom": lambda: fields.fan_stresses[1],
            "von_mises_top": lambda: von_mises(fields.fan_stresses[0]),
            "von_mises_bottom": lambda: von_mises(fields.fan_stresses[1]),
        }
    return Deferred({**makers, "principal_moments": lambda: principal(fields.fan_forces[0])})


def cell_fields(section: Section, fields: Fields) -> Deferred[NDArray[Any]]:
    """Thickness of triangles and moments in their middles."""
    return Deferred(
        {"thickness": lambda: section.thickness_per_triangle, "moment": lambda: fields.centroid_moments}
    )
