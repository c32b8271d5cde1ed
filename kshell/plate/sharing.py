"""Triangles that share a place: the values of a point on an edge, or at a vertex, are means over all of them.

Of what jumps between triangles any one of these would give a value of its own, and which of them a point is found in is
rounding.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kshell.plate.domain import Domain
from kshell.plate.fans import Fans
from kshell.plate.points import Located

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

ON_EDGE = 1e-9  # barycentric coordinate up to which a point lies on an edge


@dataclass(frozen=True)
class Shared:
    """Points in all of their triangles.

    Attributes
    ----------
    points : (m,) int array
        Which of n points; the first n are these in order, in the triangles they were found in.
    located : Located
        m of them.
    parts : (m,) array
        What each counts for: 1 in all for every point.
    """

    points: Ints
    located: Located
    parts: Floats

    def mean(self, values: Floats) -> Floats:
        """(n, ...) from values (m, ...)."""
        count = int(self.points.max(initial=-1)) + 1
        if count == len(self.points):
            return values
        out = np.zeros((count, *values.shape[1:]))
        np.add.at(out, self.points, values * self.parts.reshape(-1, *[1] * (values.ndim - 1)))
        return out


def edges_at(found: Located) -> NDArray[np.bool_]:
    """(n, 3) the local edges (0, 1), (1, 2), (0, 2) that points lie on."""
    x, y = found.xi[:, 0].T
    return np.asarray(np.abs(np.stack([y, 1 - x - y, x], axis=1)) < ON_EDGE)


def across(domain: Domain, found: Located) -> tuple[Ints, Ints, Ints]:
    """Points between the ends of straight edges inside, these edges, and the triangles on their other side."""
    mesh, at_edge = domain.mesh, edges_at(found)
    points, local = np.nonzero(at_edge & (at_edge.sum(axis=1) == 1)[:, None])
    edges = mesh.triangle_edges[found.triangles[points], local].astype(np.int64)
    inside = (mesh.edge_counts[edges] > 1) & ~np.isin(edges, domain.bent)
    points, edges = points[inside], edges[inside]
    sides = domain.sides(edges)
    return points, edges, np.where(sides[0] == found.triangles[points], sides[1], sides[0])


def along_edges(domain: Domain, found: Located, jump: NDArray[np.bool_] | None = None) -> Shared:
    """Both triangles of points on edges in equal parts; those alone that were found across edges ``jump`` (edge,)."""
    points, edges, triangles = across(domain, found)
    if jump is not None:
        points, triangles = points[~jump[edges]], triangles[~jump[edges]]
    number = np.concatenate([np.arange(len(found.triangles)), points])
    return Shared(number, _with(domain, found, points, triangles), 1.0 / np.bincount(number)[number])


def around(domain: Domain, fans: Fans, found: Located, jump: NDArray[np.bool_] | None = None) -> Shared:
    """The same, and at vertices all triangles of the fan by area, as in fields at vertices."""
    out = along_edges(domain, found, jump)
    at_edge = edges_at(found)
    points = np.flatnonzero(at_edge.sum(axis=1) == 2)
    if not len(points):
        return out
    # the vertex between two edges is the one that the third, (0, 1), (1, 2) or (0, 2), does not touch
    local = np.array([2, 0, 1])[np.argmin(at_edge[points], axis=1)]
    row = fans.corner[found.triangles[points], local]
    flat = np.asarray(fans.corner).ravel()
    wanted = np.zeros(len(fans.vertex), dtype=bool)
    wanted[row] = True
    corners = np.flatnonzero(wanted[flat])
    corners = corners[np.argsort(flat[corners], kind="stable")]
    first = np.searchsorted(flat[corners], row)
    count = np.searchsorted(flat[corners], row, side="right") - first
    step = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    triangles = corners[np.repeat(first, count) + step] // 3
    points = np.repeat(points, count)
    other = triangles != found.triangles[points]
    points, triangles = points[other], triangles[other]
    number = np.concatenate([out.points, points])
    located = Located.together([out.located, _with(domain, found, points, triangles, alone=True)])
    weight = domain.mesh.areas[located.triangles]
    at_vertex = at_edge.sum(axis=1)[number] == 2
    parts = np.append(out.parts, np.zeros(len(points)))
    parts[at_vertex] = (weight / np.bincount(number, weight)[number])[at_vertex]
    return Shared(number, located, parts)


def _with(domain: Domain, found: Located, points: Ints, triangles: Ints, alone: bool = False) -> Located:
    """Some of the points in other triangles, after all of them unless ``alone``."""
    if not len(points) and not alone:
        return found
    xy = found.xy[points]
    xi = domain.affine(triangles).reference_coordinates(xy[:, None])
    more = Located(triangles, xi, xy, found.distance[points])
    return more if alone else Located.together([found, more])
