"""Two-sided bounds of the energy and of quantities of a plate with straight edges, after Prager and Synge.

With w_h conforming, m in exact equilibrium and d = C^-1 m + kappa_0 - kappa(w_h), all norms in energy,

    |kappa(w) - kappa(w_h)|^2 + |C^-1 m + kappa_0 - kappa(w)|^2 = |d|^2,

so that the potential energy P lies in [P(w_h) - |d|^2 / 2, P(w_h)]: for supports at rest and no initial curvature the
strain energy is - P. For a functional J with the dual z, its approximations z_h, m* and their difference d*,

    J(w) = J(w_h) + <d, kappa(z_h)> + <d, d*> / 2  +- |d| |d*| / 2.

No orthogonality is used: errors of the algebra in w_h and z_h are inside. Only the equilibrium of m and m* must be
exact. Rounding leaves a residual r of it; m - C kappa(y) with a(y, .) = r would be in equilibrium, and what y
changes is added, its norm measured on the conforming functions. The region of the plate is known up to the rounding
of the coordinates of its vertices: next to corners that the mesh is graded to, that is added, too.

Source: Prager & Synge, Quart. Appl. Math. 5 (1947) 241-269; the bound of J from both identities, with e = d
projected on the conforming side, |(2 P - 1) d| = |d|.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from kshell.error.conforming import Conforming
from kshell.error.difference import Difference
from kshell.error.equilibrated import Equilibrated, required_order
from kshell.error.estimate import Estimate
from kshell.error.goals import Goal
from kshell.error.premises import require_pair, why_not
from kshell.mesh.refine import spacing
from kshell.plate.assembly import assemble_load
from kshell.plate.hhj import translate
from kshell.plate.hhj.geometry import Triangles
from kshell.plate.hhj.numbering import Held
from kshell.plate.hhj.state import Load
from kshell.plate.hhj.system import HHJSystem
from kshell.plate.loading import LOAD_DEGREE
from kshell.plate.problem import PlateProblem

Floats = NDArray[np.float64]

# of the equilibrated side: as sharp as the quintics of the conforming one, |d| is 1.02 to 1.4 times the error in energy
# norm (order 5: 1.00 to 1.02); with order 3, in .7 to 1.0 of the time, 5 to 10 times where deflections are smooth
ORDER = 4
EPS = float(np.finfo(float).eps)
FLOOR = 1e-13  # relative rounding of sums over triangles
UNCERTAIN = 2.0  # the residual of the equilibrium is seen by conforming functions only


class PlatePair:
    """A conforming and an equilibrated solution of one plate, on one factorisation each.

    Parameters
    ----------
    problem : PlateProblem
        With the Argyris element and straight edges.
    order : int
        Of the equilibrated side, 1 to 8.
    method : str
        How large systems of the equilibrated side are solved, see `kshell.solvers.prepare`.

    Attributes
    ----------
    unknowns : int
        Of both systems together.

    Raises
    ------
    InputError
        If the plate has curved edges, or supports that one of the elements does not have.
    SolveError
        If a system is singular.
    """

    def __init__(self, problem: PlateProblem, order: int = ORDER, method: str = "direct") -> None:
        require_pair(problem, order)
        self.problem, self.order = problem, order
        self.triangles = Triangles(problem.mesh)
        self.conforming = Conforming(problem, self.triangles)
        self.system = HHJSystem(
            self.triangles,
            order,
            _stiffness(problem, self.triangles),
            translate.held(self.triangles, order, problem.supports),
            translate.springs(self.triangles, order, problem.supports),
            method,
        )
        self.springs = [form for _, form in problem.supports.springs]
        self.unknowns = problem.reduction.count + self.system.count
        self.why_not = why_not(problem, order)
        largest = required_order(order, problem.loads.forms, self.springs)
        self.degree = 2 * max(3, largest - 1)  # quintics have cubic curvatures
        if problem.loads.curvatures:
            self.degree = max(self.degree, 2 * LOAD_DEGREE)
        if not problem.section.constant_per_triangle:
            self.degree += LOAD_DEGREE

    @cached_property
    def at_rest(self) -> bool:
        """Whether nothing but loads acts: no prescribed motion, no initial curvature."""
        return not np.any(self.problem.reduction.particular) and not self.problem.loads.curvatures

    @cached_property
    def _shaken(self) -> Floats:
        """(T,) relative change of a triangle by the rounding of its coordinates, and about so of its energy."""
        triangles = self.triangles
        return spacing(self.problem.mesh) * triangles.lengths.max(axis=1) / triangles.area

    @cached_property
    def primal(self) -> Side:
        """Both solutions under the loads of the problem."""
        problem, conforming = self.problem, self.conforming
        forms = problem.loads.forms
        q = conforming.unknowns
        load = problem.system.load
        solution = self.system.solve(translate.load(self.system, forms))
        equilibrated = Equilibrated(self.system, solution, forms, self.springs)
        difference = Difference(conforming, conforming.full(q), equilibrated, self.degree)
        return Side(conforming, q, difference, self._bent(load))

    def _bent(self, load: Floats) -> Floats:
        """The load without initial curvatures, which are no part of the equilibrium of moments."""
        if not self.problem.loads.curvatures:
            return np.asarray(load)
        fixed, _ = assemble_load(
            list(self.problem.loads.curvatures), self.problem.domain, self.problem.reduction
        )
        return np.asarray(load - fixed)

    def dual(self, goal: Goal) -> Side:
        """Both solutions of the dual of a goal."""
        conforming = self.conforming
        row = self.row(goal)
        load = np.asarray(conforming.reduction.T @ row)
        q = conforming.solve(load)
        solution = self.system.solve(self._dual_load(goal), Held())
        equilibrated = Equilibrated(self.system, solution, [], self.springs)
        d = conforming.full(q, prescribed=False)
        difference = Difference(conforming, d, equilibrated, self.degree, goal.stress, initial=False)
        return Side(conforming, q, difference, load)

    def row(self, goal: Goal) -> Floats:
        """(dof,) J as a functional of the physical degrees of freedom of the conforming side."""
        conforming, layout = self.conforming, self.problem.layout
        row = np.zeros(layout.count)
        np.add.at(row, layout.vertex_dofs(goal.vertices)[:, 0], goal.forces)
        for edges, weights, slopes in goal.on_edges:
            owner, values = conforming.edge_integrals(edges, slopes)
            np.add.at(row, conforming.dofs[owner], weights[:, None] * values)
        if goal.stress is not None:
            row += conforming.curvature_functional(goal.stress)
        return row

    def _dual_load(self, goal: Goal) -> Load:
        system = self.system
        out = system.no_load()
        np.add.at(out.vertices, goal.vertices, goal.forces)
        t = system.tables
        for edges, weights, slopes in goal.on_edges:
            owner, place = translate.places(self.triangles, edges)
            means = np.stack([t.edge_mean(edge, slopes) for edge in range(3)])[place]
            size = 1.0 if slopes else self.triangles.lengths[owner, place]
            np.add.at(out.local, owner, (weights * size)[:, None] * means)
        if goal.stress is not None:  # int s : kappa = int C (C^-1 s) : kappa, an initial curvature C^-1 s
            strain = np.linalg.solve(system.stiffness, goal.stress[..., None])[..., 0]
            factor = system.factor
            scaled = (factor @ strain[..., None])[..., 0] * system.root[:, None]
            out.initial = np.zeros((len(self.triangles), 3, t.moments))
            out.initial[:, :, 0] = scaled / np.sqrt(2.0)  # int psi_0 = 1 / sqrt 2 on the reference triangle
        return out

    @cached_property
    def gap(self) -> float:
        """|d|^2, with what rounding has left of the equilibrium."""
        return (self.primal.norm + self.primal.imbalance) ** 2

    def energy(self) -> Estimate:
        """The strain energy; where motion is prescribed or curvature initial, the potential energy instead."""
        side = self.primal
        a = self.problem.system
        work = float(a.load @ side.q + a.load_work)
        potential = side.difference.energy() - work
        rounding = FLOOR * (abs(potential) + abs(work)) + EPS * side.difference.cancelled
        rounding += float((self._shaken * side.difference.bent()).sum())
        middle = potential - 0.25 * self.gap
        half = 0.25 * self.gap + rounding
        return self._estimate(-middle if self.at_rest else middle, half, 0.5 * half)

    def probe(self, goal: Goal, dual: Side | None = None) -> Estimate:
        """A quantity; ``dual`` where its `dual` is at hand."""
        mine = self.primal
        its = self.dual(goal) if dual is None else dual
        d = self.conforming.full(mine.q)
        value = float(self.row(goal) @ d) + goal.constant
        shift = mine.difference.with_deflection(its.difference)
        shift += 0.5 * float(mine.difference.per_triangle(its.difference).sum())
        rounding = (
            abs(float(mine.residual @ its.q))
            + mine.imbalance * (its.norm + its.imbalance)
            + its.imbalance * mine.norm
            + FLOOR * abs(value)
            + float((self._shaken * np.sqrt(mine.difference.bent() * its.difference.bent())).sum())
        )
        half = 0.5 * mine.norm * its.norm + rounding
        expected = 0.5 * float(np.sqrt(np.abs(mine.local * its.local)).sum()) + rounding
        return self._estimate(value + shift, half, min(expected, half))

    def _estimate(self, value: float, half: float, expected: float) -> Estimate:
        kind = "estimated" if self.why_not else "guaranteed"
        return Estimate(float(value), float(half), float(expected), kind, self.why_not)  # type: ignore[arg-type]


class Side:
    """A load or a goal: its conforming deflection and the difference to the equilibrated side.

    Attributes
    ----------
    q : (unknown,) array
        The conforming deflection, without prescribed motion.
    difference : Difference
    local : (T,) array
        |d|^2 of each triangle: what to refine for the energy.
    """

    def __init__(self, conforming: Conforming, q: Floats, difference: Difference, balanced: Floats) -> None:
        self.q, self.difference = q, difference
        self._conforming, self._balanced = conforming, balanced
        self.local = difference.per_triangle(difference)

    @cached_property
    def norm(self) -> float:
        """|d|."""
        return float(np.sqrt(max(self.local.sum(), 0.0)))

    @cached_property
    def residual(self) -> Floats:
        """(unknown,) what is missing in the equilibrium of the moments: 0 up to rounding."""
        exerted = self.difference.equilibrium()
        return np.asarray(self._conforming.reduction.T @ exerted) - self._balanced

    @cached_property
    def imbalance(self) -> float:
        """Energy norm of that residual over conforming functions."""
        return UNCERTAIN * float(np.sqrt(abs(self.residual @ self._conforming.once(self.residual))))


def _stiffness(problem: PlateProblem, triangles: Triangles) -> Floats:
    """Stiffness of the equilibrated side, in the middle of triangles where it varies: equilibrium needs no more."""
    if problem.section.constant_per_triangle:
        return translate.bending_stiffness(problem.section)
    middle = triangles.xy(np.full((1, 2), 1.0 / 3.0))
    return problem.bending.at(np.arange(len(triangles)), middle)[:, 0]


def energy_bounds(problem: PlateProblem, order: int = ORDER) -> Estimate:
    """Bounds of the strain energy of a plate, see `PlatePair.energy`.

    Raises
    ------
    InputError, SolveError
        As `PlatePair`.
    """
    return PlatePair(problem, order).energy()


def probe_bounds(problem: PlateProblem, goals: list[Goal], order: int = ORDER) -> list[Estimate]:
    """Bounds of some quantities of a plate.

    Raises
    ------
    InputError, SolveError
        As `PlatePair`.
    """
    pair = PlatePair(problem, order)
    return [pair.probe(goal) for goal in goals]
