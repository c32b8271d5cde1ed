"""Supports of a plate: from names to conditions on degrees of freedom, and springs.

Along an edge with unit tangent t, curvature vector k and normal n, holding w means at each vertex

    w = g,   t.grad w = g',   t.(hess w) t + k.grad w = g''          (derivatives of g by arc length)

and holding the rotation about the edge means n.grad w = 0 and its derivative along the edge, with n
turning with the edge, as well as w_n = 0 at the true midpoint. Together with the C1 quintics of the
Argyris element this makes w and w_n vanish along the whole edge, exactly on straight edges and to the
order of the element on curved ones. The Morley element holds its vertex and midpoint values.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.elements import matrices
from kshell.errors import InputError
from kshell.mesh.mesh import Mesh
from kshell.mesh.select import Selection
from kshell.mesh.words import place
from kshell.plate.conditions import Conditions
from kshell.plate.curves import EdgeCurves, edge_curves, joined_curves
from kshell.plate.domain import Domain
from kshell.plate.forms import AreaSpring, Bending, EdgeSpring, Form, PointSpring
from kshell.plate.holds import CurvedHold, HoldLoad
from kshell.plate.layout import Layout
from kshell.plate.ties import CurvedTie
from kshell.scene.handlers import Handlers
from kshell.scene.structure import Placed
from kshell.scene.supports import Clamped, Elastic, Fixed, Free, SimplySupported, Support, Symmetry
from kshell.values.degree import polynomial_degree

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SAMPLES = np.linspace(0.0, 1.0, 6)  # where prescribed values are read along an edge: a quintic
NONE = np.zeros(0, dtype=np.int64)
UPRIGHT = 1e-9  # component of a unit vector that is rounding

HANDLERS = Handlers('is for shells: take model = "shell", or leave it out')


@dataclass
class HeldGroup:
    """What one support holds, for reactions.

    Attributes
    ----------
    label : str
    vertices : (n,) int array
    edges : (n,) int array
        Edges whose slope is held.
    line : (n,) int array
        Edges along which the deflection is held.
    points : (n,) int array
        Vertices at which the deflection alone is held, without an edge.
    surface : (n,) int array
        Triangles that are held whole.
    turned : bool
        Whether the rotation is held at single points.
    value : function or None
        Prescribed deflection at points (..., 2); None is zero.
    degree : int or None
        Of that deflection as a polynomial; None where it is none, or not known to be one.
    rows : range
        Its rows among the conditions.
    """

    label: str
    vertices: Ints
    edges: Ints
    line: Ints
    points: Ints = field(default_factory=lambda: NONE)
    surface: Ints = field(default_factory=lambda: NONE)
    turned: bool = False
    value: Callable[[Floats], Floats] | None = None
    degree: int | None = 0
    rows: range = range(0)

    def times(self, motion: float) -> HeldGroup:
        """The same with the prescribed deflection times a number."""
        value = self.value
        if value is None:
            return self
        return replace(self, value=lambda xy: motion * value(xy))


@dataclass
class Supports:
    """All supports of a scene on one element.

    Attributes
    ----------
    conditions : Conditions
    ties : list of CurvedTie
        Consistency terms of curved edges inside where nothing is held.
    springs : list of (label, Form)
    held : list of HeldGroup
    holds : list of (label, CurvedHold)
        Consistency terms of held curved edges.
    hold_loads : list of HoldLoad
        Their right-hand sides where a deflection is prescribed.
    warnings : list of str
    """

    conditions: Conditions = field(default_factory=Conditions)
    ties: list[CurvedTie] = field(default_factory=list)
    springs: list[tuple[str, Form]] = field(default_factory=list)
    held: list[HeldGroup] = field(default_factory=list)
    holds: list[tuple[str, CurvedHold]] = field(default_factory=list)
    hold_loads: list[HoldLoad] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    def times(self, motion: float) -> Supports:
        """The same with the prescribed deflections times a number; conditions keep theirs."""
        return replace(
            self,
            held=[group.times(motion) for group in self.held],
            hold_loads=[load.times(motion) for load in self.hold_loads],
        )


def apply_supports(
    supports: Iterable[Placed[Support]], domain: Domain, layout: Layout, bending: Bending
) -> Supports:
    """Translate the supports of a structure.

    Raises
    ------
    InputError
        For supports that do not fit the element, or that plates do not have.
    """
    builder = _Builder(domain, layout, bending)
    for placed in supports:
        HANDLERS.handle(builder, placed, builder.out.warnings)
    builder.tie()
    return builder.out


def points_3d(domain: Domain, xy: Floats) -> Floats:
    """Points (..., 2) of the plane of the mesh as (..., 3), for functions of the place."""
    z = np.broadcast_to(domain.mesh.points[0, 2], (*xy.shape[:-1], 1))
    return np.concatenate([xy, z], axis=-1)


class _Builder:
    def __init__(self, domain: Domain, layout: Layout, bending: Bending) -> None:
        self.domain, self.layout, self.bending = domain, layout, bending
        # curved edges that have their consistency terms for deflection and for slope already
        self.consistent = np.zeros((2, len(domain.mesh.edges)), dtype=bool)
        self.mesh: Mesh = domain.mesh
        self.rich = layout.per_vertex == 6  # gradients and Hessians at vertices
        self.out = Supports()

    @HANDLERS.of(Free)
    def _free(self, support: Any, placed: Placed[Any]) -> None:
        """Nothing is held."""

    @HANDLERS.of(Clamped, SimplySupported, Symmetry, Fixed)
    def _held(self, support: Any, placed: Placed[Any]) -> None:
        selection = placed.place
        assert selection is not None  # supports are somewhere
        what = f"support {support.kind}"
        if getattr(support, "axes", None) is not None:
            raise InputError(
                f"{what} on '{selection.label}': axes of its own are for shells, where motion in the plane counts; set "
                'model = "shell", or leave axes out'
            )
        holds_w, holds_r = "z" in support.freedoms, "r" in support.freedoms
        if not (holds_w or holds_r):
            return  # in-plane freedoms do not concern a plate in bending
        if selection.dimension == 0:
            self._points(support, selection, holds_w, holds_r, what)
        elif selection.dimension == 1:
            self._edges(support, selection, holds_w, holds_r, what)
        else:
            self._surface(support, selection, holds_w, holds_r, what)

    def _value(self, support: Any, xy: Floats) -> Floats:
        return support.translation_at(points_3d(self.domain, xy))[..., 2]

    def _prescribed(self, support: Any) -> Callable[[Floats], Floats] | None:
        """The prescribed deflection as a function of the place."""
        return None if support.value is None else lambda xy: self._value(support, xy)

    def _row(self, entries: dict[int, Floats | float], count: int) -> Floats:
        rows = np.zeros((count, self.layout.per_vertex))
        for dof, value in entries.items():
            rows[:, dof] = value
        return rows

    def _points(self, support: Any, selection: Selection, holds_w: bool, holds_r: bool, what: str) -> None:
        vertices = selection.members.astype(np.int64)
        conditions = self.out.conditions
        first = len(conditions.rows)
        if holds_r and not self.rich:
            raise InputError(
                f"{what} on '{selection.label}': this element has no rotation at a point; hold the "
                'deflection there (simply_supported), clamp a short edge, or use element = "argyris"'
            )
        if holds_w:
            value = self._value(support, self.domain.points[vertices])
            conditions.at_vertices(vertices, self._row({0: 1.0}, len(vertices)), value)
        if holds_r:
            for dof, axis in zip((1, 2), np.eye(2), strict=True):
                conditions.at_vertices(vertices, self._row({dof: 1.0}, len(vertices)))
                conditions.slope_vertices.append(vertices)
                conditions.slopes.append(np.tile(axis, (len(vertices), 1)))
        points = vertices if holds_w else NONE
        prescribed = self._prescribed(support)
        group = HeldGroup(
            selection.label,
            vertices,
            NONE,
            NONE,
            points,
            turned=holds_r,
            value=prescribed,
            degree=polynomial_degree(support.value),
            rows=range(first, len(conditions.rows)),
        )
        self.out.held.append(group)

    def _surface(self, support: Any, selection: Selection, holds_w: bool, holds_r: bool, what: str) -> None:
        if not holds_w:
            raise InputError(
                f"{what} on '{selection.label}': on a surface hold the deflection too (freedom z)"
            )
        vertices = np.unique(self.mesh.triangles[selection.members]).astype(np.int64)
        fans = np.unique(self.layout.fans.corner[selection.members]).astype(np.int64)
        value = self._value(support, self.domain.points[vertices])
        if np.ptp(value) > 1e-12 * np.abs(value).max():
            raise InputError(
                f"{what} on '{selection.label}': on a surface the prescribed deflection must be constant; "
                "prescribe a varying one along curves"
            )
        first = len(self.out.conditions.rows)
        self.out.conditions.at_vertices(vertices, self._row({0: 1.0}, len(vertices)), value)
        for dof in range(1, self.layout.per_vertex):
            at = vertices if dof < 3 else fans  # beside the border the plate bends
            self.out.conditions.at_vertices(at, self._row({dof: 1.0}, len(at)))
        for axis in np.eye(2):
            self.out.conditions.slope_vertices.append(vertices)
            self.out.conditions.slopes.append(np.tile(axis, (len(vertices), 1)))
        edges = np.unique(self.mesh.triangle_edges[selection.members]).astype(np.int64)
        self.out.conditions.edges.append(edges)
        surface = selection.members.astype(np.int64)
        prescribed = self._prescribed(support)
        group = HeldGroup(
            selection.label,
            vertices,
            edges,
            NONE,
            surface=surface,
            value=prescribed,
            degree=polynomial_degree(support.value),
            rows=range(first, len(self.out.conditions.rows)),
        )
        self.out.held.append(group)

    def _curves_of(self, edges: Ints) -> EdgeCurves:
        """Shape of a line of supports: as the plate follows it, if it does."""
        curves = self.domain.curves
        unknown = edges[~np.isin(edges, curves.edges)]
        return (
            joined_curves(curves, edge_curves(self.mesh, unknown.astype(np.int32)))
            if len(unknown)
            else curves
        )

    def _edges(self, support: Any, selection: Selection, holds_w: bool, holds_r: bool, what: str) -> None:
        edges = selection.members.astype(np.int64)
        ends = self.mesh.edges[edges]  # (edge, 2)
        vertices = np.unique(ends).astype(np.int64)
        curves = self._curves_of(edges)
        first = len(self.out.conditions.rows)
        if support.kind == "symmetry":
            self._require_straight(edges, selection.label)
        if holds_w and not self.rich:
            value = self._value(support, self.domain.points[vertices])
            self.out.conditions.at_vertices(vertices, self._row({0: 1.0}, len(vertices)), value)
        place_in = curves.place(edges)
        for end in range(2):
            t = curves.tangent[place_in, end]
            directions = [t] * holds_w + [np.stack([t[:, 1], -t[:, 0]], axis=1)] * holds_r
            for direction in directions:
                self.out.conditions.slope_vertices.append(ends[:, end].astype(np.int64))
                self.out.conditions.slopes.append(direction)
        if self.rich:
            values = self._edge_values(support, edges) if holds_w else np.zeros((len(edges), 2, 3))
            for end in range(2):
                t = curves.tangent[place_in, end]
                k = curves.curvature[place_in, end]
                self._edge_end(self._fans(edges, end), t, k, values[:, end], holds_w, holds_r)
        if holds_r:
            self._edge_slopes(edges, curves)
        if self.rich:
            self._curved_holds(support, edges, selection.label, holds_w, holds_r)
        held_vertices = vertices if holds_w or self.rich else NONE
        group = HeldGroup(
            selection.label,
            held_vertices,
            edges if holds_r else NONE,
            edges if holds_w else NONE,
            value=self._prescribed(support) if holds_w else None,
            degree=polynomial_degree(support.value) if holds_w else 0,
            rows=range(first, len(self.out.conditions.rows)),
        )
        self.out.held.append(group)

    def _fans(self, edges: Ints, end: int) -> Ints:
        """(2, n) fans on both sides of edges at one end."""
        vertex = self.mesh.edges[edges, end].astype(np.int64)
        if not self.layout.fans.extra:
            return np.stack([vertex, vertex])
        sides = self.domain.sides(edges)
        corner = np.argmax(self.mesh.triangles[sides] == vertex[None, :, None], axis=2)
        return self.layout.fans.corner[sides, corner].astype(np.int64)

    def _edge_end(self, fans: Ints, t: Floats, k: Floats, g: Floats, holds_w: bool, holds_r: bool) -> None:
        """Rows at one end of each edge, between fans (2, n) there; g (n, 3): prescribed w and its derivatives by s."""
        self._fan_rows(fans[0], t, k, g, holds_w, holds_r)
        other = fans[1] != fans[0]
        if other.any():
            self._fan_rows(fans[1, other], t[other], k[other], g[other], holds_w, holds_r)

    def _fan_rows(self, fans: Ints, t: Floats, k: Floats, g: Floats, holds_w: bool, holds_r: bool) -> None:
        h = self.layout.vertex_sizes[self.layout.fans.vertex[fans]]
        n = len(fans)
        tx, ty, conditions = t[:, 0], t[:, 1], self.out.conditions
        kx, ky = k[:, 0] * h, k[:, 1] * h
        if holds_w:
            conditions.at_vertices(fans, self._row({0: 1.0}, n), g[:, 0])
            conditions.at_vertices(fans, self._row({1: tx, 2: ty}, n), g[:, 1] * h)
            second = self._row({1: kx, 2: ky, 3: tx * tx, 4: 2 * tx * ty, 5: ty * ty}, n)
            conditions.at_vertices(fans, second, g[:, 2] * h**2)
        if holds_r:
            nx, ny = ty, -tx
            conditions.at_vertices(fans, self._row({1: nx, 2: ny}, n))
            # n = t turned by -90 degrees, so dn/ds = k turned by -90 degrees
            turned: dict[int, Floats | float] = {1: ky, 2: -kx, 3: tx * nx, 4: tx * ny + ty * nx, 5: ty * ny}
            conditions.at_vertices(fans, self._row(turned, n))

    def _curved_holds(self, support: Any, edges: Ints, label: str, holds_w: bool, holds_r: bool) -> None:
        """Consistency terms on curved edges, once for each edge, side and quantity."""
        curves = self.domain.curves
        if not curves.curved.any():
            return
        bent = edges[np.isin(edges, curves.edges[curves.curved])]
        needs = np.array([[holds_w], [holds_r]]) & ~self.consistent[:, bent]
        self.consistent[:, bent] |= needs
        for value, slope in ((True, True), (True, False), (False, True)):
            chosen = bent[(needs[0] == value) & (needs[1] == slope)]
            for side in range(2):
                if side:
                    chosen = chosen[self.mesh.edge_counts[chosen] > 1]
                if not len(chosen):
                    continue
                hold = CurvedHold(self.domain, self.layout.element, self.bending, chosen, value, slope, side)
                self.out.holds.append((label, hold))
                if value and support.value is not None:
                    self.out.hold_loads.append(HoldLoad(hold, lambda xy: self._value(support, xy)))

    def tie(self) -> None:
        """Consistency terms on curved edges inside, of the quantities that no support holds."""
        bent = self.domain.bent
        free = ~self.consistent[:, bent]
        for value, slope in ((True, True), (True, False), (False, True)):
            chosen = bent[(free[0] == value) & (free[1] == slope)]
            for side in range(2 if len(chosen) else 0):
                tie = CurvedTie(self.domain, self.layout.element, self.bending, chosen, value, slope, side)
                self.out.ties.append(tie)

    def _edge_values(self, support: Any, edges: Ints) -> Floats:
        """Prescribed w and its first and second derivative by arc length at both ends: (edge, end, 3)."""
        out = np.zeros((len(edges), 2, 3))
        if support.value is None:
            return out
        patch = self.domain.edge_points(edges, SAMPLES, np.ones(len(SAMPLES)))
        g = self._value(support, patch.xy)
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

    def _edge_slopes(self, edges: Ints, curves: EdgeCurves) -> None:
        """w_n = 0 at midpoints: the edge's own degree of freedom, or the true midpoint of a curved edge."""
        conditions = self.out.conditions
        bent = np.zeros(len(edges), dtype=bool)
        if self.rich and curves.curved.any():
            followed = np.isin(edges, self.domain.curves.edges)
            bent = followed & curves.curved[curves.place(edges)]
        conditions.edges.append(edges[~bent])
        if bent.any():
            patch = self.domain.edge_points(edges[bent], np.array([0.5]), np.ones(1))
            affine = self.domain.affine(patch.triangles)
            element = self.layout.element
            gradient = matrices.rows(element, affine, patch.xi, 1, element.transformation(affine))
            rows = (patch.normal[:, :, None, :] @ gradient)[:, 0, 0]
            conditions.triangle_edges.append(edges[bent])
            conditions.triangles.append(patch.triangles)
            conditions.triangle_rows.append(rows)

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

    @HANDLERS.of(Elastic)
    def _springs(self, support: Any, placed: Placed[Any]) -> None:
        selection = placed.place
        assert selection is not None  # supports are somewhere
        what = f"support {support.kind}"
        letters = _spring_letters(support, f"{what} on '{selection.label}'")
        if not letters:
            return
        members = selection.members.astype(np.int64)
        element = self.layout.element

        def stiffness(xy: Floats) -> Floats:
            return support.stiffness_at(points_3d(self.domain, xy))

        label, degree = selection.label, polynomial_degree(support.stiffness)
        if selection.dimension == 2:
            if "r" in letters:
                raise InputError(
                    f"{what} on '{label}': a rotation spring needs a curve or a point, not a surface"
                )
            self.out.springs.append((label, AreaSpring(self.domain, element, members, stiffness, degree)))
        elif selection.dimension == 1:
            for freedom in letters:
                form = EdgeSpring(self.domain, element, members, stiffness, freedom == "r", degree)
                self.out.springs.append((label, form))
        else:
            self._point_springs(letters, selection, stiffness, what)

    def _point_springs(self, letters: str, selection: Selection, stiffness: Any, what: str) -> None:
        vertices = selection.members.astype(np.int64)
        k = stiffness(self.domain.points[vertices])
        dofs = [0] if "z" in letters else []
        if "r" in letters:
            if not self.rich:
                raise InputError(
                    f"{what} on '{selection.label}': this element has no rotation at a point; use "
                    'element = "argyris"'
                )
            dofs += [1, 2]
        triangles, corner = first_triangles(self.mesh, vertices)
        for dof in dofs:
            rows = np.zeros((len(vertices), self.layout.element.count))
            rows[np.arange(len(vertices)), corner * self.layout.per_vertex + dof] = 1.0
            form = PointSpring(self.layout.element, self.domain, triangles, rows, k)
            self.out.springs.append((selection.label, form))


def _spring_letters(support: Elastic, what: str) -> str:
    """Of springs those that a plate in bending feels: "z" and "r".

    Raises
    ------
    InputError
        If some lean out of the plane, so that bending and stretching are not apart.
    """
    letters = ""
    for along in support.directions():
        if isinstance(along, str):
            letters += "r" if along == "r" else "z"
        elif abs(along[2]) > 1.0 - UPRIGHT:
            letters += "z"
        elif abs(along[2]) > UPRIGHT:
            raise InputError(
                f"{what}: a spring along {place(along)} couples bending with motion in the plane, which a plate does "
                'not have: set model = "shell"'
            )
    return letters


def first_triangles(mesh: Mesh, vertices: Ints) -> tuple[Ints, Ints]:
    """One triangle at each vertex, and the vertex's place in it."""
    flat = mesh.triangles.ravel()
    first = np.full(len(mesh.points), -1, dtype=np.int64)
    first[flat[::-1]] = np.arange(len(flat))[::-1]
    return first[vertices] // 3, first[vertices] % 3
