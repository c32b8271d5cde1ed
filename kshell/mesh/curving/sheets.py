"""Which edges of flat triangles keep their shape, and the smooth sheets that they bound.

An edge is kept where not exactly two triangles meet, where they meet at the angle of a crease, where the angle stands
out from all angles beside it, and where a flat part of the surface ends. A flat part is a set of coplanar triangles
with a vertex all of whose triangles lie in the plane (the strips of a structured cylinder are coplanar, too, but have
no such vertex), or a strip of coplanar triangles that is wide and bends little at its borders, compared with the
facets of the bend that follows.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.connected import connected_parts
from kshell.mesh.orient import shared_edges
from kshell.mesh.triangulation import Triangulation
from kshell.mesh.vectors import cross

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

FLAT = 1e-4  # angle between triangles of one plane, radians
FLAT_PART = 0.02  # the same, in the median of the angles of curved parts
LEAST_JUMP = np.radians(8.0)  # angle from which an edge may stand out
STANDS_OUT = 2.5  # by which factor it is larger then than the angles beside it
WIDE = 2.0  # height of a flat strip, in the heights of the facets beside it
GENTLE = 0.45  # curvature over its border, in the curvature over the next border


@dataclass(frozen=True)
class Sheets:
    """A mesh cut along its kept edges.

    Attributes
    ----------
    angle : (edge,) between the two triangles, 0 where there are not two
    pair : (edge, 2) the two triangles, -1 where there are not two
    kept : (edge,) bool
    flat : (triangle,) bool, in a flat part
    triangles : (triangle, 3) numbers of vertices of the cut mesh
    vertex : (vertex of the cut mesh,) number in the mesh
    """

    angle: Floats
    pair: Ints
    kept: Bools
    flat: Bools
    triangles: Ints
    vertex: Ints


def find_sheets(mesh: Triangulation, crease: float) -> Sheets:
    """Kept edges, flat parts and sheets.

    Parameters
    ----------
    mesh : Triangulation
        Of order 1.
    crease : float
        Angle in radians from which neighbours meet in a fold.
    """
    angle, pair = _angles(mesh)
    two = pair[:, 0] >= 0
    curved = two & (angle > FLAT) & (angle < crease)
    level = max(FLAT, FLAT_PART * float(np.median(angle[curved]))) if curved.any() else FLAT
    in_plane = two & (angle < level)
    label = _components(len(mesh.triangles), pair[in_plane])
    flat = _whole_fans(mesh, ~in_plane, label)
    flat |= _wide_strips(mesh, angle, pair, label, level, crease, flat)
    kept = ~two | (angle >= crease)
    kept |= _jumps(mesh, angle, pair, kept)
    kept[two] |= flat[pair[two, 0]] != flat[pair[two, 1]]
    triangles, vertex = _cut(mesh, kept, pair)
    return Sheets(angle, pair, kept, flat, triangles, vertex)


def unit_normals(points: Floats, triangles: NDArray[np.integer]) -> Floats:
    """(triangle, 3)."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    n = cross(b - a, c - a)
    return n / np.linalg.norm(n, axis=1)[:, None]


def _angles(mesh: Triangulation) -> tuple[Floats, Ints]:
    normal = unit_normals(mesh.points, mesh.triangles)
    places, _ = shared_edges(mesh)
    edge = mesh.triangle_edges.ravel()[places[:, 0]]
    pair = np.full((len(mesh.edges), 2), -1, dtype=np.int64)
    pair[edge] = places // 3
    one, other = normal[pair[edge, 0]], normal[pair[edge, 1]]
    angle = np.zeros(len(mesh.edges))
    angle[edge] = np.arctan2(np.linalg.norm(cross(one, other), axis=1), np.sum(one * other, axis=1))
    return angle, pair


def _components(number: int, links: Ints) -> Ints:
    """(item,) label of the connected set each belongs to."""
    return connected_parts(number, links[:, 0], links[:, 1])[1]


def _whole_fans(mesh: Triangulation, border_or_bent: Bools, label: Ints) -> Bools:
    """(triangle,) coplanar sets with a vertex off the border none of whose edges is bent."""
    rough = np.zeros(len(mesh.points), dtype=bool)
    rough[mesh.edges[border_or_bent]] = True
    hit = ~rough[mesh.triangles].all(axis=1)
    return np.isin(label, label[hit])


def _wide_strips(
    mesh: Triangulation, angle: Floats, pair: Ints, label: Ints, level: float, crease: float, known: Bools
) -> Bools:
    """(triangle,) strips of coplanar triangles without such a vertex that are flat parts beside bends.

    Over every border, unless it is a crease, the strip is WIDE times as high as the facet beyond, and the surface
    bends there, angle over mean height, by less than GENTLE of what it does over the other borders of that facet.
    """
    out = np.zeros(len(mesh.triangles), dtype=bool)
    size = np.bincount(label)
    bends = np.flatnonzero((pair[:, 0] >= 0) & (angle >= level))
    candidates = np.flatnonzero((size >= 2) & ~np.isin(np.arange(len(size)), label[known]))
    if not len(candidates) or not len(bends):
        return out
    sides = label[pair[bends]]  # (bend, side)
    at_bend = _rows(sides.ravel(), len(size))
    of_label = _rows(label, len(size))
    place = dict(zip(bends.tolist(), range(len(bends)), strict=True))

    def borders(c: int) -> list[int]:
        return [int(bends[k // 2]) for k in at_bend(c)]

    def height(c: int, edge: int) -> float:
        a, b = mesh.points[mesh.edges[edge]]
        d = mesh.points[mesh.triangles[of_label(c)].ravel()] - a
        u = (b - a) / np.linalg.norm(b - a)
        return float(np.linalg.norm(d - (d @ u)[:, None] * u, axis=1).max())

    def curvature(edge: int) -> float:
        one, other = sides[place[edge]]
        return float(angle[edge]) / (0.5 * (height(one, edge) + height(other, edge)))

    def gentle(c: int, edge: int) -> bool:
        if angle[edge] >= crease:
            return True
        beyond = int(sides[place[edge]].sum()) - c
        past = [x for x in borders(beyond) if c not in sides[place[x]]]
        if height(c, edge) <= WIDE * height(beyond, edge) or not past:
            return False
        return curvature(edge) < GENTLE * max(map(curvature, past))

    for c in candidates.tolist():
        edges = borders(c)
        if edges and all(gentle(c, edge) for edge in edges):
            out |= label == c
    return out


class _rows:
    """Positions of each value of an array of small whole numbers."""

    def __init__(self, values: Ints, number: int) -> None:
        self.order = np.argsort(values, kind="stable")
        self.start = np.searchsorted(values[self.order], np.arange(number + 1))

    def __call__(self, value: int) -> Ints:
        return self.order[self.start[value] : self.start[value + 1]]


def _jumps(mesh: Triangulation, angle: Floats, pair: Ints, kept: Bools) -> Bools:
    """(edge,) whose angle stands out from all those at the corners opposite, edges to its own ends left out.

    Chains of them that end in the middle of a sheet are none.
    """
    some = np.flatnonzero((angle > LEAST_JUMP) & (pair[:, 0] >= 0))
    out = np.zeros(len(angle), dtype=bool)
    if not len(some):
        return out
    ends = mesh.edges.astype(np.int64)
    order = np.argsort(ends.ravel(), kind="stable")
    at, start = order // 2, np.searchsorted(ends.ravel()[order], np.arange(len(mesh.points) + 1))
    largest = np.zeros(len(some))
    for side in range(2):
        opposite = mesh.triangles[pair[some, side]].sum(axis=1, dtype=np.int64) - ends[some].sum(axis=1)
        count = start[opposite + 1] - start[opposite]
        row = np.repeat(np.arange(len(some)), count)
        first = np.repeat(start[opposite] - np.cumsum(count) + count, count)
        edge = at[first + np.arange(count.sum())]
        other = ends[edge].sum(axis=1) - opposite[row]
        free = (other[:, None] != ends[some[row]]).all(axis=1)
        np.maximum.at(largest, row[free], angle[edge[free]])
    out[some] = angle[some] > STANDS_OUT * largest
    out &= ~kept
    while True:
        degree = np.bincount(ends[kept | out].ravel(), minlength=len(mesh.points))
        loose = out & (degree[ends] < 2).any(axis=1)
        if not loose.any():
            return out
        out &= ~loose


def _cut(mesh: Triangulation, kept: Bools, pair: Ints) -> tuple[Ints, Ints]:
    """Triangles of the mesh cut along the kept edges, and the vertex that each of its vertices was."""
    corners = mesh.triangles.astype(np.int64)
    inner = np.flatnonzero(~kept)
    links = []
    for end in range(2):
        vertex = mesh.edges[inner, end]
        number = [
            3 * pair[inner, side] + np.argmax(corners[pair[inner, side]] == vertex[:, None], axis=1)
            for side in range(2)
        ]
        links.append(np.stack(number, axis=1))
    label = _components(corners.size, np.concatenate(links))
    vertex = np.empty(label.max() + 1, dtype=np.int64)
    vertex[label] = corners.ravel()
    return label.reshape(-1, 3), vertex
