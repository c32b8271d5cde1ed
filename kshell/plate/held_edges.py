"""Supports of a plate along curves: conditions at the ends and middles of their edges.

Along an edge with unit tangent t, curvature vector k and normal n, holding w means at each vertex

    w = g,   t.grad w = g',   t.(hess w) t + k.grad w = g''          (derivatives of g by arc length)

and holding the rotation about the edge means n.grad w = s and its derivative along the edge, with n turning with the
edge, as well as w_n = s at the true midpoint; s is minus the prescribed rotation, which turns as a positive edge moment
does. Together with the C1 quintics of the Argyris element w and w_n are then right along the whole edge, exactly on
straight edges (g of degree 5, s of degree 4) and to the order of the element on curved ones. The Morley element holds
its vertex values and mean slopes.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.elements import matrices
from kshell.elements.quadrature import interval_rule
from kshell.errors import InputError
from kshell.mesh.distinct import distinct
from kshell.mesh.mesh import Mesh
from kshell.mesh.select import Selection
from kshell.mesh.words import place
from kshell.plate.curves import EdgeCurves, joined_curves
from kshell.plate.domain import Domain
from kshell.plate.forms import Bending
from kshell.plate.held import NONE, HeldGroup, Supports
from kshell.plate.holds import CurvedHold, HoldLoad, OfPlace
from kshell.plate.layout import Layout
from kshell.plate.places import points_3d
from kshell.plate.rims import edge_curves
from kshell.plate.ties import CurvedTie
from kshell.scene.supports import Support
from kshell.values.degree import polynomial_degree

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SAMPLES = np.linspace(0.0, 1.0, 6)  # where prescribed values are read along an edge: a quintic
MEAN_POINTS = 4  # of the mean of a prescribed slope
# what is held and needs its consistency terms: deflection and slope, or one of them
COMBINATIONS = ((True, True), (True, False), (False, True))


class EdgeHolder:
    """Adds supports along curves to those of a plate.

    Parameters
    ----------
    out : Supports
        What is added to.
    """

    def __init__(self, domain: Domain, layout: Layout, bending: Bending, out: Supports) -> None:
        self.domain, self.layout, self.bending, self.out = domain, layout, bending, out
        # curved edges that have their consistency terms for deflection and for slope already
        self.consistent = np.zeros((2, len(domain.mesh.edges)), dtype=bool)
        self.mesh: Mesh = domain.mesh
        self.rich = layout.per_vertex == 6  # gradients and Hessians at vertices
        self.conditions = out.conditions

    def hold(self, support: Any, selection: Selection, holds_w: bool, holds_r: bool) -> None:
        """Hold the deflection, the rotation, or both along curves.

        Raises
        ------
        InputError
            If a line of symmetry is not straight.
        """
        edges = selection.members.astype(np.int64)
        ends = self.mesh.edges[edges]  # (edge, 2)
        vertices = distinct(len(self.mesh.points), ends)
        curves = self._curves_of(edges)
        first = len(self.conditions.rows)
        if support.kind == "symmetry":
            self._require_straight(edges, selection.label)
        value = prescribed_deflection(support, self.domain) if holds_w else None
        slope = prescribed_slope(support, self.domain) if holds_r else None
        if holds_w and not self.rich:
            at = 0.0 if value is None else value(self.domain.points[vertices])
            self.conditions.at_vertices(vertices, np.ones((len(vertices), 1)), at)
        place_in = curves.place(edges)
        self.conditions.along.append((ends, curves.tangent[place_in], holds_w, holds_r))
        if self.rich:
            g = self._along(value, edges)
            s = self._along(slope, edges)
            if slope is not None:
                s *= self._outward(edges)[:, None, None]
            for end in range(2):
                t = curves.tangent[place_in, end]
                k = curves.curvature[place_in, end]
                fans = self._fans(edges, end)
                self._edge_end(fans, t, k, g[:, end] if holds_w else None, s[:, end] if holds_r else None)
        if holds_r:
            self._edge_slopes(edges, curves, slope)
        if self.rich:
            self._curved_holds(edges, selection.label, (holds_w, holds_r), value, slope)
        self.out.held.append(
            HeldGroup(
                selection.label,
                vertices if holds_w or self.rich else NONE,
                edges if holds_r else NONE,
                edges if holds_w else NONE,
                value=value,
                degree=polynomial_degree(support.value) if holds_w else 0,
                slope=slope,
                slope_degree=polynomial_degree(support.rotation) if slope is not None else 0,
                rows=range(first, len(self.conditions.rows)),
            )
        )

    def tie(self) -> None:
        """Consistency terms on curved edges inside, of the quantities that no support holds."""
        bent = self.domain.bent
        free = ~self.consistent[:, bent]
        for value, slope in COMBINATIONS:
            chosen = bent[(free[0] == value) & (free[1] == slope)]
            for side in range(2 if len(chosen) else 0):
                tie = CurvedTie(self.domain, self.layout.element, self.bending, chosen, value, slope, side)
                self.out.ties.append(tie)

    def _curves_of(self, edges: Ints) -> EdgeCurves:
        """Shape of a line of supports: as the plate follows it, if it does."""
        curves = self.domain.curves
        known = np.zeros(len(self.mesh.edges), dtype=bool)
        known[curves.edges] = True
        unknown = edges[~known[edges]]
        return (
            joined_curves(curves, edge_curves(self.mesh, unknown.astype(np.int32)))
            if len(unknown)
            else curves
        )

    def _outward(self, edges: Ints) -> Floats:
        """(edge,) 1 where the tangent from the lower to the higher vertex, turned by -90 degrees, points outwards."""
        patch = self.domain.edge_points(edges, np.array([0.5]), np.ones(1))
        ends = self.domain.points[self.mesh.edges[edges]]
        chord = ends[:, 1] - ends[:, 0]
        normal = patch.normal[:, 0]
        return np.sign(chord[:, 1] * normal[:, 0] - chord[:, 0] * normal[:, 1])

    def _fans(self, edges: Ints, end: int) -> Ints:
        """(2, n) fans on both sides of edges at one end."""
        vertex = self.mesh.edges[edges, end].astype(np.int64)
        if not self.layout.fans.extra:
            return np.stack([vertex, vertex])
        sides = self.domain.sides(edges)
        corner = np.argmax(self.mesh.triangles[sides] == vertex[None, :, None], axis=2)
        return self.layout.fans.corner[sides, corner].astype(np.int64)

    def _edge_end(self, fans: Ints, t: Floats, k: Floats, g: Floats | None, s: Floats | None) -> None:
        """Rows at one end of each edge, between fans (2, n) there.

        Parameters
        ----------
        g, s : (n, 3), optional
            Prescribed w, and w_n along t turned by -90 degrees, with their derivatives by arc length; None: not held.
        """
        self._fan_rows(fans[0], t, k, g, s)
        other = fans[1] != fans[0]
        if other.any():
            self._fan_rows(
                fans[1, other],
                t[other],
                k[other],
                None if g is None else g[other],
                None if s is None else s[other],
            )

    def _fan_rows(self, fans: Ints, t: Floats, k: Floats, g: Floats | None, s: Floats | None) -> None:
        h = self.layout.vertex_sizes[self.layout.fans.vertex[fans]]
        tx, ty, add = t[:, 0], t[:, 1], self.conditions.at_vertices
        kx, ky = k[:, 0] * h, k[:, 1] * h
        none, one = np.zeros(len(fans)), np.ones(len(fans))
        if g is not None:
            add(fans, np.stack([one, none, none, none, none, none], axis=1), g[:, 0])
            add(fans, np.stack([none, tx, ty, none, none, none], axis=1), g[:, 1] * h)
            second = np.stack([none, kx, ky, tx * tx, 2 * tx * ty, ty * ty], axis=1)
            add(fans, second, g[:, 2] * h**2)
        if s is not None:
            nx, ny = ty, -tx
            add(fans, np.stack([none, nx, ny, none, none, none], axis=1), s[:, 0] * h)
            # n = t turned by -90 degrees, so dn/ds = k turned by -90 degrees
            turned = np.stack([none, ky, -kx, tx * nx, tx * ny + ty * nx, ty * ny], axis=1)
            add(fans, turned, s[:, 1] * h**2)

    def _curved_holds(
        self, edges: Ints, label: str, holds: tuple[bool, bool], value: OfPlace | None, slope: OfPlace | None
    ) -> None:
        """Consistency terms on curved edges, once for each edge, side and quantity."""
        curves = self.domain.curves
        if not curves.curved.any():
            return
        bent = edges[np.isin(edges, curves.edges[curves.curved])]
        needs = np.array(holds)[:, None] & ~self.consistent[:, bent]
        self.consistent[:, bent] |= needs
        for of_value, of_slope in COMBINATIONS:
            chosen = bent[(needs[0] == of_value) & (needs[1] == of_slope)]
            for side in range(2):
                if side:
                    chosen = chosen[self.mesh.edge_counts[chosen] > 1]
                if not len(chosen):
                    continue
                hold = CurvedHold(
                    self.domain, self.layout.element, self.bending, chosen, of_value, of_slope, side
                )
                self.out.holds.append((label, hold))
                given = value if of_value else None, slope if of_slope else None
                if any(part is not None for part in given):
                    self.out.hold_loads.append(HoldLoad(hold, *given))

    def _along(self, function: OfPlace | None, edges: Ints) -> Floats:
        """A function and its first and second derivative by arc length at both ends of edges: (edge, end, 3)."""
        out = np.zeros((len(edges), 2, 3))
        if function is None:
            return out
        patch = self.domain.edge_points(edges, SAMPLES, np.ones(len(SAMPLES)))
        g = function(patch.xy)
        vandermonde = np.vander(SAMPLES, increasing=True)
        c = np.linalg.solve(vandermonde, g.T)  # (power, edge)
        c[1:][np.abs(c[1:]) < 1e-10 * np.abs(g).max()] = 0.0
        x = np.linalg.solve(vandermonde, patch.xy.transpose(1, 0, 2).reshape(6, -1)).reshape(6, -1, 2)
        power = np.arange(6)
        for end, s in enumerate((0.0, 1.0)):
            at = [
                s**power,
                power * s ** np.maximum(power - 1, 0),
                power * (power - 1) * s ** np.maximum(power - 2, 0),
            ]
            value, first, second = (weights @ c for weights in at)
            velocity, acceleration = (np.einsum("k,kex->ex", weights, x) for weights in at[1:])
            speed = np.hypot(velocity[:, 0], velocity[:, 1])
            slowing = (velocity * acceleration).sum(1) / speed
            by_arc = first / speed
            out[:, end] = np.stack([value, by_arc, (second - by_arc * slowing) / speed**2], axis=1)
        return out

    def _edge_slopes(self, edges: Ints, curves: EdgeCurves, slope: OfPlace | None) -> None:
        """w_n at midpoints: the edge's own degree of freedom, or the true midpoint of a curved edge."""
        conditions = self.conditions
        bent = np.zeros(len(edges), dtype=bool)
        if self.rich and curves.curved.any():
            followed = np.isin(edges, self.domain.curves.edges)
            bent = followed & curves.curved[curves.place(edges)]
        given = np.zeros(len(edges))
        if slope is not None:
            # the mean slope of an edge is what Morley's element knows, the slope in the middle what quintics do
            s, w = (np.array([0.5]), np.ones(1)) if self.rich else interval_rule(MEAN_POINTS)
            given = slope(self.domain.edge_points(edges, s, w).xy) @ w
            given[~bent] *= self._outward(edges[~bent])
        conditions.edges.append(edges[~bent])
        conditions.edge_values.append(given[~bent])
        if bent.any():
            patch = self.domain.edge_points(edges[bent], np.array([0.5]), np.ones(1))
            affine = self.domain.affine(patch.triangles)
            element = self.layout.element
            gradient = matrices.rows(element, affine, patch.xi, 1, element.transformation(affine))
            rows = (patch.normal[:, :, None, :] @ gradient)[:, 0, 0]
            conditions.triangle_edges.append(edges[bent])
            conditions.triangles.append(patch.triangles)
            conditions.triangle_rows.append(rows)
            conditions.triangle_values.append(given[bent])

    def _require_straight(self, edges: Ints, label: str) -> None:
        """Lines of symmetry may meet at corners, but each must be straight."""
        curves = edge_curves(self.mesh, edges.astype(np.int32))
        if curves.curved.any():
            edge = curves.edges[int(np.abs(curves.shape).max(axis=(1, 2)).argmax())]
            where = self.domain.points[self.mesh.edges[edge]].mean(axis=0)
            raise InputError(
                f"support symmetry on '{label}': the group is not straight but curved near {place(where)}, and "
                "only a straight edge can be a line of symmetry; split the group, or hold the rotation alone "
                'with fix = "r"'
            )


def prescribed_deflection(support: Support, domain: Domain) -> OfPlace | None:
    """The prescribed deflection at points (..., 2); None is zero."""
    if support.value is None:
        return None
    return lambda xy: support.translation_at(points_3d(domain, xy))[..., 2]


def prescribed_slope(support: Support, domain: Domain) -> OfPlace | None:
    """The prescribed derivative along the outward normal at points (..., 2); None is zero."""
    if support.rotation is None:
        return None
    return lambda xy: -support.rotation_at(points_3d(domain, xy))
