"""Reactions of the supports, concentrated corner forces, and the check of equilibrium.

The residual K d - f of the degrees of freedom that supports hold is the work of the reactions on unit
motions; on rigid motions it gives forces and moments without any differentiation of the solution.
"""

from __future__ import annotations

from collections.abc import MutableMapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.plate.along_supports import AlongSupports
from kshell.plate.assembly import Part, residual, works
from kshell.plate.corner_forces import CornerForces
from kshell.plate.domain import Domain, EdgePatch
from kshell.plate.forms import Bending, Form, edge_rows
from kshell.plate.held import Supports
from kshell.plate.layout import Layout
from kshell.plate.line_forces import LineForces, Lines
from kshell.plate.linear_form import LinearForm, Scaled
from kshell.plate.recovery import Fields
from kshell.plate.reduction import Reduction
from kshell.plate.rigid import rigid_motions
from kshell.plate.shared_vertices import rows_of_groups, shared_at
from kshell.result.deferred import Deferred

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Reactions:
    """Forces of the supports on the plate.

    Attributes
    ----------
    groups : dict of label to dict
        force (3,), moment (3,) about the origin of the coordinates, corners: concentrated forces at corners
        of the plate, part of force.
    balance : float
        What loads and reactions leave over, relative to the largest of them.
    left : float
        The same as a force.
    along : dict of label to dict
        Their distribution along lines.
    """

    groups: dict[str, MutableMapping[str, Any]]
    balance: float
    left: float = 0.0
    along: MutableMapping[str, dict[str, Any]] = field(default_factory=dict)


class ReactionFinder:
    """Collects reactions group by group."""

    def __init__(
        self,
        domain: Domain,
        layout: Layout,
        reduction: Reduction,
        supports: Supports,
        bending: Bending,
        kept: dict[Any, Any] | None = None,
    ) -> None:
        """`kept` has what only depends on where supports are, for further loads."""
        self.kept = {} if kept is None else kept
        self.domain, self.layout, self.reduction, self.supports = domain, layout, reduction, supports
        self.bending = bending
        self.forms: list[Form] = [
            bending,
            *[form for _, form in [*supports.springs, *supports.holds]],
            *supports.ties,
        ]
        mesh = domain.mesh
        self.centre = 0.5 * (domain.points.min(axis=0) + domain.points.max(axis=0))
        self.size = float(np.abs(domain.points - self.centre).max())
        held = np.zeros(len(mesh.points), dtype=bool)
        for group in supports.held:
            held[group.vertices] = True
            held[mesh.edges[group.edges]] = True
        if "at supports" not in self.kept:
            near = np.flatnonzero(held[mesh.triangles].any(axis=1)).astype(np.int64)
            self.kept["at supports"] = Part(domain, near)
        self.near: Part = self.kept["at supports"]

    def find(
        self, d: Floats, loads: Sequence[Scaled], fields: Fields, inertia: Floats | None = None
    ) -> Reactions:
        """Reactions of a solution with physical degrees of freedom d; inertia (dof,) acts as a load."""
        r = residual(self.forms, self.supports.hold_loads, self.reduction, d, self.near)
        r -= self._pushing(loads)
        pushed = np.zeros(3)
        if inertia is not None:
            r = r - inertia
            pushed = self._rigid_everywhere().T @ inertia
        slopes = self.reduction.slaves.released(r)  # at curved edges
        totals: dict[str, Floats] = {}
        shared = self._shared(r)
        for number, group in enumerate(self.supports.held):
            total = self._at_vertices(r, number, shared) + self._at_edges(r, slopes, group.edges)
            totals[group.label] = totals.get(group.label, np.zeros(3)) + total
        # what springs, and the consistency terms of curved edges, exert over the plate's own residual
        for label, form in [*self.supports.springs, *self.supports.holds]:
            totals[label] = totals.get(label, np.zeros(3)) + self._spring_force(form, d)
        for load in self.supports.hold_loads:
            label = next(name for name, form in self.supports.holds if form is load.hold)
            totals[label] = totals[label] + self._rigid_work(load)
        corners = CornerForces(
            self.domain, self.reduction, self.supports, self.bending, loads, fields, self.kept
        )
        groups = {label: self._document(label, total, corners) for label, total in totals.items()}
        along = self._along(d, loads, totals, inertia)
        return Reactions(groups, *self._balance(totals, loads, d, pushed), along)

    def _pushing(self, loads: Sequence[Scaled]) -> Floats:
        """(dof,) the work of loads on the triangles at supports."""
        out, key = np.zeros(self.layout.count), ("works", self.near.where.tobytes())
        for load in loads:
            dofs, work = load.once(key, partial(self._work_there, load.alone))
            out[dofs] += load.factor * work
        return out

    def _work_there(self, load: Scaled) -> tuple[Ints, Floats]:
        """Degrees of freedom, and the work of a load on them."""
        found = works(load, self.layout, self.near)
        dofs = np.flatnonzero(found)
        return dofs, found[dofs]

    def _along(
        self, d: Floats, loads: Sequence[Scaled], totals: dict[str, Floats], inertia: Floats | None
    ) -> MutableMapping[str, dict[str, Any]]:
        """What the supports exert along their lines, found when it is looked at."""
        domain, supports = self.domain, self.supports
        springs = [form for _, form in supports.springs]

        def find(lines: Lines) -> LineForces:
            # without what holds curved edges: that is the supports', too
            forms = [self.bending, *springs, *supports.ties]
            r = residual(forms, [], self.reduction, d, self.near) - self._pushing(loads)
            if inertia is not None:
                r = r - inertia
            wanted = np.sum([np.zeros(3), *totals.values()], axis=0)
            for form in springs:
                wanted = wanted - self._spring_force(form, d)
            return LineForces(domain, self.layout, lines, r, self.centre, wanted)

        def moved(patch: EdgePatch, slope: bool) -> Floats:
            affine, element = domain.affine(patch.triangles), self.layout.element
            transform = element.transformation(affine)
            rows = edge_rows(element, affine, patch, slice(None), slope, transform)[:, :, 0]
            return np.asarray((rows @ d[self.layout.triangle_dofs(patch.triangles)][:, :, None])[..., 0])

        return AlongSupports(
            domain, supports, lambda: Lines(domain, supports, loads), find, moved
        ).documents()

    def _shared(self, r: Floats) -> dict[int, dict[int, Floats]]:
        """Work (per_vertex,) that falls to each group, by its number, at vertices that several groups hold."""
        if "rows of supports" not in self.kept:
            self.kept["rows of supports"] = rows_of_groups(
                self.domain, self.layout, self.reduction, self.supports
            )
        known: dict[int, tuple[Floats, Ints]] = self.kept["rows of supports"]
        return {v: shared_at(v, *of_groups, r, self.layout, self.reduction) for v, of_groups in known.items()}

    def _at_vertices(self, r: Floats, number: int, shared: dict[int, dict[int, Floats]]) -> Floats:
        """Force along z and moments about x, y through the centre."""
        vertices = self.supports.held[number].vertices
        work = r[self.layout.vertex_dofs(vertices)]
        for k, v in enumerate(vertices.tolist()):
            if v in shared:
                work[k] = shared[v].get(number, 0.0)
        arm = self.domain.points[vertices] - self.centre
        total = np.array([work[:, 0].sum(), (work[:, 0] * arm[:, 1]).sum(), -(work[:, 0] * arm[:, 0]).sum()])
        if self.layout.per_vertex > 1:
            total[1] += work[:, 2].sum()
            total[2] -= work[:, 1].sum()
        return total

    def _at_edges(self, r: Floats, slopes: Floats, edges: Ints) -> Floats:
        """Moments of held slopes; an edge in several groups is shared."""
        if not len(edges):
            return np.zeros(3)
        key = "edges held", edges.tobytes()
        if key not in self.kept:
            self.kept[key] = self._weights_and_normals(edges)
        weight, normal, bent = self.kept[key]
        moment = r[self.layout.edge_dofs(edges)] * weight
        if bent.any():
            total = np.bincount(self.reduction.slaves.edges, slopes, len(self.domain.mesh.edges))
            moment[bent] = total[edges[bent]] * weight[bent]
        return np.array([0.0, (moment * normal[:, 1]).sum(), -(moment * normal[:, 0]).sum()])

    def _weights_and_normals(self, edges: Ints) -> tuple[Floats, Floats, NDArray[np.bool_]]:
        """(n,) the share of a group in edges it holds, (n, 2) their normals, and (n,) whether they are bent."""
        count = sum(np.isin(edges, other.edges).astype(float) for other in self.supports.held)
        ends = self.domain.points[self.domain.mesh.edges[edges]]
        t = (ends[:, 1] - ends[:, 0]) / self.domain.mesh.edge_lengths[edges][:, None]
        normal = np.stack([t[:, 1], -t[:, 0]], axis=1)
        bent = np.isin(edges, self.reduction.slaves.edges)
        if bent.any():
            patch = self.domain.edge_points(edges[bent], np.array([0.5]), np.ones(1))
            normal[bent] = patch.normal[:, 0]
        return 1.0 / np.maximum(count, 1.0), normal, bent

    def _spring_force(self, form: Form, d: Floats) -> Floats:
        """What springs exert on the plate: minus their stiffness times the motion, on rigid motions."""
        total = np.zeros(3)
        for positions, triangles in form.blocks():
            affine = self.domain.affine(triangles)
            m = self.layout.element.transformation(affine)
            dofs = d[self.layout.triangle_dofs(triangles)]
            rigid = self._rigid(triangles)
            both = np.concatenate([m @ rigid, m @ dofs[:, :, None]], axis=2)
            total -= form.matrices(positions, both)[:, :3, 3].sum(axis=0)
        return total

    def _rigid_work(self, load: LinearForm) -> Floats:
        """Work of a load on the three rigid motions."""
        total = np.zeros(3)
        for positions, triangles in load.blocks():
            m = self.layout.element.transformation(self.domain.affine(triangles))
            total += load.vectors(positions, m @ self._rigid(triangles)).sum(axis=0)
        return total

    def _rigid(self, triangles: Ints) -> Floats:
        """(n, local, 3) degrees of freedom of w = 1, y - y0, -(x - x0)."""
        b = self.layout.per_vertex
        affine = self.domain.affine(triangles)
        out = np.zeros((len(triangles), self.layout.element.count, 3))
        for v in range(3):
            arm = affine.corners[:, v] - self.centre
            out[:, b * v, 0] = 1.0
            out[:, b * v, 1], out[:, b * v, 2] = arm[:, 1], -arm[:, 0]
            if b > 1:
                out[:, b * v + 2, 1], out[:, b * v + 1, 2] = 1.0, -1.0
        out[:, 3 * b :, 1] = affine.normals[..., 1]
        out[:, 3 * b :, 2] = -affine.normals[..., 0]
        return out

    def _rigid_everywhere(self) -> Floats:
        every = np.arange(len(self.domain.mesh.triangles))
        return rigid_motions(self.domain, self.layout, self.centre, every)

    def _document(self, label: str, total: Floats, corners: CornerForces) -> MutableMapping[str, Any]:
        force, mx, my = total
        # from the centre to the origin of the coordinates: M + r x F
        moment = np.array([mx + self.centre[1] * force, my - self.centre[0] * force, 0.0])
        out: dict[str, Any] = {"force": np.array([0.0, 0.0, force]), "moment": moment}
        mine = [k for k, corner in enumerate(corners.corners) if label in corner.groups]
        if not mine:
            return out
        points = self.domain.mesh.points

        def concentrated() -> list[dict[str, Floats]]:
            return [
                {"at": points[corners.corners[k].vertex], "force": np.array([0.0, 0.0, corners.forces[k]])}
                for k in mine
            ]

        return Deferred(
            {"force": lambda: out["force"], "moment": lambda: out["moment"], "corners": concentrated}
        )

    def _balance(
        self, totals: dict[str, Floats], loads: Sequence[Scaled], d: Floats, pushed: Floats
    ) -> tuple[float, float]:
        """Error of equilibrium of forces, and of moments about the centre, relative to what acts, and as it is.

        Where no load acts, relative to the forces that would bend the plate by as much as it moves: one that is only
        lifted has reactions of rounding.
        """
        scale = np.array([1.0, 1.0 / self.size, 1.0 / self.size])
        parts = [load.resultant(self.centre) * scale for load in loads]
        parts += [total * scale for total in [*totals.values(), pushed]]
        gross = [load.gross(self.size) for load in loads] or [self._bending_force(d)]
        largest = max(float(np.abs(parts).max()), *gross, 1e-300)
        left = float(np.abs(np.sum(parts, axis=0)).max())
        return left / largest, left

    def _bending_force(self, d: Floats) -> float:
        """D w / size^2 with the largest stiffness and deflection."""
        mesh = self.domain.mesh
        every, centres = np.arange(len(mesh.triangles)), self.domain.points[mesh.triangles].mean(axis=1)
        deflection = d[: self.layout.per_vertex * len(mesh.points) : self.layout.per_vertex]
        stiffness = np.abs(self.bending.at(every, centres[:, None])).max()
        return float(stiffness * np.abs(deflection).max() / self.size**2)
