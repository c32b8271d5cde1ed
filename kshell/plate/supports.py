"""Supports of a plate: from names to conditions on degrees of freedom, and springs.

At points and on surfaces here; along curves in `kshell.plate.held_edges`, elastic ones in `kshell.plate.springs`.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh.mesh import Mesh
from kshell.mesh.select import Selection
from kshell.plate.domain import Domain
from kshell.plate.forms import Bending
from kshell.plate.held import NONE, HeldGroup, Supports
from kshell.plate.held_edges import EdgeHolder, prescribed_deflection
from kshell.plate.layout import Layout
from kshell.plate.places import points_3d
from kshell.plate.springs import spring_forms
from kshell.scene.handlers import Handlers
from kshell.scene.placed import Placed
from kshell.scene.supports import Clamped, Elastic, Fixed, Free, SimplySupported, Support, Symmetry
from kshell.values.degree import polynomial_degree

Floats = NDArray[np.float64]

HANDLERS = Handlers('is for shells: take model = "shell", or leave it out')


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
    builder.edges.tie()
    return builder.out


class _Builder:
    def __init__(self, domain: Domain, layout: Layout, bending: Bending) -> None:
        self.domain, self.layout = domain, layout
        self.mesh: Mesh = domain.mesh
        self.rich = layout.per_vertex == 6  # gradients and Hessians at vertices
        self.out = Supports()
        self.edges = EdgeHolder(domain, layout, bending, self.out)

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
            self.edges.hold(support, selection, holds_w, holds_r)
        else:
            self._surface(support, selection, holds_w, holds_r, what)

    def _value(self, support: Any, xy: Floats) -> Floats:
        return support.translation_at(points_3d(self.domain, xy))[..., 2]

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
        prescribed = prescribed_deflection(support, self.domain)
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
        self.out.conditions.edge_values.append(np.zeros(len(edges)))
        surface = selection.members.astype(np.int64)
        prescribed = prescribed_deflection(support, self.domain)
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

    @HANDLERS.of(Elastic)
    def _springs(self, support: Any, placed: Placed[Any]) -> None:
        selection = placed.place
        assert selection is not None  # supports are somewhere
        forms = spring_forms(support, selection, self.domain, self.layout)
        self.out.springs += [(selection.label, form) for form in forms]
