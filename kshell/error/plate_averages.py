"""Moments of Morley and HHJ plates against their continuous averages: an estimate of the error.

Their moments m jump between triangles, of Morley constant in each, of HHJ elements polynomials of degree p - 1. With m*
the continuous averages at Lagrange nodes, over triangles of one stiffness,

    eta_T^2 = int over T of (m - m*) : C^-1 (m - m*),

more on foundations (`foundations.py`), and of a deflection with the dual solution the sum over T of eta_T eta*_T;
`SAFETY` times that is relied on. (Of Argyris plates moments are continuous at vertices, just where singularities sit:
there averages are useless.)

Source: Zienkiewicz & Zhu, Int. J. Numer. Meth. Eng. 33 (1992) 1331-1364, 1365-1382.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kshell.elements.hierarchic import orthonormal
from kshell.elements.quadrature import triangle_rule
from kshell.elements.reference import VERTICES
from kshell.equilibrium.model import Solved
from kshell.error.assessment import ENERGY, RESTING, Assessment, Interval, energy_interval
from kshell.error.between import Between
from kshell.error.chords import share_of_chords
from kshell.error.corner_fits import SINGLE, CornerFits, by_piece
from kshell.error.corner_share import of_averages
from kshell.error.curve_doubt import turns
from kshell.error.estimate import Estimate
from kshell.error.foundations import hidden_by_foundations
from kshell.error.geometry_share import PAIRS
from kshell.error.marking import doerfler
from kshell.error.plates import deflection_rows, geometry_share, goal_marks
from kshell.plate.domain import BLOCK, Domain
from kshell.plate.hhj.model import HHJModel
from kshell.plate.hhj.numbering import Held
from kshell.plate.hhj.state import HHJSolution
from kshell.plate.loads import Loads
from kshell.plate.model import PlateModel
from kshell.plate.problem import PlateProblem
from kshell.plate.recovery import Fields
from kshell.plate.sharing import along_edges
from kshell.result.result import Result

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SAFETY_HIGHER = 4.0  # of HHJ elements, whose moments are sharper than their averages next to edges
SAFETY = 2.0  # 229 deflections and energies of Morley plates: 1.1 to 50 times their errors, 2.2 in the median
WHY_NOT = "averages of moments are no proof; Argyris plates with straight edges have one, with a tolerance"
FEWEST = (
    13  # triangles; of 226 plates of fewer a quarter of the intervals missed, of 112 of up to 24 one in 25
)
FEW = (
    f"fewer than {FEWEST} triangles with a constant moment each tell too little of their error: take a finer mesh, or "
    "elements of a higher order"
)
SAME = 1e-9  # relative difference of stiffnesses that is none


def assess_averages(
    model: PlateModel | HHJModel, solved: Solved, result: Result, duals: int, names: Sequence[str]
) -> Assessment:
    """At most so many dual solutions, for the first named probes."""
    problem = model.problem
    if isinstance(model, PlateModel):
        mesh = problem.mesh
        averages = _Averages(
            problem, 1, mesh.triangles.astype(np.int64), mesh.triangle_edges.astype(np.int64)
        )
        own, safety = averages.local(_constant_moments(problem.fields(np.asarray(solved.x)))), SAFETY
    else:
        averages = _Averages(problem, model.order, model.triangles.corners, model.triangles.edges)
        own, safety = averages.local(_moments(solved.own, averages.nodes)), SAFETY_HIGHER
    unknown = 0.0 if averages.told else np.inf
    out = Assessment(why_not=averages.why_not or WHY_NOT, told=averages.told)
    half = 0.5 * safety * float(own.sum()) + unknown
    expected = half / (2.0 * safety)
    if averages.constant and (np.any(problem.reduction.particular) or problem.loads.curvatures):
        # not at rest energies are off by as much as moments are, of which constant ones are known to little more
        widest = energy_interval(result.strain_energy, float(np.sqrt(2.0 * half)), False)
        half, expected = widest.half_width, widest.expected
    out.energy = Estimate(result.strain_energy, half, expected, "estimated", WHY_NOT)
    out.marks[ENERGY], out.parts[ENERGY] = own, 0.5 * safety * own
    chosen = list(names)[:duals]
    largest = abs(float(result.extremes["deflection"]["value"])) if chosen else 0.0
    for name, moments in zip(chosen, _dual_moments(model, chosen, averages.nodes), strict=True):
        dual = averages.local(moments)
        out.parts[name] = safety * np.sqrt(own * dual)
        width = float(out.parts[name].sum())
        value = result.motion_at_probe(name)
        if isinstance(model, HHJModel):
            if averages.constant:
                width += safety * averages.bulge(
                    problem, name, _moments(solved.own, averages.nodes[:1])[:, 0]
                )
            else:
                between = Between(model, solved, name)
                still = between.on_held and abs(between.own) <= RESTING * largest
                value, width = (np.zeros(3), 0.0) if still else (value, width + between.apart)
        along = np.array([0.0, 0.0, width + unknown])
        out.probes[name] = Interval(value, along, along / (2.0 * safety), "estimated")
        out.marks[name] = goal_marks(own, dual)
    out.geometry = _chords(problem) if isinstance(model, PlateModel) else geometry_share(problem.domain)
    return out


class _Averages:
    """Where moments are averaged, and what their differences weigh.

    Parameters
    ----------
    problem : PlateProblem
    order : int
    corners, edges : (T, 3) arrays
        Vertices of the triangles as their reference coordinates count them, in ascending order where the order of
        the element is 4 or more, and edges 01, 12, 02.

    Attributes
    ----------
    nodes : (node, 2) array
        Reference coordinates of the Lagrange nodes.
    constant : bool
        Whether moments are constant in each triangle.
    why_not : str
        Why they do not tell the error of every triangle; empty where they do.
    """

    def __init__(self, problem: PlateProblem, order: int, corners: Ints, edges: Ints) -> None:
        mesh = problem.mesh
        degree = max(order - 1, 1)
        self.nodes = _nodes(degree)
        middle = mesh.points[mesh.triangles, :2].mean(axis=1)[:, None]
        stiffness = problem.bending.at(np.arange(len(middle)), middle)[:, 0]
        hidden = hidden_by_foundations(problem.structure, order, np.eye(3)[2:], stiffness)
        self._factor: Floats = hidden * of_averages(problem)
        if (stiffness == stiffness[0]).all():
            stiffness = np.broadcast_to(stiffness[0], stiffness.shape)  # one number of each is kept
            self._compliance: Floats = np.broadcast_to(np.linalg.inv(stiffness[0]), stiffness.shape)
        else:
            self._compliance = np.linalg.inv(stiffness).astype(np.float64)
        along = np.arange(degree - 1)
        inside = len(self.nodes) - 3 * degree  # each triangle's own
        parts = [
            corners,
            len(mesh.points)
            + (edges[..., None] * (degree - 1) + along).reshape(len(corners), 3 * (degree - 1)),
            len(mesh.points)
            + len(mesh.edges) * (degree - 1)
            + np.arange(len(corners) * inside).reshape(len(corners), inside),
        ]
        number = np.concatenate(parts, axis=1)
        kinds = _kinds(problem, stiffness)
        self._number: Ints = by_piece(number, kinds)
        position = np.zeros((len(corners), len(self.nodes), 3))
        for start in range(0, len(corners), BLOCK):
            x = mesh.points[corners[start : start + BLOCK], :2]
            sides = np.stack([x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]], axis=1)
            position[start : start + BLOCK, :, :2] = x[:, :1] + self.nodes @ sides
        axes = np.broadcast_to(np.eye(3), (*position.shape, 3))
        self._fits = CornerFits(corners, edges, kinds, degree, position, axes)
        self.constant = order == 1
        self._untold = self._fits.untold(order)
        single = SINGLE if self._untold.any() else ""
        self.why_not = FEW if self.constant and len(corners) < FEWEST else single
        self._area = mesh.areas
        self._weight = np.repeat(mesh.areas, len(self.nodes))
        self._total = np.bincount(self._number.ravel(), self._weight)
        xi, w = triangle_rule(2 * degree)
        values = orthonormal(degree, xi) @ np.linalg.inv(orthonormal(degree, self.nodes))
        self._mass = 2.0 * np.einsum("q,qi,qj->ij", w, values, values)

    @property
    def told(self) -> bool:
        """Whether the averages tell the error of every triangle."""
        return not self.why_not

    def bulge(self, problem: PlateProblem, name: str, moments: Floats) -> float:
        """How far a probe lies from the planes through the vertices of its triangles, with constant moments (T, 3)."""
        found = problem.locator.find(np.array(problem.structure.probes[name])[None, :2])
        found, out = along_edges(problem.domain, found).located, 0.0
        for triangle, (x, y) in zip(found.triangles.tolist(), found.xi[:, 0].tolist(), strict=True):
            curvature = self._compliance[triangle] @ moments[triangle]
            corner = problem.mesh.points[problem.mesh.triangles[triangle], :2]
            part = np.array([1.0 - x - y, x, y])
            along = np.array([corner[j] - corner[i] for i, j in PAIRS])
            bent = np.stack([along[:, 0] ** 2, along[:, 1] ** 2, along.prod(axis=1)], axis=1) @ curvature
            off = sum(part[i] * part[j] * b for (i, j), b in zip(PAIRS, bent, strict=True))
            out = max(out, float(abs(0.5 * off)))
        return out

    def local(self, moments: Floats) -> Floats:
        """(T,) eta_T^2 of moments (T, node, 3)."""
        place = self._number.ravel()
        mean = np.stack(
            [np.bincount(place, self._weight * moments[..., k].ravel()) / self._total for k in range(3)],
            axis=1,
        )
        average = mean[self._number]
        average[self._fits.triangles, self._fits.nodes] = self._fits.values(moments)
        own = np.empty(len(moments))
        for start in range(0, len(own), BLOCK):
            some = slice(start, start + BLOCK)
            off = moments[some] - average[some]
            own[some] = ((self._mass @ off) * (off @ self._compliance[some])).sum(axis=(1, 2))
        own *= self._area * self._factor
        own[self._untold] = own.max()  # these first
        return own


def _nodes(degree: int) -> Floats:
    """(node, 2) Lagrange nodes: vertices, edges 01, 12, 02 from their first to their second vertex, inside."""
    corners = VERTICES[[[0, 1], [1, 2], [0, 2]]]
    s = (np.arange(1, degree) / degree)[:, None]
    on_edges = [a + s * (b - a) for a, b in corners]
    i, j = np.meshgrid(np.arange(1, degree), np.arange(1, degree))
    inside = np.stack([i[i + j < degree], j[i + j < degree]], axis=1) / degree
    return np.concatenate([VERTICES, *on_edges, inside])


def _kinds(problem: PlateProblem, stiffness: Floats) -> Ints:
    """(T,) a number for each stiffness; one for all where it varies inside triangles."""
    if not problem.section.constant_per_triangle or stiffness.strides[0] == 0:
        return np.zeros(len(stiffness), dtype=np.int64)
    whole = stiffness.reshape(len(stiffness), -1) / np.abs(stiffness).max()
    return np.asarray(
        np.unique(np.round(whole / SAME), axis=0, return_inverse=True)[1], dtype=np.int64
    ).ravel()


def _constant_moments(fields: Fields) -> Floats:
    """(T, 3, 3) moments of a Morley deflection at the corners of triangles, where they are the same."""
    found = fields.centroid_moments
    return np.broadcast_to(found[:, None], (len(found), 3, 3))


def _moments(solution: HHJSolution, nodes: Floats) -> Floats:
    """(T, node, 3)."""
    degree = round((np.sqrt(8 * solution.moments.shape[1] + 1) - 3) / 2)
    return np.asarray(orthonormal(degree, nodes) @ solution.moments)


def _dual_moments(model: PlateModel | HHJModel, names: Sequence[str], nodes: Floats) -> list[Floats]:
    """(T, node, 3) moments of the duals of the deflections at probes."""
    if not names:
        return []
    problem = model.problem
    places = np.array([np.array(model.structure.probes[name])[:2] for name in names])
    if isinstance(model, PlateModel):
        rows, _, _ = deflection_rows(problem, places)
        reduction = problem.reduction
        z = reduction.spread(model.respond(reduction.gathered(rows)))
        p = problem
        return [
            _constant_moments(Fields(p.domain, p.layout, p.bending, p.section, Loads(), column))
            for column in z.T
        ]
    system = model.system()
    found = problem.locator.find(places)
    out = []
    for triangle, xy in zip(found.triangles.tolist(), found.xy, strict=True):
        load = system.no_load()
        chosen = np.array([triangle])
        xi = system.triangles.reference(xy[None, None], chosen)
        load.local[triangle] = system.tables.inside(xi)[0, 0]
        if system.arcs is not None:
            system.arcs.to_unknowns(load.local)
        out.append(_moments(system.solve(load, Held()), nodes))
    return out


def _chords(problem: PlateProblem) -> float:
    """Relative error because curved edges are their chords."""
    curves = Domain(problem.mesh, True).boundary
    if not curves.curved.any():
        return 0.0
    return share_of_chords(turns(curves), problem.mesh.edge_lengths[curves.edges])


def at_chords(problem: PlateProblem, share: float) -> Ints:
    """The fewest triangles at curved edges that have a share of that error."""
    mesh = problem.mesh
    curves = Domain(mesh, True).boundary
    worst = doerfler(turns(curves) ** 2 * mesh.edge_lengths[curves.edges], share)
    return np.asarray(mesh.edge_owner[curves.edges[worst], 0], dtype=np.int64)
