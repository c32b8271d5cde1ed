"""Deflection, rotation, moments, shear forces and stresses of a solution, and the reactions of its supports.

Moments M = -m are those of the element, in equilibrium with the loads; shear forces are their divergence. At
vertices both are means over the triangles around, by area.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from itertools import permutations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.elements.hierarchic import orthonormal
from kshell.mesh.distinct import distinct
from kshell.mesh.mesh import Mesh
from kshell.plate.along_supports import AlongSupports
from kshell.plate.domain import EdgePatch
from kshell.plate.held import HeldGroup
from kshell.plate.hhj.along import HHJLineForces
from kshell.plate.hhj.finer import FinerDeflection
from kshell.plate.hhj.state import HHJSolution
from kshell.plate.hhj.system import HHJSystem
from kshell.plate.line_forces import Lines
from kshell.plate.loads import Loads
from kshell.plate.problem import PlateProblem
from kshell.plate.reactions import Reactions
from kshell.plate.recovery import Fields

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

ALONG = np.array([0.2, 0.5, 0.8])  # of edges, where deflections of their triangles are compared


class HHJFields(Fields):
    """Everything that can be read off a solution.

    Parameters
    ----------
    problem : PlateProblem
        That the words of the scene were read for.
    system : HHJSystem
    solution : HHJSolution
    """

    def __init__(self, problem: PlateProblem, loads: Loads, system: HHJSystem, solution: HHJSolution) -> None:
        super().__init__(
            problem.domain, problem.layout, problem.bending, problem.section, loads, solution.unknowns
        )
        self.system, self.solution = system, solution
        self.polynomial_moments, self.smooth = True, False
        arcs = system.arcs
        self.local = solution.local if arcs is None else arcs.coefficients(solution.local)

    @cached_property
    def finer(self) -> FinerDeflection:
        """The deflection between vertices."""
        return FinerDeflection(self.system, self.solution, self.local)

    def derivatives(self, triangles: Ints, xi: Floats, order: int) -> Floats:
        """w (order 0) or its gradient (1) at reference points of the mesh's triangles: (n, point, partial)."""
        if order > 1:
            raise ValueError("curvatures are those of the moments")
        if self.system.order == 1:  # whose deflection is no closer to its unknowns than to the true one
            return self.of_the_element(triangles, xi, order)
        finer = self.finer

        def evaluate(chosen: Ints, own: Floats) -> Floats:
            psi, found = orthonormal(self.system.order + 1, own), finer.coefficients(chosen)
            if order == 0:
                return psi @ found[..., None]
            along = (finer.tables.first @ found[:, None, :, None])[..., 0].swapaxes(1, 2)  # (n, N, reference)
            return (psi @ along) @ self.system.triangles.inverse[chosen]

        return self._on_sorted(triangles, xi, evaluate)

    def of_the_element(self, triangles: Ints, xi: Floats, order: int) -> Floats:
        """The same of the element's own deflection."""
        t = self.system.tables

        def evaluate(chosen: Ints, own: Floats) -> Floats:
            local = self.local[chosen]
            if order == 0:
                return (t.inside(own) @ local[..., None])[..., 0][..., None]
            reference = (t.gradients(own) @ local[:, None, :, None])[..., 0]
            return reference @ self.system.triangles.inverse[chosen]

        return self._on_sorted(triangles, xi, evaluate)

    def apart(self, triangle: int, held: NDArray[np.bool_]) -> float:
        """How far w in a triangle lies from that of its neighbours along its edges, and from what holds them there.

        It is off by as much somewhere at least, however small the error of the element's own unknowns is.

        Parameters
        ----------
        held : (edge,) bool array
            Edges of the mesh along which the deflection is held.
        """
        edges = self.domain.mesh.triangle_edges[triangle].astype(np.int64)
        sides = [self.domain.edge_points(edges, ALONG, ALONG, side=side) for side in range(2)]
        values = [self.derivatives(patch.triangles, patch.xi, 0) for patch in sides]
        off = [float(np.abs(values[1] - values[0]).max())]
        for patch, value in zip(sides, values, strict=True):
            at = np.flatnonzero(held[edges] & (patch.triangles == triangle))
            if len(at):
                exact = self.of_the_element(patch.triangles[at], patch.xi[at], 0)
                off.append(float(np.abs(value[at] - exact).max()))
        return max(off)

    def moment(self, triangles: Ints, xi: Floats, xy: Floats) -> Floats:
        """M_xx, M_yy, M_xy (n, point, 3)."""

        def evaluate(chosen: Ints, own: Floats) -> Floats:
            return -(self.system.tables.moment_functions(own) @ self.solution.moments[chosen])

        return self._on_sorted(triangles, xi, evaluate)

    def shear(self, triangles: Ints, xi: Floats, xy: Floats) -> Floats:
        """Q_x, Q_y (n, point, 2), the divergence of the moments."""

        def evaluate(chosen: Ints, own: Floats) -> Floats:
            slopes = self.system.tables.moment_gradients(own)  # (..., point, 2, k)
            coefficients = self.solution.moments[chosen][:, None]
            along = (slopes @ coefficients).swapaxes(-1, -2)
            m = along @ self.system.triangles.inverse[chosen][:, None]  # (n, point, component, d/dx d/dy)
            return -np.stack([m[..., 0, 0] + m[..., 2, 1], m[..., 2, 0] + m[..., 1, 1]], axis=-1)

        return self._on_sorted(triangles, xi, evaluate)

    def on_edges(self, patch: EdgePatch, slope: bool) -> Floats:
        """w, or w_n along the outward normal, at points of edges: (edge, point)."""
        values = self.derivatives(patch.triangles, patch.xi, int(slope))
        return np.asarray((values * patch.normal).sum(axis=2) if slope else values[..., 0])

    def _on_sorted(self, triangles: Ints, xi: Floats, evaluate: Any) -> Floats:
        """Values at points given in the mesh's own triangles, from a function of those with sorted vertices."""
        order = self.system.triangles.order[triangles]
        x, y = xi[..., 0], xi[..., 1]
        weights = np.stack([1 - x - y, x, y], axis=-1)  # (..., point, vertex)
        if xi.ndim == 3:
            place = np.broadcast_to(order[:, None], weights.shape)
            own = np.take_along_axis(weights, place, axis=2)
            return np.asarray(evaluate(triangles, own[..., 1:]))
        out: Floats | None = None
        for permutation in permutations(range(3)):  # the same points in all triangles: six sets of them
            here = np.flatnonzero((order == permutation).all(axis=1))
            if not len(here):
                continue
            found = evaluate(triangles[here], weights[:, list(permutation)][:, 1:])
            if out is None:
                out = np.empty((len(triangles), *found.shape[1:]))
            out[here] = found
        assert out is not None  # a mesh has triangles
        return out


def work_of_supports(system: HHJSystem, solution: HHJSolution) -> float:
    """Work of what supports exert on the motion that they prescribe, as if it acted in full."""
    held = ~system.numbering.free
    motion = solution.unknowns[held]
    return float(_exerted(system, solution)[0][held] @ motion) if motion.any() else 0.0


def _exerted(system: HHJSystem, solution: HHJSolution) -> tuple[Floats, list[Floats]]:
    """(count,) what all unknowns lack to equilibrium, and the forces of the springs."""
    numbering, outer = system.numbering, system.tables.outer
    left = system.forces(solution.strains) - solution.load.local
    spring_forces = [spring.forces(solution.local) for spring in system.springs]
    for spring, force in zip(system.springs, spring_forces, strict=True):
        np.add.at(left, spring.triangles, force)
    residual: Floats = np.bincount(numbering.outer.ravel(), left[:, :outer].ravel(), numbering.count).astype(
        np.float64
    )
    residual[: numbering.vertices] -= solution.load.vertices
    return residual, spring_forces


def _along_arcs(
    system: HHJSystem,
    solution: HHJSolution,
    residual: Floats,
    motions: Floats,
    lifting: Floats,
    turning: Floats,
) -> None:
    """Work (edge, 3) of what curved edges lack to equilibrium on rigid motions (vertex, 3), of bubbles and slopes.

    Slopes that are held follow rigid motions to the order of the element only; what they miss strains the triangle,
    and its work against the strains there is the moments' on that difference.
    """
    arcs, numbering, t = system.arcs, system.numbering, system.tables
    assert arcs is not None
    rigid = motions[system.triangles.corners[arcs.triangles]]  # (c, vertex, 3)
    planes = arcs.planes @ rigid
    strains = solution.strains[arcs.triangles].reshape(len(rigid), 1, -1)
    missed = (strains @ (system.arc_planes @ rigid))[:, 0] / np.maximum(arcs.pure.sum(axis=1), 1)[:, None]
    at, edges, k = arcs.pairs, arcs.pair_edges[:, None], np.arange(system.order)
    own = arcs.triangles[at]
    number = system.triangles.edges[own, arcs.pair_edges]
    bubbles = t.bubbles(0).start + edges * (system.order - 1) + k[:-1]
    slopes = t.slopes(0).start + edges * system.order + k
    for part, out in ((bubbles, lifting), (slopes, turning)):
        left = residual[numbering.outer[own[:, None], part]]
        out[number] = (left[:, None] @ planes[at[:, None], part])[:, 0]
    turning[number] -= missed[at] * arcs.pure[at, arcs.pair_edges, None]


def _shared(works: list[Floats], groups: list[HeldGroup], mesh: Mesh) -> Iterator[tuple[str, Floats]]:
    """Of each group its label and (3,) work: of vertices, edges and lines, each shared by the groups that hold it."""
    held = [
        (distinct(len(mesh.points), group.points, mesh.edges[group.line]), group.edges, group.line)
        for group in groups
    ]
    if len(groups) > 1:
        shares = [
            np.bincount(np.concatenate(parts), minlength=len(work))
            for work, parts in zip(works, zip(*held, strict=True), strict=False)
        ]
        works = [work / np.maximum(share, 1)[:, None] for work, share in zip(works, shares, strict=True)]
    for group, own in zip(groups, held, strict=True):
        parts = (work[part] for work, part in zip(works, own, strict=False) if len(part))
        yield group.label, sum((part.sum(axis=0) for part in parts), np.zeros(3))


def reactions(
    problem: PlateProblem, loads: Loads, system: HHJSystem, solution: HHJSolution, fields: HHJFields
) -> Reactions:
    """Forces of the supports on the plate, by the work of what is left over on rigid motions."""
    mesh, triangles, numbering = problem.mesh, system.triangles, system.numbering
    points = mesh.points[:, :2]
    low, high = points.min(axis=0), points.max(axis=0)
    centre, size = 0.5 * (low + high), 0.5 * float((high - low).max())
    residual, spring_forces = _exerted(system, solution)

    motions = np.ones((len(points), 3))
    motions[:, 1], motions[:, 2] = points[:, 1] - centre[1], centre[0] - points[:, 0]
    turns = np.zeros((len(mesh.edges), 3))  # slopes of w = y, -x: n along the tangent turned by -90 degrees
    turns[:, 1:] = points[mesh.edges[:, 0]] - points[mesh.edges[:, 1]]
    turning = residual[numbering.slope_start :: system.order, None] * turns  # (edge, 3)
    works = [residual[: numbering.vertices, None] * motions, turning]
    if system.arcs is not None:
        works.append(np.zeros_like(turning))  # of the bubbles
        _along_arcs(system, solution, residual, motions, works[2], turning)

    totals: dict[str, Floats] = {}
    for label, force in _shared(works, problem.supports.held, mesh):
        totals[label] = totals.get(label, 0.0) + force
    for spring, force in zip(system.springs, spring_forces, strict=True):
        rigid = np.zeros((len(triangles), system.tables.count, 3))[spring.triangles]
        rigid[:, :3] = motions[triangles.corners[spring.triangles]]
        slopes = triangles.plane_slopes[spring.triangles] @ rigid[:, :3]
        start = system.tables.slopes(0).start
        rigid[:, start : start + 3 * system.order : system.order] = slopes
        if system.arcs is not None:
            bent = system.arcs.place[spring.triangles] >= 0
            planes = system.arcs.planes[system.arcs.place[spring.triangles[bent]]]
            rigid[bent] = planes @ motions[triangles.corners[spring.triangles[bent]]]
        work = (force[:, None] @ rigid)[:, 0].sum(axis=0)
        totals[spring.label] = totals.get(spring.label, np.zeros(3)) - work

    scale = np.array([1.0, 1.0 / size, 1.0 / size])
    parts = [load.resultant(centre) * scale for load in loads.forms]
    parts += [total * scale for total in totals.values()]
    balance = left_over = 0.0
    if parts:
        # where nothing acts, the forces that would bend the plate by as much as it moves
        bending = (
            np.abs(system.stiffness).max() * np.abs(solution.unknowns[: numbering.vertices]).max() / size**2
        )
        gross = [load.gross(size) for load in loads.forms] or [float(bending)]
        largest = max(float(np.abs(parts).max()), *gross, 1e-300)
        left_over = float(np.abs(np.sum(parts, axis=0)).max())
        balance = left_over / largest
    documents: dict[str, Any] = {}
    for label, (force, mx, my) in totals.items():
        moment = np.array([mx + centre[1] * force, my - centre[0] * force, 0.0])
        documents[label] = {"force": np.array([0.0, 0.0, force]), "moment": moment}
    along = AlongSupports(
        problem.domain,
        problem.supports,
        lambda: Lines(problem.domain, problem.supports, loads.forms),
        lambda lines: HHJLineForces(problem.domain, system, lines, residual),
        fields.on_edges,
    )
    return Reactions(documents, balance, left_over, along.documents())
