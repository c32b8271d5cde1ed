"""From supports, springs and loads of a plate, as `kshell.plate` reads them from a scene, to those of this element.

Both elements of a pair of bounds are told the same: what an Argyris or Morley problem holds and carries is taken
over edge by edge and triangle by triangle, and integrated with rules that are exact for the same polynomials.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kshell.elements.hierarchic import orthonormal
from kshell.elements.jets import legendre
from kshell.elements.quadrature import interval_rule, triangle_rule
from kshell.errors import InputError
from kshell.material.section import Section
from kshell.mesh.distinct import distinct
from kshell.plate.forms import AreaSpring, EdgeSpring, PointSpring
from kshell.plate.held import Supports
from kshell.plate.hhj.arcs import Arcs
from kshell.plate.hhj.geometry import Triangles
from kshell.plate.hhj.numbering import Held, edge_coefficients
from kshell.plate.hhj.state import Load, Spring
from kshell.plate.hhj.system import HHJSystem
from kshell.plate.hhj.tables import tables
from kshell.plate.holds import OfPlace
from kshell.plate.linear_form import Scaled
from kshell.plate.loading import LOAD_DEGREE, AreaLoad, CurvatureLoad, EdgeLoad, PointLoad

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

BEYOND = 8  # points more along edges that may be curved
VARYING = 6  # degree of a varying stiffness that is integrated exactly


def bending_stiffness(section: Section) -> Floats:
    """C, (3, 3) where it is the same everywhere, else (T, 3, 3)."""
    if section.uniform:
        return section.bending_everywhere
    every = section.bending_per_triangle()
    return np.array(every[0] if len(every) == 1 else every)


def held(triangles: Triangles, order: int, supports: Supports) -> Held:
    """What supports hold."""
    mesh = triangles.mesh
    groups = supports.held
    for group in groups:
        if group.turned:
            raise InputError(
                f"support on '{group.label}': this element has no rotation at a point; hold the deflection there "
                'alone, clamp a short edge, or use element = "argyris"'
            )
        if len(group.surface):
            raise InputError(
                f"support on '{group.label}': a surface is held: the element hhj is held at points and curves; cut the "
                'surface out of the mesh and clamp its edge, or use element = "argyris"'
            )
    out = Held(
        distinct(len(mesh.points), *(group.points for group in groups)),
        distinct(len(mesh.edges), *(group.line for group in groups)),
        distinct(len(mesh.edges), *(group.edges for group in groups)),
    )
    if all(group.value is None and group.slope is None for group in groups):
        return out
    at_vertices = np.zeros(len(mesh.points))
    at_edges = np.zeros((len(mesh.edges), order - 1))
    slopes = np.zeros((len(mesh.edges), order))
    points = mesh.points[:, :2]
    s, _ = interval_rule(order + 6)
    for group in groups:
        if group.slope is not None:
            slopes[group.edges] = _slope_coefficients(triangles, order, group.edges, group.slope)
        if group.value is None:
            continue
        own = distinct(len(mesh.points), group.points, mesh.edges[group.line])
        at_vertices[own] = group.value(points[own])
        if len(group.line):
            on_edges = group.value(along(triangles, group.line, s))
            coefficients = edge_coefficients(on_edges, at_vertices[mesh.edges[group.line]], order)
            size = np.abs(at_vertices).max() + 1e-300
            coefficients[np.abs(coefficients) < 1e-14 * size] = 0.0
            at_edges[group.line] = coefficients
    out.values = (at_vertices, at_edges, slopes)
    return out


def _slope_coefficients(triangles: Triangles, order: int, edges: Ints, slope: OfPlace) -> Floats:
    """(n, order) of the length times dw/dn, n the edge's own normal, from the derivative along the outward one."""
    s, w = interval_rule(order + 1 + VARYING // 2)
    owner, place = places(triangles, edges)
    at = slope(along(triangles, edges, s)) * speeds(triangles, edges, s)
    projected = (at * w) @ legendre(order - 1, s)
    return triangles.outward[owner, place][:, None] * projected * (2 * np.arange(order) + 1)


def springs(
    triangles: Triangles, order: int, supports: Supports, arcs: Arcs | None = None
) -> tuple[Spring, ...]:
    """Elastic supports as roots of their energies."""
    t, mesh = tables(order), triangles.mesh
    out = []
    for label, form in supports.springs:
        if isinstance(form, AreaSpring):
            chosen, bent = _divided(form.triangles, arcs)
            xi, w = triangle_rule(2 * order + VARYING)
            k = form.stiffness(triangles.xy(xi, chosen))
            root = np.sqrt(k * w * triangles.area[chosen, None])
            out.append(Spring(chosen, root[..., None] * t.inside(xi), label))
            if arcs is not None and len(bent):
                patch, xi = arcs.patch(arcs.place[bent], 2 * order + VARYING)
                root = np.sqrt(form.stiffness(patch.xy) * patch.weights)
                rows = arcs.rows_on_unknowns(bent, root[..., None] * t.inside(xi))
                out.append(Spring(bent, rows, label))
        elif isinstance(form, EdgeSpring):
            s, w = interval_rule(order + 1 + VARYING // 2 + (0 if arcs is None else BEYOND))
            owner, place = places(triangles, form.edges)
            k = form.stiffness(along(triangles, form.edges, s))
            size = speeds(triangles, form.edges, s)
            root = np.sqrt(k * w * (1.0 / size if form.rotation else size))
            rows = root[..., None] * edge_rows(triangles, order, form.edges, s, form.rotation, arcs)
            out.append(Spring(owner, rows if arcs is None else arcs.rows_on_unknowns(owner, rows), label))
        elif isinstance(form, PointSpring):
            step = len(form.element.vertex_powers)
            local = np.abs(form.rows).argmax(axis=1)
            if np.any(local % step):
                raise InputError(
                    f"support elastic on '{label}': this element has no rotation at a point; use "
                    'element = "argyris"'
                )
            vertex = mesh.triangles[form.triangles, local // step]
            place = (triangles.corners[form.triangles] == vertex[:, None]).argmax(axis=1)
            rows = np.zeros((len(vertex), 1, t.count))
            rows[np.arange(len(vertex)), 0, place] = np.sqrt(form.stiffness)  # a vertex is an unknown itself
            out.append(Spring(form.triangles, rows, label))
    return tuple(out)


def load(system: HHJSystem, forms: Sequence[Scaled]) -> Load:
    """The sum of some loads."""
    out = system.no_load()
    for form in of_order(forms, system.order, system.arcs is not None):
        if isinstance(form, AreaLoad):
            _pressure(system, out, form)
        elif isinstance(form, EdgeLoad):
            _on_edges(system, out, form)
        elif isinstance(form, PointLoad):
            _at_point(system, out, form)
        elif isinstance(form, CurvatureLoad):
            _curvature(system, out, form)
    if system.arcs is not None:
        system.arcs.to_unknowns(out.local)
    return out


def of_order(forms: Sequence[Scaled], order: int, curved: bool) -> list[Scaled]:
    """Loads whose resultants are integrated by the rules that this element integrates their work by."""
    points = order + 1 + LOAD_DEGREE // 2 + (BEYOND if curved else 0)
    return [form.on_order(order, points) if isinstance(form, AreaLoad | EdgeLoad) else form for form in forms]


def load_degree(forms: Sequence[Scaled]) -> int:
    """The degree of polynomials for which pressures that vary are integrated; 0 where none varies."""
    varying = (form for form in forms if isinstance(form, AreaLoad) and form.uniform is None)
    return max((form.rule for form in varying), default=0)


def vertex_of(form: PointLoad, points: Floats) -> int:
    """The vertex a point load acts at."""
    corners = form.domain.mesh.triangles[form.triangles[0]]
    return int(corners[np.abs(points[corners] - form.xy).sum(axis=1).argmin()])


def places(triangles: Triangles, edges: Ints) -> tuple[Ints, Ints]:
    """One triangle at each edge, and the edge's place in it."""
    owner, local = triangles.mesh.edge_owner[edges].astype(np.int64).T
    return owner, triangles.local[owner, local]


def along(triangles: Triangles, edges: Ints, s: Floats) -> Floats:
    """(n, point, 2) points along edges, from the lower to the higher vertex."""
    if triangles.domain is not None:
        return triangles.domain.edge_points(edges, s, s).xy
    ends = triangles.mesh.points[triangles.mesh.edges[edges], :2]
    return ends[:, :1] + s[:, None] * (ends[:, 1:] - ends[:, :1])


def speeds(triangles: Triangles, edges: Ints, s: Floats) -> Floats:
    """(n, point) length per s at points along edges."""
    if triangles.domain is not None:
        return np.asarray(np.linalg.norm(triangles.domain.edge_motion(edges, s)[1], axis=2))
    owner, place = places(triangles, edges)
    return np.repeat(triangles.lengths[owner, place][:, None], len(s), axis=1)


def edge_rows(
    triangles: Triangles, order: int, edges: Ints, s: Floats, slopes: bool, arcs: Arcs | None
) -> Floats:
    """(n, point, m) w, or alpha, at points along edges, from coefficients (of `Arcs`) of one triangle at each."""
    t = tables(order)
    owner, place = places(triangles, edges)
    rows = np.stack([(t.slopes_on_edge if slopes else t.on_edge)(edge, s) for edge in range(3)])[place]
    if arcs is None:
        return rows
    in_arcs = arcs.place[owner]
    for edge in range(3):
        at = np.flatnonzero((place == edge) & (in_arcs >= 0))
        at = at[arcs.bent[in_arcs[at], edge]]
        rows[at] = (arcs.slope_rows if slopes else arcs.deflection_rows)(in_arcs[at], edge, s)
    return rows


def _divided(chosen: Ints | None, arcs: Arcs | None) -> tuple[Ints, Ints]:
    """Of some triangles those with straight edges, and those at curved ones."""
    if arcs is None:
        assert chosen is not None
        return chosen, np.zeros(0, dtype=np.int64)
    chosen = np.arange(len(arcs.place)) if chosen is None else np.asarray(chosen, dtype=np.int64)
    bent = arcs.place[chosen] >= 0
    return chosen[~bent], chosen[bent]


def _pressure(system: HHJSystem, out: Load, form: AreaLoad) -> None:
    triangles, t = system.triangles, system.tables
    chosen = np.arange(len(triangles)) if form.triangles is None else form.triangles
    arcs = system.arcs
    if arcs is not None:
        chosen, bent = _divided(chosen, arcs)
        if form.uniform is None:
            patch, psi = arcs.tabulated(arcs.place[bent], form.rule)
            weighted = form.values_on(patch) * patch.weights
            out.local[bent] += (weighted[:, None] @ psi)[:, 0] @ t.jets[0]
        else:
            out.local[bent] += form.uniform * arcs.integrals[arcs.place[bent]]
    if form.uniform is not None:
        out.local[chosen] += form.uniform * triangles.area[chosen, None] * t.load
        return
    if not len(chosen):
        return
    xi, w = triangle_rule(form.rule)
    values = form.values(chosen, triangles.xy(xi, chosen))
    out.local[chosen] += (values * w * triangles.area[chosen, None]) @ t.inside(xi)


def _on_edges(system: HHJSystem, out: Load, form: EdgeLoad) -> None:
    triangles, arcs = system.triangles, system.arcs
    s, w = interval_rule(form.patch.weights.shape[1])
    owner, place = places(triangles, form.edges)
    value = form.value(along(triangles, form.edges, s)) * w
    if form.moment:  # - m dw/dn, alpha = length dw/dn along the edge's own normal
        value = -value * triangles.outward[owner, place][:, None]
    else:
        value = value * speeds(triangles, form.edges, s)
    rows = edge_rows(triangles, system.order, form.edges, s, form.moment, arcs)
    np.add.at(out.local, owner, (value[:, None] @ rows)[:, 0])


def _at_point(system: HHJSystem, out: Load, form: PointLoad) -> None:
    triangles, t = system.triangles, system.tables
    force, mx, my = form.total
    vertex = vertex_of(form, triangles.mesh.points[:, :2])
    out.vertices[vertex] += force
    if mx == 0.0 and my == 0.0:
        return
    around, place = np.nonzero(triangles.corners == vertex)
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    reference = t.gradients(corners)[place]  # (n, 2, m)
    gradient = triangles.inverse[around].swapaxes(1, 2) @ reference
    out.local[around] += (mx * gradient[:, 1] - my * gradient[:, 0]) / len(around)


def _curvature(system: HHJSystem, out: Load, form: CurvatureLoad) -> None:
    triangles = system.triangles
    chosen = np.arange(len(triangles)) if form.triangles is None else form.triangles
    xi, w = triangle_rule(system.order - 1 + LOAD_DEGREE)
    curvature = form.curvature(chosen, triangles.xy(xi, chosen))  # (n, point, 3)
    factor = system.factor if system.factor.ndim == 2 else system.factor[chosen]
    means = (curvature * w[:, None]).swapaxes(1, 2) @ orthonormal(system.order - 1, xi)  # (n, 3, k)
    if out.initial is None:
        out.initial = np.zeros((len(triangles), 3, system.tables.moments))
    found = system.root[chosen, None, None] * (factor @ means)
    arcs = system.arcs
    if arcs is not None:
        at = np.flatnonzero(arcs.place[chosen] >= 0)
        place = arcs.place[chosen[at]]
        patch, xi = arcs.patch(place, system.order - 1 + LOAD_DEGREE)
        curvature = form.curvature(chosen[at], patch.xy) * patch.weights[..., None]
        integrals = curvature.swapaxes(1, 2) @ orthonormal(system.order - 1, xi)  # (n, 3, k)
        own = factor if factor.ndim == 2 else factor[at]
        # l = L^-1 of the integrals, along k
        found[at] = (own @ integrals) @ arcs.up[place].swapaxes(1, 2)
    out.initial[chosen] += found
