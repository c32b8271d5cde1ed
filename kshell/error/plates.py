"""Estimates for Argyris plates on any edges, and guaranteed intervals on straight ones."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kshell.elements import matrices
from kshell.error import missed_stiffness
from kshell.error.assessment import ENERGY, Assessment, Interval, energy_interval
from kshell.error.bounds import PlatePair
from kshell.error.curve_doubt import curve_doubt, polygon_share, turns
from kshell.error.estimate import Estimate
from kshell.error.goals import Goal
from kshell.error.residual import Loaded, PlateResidual
from kshell.mesh.mesh import Mesh
from kshell.plate.domain import Domain
from kshell.plate.forms import VARIABLE_DEGREE
from kshell.plate.model import PlateModel
from kshell.plate.problem import PlateProblem
from kshell.plate.sharing import along_edges
from kshell.result.result import Result

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

WHY_NOT = "residuals are no proof, which bounds from a tolerance are on straight edges"
AT_VERTEX = 1e-9  # distance of a probe from a vertex, in the size of the plate, that is none
LIKELY = 0.25  # of the half width: residuals overestimate by 1 to 100 times
FEW = 50_000  # triangles of all load cases that are estimated at once
GROWTH = 4.0  # deflections grow with size to this power


def assess_residual(
    model: PlateModel, d: Floats, result: Result, duals: int, names: Sequence[str]
) -> Assessment:
    """By residuals; d are physical degrees of freedom. At most so many dual solutions, for the first named probes."""
    problem = model.problem
    at_rest = not np.any(problem.reduction.particular) and not problem.loads.curvatures
    out = Assessment(why_not=WHY_NOT)
    chosen = list(names)[:duals]
    new = [name for name in chosen if name not in model.duals]
    own = _local(model, d, new)
    out.energy = energy_interval(result.strain_energy, float(np.sqrt(own.sum())), at_rest, WHY_NOT)
    out.marks[ENERGY], out.parts[ENERGY] = own, 0.25 * own
    for name in chosen:
        out.duals[name], dual = model.duals[name]
        out.parts[name] = np.sqrt(own * dual)
        half = float(out.parts[name].sum())
        out.probes[name] = _along_z(result.motion_at_probe(name), half, LIKELY * half, "estimated")
        out.marks[name] = goal_marks(own, dual)
    out.geometry = geometry_share(problem.domain)
    missed_stiffness.widen(out, problem, VARIABLE_DEGREE, d)
    return out


def _local(model: PlateModel, d: Floats, new: Sequence[str]) -> Floats:
    """(T,) estimates of a deflection; those of the others solved together, and of new duals, are found beside it."""
    kept: list[tuple[Floats, Floats]] = model.estimates
    own = next((eta for x, eta in kept if x is d), None)
    waiting = [] if own is not None else _beside(model, d)
    cases = [*(Loaded.of(problem, x) for problem, x in waiting), *_dual_cases(model, new)]
    if cases:
        found = PlateResidual(model.problem).local(cases)
        kept += [(x, eta) for (_, x), eta in zip(waiting, found, strict=False)]
        duals = zip(new, cases[len(waiting) :], found[len(waiting) :], strict=True)
        model.duals.update({name: (case.d, eta) for name, case, eta in duals})
    return next(eta for x, eta in kept if x is d) if own is None else own


def _beside(model: PlateModel, d: Floats) -> list[tuple[PlateProblem, Floats]]:
    """A deflection with those that were solved for together with it, as long as they are few numbers in all."""
    together = model.together
    if any(x is d for _, x in together) and len(together) * len(model.problem.mesh.triangles) <= FEW:
        return together
    return [(model.problem, d)]


def _dual_cases(model: PlateModel, names: Sequence[str]) -> list[Loaded]:
    """The dual solutions of the deflections at probes."""
    if not names:
        return []
    problem = model.problem
    places = np.array([np.array(problem.structure.probes[name])[:2] for name in names])
    rows, triangles, at_vertex = deflection_rows(problem, places)
    reduction = problem.reduction
    z = reduction.spread(model.respond(reduction.gathered(rows)))
    still = on_held_edges(problem, places)
    inner = [[] if known else [triangles[k]] for k, known in enumerate(at_vertex | still)]
    return [Loaded(z[:, k], inner=inner[k]) for k in range(len(names))]


def assess_pair(pair: PlatePair, names: Sequence[str], strain_energy: float | None = None) -> Assessment:
    """Guaranteed where the premises hold; probes must be vertices.

    Parameters
    ----------
    pair : PlatePair
    names : sequence of str
        Probes.
    strain_energy : float, optional
        Of the conforming solution, where it is not at rest.
    """
    problem = pair.problem
    out = Assessment(why_not=pair.why_not)
    if pair.at_rest:
        out.energy = pair.energy()
    elif strain_energy is not None:
        norm = float(np.sqrt(pair.gap))
        found = energy_interval(strain_energy, norm, False)
        kind = pair.energy().kind
        out.energy = Estimate(found.value, found.half_width, found.expected, kind, pair.why_not)
    primal = pair.primal
    out.marks[ENERGY] = primal.local
    out.parts[ENERGY] = 0.25 * primal.local
    for name in names:
        goal = Goal.at_vertex(vertex_at(problem.mesh, np.array(problem.structure.probes[name])))
        dual = pair.dual(goal)
        found = pair.probe(goal, dual)
        value = np.array([0.0, 0.0, found.value])
        out.probes[name] = _along_z(value, found.half_width, found.expected, found.kind)
        out.marks[name] = goal_marks(primal.local, dual.local)
        out.parts[name] = 0.5 * np.sqrt(np.abs(primal.local * dual.local))
        out.duals[name] = pair.conforming.full(dual.q, prescribed=False)
    out.geometry = 0.0
    missed_stiffness.widen(out, problem, pair.degree, pair.conforming.full(primal.q))
    if names:
        out.resting(pair.conforming.largest())
    return out


def vertex_at(mesh: Mesh, place: Floats) -> int:
    """The vertex nearest to a place."""
    return int(np.linalg.norm(mesh.points[:, :2] - place[:2], axis=1).argmin())


def goal_marks(own: Floats, dual: Floats) -> Floats:
    """What to refine for a quantity: eta^2 |eta*|^2 + eta*^2 |eta|^2, of its scale less.

    Source: Becker, Estecahandy & Trujillo, SIAM J. Numer. Anal. 49 (2011) 2451-2469.
    """
    total, its = float(own.sum()), float(dual.sum())
    if total == 0.0 or its == 0.0:
        return np.zeros_like(own)
    marks: Floats = own / total + dual / its
    return marks


def deflection_rows(problem: PlateProblem, xy: Floats) -> tuple[Floats, list[Ints], NDArray[np.bool_]]:
    """(dof, n) the rows of w at places (n, 2), lists of the triangles there, and (n,) whether a place is a vertex."""
    found = problem.locator.find(xy)
    shared = along_edges(problem.domain, found)
    at = shared.located
    affine = problem.domain.affine(at.triangles)
    rows = matrices.rows(problem.element, affine, at.xi, 0, problem.element.transformation(affine))[:, 0, 0]
    out = np.zeros((problem.layout.count, len(xy)))
    dofs = problem.layout.triangle_dofs(at.triangles)
    np.add.at(out, (dofs, shared.points[:, None]), shared.parts[:, None] * rows)
    corners = problem.domain.points[problem.mesh.triangles[found.triangles]]
    nearest = np.linalg.norm(corners - found.xy[:, None], axis=2).min(axis=1)
    triangles = [at.triangles[shared.points == k].astype(np.int64) for k in range(len(xy))]
    return out, triangles, nearest <= AT_VERTEX * problem.mesh.size


def on_held_edges(problem: PlateProblem, xy: Floats) -> NDArray[np.bool_]:
    """(n,) whether places (n, 2) lie on edges along which supports hold the deflection, between vertices or at them."""
    mesh = problem.mesh
    held = np.zeros(len(mesh.edges), dtype=bool)
    for group in problem.supports.held:
        held[group.line] = True
    ends = problem.domain.points[mesh.edges[held]]
    side = ends[:, 1] - ends[:, 0]
    length = np.hypot(side[:, 0], side[:, 1])
    off = xy[:, None] - ends[:, 0]  # (n, edge, 2)
    across = np.abs(off[..., 0] * side[:, 1] - off[..., 1] * side[:, 0]) / length
    along = (off * side).sum(axis=2) / length**2
    on = (across <= AT_VERTEX * mesh.size) & (along >= -AT_VERTEX) & (along <= 1.0 + AT_VERTEX)
    return np.asarray(on.any(axis=1))


def _along_z(u: Floats, half: float, expected: float, kind: str) -> Interval:
    along = np.array([0.0, 0.0, 1.0])
    return Interval(np.asarray(u, dtype=float), half * along, expected * along, kind)  # type: ignore[arg-type]


def geometry_share(domain: Domain, off: Floats | None = None) -> float:
    """Relative error because the shape of curved edges is known by their nodes only.

    Of a disk of radius R whose edge is off by delta everywhere it is 4 delta / R. ``off`` (edge,) of `Domain.curves` is
    the `curve_doubt` if absent.
    """
    curves = domain.curves
    if not curves.curved.any():
        return 0.0
    weights = domain.mesh.edge_lengths[curves.edges]
    # turn over length is the curvature
    polygon = polygon_share(domain) if off is None else 0.0
    off = curve_doubt(domain) if off is None else off
    return polygon + float(GROWTH * (off * turns(curves)).sum() / weights.sum())
