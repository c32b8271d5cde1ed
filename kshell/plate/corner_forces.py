"""Concentrated forces of the supports at corners of a plate, where an edge that holds w ends.

The force is the jump of the twisting moment M_nt. Read off the triangles at the corner it converges slowly:
between simply supported edges w contains r^4 log r, so second derivatives at the corner converge like h^2 only.
At a right angle between simply supported straight edges of an isotropic plate it is therefore drawn from the
deflection around the corner. With polar coordinates at the corner, the edges at theta = 0 and pi / 2,

    w = A x y + O(r^4 log r),    s = sin 2 theta

are both without bending moment on the edges and without load; with a cut-off chi(r) that is 1 at the corner and
ends smoothly at a radius R, Green's formula for D w'''' = q and chi s gives

    2 pi A = int chi s q / D  -  int w  Laplace^2 (chi s),    force = 2 (1 - nu) D A,

an average of w, which converges like the deflection. The function dual to r^lambda is r^(2 - lambda), here r^0
(V. G. Maz'ya & B. A. Plamenevskii, Math. Nachr. 76 (1977) 29-60). With chi = (1 - r^2 / R^2)^4,

    Laplace^2 (chi s) = 384 (5 r^4 / R^8 - 4 r^2 / R^6) sin 2 theta.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.elements.quadrature import interval_rule
from kshell.plate.domain import Domain
from kshell.plate.forms import AreaSpring, Bending, EdgeSpring, PointSpring
from kshell.plate.held import Supports
from kshell.plate.linear_form import LinearForm
from kshell.plate.loading import AreaLoad, CurvatureLoad, EdgeLoad, PointLoad
from kshell.plate.recovery import Fields
from kshell.plate.reduction import Reduction

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

POINTS = 16  # Gauss points along r and theta
WITHIN = 0.999  # of the distance to what ends the region around a corner
FEWER_POINTS = 8
SECOND_RADIUS = 0.7  # the average over a smaller region must agree
NO_CORNER = 1e-6  # sine of the angle between tangents
STRAIGHT = 1e-9


@dataclass(frozen=True)
class Corner:
    """A corner with a concentrated force.

    Attributes
    ----------
    vertex : int
    ends : two pairs of int
        Position in the boundary and end (0 lower, 1 higher vertex) of its two edges.
    groups : tuple of str
        Labels of the supports along these edges.
    """

    vertex: int
    ends: tuple[tuple[int, int], tuple[int, int]]
    groups: tuple[str, ...]


class CornerForces:
    """Finds the corners of a plate and the forces there.

    Attributes
    ----------
    corners : list of Corner
        The other edge of a corner may hold w, too, or be free: a plate on two opposite sides has forces there.
    """

    def __init__(
        self,
        domain: Domain,
        reduction: Reduction,
        supports: Supports,
        bending: Bending,
        loads: Sequence[LinearForm],
        fields: Fields,
        kept: dict[Any, Any],
    ) -> None:
        self._domain, self._bending, self._loads, self._fields = domain, bending, loads, fields
        self._supports = supports
        self._at_rest = not reduction.particular.any()
        if "corners" not in kept:
            kept["corners"] = self._find() if fields.polynomial_moments else []
        self.corners: list[Corner] = kept["corners"]

    def _find(self) -> list[Corner]:
        mesh, boundary = self._domain.mesh, self._domain.boundary
        labels: dict[int, list[str]] = {}
        for group in self._supports.held:
            for e in group.line.tolist():
                labels.setdefault(e, []).append(group.label)
        supported = np.array([e for e in labels if mesh.edge_counts[e] == 1], dtype=np.int64)
        at_support = np.zeros(len(mesh.points), dtype=bool)
        at_support[mesh.edges[supported]] = True
        ends = mesh.edges[boundary.edges]
        around: dict[int, list[tuple[int, int]]] = {}
        for k, end in np.argwhere(at_support[ends]).tolist():
            around.setdefault(int(ends[k, end]), []).append((k, end))
        found = []
        for v, pair in around.items():
            if len(pair) != 2:
                continue
            (ax, ay), (bx, by) = (boundary.tangent[k, end] for k, end in pair)
            if abs(ax * by - ay * bx) > NO_CORNER:
                names = {name for k, _ in pair for name in labels.get(int(boundary.edges[k]), [])}
                found.append(Corner(v, (pair[0], pair[1]), tuple(sorted(names))))
        return found

    @cached_property
    def forces(self) -> Floats:
        """(corner,) forces along z of the supports on the plate."""
        if not self.corners:
            return np.zeros(0)
        place, end = np.array([corner.ends for corner in self.corners]).reshape(-1, 2).T
        forces = self._twist(place, end).reshape(-1, 2).sum(axis=1)
        sectors = [(k, *found) for k, corner in enumerate(self.corners) if (found := self._sector(corner))]
        if sectors:
            which = np.array([k for k, *_ in sectors])
            radius = np.array([r for _, _, _, r in sectors])
            axes, stiffness = (np.array([sector[i] for sector in sectors]) for i in (1, 2))
            wide = self._averages(which, axes, stiffness, radius, POINTS)
            narrow = self._averages(which, axes, stiffness, SECOND_RADIUS * radius, FEWER_POINTS)
            better = np.abs(wide - narrow) < np.abs(wide - forces[which])
            forces[which[better]] = wide[better]
        return forces

    def _twist(self, place: Ints, end: Ints) -> Floats:
        """M_nt (n,) at ends of boundary edges walked with the plate on the left, minus where the walk ends there."""
        mesh, boundary = self._domain.mesh, self._domain.boundary
        edges = boundary.edges[place]
        triangle, local = mesh.edge_owner[edges].astype(np.int64).T
        # local edge k starts at local vertex k, walked counter-clockwise
        forward = np.where(mesh.edges[edges, 0] == mesh.triangles[triangle, local], 1.0, -1.0)
        leaves = np.where(end == 0, forward, -forward)
        t = boundary.tangent[place, end] * forward[:, None]
        n = np.stack([t[:, 1], -t[:, 0]], axis=1)
        xy = self._domain.points[mesh.edges[edges, end]][:, None]
        xi = self._domain.affine(triangle).reference_coordinates(xy)
        xx, yy, both = self._fields.moment(triangle, xi, xy)[:, 0].T
        value = (
            n[:, 0] * t[:, 0] * xx + n[:, 1] * t[:, 1] * yy + (n[:, 0] * t[:, 1] + n[:, 1] * t[:, 0]) * both
        )
        return leaves * value

    def _sector(self, corner: Corner) -> tuple[Floats, Floats, float] | None:
        """Directions of the edges (2, xy), D and the radius of a region around a corner, where the formula holds."""
        boundary = self._domain.boundary
        axes = np.array([boundary.tangent[k, end] * (1.0 if end == 0 else -1.0) for k, end in corner.ends])
        constant = self._bending.constant
        if abs(axes[0] @ axes[1]) > STRAIGHT or constant is None or not self._at_rest:
            return None
        stiffness = constant[self._domain.mesh.edge_owner[boundary.edges[corner.ends[0][0]], 0]]
        if not _is_isotropic(stiffness) or any(load.triangles is None for load in self._curvatures):
            return None
        radius = WITHIN * self._clear_radius(corner, axes, stiffness, constant)
        return (axes, stiffness, radius) if radius > 0.0 else None

    def _averages(self, which: Ints, axes: Floats, stiffness: Floats, radius: Floats, points: int) -> Floats:
        """The forces at some corners as averages over sectors with axes (corner, 2, xy) and radii (corner,)."""
        x, weight = interval_rule(points)
        angle = np.pi / 2 * x
        unit = np.stack([np.cos(angle), np.sin(angle)], axis=1) @ axes  # (corner, theta, xy)
        r = radius[:, None] * x  # (corner, r)
        vertices = [corner.vertex for corner in self.corners]
        start = self._domain.points[np.array(vertices)[which]]
        xy = (start[:, None, None] + r[:, :, None, None] * unit[:, None]).reshape(-1, 2)
        found = self._fields.locator.find(xy)
        shape = (len(which), points, points)  # (corner, r, theta)
        w = self._fields.derivatives(found.triangles, found.xi, 0).reshape(shape)
        q = self._pressure(found.triangles, xy).reshape(shape)
        t = (x**2)[:, None]
        d = stiffness[:, 0, 0]
        bilaplacian = 384 * (5 * t**2 - 4 * t) / radius[:, None, None] ** 4
        area = np.pi / 2 * radius[:, None, None] * (r * weight)[:, :, None] * weight
        density = (1 - t) ** 4 * q / d[:, None, None] - w * bilaplacian
        twist = (density * np.sin(2 * angle) * area).sum(axis=(1, 2)) / (2 * np.pi)
        return 2 * (d - stiffness[:, 0, 1]) * twist

    def _pressure(self, triangles: Ints, xy: Floats) -> Floats:
        total = np.zeros(len(xy))
        for load in self._loads:
            if isinstance(load, AreaLoad):
                here = np.ones(len(xy), dtype=bool)
                if load.triangles is not None:
                    here = np.isin(triangles, load.triangles)
                total[here] += load.values(triangles[here], xy[here][:, None])[:, 0]
        return total

    @property
    def _curvatures(self) -> list[CurvatureLoad]:
        return [load for load in self._loads if isinstance(load, CurvatureLoad)]

    def _clear_radius(self, corner: Corner, axes: Floats, stiffness: Floats, everywhere: Floats) -> float:
        """Distance from a corner within which only its two simply supported edges, and pressure, act."""
        mesh, points = self._domain.mesh, self._domain.points
        own = np.zeros(len(mesh.edges), dtype=bool)
        for (k, end), axis in zip(corner.ends, axes, strict=True):
            own[self._run(k, end, axis)] = True
        edges, triangles, vertices = self._in_the_way
        other = np.abs(everywhere - stiffness).max(axis=(1, 2)) > STRAIGHT * stiffness[0, 0]
        ends = mesh.edges[edges[~own[edges]]]
        borders = mesh.edges[mesh.triangle_edges[np.union1d(triangles, np.flatnonzero(other))].ravel()]
        own_vertices = np.zeros(len(mesh.points), dtype=bool)
        own_vertices[mesh.edges[own]] = True
        single = vertices[~own_vertices[vertices]]
        segments = np.concatenate([ends, borders, np.stack([single, single], axis=1)]).astype(np.int64)
        return _distance(points[corner.vertex], points[segments[:, 0]], points[segments[:, 1]])

    @cached_property
    def _in_the_way(self) -> tuple[Ints, Ints, Ints]:
        """Edges, triangles and vertices where something else than pressure acts."""
        mesh, supports = self._domain.mesh, self._supports
        edges: list[Any] = [mesh.boundary_edges]
        triangles: list[Any] = [load.triangles for load in self._curvatures if load.triangles is not None]
        vertices: list[Any] = []
        for group in supports.held:
            edges += [group.line, group.edges]
            vertices.append(group.vertices)
        for _, spring in supports.springs:
            if isinstance(spring, EdgeSpring):
                edges.append(spring.edges)
            elif isinstance(spring, AreaSpring | PointSpring):
                triangles.append(spring.triangles)
        for load in self._loads:
            if isinstance(load, EdgeLoad):
                edges.append(load.edges)
            elif isinstance(load, AreaLoad) and load.triangles is not None:
                inside = np.bincount(mesh.triangle_edges[load.triangles].ravel(), minlength=len(mesh.edges))
                edges.append(np.flatnonzero((inside > 0) & (inside < mesh.edge_counts)))
            elif isinstance(load, PointLoad):
                triangles.append(load.triangles)
        return _joined(edges), _joined(triangles), _joined(vertices)

    def _run(self, place: int, end: int, axis: Floats) -> Ints:
        """The edges from a corner straight on that hold the deflection alone, and bear neither spring nor load."""
        mesh, boundary = self._domain.mesh, self._domain.boundary
        run: list[int] = []
        while self._is_hinged[place] and not boundary.curved[place]:
            direction = boundary.tangent[place, 0] * (1.0 if end == 0 else -1.0)
            if direction @ axis < 1.0 - STRAIGHT:
                break
            run.append(int(boundary.edges[place]))
            vertex = int(mesh.edges[boundary.edges[place], 1 - end])
            onward = [pair for pair in self._around[vertex] if pair[0] != place]
            if len(onward) != 1:
                break
            place, end = onward[0]
        return np.array(run, dtype=np.int64)

    @cached_property
    def _is_hinged(self) -> NDArray[np.bool_]:
        """(boundary edge,) whether a support holds the deflection, none the slope, and nothing acts on the edge."""
        alone = np.zeros(len(self._domain.mesh.edges), dtype=bool)
        for group in self._supports.held:
            alone[group.line] = True
        for group in self._supports.held:
            alone[group.edges] = False
        for _, spring in self._supports.springs:
            if isinstance(spring, EdgeSpring):
                alone[spring.edges] = False
        for load in self._loads:
            if isinstance(load, EdgeLoad):
                alone[load.edges] = False
        return alone[self._domain.boundary.edges]

    @cached_property
    def _around(self) -> dict[int, list[tuple[int, int]]]:
        """Boundary edges, as (position, end), by vertex."""
        table: dict[int, list[tuple[int, int]]] = {}
        for k, ends in enumerate(self._domain.mesh.edges[self._domain.boundary.edges].tolist()):
            for end, v in enumerate(ends):
                table.setdefault(v, []).append((k, end))
        return table


def _is_isotropic(d: Floats) -> bool:
    expected = np.array([[d[0, 0], d[0, 1], 0], [d[0, 1], d[0, 0], 0], [0, 0, (d[0, 0] - d[0, 1]) / 2]])
    return bool(np.abs(d - expected).max() < STRAIGHT * d[0, 0])


def _joined(parts: list[Any]) -> Ints:
    return np.concatenate([np.zeros(0, dtype=np.int64), *parts]).astype(np.int64)


def _distance(point: Floats, start: Floats, end: Floats) -> float:
    """From a point to the nearest of some segments (n, 2)."""
    along = end - start
    square = np.maximum((along**2).sum(axis=1), 1e-300)
    s = np.clip(((point - start) * along).sum(axis=1) / square, 0.0, 1.0)
    return float(np.linalg.norm(start + s[:, None] * along - point, axis=1).min(initial=np.inf))
