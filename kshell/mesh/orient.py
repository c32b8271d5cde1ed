"""Consistent orientation of triangles.

In the plane z = const every triangle is turned counter-clockwise. In space neighbours are made to agree
within each sheet, that is across edges shared by exactly two triangles, by a double cover: every triangle is
two nodes of a graph, "as stored" and "reversed"; an edge links the nodes that agree. The two copies of a sheet
fall apart into two components, one per orientation, unless the sheet is one-sided (a Moebius strip).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh.mesh import EDGE_VERTICES
from kshell.mesh.words import place

# walking round a triangle (0, 1, 2), its edges (0, 1), (1, 2) are met forward and (0, 2) backward
WALK = np.array([1, 1, -1])

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


def shared_edges(triangles: Ints, n_points: int) -> tuple[Ints, Bools]:
    """Pairs of triangles across the edges that exactly two triangles share.

    Returns
    -------
    pairs : (n, 2) flat positions 3 * triangle + local edge
    agree : (n,) whether the two triangles run along the edge in opposite directions, as they should
    """
    ends = triangles[:, EDGE_VERTICES]  # (triangle, edge, end)
    forward = (np.sign(ends[..., 1] - ends[..., 0]) * WALK).ravel()
    low, high = ends.min(axis=2), ends.max(axis=2)
    key = (low.astype(np.int64) * n_points + high).ravel()
    order = np.argsort(key, kind="stable")
    key = key[order]
    same = key[1:] == key[:-1]
    first = np.concatenate([[True], ~same])  # a new edge starts here
    start = np.flatnonzero(first)
    length = np.diff(np.append(start, len(key)))
    start = start[length == 2]
    pairs = np.stack([order[start], order[start + 1]], axis=1)
    return pairs, forward[pairs[:, 0]] != forward[pairs[:, 1]]


def to_reverse(points: NDArray[np.float64], triangles: Ints, flat: bool, source: str) -> Bools:
    """(triangle,) which triangles must be reversed.

    Parameters
    ----------
    points : (vertex, 3) array
    triangles : (triangle, 3) array
    flat : bool
        The mesh lies in a plane z = const: normals become +z. Else the majority of each sheet stays.

    Raises
    ------
    InputError
        Where triangles of a flat mesh overlap, or a surface in space is one-sided.
    """
    pairs, agree = shared_edges(triangles, len(points))
    if flat:
        a, b, c = (points[triangles[:, k], :2] for k in range(3))
        turn = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
        reverse = turn < 0.0
        t = pairs // 3
        folded = np.flatnonzero(agree == (reverse[t[:, 0]] != reverse[t[:, 1]]))
        if len(folded):
            middle = _edge_middle(points, triangles, pairs[folded[0], 0])
            raise InputError(
                f"{source}: the mesh is folded over itself at {len(folded)} of its edges, e.g. at {place(middle)}: "
                "an inverted triangle overlaps its neighbour there. Mesh again (a smaller element size or, for "
                "order 2, gmsh's high-order optimisation helps), or move the vertex back"
            )
        return reverse
    if agree.all():
        return np.zeros(len(triangles), dtype=bool)
    return _by_double_cover(points, triangles, pairs, agree, source)


def _by_double_cover(
    points: NDArray[np.float64], triangles: Ints, pairs: Ints, agree: Bools, source: str
) -> Bools:
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    n = len(triangles)
    t = pairs // 3
    cross = np.where(agree, 0, n)
    row = np.concatenate([t[:, 0], t[:, 0] + n])
    column = np.concatenate([t[:, 1] + cross, (t[:, 1] + n + cross) % (2 * n)])
    graph = coo_matrix((np.ones(len(row), dtype=np.int8), (row, column)), shape=(2 * n, 2 * n))
    n_parts, part = connected_components(graph, directed=False)
    stored, reversed_ = part[:n], part[n:]
    one_sided = np.flatnonzero(stored == reversed_)
    if len(one_sided):
        # an edge where the stored orientations clash: the strip can be cut there
        clash = np.flatnonzero(~agree & (stored == reversed_)[t[:, 0]])[0]
        middle = _edge_middle(points, triangles, pairs[clash, 0])
        raise InputError(
            f"{source}: the surface is one-sided (a Moebius strip) near {place(middle)}, so it has no top and "
            "bottom. Cut it there into two surfaces that share no vertices, or mesh it as two sheets"
        )
    # of the two components of a sheet keep the one that holds more triangles as stored; ties keep the first
    as_stored = np.bincount(stored, minlength=n_parts)
    as_reversed = np.bincount(reversed_, minlength=n_parts)  # the same count for the opposite component
    better = as_stored[stored] - as_reversed[stored]
    return (better < 0) | ((better == 0) & (stored > reversed_))


def _edge_middle(points: NDArray[np.float64], triangles: Ints, flat_position: int) -> NDArray[np.float64]:
    triangle, edge = divmod(int(flat_position), 3)
    middle: NDArray[np.float64] = points[triangles[triangle, EDGE_VERTICES[edge]]].mean(axis=0)
    return middle
