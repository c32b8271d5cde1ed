"""Residuals of an Argyris plate as an estimate of its error, on curved edges and with any stiffness.

With M = - D kappa, h the square root of twice the area of a triangle T, h_E the length of an edge E, d the smallest of
the two bending stiffnesses along x and y, outward normals on both sides, and V_n = Q_n + d M_nt / dt,

    eta_T^2 = h^4 / d |q - k w + div Q|^2
              + sum over E of share (h_E / d |[M_nn] - m|^2 + h_E^3 / d |[V_n] - p|^2),

where outward normals make the jump [V_n] a sum over both sides and [M_nn] a difference; share is 1/2 inside. Where w is
held along an edge V_n is a reaction, where the slope is held M_nn is one. Vertices need nothing: quintics take all
values there, so that the error does not feel forces at vertices and corners. A single force inside a triangle counts as
h^2 / d times its square.

|eta| overestimates the error in energy: by 42 to 156 times on 27 meshes of squares, an L and a rhombus under uniform
pressure and point loads, steadily under refinement. `SCALE` is below all of these.

Source: Gustafsson, Stenberg & Videman, SIAM J. Sci. Comput. 40 (2018) B1297 (arXiv:1707.08396).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kshell.elements.quadrature import interval_rule, triangle_rule
from kshell.elements.reference import VERTICES
from kshell.mesh.refine import AROUND
from kshell.plate.domain import EdgePatch
from kshell.plate.forms import AreaSpring, EdgeSpring
from kshell.plate.loading import AreaLoad, EdgeLoad, LinearForm
from kshell.plate.loads import Loads
from kshell.plate.problem import PlateProblem
from kshell.plate.recovery import Fields
from kshell.shell.reference import first_derivatives, lattice

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SCALE = 40.0
POINTS = 4  # on edges: moments of quintics are cubics there


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
        self.every = np.arange(len(mesh.triangles))
        self.edges = np.arange(len(mesh.edges))
        self.size: Floats = np.sqrt(2.0 * mesh.areas)
        bending = problem.bending.at(self.every, mesh.points[mesh.triangles, :2].mean(axis=1)[:, None])[:, 0]
        self.stiffness: Floats = np.minimum(bending[:, 0, 0], bending[:, 1, 1])
        count = len(mesh.edges)
        self.held, self.turned = np.zeros(count, dtype=bool), np.zeros(count, dtype=bool)
        for group in problem.supports.held:
            self.held[group.line] = True
            self.turned[group.edges] = True
        s, w = interval_rule(POINTS)
        self._along, self._weights = _differentiation(s), w
        corners = VERTICES[AROUND]  # (edge, end, 2)
        self._on_sides = (corners[:, :1] + s[:, None] * (corners[:, 1:] - corners[:, :1])).reshape(-1, 2)
        self.affine = self.domain.affine(self.every)
        ends = self.affine.corners[:, AROUND]
        step = ends[:, :, 1] - ends[:, :, 0]  # (T, edge, 2), walked counter-clockwise
        self._length: Floats = np.hypot(step[..., 0], step[..., 1])
        self._tangent: Floats = step / self._length[..., None]
        start = mesh.triangles[:, AROUND]
        self._ahead = start[..., 0] < start[..., 1]
        self._second = np.arange(len(mesh.triangles))[:, None] != mesh.edge_owner[mesh.triangle_edges, 0]
        self._patch = self.domain.edge_points(self.edges, s, w)
        bent = self.domain.curves.edges[self.domain.curves.curved].astype(np.int64)
        both = bent[mesh.edge_counts[bent] > 1]
        self._bent = self.domain.edge_points(bent, s, w) if len(bent) else None
        self._bent_inside = self.domain.edge_points(both, s, w, side=1) if len(both) else None

    def local(
        self, d: Floats, forms: Sequence[LinearForm], loads: Loads, inner: Sequence[Ints] = ()
    ) -> Floats:
        """(T,) estimate of the square of the error in energy, triangle by triangle.

        Parameters
        ----------
        d : (dof,)
            Physical degrees of freedom of the deflection.
        forms : sequence of LinearForm
            The loads of the deflection.
        loads : Loads
            For initial curvatures; empty for duals.
        inner : sequence of int arrays
            Triangles that unit forces act inside.
        """
        p = self.problem
        fields = Fields(p.domain, p.layout, p.bending, p.section, loads, d)
        out = self.size**4 * self._inside(fields, forms)
        on_edges = self._on_edges(fields, forms)
        out += on_edges[p.mesh.triangle_edges].sum(axis=1)
        for triangles in inner:
            out[triangles] += self.size[triangles] ** 2
        scaled: Floats = out / self.stiffness / SCALE**2
        return scaled

    def _inside(self, fields: Fields, forms: Sequence[LinearForm]) -> Floats:
        """(T,) integral of the square of the missing pressure."""
        domain = self.domain
        affine = domain.affine(self.every)
        nodes = lattice(2)
        shear = fields.shear(self.every, nodes, self._xy(nodes))
        xi, w = triangle_rule(4)
        xy = self._xy(xi)
        # (direction, point, node) along the reference axes, then along x and y
        slopes = np.einsum("aqk,tkv->tqav", first_derivatives(2, xi), shear)
        missing = np.einsum("tqav,tav->tq", slopes, affine.inverse)
        for load in forms:
            if isinstance(load, AreaLoad):
                chosen = self.every if load.triangles is None else load.triangles
                missing[chosen] += load.values(chosen, xy[chosen])
        for _, spring in self.problem.supports.springs:
            if isinstance(spring, AreaSpring):
                chosen = spring.triangles
                w_there = fields.derivatives(chosen, xi, 0)[..., 0]
                missing[chosen] -= spring.stiffness(xy[chosen]) * w_there
        return np.asarray((missing**2 * w).sum(axis=1) * np.abs(affine.determinant))

    def _xy(self, xi: Floats) -> Floats:
        affine = self.affine
        return np.asarray(affine.corners[:, None, 0] + xi @ np.swapaxes(affine.jacobian, 1, 2))

    def _on_edges(self, fields: Fields, forms: Sequence[LinearForm]) -> Floats:
        """(edge,) share times the squares of missing moments and forces."""
        mesh = self.problem.mesh
        moment, force = self._jumps(fields)
        if self._bent is not None:
            moment[self._bent.edges], force[self._bent.edges] = self._tractions(fields, self._bent)
        if self._bent_inside is not None:
            other, its_force = self._tractions(fields, self._bent_inside)
            moment[self._bent_inside.edges] -= other
            force[self._bent_inside.edges] += its_force
        for load in forms:
            if isinstance(load, EdgeLoad):
                edges = np.unique(load.edges)
                values = load.value(self._patch.xy[edges])
                if load.moment:  # on outer edges only
                    moment[edges] -= values
                else:
                    force[edges] -= values
        for _, spring in self.problem.supports.springs:
            if isinstance(spring, EdgeSpring):
                edges = np.unique(spring.edges)
                k = spring.stiffness(self._patch.xy[edges])
                triangles, xi = self._patch.triangles[edges], self._patch.xi[edges]
                if spring.rotation:
                    slope = fields.derivatives(triangles, xi, 1)
                    moment[edges] -= k * (slope * self._patch.normal[edges]).sum(axis=2)
                else:
                    force[edges] += k * fields.derivatives(triangles, xi, 0)[..., 0]
        moment[self.turned] = 0.0
        force[self.held] = 0.0
        h, w = mesh.edge_lengths, self._patch.weights
        share = np.where(mesh.edge_counts == 1, 1.0, 0.5)
        return np.asarray(share * (h * (moment**2 * w).sum(axis=1) + h**3 * (force**2 * w).sum(axis=1)))

    def _jumps(self, fields: Fields) -> tuple[Floats, Floats]:
        """(edge, point) M_nn less that of the other side, and V_n and that of the other side, along chords."""
        mesh = self.problem.mesh
        shape = (len(self.every), 3, POINTS, -1)
        xy = self._xy(self._on_sides)
        m = fields.moment(self.every, self._on_sides, xy).reshape(shape)
        q = fields.shear(self.every, self._on_sides, xy).reshape(shape)
        tx, ty = self._tangent[..., 0, None], self._tangent[..., 1, None]
        nx, ny = ty, -tx
        normal = nx**2 * m[..., 0] + ny**2 * m[..., 1] + 2 * nx * ny * m[..., 2]
        twist = nx * tx * m[..., 0] + ny * ty * m[..., 1] + (nx * ty + ny * tx) * m[..., 2]
        force = nx * q[..., 0] + ny * q[..., 1] + twist @ self._along.T / self._length[..., None]
        back = ~self._ahead
        for values in (normal, force):
            values[back] = values[back][:, ::-1]
        normal[self._second] *= -1.0
        out = np.zeros((2, len(mesh.edges), POINTS))
        for side in (self._second, ~self._second):
            out[:, mesh.triangle_edges[side]] += np.stack([normal[side], force[side]])
        return out[0], out[1]

    def _tractions(self, fields: Fields, patch: EdgePatch) -> tuple[Floats, Floats]:
        """M_nn and V_n (n, point) of the triangles of a patch, by their outward normals."""
        m = fields.moment(patch.triangles, patch.xi, patch.xy)
        q = fields.shear(patch.triangles, patch.xi, patch.xy)
        nx, ny = patch.normal[..., 0], patch.normal[..., 1]
        tx, ty = -ny, nx
        normal = nx**2 * m[..., 0] + ny**2 * m[..., 1] + 2 * nx * ny * m[..., 2]
        twist = nx * tx * m[..., 0] + ny * ty * m[..., 1] + (nx * ty + ny * tx) * m[..., 2]
        speed = patch.weights / self._weights
        step = patch.xy[:, -1] - patch.xy[:, 0]
        sense = np.sign(tx.mean(axis=1) * step[:, 0] + ty.mean(axis=1) * step[:, 1])[:, None]
        change = sense * (twist @ self._along.T) / speed
        return normal, nx * q[..., 0] + ny * q[..., 1] + change


def _differentiation(s: Floats) -> Floats:
    """(point, point) matrix that differentiates the polynomial through values at points."""
    powers = np.vander(s, increasing=True)
    slopes = np.zeros_like(powers)
    slopes[:, 1:] = powers[:, :-1] * np.arange(1, len(s))
    return np.asarray(slopes @ np.linalg.inv(powers))
