"""Bisection by the newest vertex: marked triangles are cut, the mesh stays conforming, its groups and its curves stay.

A triangle (a, b, c) is cut at its edge (a, b), its children are (c, a, m) and (b, c, m): they keep its sense, and their
first edges lie opposite the new vertex. Only four shapes come from each first triangle, however often it is cut. Edges
are marked, not triangles: where an edge of a triangle is cut its first one is, too, until nothing changes; the number
of triangles stays proportional to that of the marked ones.

Sources: Binev, Dahmen & DeVore, Numer. Math. 97 (2004) 219-268; Stevenson, Math. Comp. 77 (2008) 227-241; in arrays:
Funken, Praetorius & Wissgott, Comput. Methods Appl. Math. 11 (2011) 460-490.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.mesh import Mesh
from kshell.mesh.triangulation import Group, changed

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

AROUND = np.array([[0, 1], [1, 2], [2, 0]])  # the edges walked around; meshes number them so
CORNERS = np.eye(3)  # barycentric coordinates
MIDDLES = CORNERS[AROUND].mean(axis=1)
NODES = np.concatenate([CORNERS, MIDDLES])
# children by the edges that are cut beside the first: corners 0 1 2, and 3 4 5 the middles of edges 01 12 20
WHOLE, FIRST_HALF, SECOND_HALF = ((0, 1, 2),), ((2, 0, 3),), ((1, 2, 3),)
FIRST_QUARTERS, SECOND_QUARTERS = ((3, 2, 5), (0, 3, 5)), ((3, 1, 4), (2, 3, 4))
ALIKE = 1e-9  # relative difference of lengths that is none: regular meshes are cut regularly
# spacings of the coordinates that an edge is to be long at least: vertices on a slanted line are off it by one of them
FINEST = 128.0


@dataclass(frozen=True, eq=False)
class Refined:
    """A refined mesh.

    Attributes
    ----------
    mesh : Mesh
        The vertices of the mesh before come first, with their numbers.
    parent : (triangle,) int array
        Of each triangle the one before, in ascending order.
    """

    mesh: Mesh
    parent: Ints


def longest_first(mesh: Mesh) -> Mesh:
    """The same mesh with each triangle's longest edge as its first, at which it will be cut."""
    length = mesh.edge_lengths[mesh.triangle_edges]  # of edges 01, 12, 02
    longest = np.argmax(length >= (1.0 - ALIKE) * length.max(axis=1, keepdims=True), axis=1)
    turned = (longest[:, None] + np.arange(3)) % 3
    return replace(mesh, triangles=np.take_along_axis(mesh.triangles, turned.astype(np.int64), axis=1))


def bisect(
    mesh: Mesh, marked: NDArray[np.integer] | NDArray[np.bool_], middles: Floats | None = None
) -> Refined:
    """Marked triangles cut at all of their edges into four, and others as it takes to keep the mesh conforming.

    Parameters
    ----------
    mesh : Mesh
        Of order 1 or 2, flat or in space; the mid-edge nodes of order 2 stay on the curves and surfaces of its nodes.
    marked : (n,) int or (triangle,) bool array
    middles : (edge, 3) array, optional
        Where the vertex on each edge goes; absent: to its mid-edge node, or to the middle of the chord.
    """
    edges = mesh.triangle_edges.astype(np.int64)
    cut = np.zeros(len(mesh.edges), dtype=bool)
    cut[edges[marked].ravel()] = True
    while True:
        torn = cut[edges].any(axis=1) & ~cut[edges[:, 0]]
        if not torn.any():
            break
        cut[edges[torn, 0]] = True
    if middles is None:
        middles = mesh.points[mesh.edges].mean(axis=1) if mesh.midpoints is None else mesh.midpoints
    vertex = np.full(len(cut), -1, dtype=np.int64)
    vertex[cut] = len(mesh.points) + np.arange(np.count_nonzero(cut))
    points = np.concatenate([mesh.points, middles[cut]])
    nodes = np.concatenate([mesh.triangles.astype(np.int64), vertex[edges]], axis=1)
    children, parent = _children(cut[edges])
    order = np.argsort(parent, kind="stable")
    children, parent = children[order], parent[order]
    triangles = np.take_along_axis(nodes[parent], children, axis=1).astype(np.int32)
    fine = replace(mesh, points=points, triangles=triangles, midpoints=None, groups={}, parts=None)
    parts = None if mesh.parts is None else mesh.parts[parent]
    midpoints = None if mesh.midpoints is None else _midpoints(mesh, fine, children, parent)
    groups = {name: _refined_group(mesh, fine, group, vertex, parent) for name, group in mesh.groups.items()}
    return Refined(changed(fine, midpoints=midpoints, groups=groups, parts=parts), parent)


def bisect_around(mesh: Mesh, vertices: NDArray[np.integer], times: int) -> Mesh:
    """The triangles at some vertices cut again and again, as long as coordinates resolve them: a graded mesh."""
    for _ in range(times):
        chosen = np.flatnonzero(np.isin(mesh.triangles, vertices).any(axis=1))
        if not cuttable(mesh)[chosen].all():
            break
        mesh = bisect(mesh, chosen).mesh
    return mesh


def spacing(mesh: Mesh) -> Floats:
    """(triangle,) distance of neighbouring floating-point numbers as large as the coordinates of a triangle."""
    varies = np.ptp(mesh.points, axis=0) > 0.0
    largest = np.abs(mesh.points[:, varies]).max(axis=1, initial=0.0)[mesh.triangles].max(axis=1)
    return np.spacing(largest).astype(np.float64)


def cuttable(mesh: Mesh) -> NDArray[np.bool_]:
    """(triangle,) whether the halves of its edges are much longer than the spacing of the coordinates."""
    shortest = mesh.edge_lengths[mesh.triangle_edges].min(axis=1)
    return np.asarray(shortest >= 2.0 * FINEST * spacing(mesh), dtype=bool)


def _children(cut: NDArray[np.bool_]) -> tuple[Ints, Ints]:
    """(n, 3) corners of the children among the six nodes of their parents, and (n,) these, from (triangle, 3) cuts."""
    first, second, third = cut.T
    parts: list[Ints] = []
    parents: list[Ints] = []
    for where, kind in (
        (~first, WHOLE),
        (first & ~third, FIRST_HALF),
        (first & third, FIRST_QUARTERS),
        (first & ~second, SECOND_HALF),
        (first & second, SECOND_QUARTERS),
    ):
        rows = np.flatnonzero(where)
        for corners in kind:
            parts.append(np.broadcast_to(np.array(corners, dtype=np.int64), (len(rows), 3)))
            parents.append(rows)
    return np.concatenate(parts), np.concatenate(parents)


def _midpoints(mesh: Mesh, fine: Mesh, children: Ints, parent: Ints) -> Floats:
    """(edge, 3) mid-edge nodes of the children on the quadratic triangles of their parents."""
    assert mesh.midpoints is not None
    at = np.concatenate([mesh.points[mesh.triangles], mesh.midpoints[mesh.triangle_edges]], axis=1)
    out = np.empty((len(fine.edges), 3))
    for number, (i, j) in enumerate(AROUND):
        a, b, c = (0.5 * (NODES[children[:, i]] + NODES[children[:, j]])).T
        shape = np.stack(
            [a * (2 * a - 1), b * (2 * b - 1), c * (2 * c - 1), 4 * a * b, 4 * b * c, 4 * c * a], axis=1
        )
        out[fine.triangle_edges[:, number]] = (shape[:, None] @ at[parent])[:, 0]
    return out


def _refined_group(mesh: Mesh, fine: Mesh, group: Group, vertex: Ints, parent: Ints) -> Group:
    if group.dimension == 0:
        return group
    if group.dimension == 2:
        members = np.flatnonzero(np.isin(parent, group.members))
    else:
        ends, new = mesh.edges[group.members].astype(np.int64), vertex[group.members]
        split = new >= 0
        halves = [np.stack([ends[split, end], new[split]], axis=1) for end in range(2)]
        members = np.sort(fine.edge_index(np.concatenate([ends[~split], *halves])))
    return replace(group, members=members.astype(group.members.dtype))
