"""The region a plate covers: triangles, and the true shape of its curved edges, with quadrature on both.

A triangle at a curved edge keeps the polynomials of the straight triangle, extended a little beyond the chord, but is
integrated over its true region (`kshell.plate.region`); the other triangles are affine.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.elements.affine import AffineTriangles
from kshell.elements.quadrature import interval_rule, triangle_rule
from kshell.elements.reference import VERTICES
from kshell.mesh.distinct import distinct
from kshell.mesh.mesh import EDGE_VERTICES, Mesh
from kshell.plate.curves import EdgeCurves, joined_curves
from kshell.plate.region import bulge, motion, region_points
from kshell.plate.rims import edge_curves

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

KEPT = 3  # batches whose maps are kept
MANY = 8192  # triangles up to which the maps of all of them are kept
BLOCK = 1024  # triangles treated at a time: enough to amortise Python, small enough to stay in cache


@dataclass(frozen=True)
class Patch:
    """Quadrature points of a batch of triangles.

    Attributes
    ----------
    triangles : (n,) int array
    reference : (point, 2) array, or function of xy
        Points of a rule for all triangles, or what finds those of each.
    xy : (n, point, 2) array
    weights : (n, point) array
        Areas.
    """

    triangles: Ints
    reference: Floats | Callable[[Floats], Floats]
    xy: Floats
    weights: Floats

    @cached_property
    def xi(self) -> Floats:
        """(point, 2) or (n, point, 2) reference coordinates in the straight triangle."""
        return self.reference(self.xy) if callable(self.reference) else self.reference


@dataclass(frozen=True)
class EdgePatch:
    """Quadrature points along edges, seen from one triangle at each.

    Attributes
    ----------
    edges : (n,) int array
    triangles : (n,) int array
    xi : (n, point, 2) array
        Reference coordinates in the triangle.
    xy : (n, point, 2) array
    weights : (n, point) array
        Lengths.
    normal : (n, point, 2) array
        Unit normal, out of the triangle.
    curvature : (n, point, 2) array
        Curvature vector, across the tangent.
    """

    edges: Ints
    triangles: Ints
    xi: Floats
    xy: Floats
    weights: Floats
    normal: Floats
    curvature: Floats


class Domain:
    """A planar mesh as a region to integrate over.

    Parameters
    ----------
    mesh : Mesh
        Planar; triangles counter-clockwise seen from +z.
    curved : bool
        Whether to follow curved edges; otherwise every edge is its chord.
    lines : (n,) int array, optional
        Edges inside that are followed, too, if `curved`; all others inside are their chords.

    Attributes
    ----------
    boundary, curves : EdgeCurves
        Shape of the outer edges, and of these and the lines together.
    bent : (n,) int array
        Edges inside that are not their chords.
    """

    def __init__(self, mesh: Mesh, curved: bool, lines: Ints | None = None) -> None:
        self.mesh = mesh
        self.points: Floats = np.ascontiguousarray(mesh.points[:, :2])
        none = np.zeros(0, dtype=np.int32)
        self.curves: EdgeCurves
        self.bent: Ints
        self.boundary: EdgeCurves = edge_curves(mesh, mesh.boundary_edges if curved else none)
        self.curves, self.bent = self.boundary, none.astype(np.int64)
        if curved and lines is not None and len(lines):
            inner = edge_curves(mesh, lines.astype(np.int32))
            self.curves = joined_curves(self.boundary, inner)
            self.bent = inner.edges[inner.curved].astype(np.int64)
        curved_edges = self.curves.edges[self.curves.curved]
        self.curved_triangles: Ints = distinct(len(mesh.triangles), mesh.edge_owner[curved_edges, 0])
        if len(self.bent):
            self.curved_triangles = np.union1d(self.curved_triangles, self.sides(self.bent)[1])
        self._latest: list[tuple[Ints, AffineTriangles]] = []
        self._curved_patches: dict[bytes, dict[int, Patch]] = {}  # by block and degree
        self.is_curved = np.zeros(len(mesh.triangles), dtype=bool)
        self.is_curved[self.curved_triangles] = True

    def sides(self, edges: Ints) -> Ints:
        """(2, n) the triangles at edges, the same one twice at the boundary."""
        return np.asarray(self.mesh.edge_table.sides[:, edges] // 3)

    def tangents(self, edges: Ints) -> Floats:
        """(n, end, 2) unit tangents of edges at both ends, from the lower to the higher vertex."""
        ends = self.points[self.mesh.edges[edges]]
        chord = (ends[:, 1] - ends[:, 0]) / self.mesh.edge_lengths[edges][:, None]
        out = np.repeat(chord[:, None], 2, axis=1)
        if len(self.curves.edges):
            place = np.minimum(self.curves.place(edges), len(self.curves.edges) - 1)
            here = self.curves.edges[place] == edges
            out[here] = self.curves.tangent[place[here]]
        return out

    def affine(self, triangles: Ints) -> AffineTriangles:
        """The straight triangles; what was computed of the last batches is kept, and that of the domain's own."""
        own = self._own.get(id(triangles))
        if own is not None and own[0] is triangles:
            if own[1] is None:
                own[1] = AffineTriangles.of_arrays(self.points, self.mesh.triangles[triangles])
            found: AffineTriangles = own[1]
            return found
        for known, affine in self._latest:
            if known is triangles:  # forms, loads and recovery ask for the same batch in turn
                return affine
        affine = AffineTriangles.of_arrays(self.points, self.mesh.triangles[triangles])
        self._latest = [(triangles, affine), *self._latest[: KEPT - 1]]
        return affine

    def forget(self) -> None:
        """Drop the maps of the last batches, 7 kB for each triangle of Argyris."""
        self._latest = []

    @property
    def few(self) -> bool:
        """Whether there are so few triangles that what belongs to each of them may be kept."""
        return len(self.mesh.triangles) <= MANY

    @cached_property
    def every(self) -> Ints:
        """All triangles; the batch that is assembled where there is but one."""
        blocks = self._all_blocks
        return blocks[0] if len(blocks) == 1 else np.arange(len(self.mesh.triangles))

    @cached_property
    def _own(self) -> dict[int, list[Any]]:
        """All triangles and their batches, which never change, with their maps, where these are kept."""
        if not self.few:
            return {}
        return {id(part): [part, None] for part in (self.every, *self._all_blocks)}

    def keep(self, triangles: Ints) -> None:
        """Keep the maps of a batch, too."""
        if self.few and id(triangles) not in self._own:
            self._own[id(triangles)] = [triangles, None]

    @cached_property
    def _all_blocks(self) -> list[Ints]:
        return list(self._split(np.arange(len(self.mesh.triangles))))

    def blocks(self, triangles: Ints | None = None) -> Iterator[Ints]:
        """Triangle numbers in batches, straight ones and curved ones apart; those of all triangles never change."""
        return iter(self._all_blocks) if triangles is None else self._split(np.asarray(triangles))

    def _split(self, all_of_them: Ints) -> Iterator[Ints]:
        for chosen in (all_of_them[~self.is_curved[all_of_them]], all_of_them[self.is_curved[all_of_them]]):
            for start in range(0, len(chosen), BLOCK):
                yield chosen[start : start + BLOCK]

    def patches(self, degree: int, triangles: Ints | None = None) -> Iterator[Patch]:
        """Quadrature, exact for polynomials of a degree on straight triangles, in batches."""
        for block in self.blocks(triangles):
            yield self.curved_patch(block, degree) if self.is_curved[block[0]] else self._flat(block, degree)

    def _flat(self, block: Ints, degree: int) -> Patch:
        xi, w = triangle_rule(degree)
        affine = self.affine(block)
        xy = affine.corners[:, None, 0] + xi @ np.swapaxes(affine.jacobian, 1, 2)
        return Patch(block, xi, xy, np.abs(affine.determinant)[:, None] * w)

    def curved_patch(self, block: Ints, degree: int) -> Patch:
        """Quadrature over the true region of triangles with curved edges; where these are few it is made once."""
        if len(self.curved_triangles) > BLOCK:
            return self._make_curved_patch(block, degree)
        known = self._curved_patches.setdefault(block.tobytes(), {})
        enough = min((d for d in known if d >= degree), default=degree)
        if enough not in known:
            known[enough] = self._make_curved_patch(block, degree)
        return known[enough]

    def _make_curved_patch(self, block: Ints, degree: int) -> Patch:
        xy, weights = region_points(self.mesh, self.curves, block, degree)
        return Patch(block, partial(self._reference, block), xy, weights)

    def _reference(self, block: Ints, xy: Floats) -> Floats:
        return self.affine(block).reference_coordinates(xy)

    def edge_patch(self, edges: Ints, count: int, side: int = 0) -> EdgePatch:
        """Gauss points along edges, seen from one side; boundary edges and lines follow their true shape."""
        s, w = interval_rule(count)
        return self.edge_points(edges, s, w, side)

    def shared_edge_patch(self, edges: Ints, count: int) -> EdgePatch:
        """The same with edges inside seen from both sides with half their length, for functions that jump there."""
        edges = np.asarray(edges, dtype=np.int64)
        inside = self.mesh.edge_counts[edges] > 1
        first = self.edge_patch(edges, count)
        if not inside.any():
            return first
        second = self.edge_patch(edges[inside], count, side=1)
        parts = {
            name: np.concatenate([getattr(first, name), getattr(second, name)])
            for name in ("edges", "triangles", "xi", "xy", "weights", "normal", "curvature")
        }
        parts["weights"][np.append(inside, np.ones(int(inside.sum()), dtype=bool))] *= 0.5
        return EdgePatch(**parts)

    def edge_points(self, edges: Ints, s: Floats, w: Floats, side: int = 0) -> EdgePatch:
        """Given points s in [0, 1] (from the lower to the higher vertex) along edges."""
        edges = np.asarray(edges, dtype=np.int64)
        place = self.mesh.edge_table.sides[side, edges]
        triangle = place // 3
        local = place - 3 * triangle
        xy, speed, bend = self.edge_motion(edges, s)
        length = np.hypot(speed[..., 0], speed[..., 1])
        affine = self.affine(triangle)
        normal = np.stack([speed[..., 1], -speed[..., 0]], axis=-1) / length[..., None]
        # lower-to-higher tangent turned by -90 degrees points out where the triangle walks that way;
        # local edges (0, 1), (1, 2), (0, 2): the last one runs against the counter-clockwise sense
        outward = affine.sense[np.arange(len(edges)), local] * np.where(local == 2, -1.0, 1.0)
        xi = affine.reference_coordinates(xy)
        if not self.curves.curved.any():
            xi = self._on_chord(local, affine.sense[np.arange(len(edges)), local], s)
        tangent = speed / length[..., None]
        across = bend - (bend * tangent).sum(axis=-1, keepdims=True) * tangent
        return EdgePatch(
            edges,
            triangle,
            xi,
            xy,
            length * w,
            normal * outward[:, None, None],
            across / length[..., None] ** 2,
        )

    def edge_motion(self, edges: Ints, s: Floats) -> tuple[Floats, Floats, Floats]:
        """Places, first and second derivatives (n, point, 2) of edges by s, 0 to 1 from lower to higher vertex."""
        return motion(self.mesh, self.curves, edges, s)

    def places(self, triangles: Ints, xi: Floats) -> Floats:
        """Points (n, point, 2) at reference points (point, 2), of triangles with curved edges mapped to these."""
        affine = self.affine(triangles)
        xy = affine.corners[:, None, 0] + xi @ np.swapaxes(affine.jacobian, 1, 2)
        here = np.flatnonzero(self.is_curved[triangles])
        if len(here):
            xy[here] += bulge(self.mesh, self.curves, triangles[here], xi)[0]
        return np.asarray(xy)

    @staticmethod
    def _on_chord(local: Ints, sense: Floats, s: Floats) -> Floats:
        """Reference coordinates of points on straight edges, free of rounding."""
        along = np.where(sense[:, None] > 0, s, 1 - s)
        start = VERTICES[EDGE_VERTICES[local, 0]]
        return start[:, None] + along[..., None] * (VERTICES[EDGE_VERTICES[local, 1]] - start)[:, None]

    @cached_property
    def moments_of_area(self) -> Floats:
        """(3,) area, and integrals of x and y."""
        mesh = self.mesh
        areas = np.where(self.is_curved, 0.0, mesh.areas) if len(self.curved_triangles) else mesh.areas
        total = np.array([areas.sum(), *(areas @ self.points[mesh.triangles].sum(axis=1) / 3.0)])
        for start in range(0, len(self.curved_triangles), BLOCK):
            patch = self.curved_patch(self.curved_triangles[start : start + BLOCK], 1)
            total += [patch.weights.sum(), *(patch.weights[..., None] * patch.xy).sum(axis=(0, 1))]
        return total

    @cached_property
    def area(self) -> float:
        """Area of the region."""
        return float(sum(p.weights.sum() for p in self.patches(0)))
