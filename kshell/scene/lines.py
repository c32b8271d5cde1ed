"""Lines inside a plate or shell across which derivatives of the displacement jump, found from the structure.

Second derivatives of the deflection jump where the stiffness or the free curvature does, and along lines that hold
the rotation, by a support or a spring: the bending moment across such a line differs from side to side, or the
curvature that belongs to it does. Third derivatives jump at line loads, at lines that hold the deflection alone and at
borders of loaded surfaces; there it matters only that a curved line is followed.

In a shell membrane forces jump along every line that carries or holds something in its plane, and with them first
derivatives of the displacement.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.material.section import Section
from kshell.mesh.mesh import Mesh
from kshell.mesh.select import Selection
from kshell.scene.loads import (
    EdgeMoment,
    InitialCurvature,
    InitialStrain,
    LineForce,
    Load,
    Temperature,
    Traction,
)
from kshell.scene.placed import Placed
from kshell.scene.structure import Structure
from kshell.scene.supports import Elastic, Support
from kshell.scene.thermal import free_strain
from kshell.values.varying import is_constant

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]
Values = Callable[[Ints, Floats], Floats]

# how far from an edge, in triangles, its sides are looked at, and from which change on something jumps
BESIDE, JUMP = 1e-7, 1e-5


@dataclass(frozen=True)
class InnerLines:
    """Edges inside a plate, as flags (edge,).

    Attributes
    ----------
    jump
        Second derivatives across the edge may jump.
    held
        A support holds the deflection or the rotation along the edge.
    loaded
        Third derivatives jump at loads and springs.
    """

    jump: Flags
    held: Flags
    loaded: Flags

    @property
    def lines(self) -> Flags:
        """All of them."""
        return self.jump | self.held | self.loaded


def inner_lines(structure: Structure) -> InnerLines:
    """The lines of a structure."""
    mesh, section = structure.space, structure.section
    inside = mesh.edge_counts > 1
    out = InnerLines(*(np.zeros(len(mesh.edges), dtype=bool) for _ in range(3)))
    for support in structure.supports:
        _of_support(support, mesh, inside, out)
    sides = _Sides(mesh, inside)
    if not section.uniform:
        bending = partial(_bending, section)
        out.jump[sides.edges] |= sides.differ(bending, section.constant_per_triangle)
    for load in structure.loads:
        _of_load(load, section, mesh, inside, sides, out)
    return out


def _of_support(placed: Placed[Support], mesh: Mesh, inside: Flags, out: InnerLines) -> None:
    support, selection = placed.item, placed.place
    turned, lifted = "r" in support.freedoms, not set(support.freedoms).isdisjoint("zn")
    lifted |= getattr(support, "axes", None) is not None
    if selection is None or selection.dimension == 0 or not (turned or lifted):
        return
    elastic = isinstance(support, Elastic)
    if selection.dimension == 2:
        border = _border(mesh, selection.members)
        (out.loaded if elastic else out.jump)[border] = True
        return
    edges = selection.members[inside[selection.members]]
    if turned:
        out.jump[edges] = True
    (out.loaded if elastic else out.held)[edges] = True


def _of_load(
    placed: Placed[Load], section: Section, mesh: Mesh, inside: Flags, sides: _Sides, out: InnerLines
) -> None:
    load, selection = placed.item, placed.place
    if isinstance(load, Temperature | InitialCurvature):
        shapes: tuple[Any, ...]
        if isinstance(load, Temperature):
            shapes = (load.gradient, load.mean, load.expansion or 0.0)
            alike = load.expansion is not None or section.uniform
        else:
            shapes, alike = (load.value,), True
        if selection is None and alike and all(is_constant(shape) for shape in shapes):
            return
        on = np.zeros(len(mesh.triangles), dtype=bool)
        on[placed.members(mesh)] = True

        def curvature(triangles: Ints, points: Floats) -> Floats:
            here, found = on[triangles], np.zeros((*points.shape[:2], 3))
            if isinstance(load, Temperature):
                found[here] = free_strain(load, section, triangles[here], points[here])[..., 3:]
            else:
                found[here] = load.curvature_at(points[here])
            return found

        out.jump[sides.edges] |= sides.differ(curvature, False)
    elif selection is not None and selection.dimension == 2:
        out.loaded[_border(mesh, selection.members)] = True
    elif selection is not None and selection.dimension == 1:
        out.loaded[selection.members[inside[selection.members]]] = True


def shell_lines(structure: Structure) -> Flags:
    """(edge,) edges inside a shell across which first or second derivatives of the displacement jump."""
    mesh, lines = structure.space, inner_lines(structure)
    inside, out = mesh.edge_counts > 1, lines.jump.copy()
    for support in structure.supports:
        if support.item.freedoms and support.place is not None and support.place.dimension > 0:
            out[_inner(support.place, mesh, inside)] = True
    for load in structure.loads:
        if (
            isinstance(load.item, LineForce | EdgeMoment | Temperature | InitialStrain | Traction)
            and load.place
        ):
            out[_inner(load.place, mesh, inside)] = True
    return out


def held_lines(structure: Structure) -> Flags:
    """(edge,) edges inside a shell that supports hold, springs aside."""
    mesh = structure.space
    inside, out = mesh.edge_counts > 1, np.zeros(len(mesh.edges), dtype=bool)
    for support in structure.supports:
        place = support.place
        elastic = isinstance(support.item, Elastic)
        if support.item.freedoms and place is not None and place.dimension > 0 and not elastic:
            out[_inner(place, mesh, inside)] = True
    return out


def _inner(place: Selection, mesh: Mesh, inside: Flags) -> Ints:
    """The edges inside of a curve, or of the border of a surface."""
    if place.dimension == 2:
        return _border(mesh, place.members)
    return place.members[inside[place.members]].astype(np.int64)


def _border(mesh: Mesh, triangles: NDArray[np.integer]) -> Ints:
    """Edges inside the plate between some triangles and others."""
    count = np.bincount(mesh.triangle_edges[triangles].ravel(), minlength=len(mesh.edges))
    return np.flatnonzero((count > 0) & (count < mesh.edge_counts))


def _bending(section: Section, triangles: Ints, points: Floats) -> Floats:
    return section.bending(triangles, points).reshape(len(triangles), points.shape[1], 9)


class _Sides:
    """Both sides of the edges inside, for functions of triangles and places."""

    def __init__(self, mesh: Mesh, inside: Flags) -> None:
        self.edges: Ints = np.flatnonzero(inside)
        self.mesh = mesh

    @cached_property
    def triangles(self) -> Ints:
        """(2, inner edge) triangles on both sides."""
        return np.asarray(self.mesh.edge_table.sides[:, self.edges] // 3)

    def differ(self, value: Values, constant: bool) -> Flags:
        """(inner edge,) whether value(triangles (n,), points (n, 1, 3)) -> (n, 1, k) jumps across an edge."""
        mesh = self.mesh
        if constant:
            every = np.arange(len(mesh.triangles))
            centre = mesh.points[mesh.triangles].mean(axis=1)[:, None]
            of_triangle = value(every, centre)
            left, right = of_triangle[self.triangles[0]], of_triangle[self.triangles[1]]
        else:
            middle = mesh.points[mesh.edges[self.edges]].mean(axis=1)
            if mesh.midpoints is not None:
                middle = mesh.midpoints[self.edges]
            left, right = (self._beside(value, triangles, middle) for triangles in self.triangles)
        size = np.abs(np.concatenate([left, right], axis=1)).max(axis=(1, 2), initial=0.0)
        jump: Flags = np.abs(left - right).max(axis=(1, 2), initial=0.0) > JUMP * size
        return jump

    def _beside(self, value: Values, triangles: Ints, middle: Floats) -> Floats:
        centre = self.mesh.points[self.mesh.triangles[triangles]].mean(axis=1)
        found: Floats = value(triangles, (middle + BESIDE * (centre - middle))[:, None])
        return found
