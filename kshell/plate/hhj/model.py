"""The plate with this element as analyses need it."""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import ClassVar, Literal

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.elements.morley import ElementMorley
from kshell.equilibrium.model import Model, Solved
from kshell.errors import InputError, SolveError
from kshell.mesh.distinct import distinct
from kshell.mesh.words import place
from kshell.plate.answer import NODAL_VALUES, UNBALANCED, Above, cell_fields, vertex_fields
from kshell.plate.hhj import translate
from kshell.plate.hhj.arcs import Arcs
from kshell.plate.hhj.geometry import Triangles
from kshell.plate.hhj.recovery import HHJFields, reactions, work_of_supports
from kshell.plate.hhj.state import HHJSolution
from kshell.plate.hhj.system import HHJSystem
from kshell.plate.loads import Loads
from kshell.plate.problem import PlateProblem
from kshell.plate.rims import edge_curves
from kshell.plate.sampled import sampled
from kshell.result.deferred import Deferred
from kshell.result.probing import probe_values
from kshell.result.result import Result, no_error_estimate
from kshell.result.sampled import Sampled
from kshell.scene.loads import Load
from kshell.scene.placed import Placed
from kshell.scene.structure import Structure

Floats = NDArray[np.float64]


class HHJModel(Model):
    """A Kirchhoff plate; x are w at vertices, bubbles of w and slopes of the edges.

    Parameters
    ----------
    structure : Structure
        Its mesh in a plane of constant z.
    order : int
    reasons : sequence of str
        Why this model.

    Raises
    ------
    InputError
        If a support, load, material or thickness does not fit, or the plate is not held.
    """

    kind: ClassVar[Literal["plate", "shell"]] = "plate"
    element = "hhj"

    def __init__(self, structure: Structure, order: int, reasons: Sequence[str] = ()) -> None:
        self.structure, self.order, self.reasons = structure, order, list(reasons)
        # reads the scene's words, and is never assembled
        self.problem = PlateProblem(structure, ElementMorley(), curved=True, reduced=False)
        _require_straight_lines(self.problem)
        if not structure.section.constant_per_triangle:
            raise InputError(
                "the thickness varies inside triangles: the element hhj takes one thickness per group; use "
                'element = "argyris"'
            )
        domain = self.problem.domain
        curved = len(domain.curved_triangles) > 0
        self.triangles = Triangles(self.problem.mesh, domain if curved else None)
        forms = translate.of_order(self.problem.loads.forms, order, curved)
        self.loads: Loads = replace(self.problem.loads, forms=forms)
        self._systems: dict[str, HHJSystem] = {}
        self._held = translate.held(self.triangles, order, self.problem.supports)
        if self._held.values is not None:
            _ = self.problem.reduction  # finds values that contradict each other
        degree = translate.load_degree(self.loads.forms)
        self.arcs = Arcs(self.triangles, order, self._held.slopes, degree) if curved else None

    def system(self, solver: str = "auto") -> HHJSystem:
        """The factorised system, made once for each solver.

        Raises
        ------
        SolveError
            If it is singular.
        """
        if solver == "multigrid":
            raise InputError('solver = "multigrid" is for Morley and Argyris plates: leave it out')
        method = "direct" if solver == "auto" else solver
        if method not in self._systems:
            springs = translate.springs(self.triangles, self.order, self.problem.supports, self.arcs)
            stiffness = translate.bending_stiffness(self.structure.section)
            self._systems[method] = HHJSystem(
                self.triangles, self.order, stiffness, self._held, springs, method, self.arcs
            )
        return self._systems[method]

    @property
    def unknowns(self) -> int:
        return self.system().count

    def warnings(self) -> list[str]:
        return self.problem.warnings(self.loads)

    def warmth(self) -> list[Placed[Load]]:
        return [placed for _, placed in self.loads.warmth]

    def stiffness(self) -> sp.csr_matrix:
        return self.system().matrix()

    def product(self) -> Callable[[Floats], Floats]:
        return self.system().product

    def load_vectors(self) -> Floats:
        system = self.system()
        vectors = [
            system.condensed(translate.load(system, self.loads.of(number)))
            for number in range(len(self.structure.loads))
        ]
        return np.array(vectors).reshape(len(vectors), self.unknowns)

    def motion_vector(self) -> Floats:
        system = self.system()
        return -system.product_of(system.numbering.given(self._held))

    def expand(self, q: Floats) -> Floats:
        return self.system().numbering.scatter(q)

    def under(self, factors: Sequence[float], motion: float = 1.0) -> HHJModel:
        out = copy.copy(self)
        out.loads = self.loads.times(factors)
        out._held = self._held.times(motion)
        return out

    def prepare(self) -> None:
        self.system()

    def solve(self, solver: str = "auto") -> Solved:
        system = self.system(solver)
        found = system.solve(translate.load(system, self.loads.forms), self._held)
        if not np.isfinite(found.unknowns).all():
            raise SolveError(
                "the solution is not finite: check the magnitudes of stiffness and loads",
                state=found.unknowns,
            )
        why = f"{system.count} unknowns, the rest eliminated triangle by triangle"
        return Solved(found.unknowns, system.solver_name, why, len(found.corrections) - 1, found)

    def recover(self, solved: Solved) -> Result:
        found: HHJSolution = solved.own
        system, problem, mesh = self.system(), self.problem, self.problem.mesh
        fields = HHJFields(problem, self.loads, system, found)
        forces = reactions(problem, self.loads, system, found, fields)
        warnings = self.warnings()
        if problem.hanging:
            warnings += problem.drift(
                float(np.abs(fields.vertex_displacement).max()), self.loads, forces.left
            )
        if forces.balance > UNBALANCED:
            warnings.append(
                f"loads and reactions differ by {forces.balance:.1e} of the larger: the solution has few correct "
                "digits; look for very small or very thin triangles (`kshell check`)"
            )

        probed = probe_values(self.structure.probes, Above(fields, mesh), mesh, "plate")
        error = no_error_estimate()
        error["budget"]["algebra"] = found.corrections[-1]
        energies = {}
        if system.springs:
            energies = {"springs": system.spring_energy(found)}
            energies["bending"] = system.energy(found) - energies["springs"]
        return Result(
            mesh=mesh,
            fields=vertex_fields(fields),
            rows=fields.rows,
            nodal_values=NODAL_VALUES,
            cell_fields=cell_fields(problem.section, fields),
            unknowns=system.count,
            model={},
            title=self.structure.title,
            frame="global x, y",
            probes=probed.values,
            sheets=probed.sheets,
            probe_triangles=probed.triangles,
            probe_motions=probed.motions,
            reactions=forces.groups,
            along_supports=forces.along,
            balance=forces.balance,
            strain_energy=system.energy(found),
            energies=energies,
            external_work=0.5 * (found.work + work_of_supports(system, found)),
            evaluate=fields.all_at,
            sampled=Sampled(partial(sampled, fields)),
            error=error,
            warnings=warnings + probed.warnings,
        )

    def motion_fields(self, x: Floats) -> Deferred[Floats]:
        system = self.system()
        return vertex_fields(HHJFields(self.problem, Loads(), system, system.motion(x)))


def _require_straight_lines(problem: PlateProblem) -> None:
    """Refuse supports along curved lines inside, which this element would hold on chords."""
    mesh = problem.mesh
    for group in problem.supports.held:
        edges = distinct(len(mesh.edges), group.line, group.edges)
        inside = edges[mesh.edge_counts[edges] > 1].astype(np.int32)
        if not len(inside):
            continue
        curves = edge_curves(mesh, inside)
        if curves.curved.any():
            bent = curves.edges[int(np.abs(curves.shape).max(axis=(1, 2)).argmax())]
            raise InputError(
                f"support on '{group.label}': the line is curved near "
                f"{place(mesh.points[mesh.edges[bent]].mean(axis=0))} and lies inside the plate: the element hhj "
                "follows curved edges of the plate only, and on chords a held line would hold the slope, too, in the "
                'limit; use element = "argyris"'
            )
