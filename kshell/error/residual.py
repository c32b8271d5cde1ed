"""Residuals of an Argyris plate as an estimate of its error, on curved edges and with any stiffness.

With M = - D kappa, h the square root of twice the area of a triangle T, h_E the length of an edge E, d the smallest
bending stiffness along any direction, outward normals on both sides, and V_n = Q_n + d M_nt / dt,

    eta_T^2 = h^4 / d |q - k w + div Q|^2
              + sum over E of share (h_E / d |[M_nn] - m|^2 + h_E^3 / d |[V_n] - p|^2),

where outward normals make the jump [V_n] a sum over both sides and [M_nn] a difference; share is 1/2 inside. Where w is
held along an edge V_n is a reaction, where the slope is held M_nn is one. Vertices need nothing: quintics take all
values there, so that the error does not feel forces at vertices and corners. A single force inside a triangle counts as
h^2 / d times its square.

|eta| overestimates the error in energy: by 42 to 156 times on 27 meshes of squares, an L and a rhombus under uniform
pressure and point loads, steadily under refinement. `SCALE` is below all of these; beside corners see `corner_share`.

Source: Gustafsson, Stenberg & Videman, SIAM J. Sci. Comput. 40 (2018) B1297 (arXiv:1707.08396).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from kshell.elements.quadrature import interval_rule, triangle_rule
from kshell.error.corner_share import of_residuals
from kshell.error.tractions import POINTS, Tractions, tractions_of
from kshell.mesh.refine import AROUND
from kshell.plate.forms import AreaSpring, EdgeSpring
from kshell.plate.linear_form import LinearForm
from kshell.plate.loading import AreaLoad, EdgeLoad
from kshell.plate.loads import Loads
from kshell.plate.problem import PlateProblem
from kshell.plate.recovery import Fields

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SCALE = 40.0
FEW = 2.0  # over the number of triangles: two and four overestimate by 31 and 39 times where all else is held
DIRECTIONS = 36


@dataclass(frozen=True)
class Loaded:
    """A deflection with its loads.

    Attributes
    ----------
    d : (dof,)
        Physical degrees of freedom.
    forms : sequence of LinearForm
    loads : Loads
        For initial curvatures; empty for duals.
    inner : sequence of int arrays
        Triangles that unit forces act inside.
    keeper : PlateProblem, optional
        Under these loads, which keeps tractions.
    """

    d: Floats
    forms: Sequence[LinearForm] = ()
    loads: Loads = field(default_factory=Loads)
    inner: Sequence[Ints] = ()
    keeper: PlateProblem | None = None

    @classmethod
    def of(cls, problem: PlateProblem, d: Floats) -> Loaded:
        """A deflection of a plate under its loads."""
        return cls(d, problem.loads.forms, problem.loads, keeper=problem)


def _softest(bending: Floats) -> Floats:
    """(T,) the least bending stiffness along any direction, however the axes are turned."""
    angle = np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    c, s = np.cos(angle), np.sin(angle)
    along = np.stack([c * c, s * s, 2.0 * c * s], axis=1)  # of curvatures w_xx, w_yy, 2 w_xy
    return np.asarray(((along @ bending) * along).sum(axis=2).min(axis=1))


class PlateResidual:
    """Residuals of deflections of one plate.

    Parameters
    ----------
    problem : PlateProblem
        With the Argyris element.
    """

    def __init__(self, problem: PlateProblem) -> None:
        self.problem, self.domain = problem, problem.domain
        mesh = problem.mesh
        self.every = problem.every
        self.size: Floats = np.sqrt(2.0 * mesh.areas)
        bending = problem.bending.at(self.every, mesh.points[mesh.triangles, :2].mean(axis=1)[:, None])[:, 0]
        self.stiffness: Floats = _softest(bending)
        self._corners = of_residuals(problem) * (1.0 + FEW / len(mesh.triangles))
        count = len(mesh.edges)
        self.held, self.turned = np.zeros(count, dtype=bool), np.zeros(count, dtype=bool)
        for group in problem.supports.held:
            self.held[group.line] = True
            self.turned[group.edges] = True
        self.s, self.weights = interval_rule(POINTS)

    def local(self, cases: Sequence[Loaded]) -> list[Floats]:
        """(T,) estimates of the square of the error in energy, triangle by triangle, of each deflection."""
        problem = self.problem
        tractions = tractions_of(
            problem,
            [case.d for case in cases],
            [case.loads for case in cases],
            [case.keeper for case in cases],
        )
        inside = self._inside(tractions, cases)
        on_edges = self._on_edges(tractions, cases)
        out = []
        for number, case in enumerate(cases):
            total = self.size**4 * inside[:, number]
            total += on_edges[:, number][problem.mesh.triangle_edges].sum(axis=1)
            for triangles in case.inner:
                total[triangles] += self.size[triangles] ** 2
            out.append(np.asarray(self._corners * total / self.stiffness / SCALE**2))
        return out

    def _inside(self, tractions: Tractions, cases: Sequence[Loaded]) -> Floats:
        """(T, k) integral of the square of the missing pressure."""
        xi, w = triangle_rule(4)
        missing = tractions.inside(xi)
        affine = tractions.affine

        def xy(chosen: Ints) -> Floats:
            jacobian = np.swapaxes(affine.jacobian[chosen], 1, 2)
            return np.asarray(affine.corners[chosen][:, None, 0] + xi @ jacobian)

        for number, case in enumerate(cases):
            for load in case.forms:
                if isinstance(load, AreaLoad):
                    chosen = self.every if load.triangles is None else load.triangles
                    missing[chosen, number] += load.values(chosen, xy(chosen))
            for _, spring in self.problem.supports.springs:
                if isinstance(spring, AreaSpring):
                    chosen = spring.triangles
                    w_there = self._fields(case).derivatives(chosen, xi, 0)[..., 0]
                    missing[chosen, number] -= spring.stiffness(xy(chosen)) * w_there
        return np.asarray((missing**2 * w).sum(axis=2) * np.abs(affine.determinant)[:, None])

    def _fields(self, case: Loaded) -> Fields:
        p = self.problem
        return Fields(p.domain, p.layout, p.bending, p.section, case.loads, case.d)

    def _on_edges(self, tractions: Tractions, cases: Sequence[Loaded]) -> Floats:
        """(edge, k) share times the squares of missing moments and forces."""
        mesh = self.problem.mesh
        moment, force = self._jumps(tractions)
        curves = self.domain.curves
        bent = curves.edges[curves.curved].astype(np.int64)
        if len(bent):
            moment[bent], force[bent] = tractions.along(self.domain.edge_points(bent, self.s, self.weights))
            both = bent[mesh.edge_counts[bent] > 1]
            if len(both):
                other = self.domain.edge_points(both, self.s, self.weights, side=1)
                its_moment, its_force = tractions.along(other)
                moment[both] -= its_moment
                force[both] += its_force
        for number, case in enumerate(cases):
            self._act(moment[:, number], force[:, number], case)
        moment[self.turned] = 0.0
        force[self.held] = 0.0
        h = mesh.edge_lengths[:, None]
        share = np.where(mesh.edge_counts == 1, 1.0, 0.5)[:, None] * h
        squares = (moment**2 @ self.weights, force**2 @ self.weights)
        return np.asarray(share * (h * squares[0] + h**3 * squares[1]))

    def _act(self, moment: Floats, force: Floats, case: Loaded) -> None:
        """Take what loads and springs exert off the missing moments and forces (edge, point)."""
        for load in case.forms:
            if isinstance(load, EdgeLoad):
                edges = np.unique(load.edges)
                values = load.value(self.domain.edge_points(edges, self.s, self.weights).xy)
                if load.moment:  # on outer edges only
                    moment[edges] -= values
                else:
                    force[edges] -= values
        for _, spring in self.problem.supports.springs:
            if isinstance(spring, EdgeSpring):
                edges = np.unique(spring.edges)
                at = self.domain.edge_points(edges, self.s, self.weights)
                k, fields = spring.stiffness(at.xy), self._fields(case)
                if spring.rotation:
                    slope = fields.derivatives(at.triangles, at.xi, 1)
                    moment[edges] -= k * (slope * at.normal).sum(axis=2)
                else:
                    force[edges] += k * fields.derivatives(at.triangles, at.xi, 0)[..., 0]

    def _jumps(self, tractions: Tractions) -> tuple[Floats, Floats]:
        """(edge, k, point) M_nn less that of the other side, and V_n and that of the other side, along chords."""
        mesh = self.problem.mesh
        start = mesh.triangles[:, AROUND]
        back = (start[..., 0] > start[..., 1]).ravel()  # walked against the edge
        inside = mesh.edge_counts > 1
        first, second = mesh.edge_table.sides
        out = []
        for values, sign in zip(tractions.sides(), (-1.0, 1.0), strict=True):
            by_side = np.moveaxis(values, 2, 1).reshape(len(back), *values.shape[1::2])  # (3 T, k, point)
            by_side[back] = by_side[back, :, ::-1]
            total = by_side[first]
            total[inside] += sign * by_side[second[inside]]
            out.append(total)
        return out[0], out[1]
