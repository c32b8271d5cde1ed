"""Consistent orientation of triangles.

In the plane z = const every triangle is turned counter-clockwise. In space neighbours are made to agree
within each sheet, that is across edges shared by exactly two triangles, by a double cover: every triangle is
two nodes of a graph, "as stored" and "reversed"; an edge links the nodes that agree. The two copies of a
sheet fall apart into two components, one per orientation, unless the sheet is one-sided (a Moebius strip).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh.connected import connected_parts
from kshell.mesh.triangulation import EDGE_VERTICES, FIRST, SECOND, Triangulation
from kshell.mesh.words import place

# walking round a triangle (0, 1, 2), its edges (0, 1), (1, 2) are met forward and (0, 2) backward
WALKED_FORWARD = np.array([True, True, False])

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


def shared_edges(mesh: Triangulation) -> tuple[Ints, Bools]:
    """Pairs of triangles across the edges that exactly two triangles share.

    Returns
    -------
    pairs : (n, 2) flat positions 3 * triangle + local edge
    agree : (n,) whether the two triangles run along the edge in opposite directions, as they should
    """
    t = mesh.triangles
    forward = ((t[:, SECOND] > t[:, FIRST]) == WALKED_FORWARD).ravel()
    pairs = mesh.edge_table.sides[:, mesh.edge_counts == 2].T
    agree: Bools = forward[pairs[:, 0]] != forward[pairs[:, 1]]
    return pairs, agree


def to_reverse(mesh: Triangulation, flat: bool) -> Bools:
    """(triangle,) which triangles must be reversed.

    Parameters
    ----------
    mesh : Triangulation
    flat : bool
        The mesh lies in a plane z = const: normals become +z. Else the majority of each sheet stays.

    Raises
    ------
    InputError
        Where triangles of a flat mesh overlap, or a surface in space is one-sided.
    """
    pairs, agree = shared_edges(mesh)
    if flat:
        x = mesh.points[mesh.triangles, :2]
        a, b = x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]
        reverse = a[:, 0] * b[:, 1] < a[:, 1] * b[:, 0]
        t = pairs // 3
        folded = np.flatnonzero(agree == (reverse[t[:, 0]] != reverse[t[:, 1]]))
        if len(folded):
            middle = _edge_middle(mesh, pairs[folded[0], 0])
            raise InputError(
                f"{mesh.source}: the mesh is folded over itself at {len(folded)} of its edges, e.g. at "
                f"{place(middle)}: an inverted triangle overlaps its neighbour there. Mesh again (a smaller "
                "element size or, for order 2, gmsh's high-order optimisation helps), or move the vertex "
                "back"
            )
        return reverse
    if agree.all():
        return np.zeros(len(mesh.triangles), dtype=bool)
    return _by_double_cover(mesh, pairs, agree)


def _by_double_cover(mesh: Triangulation, pairs: Ints, agree: Bools) -> Bools:
    n = len(mesh.triangles)
    t = pairs // 3
    cross = np.where(agree, 0, n)
    row = np.concatenate([t[:, 0], t[:, 0] + n])
    column = np.concatenate([t[:, 1] + cross, (t[:, 1] + n + cross) % (2 * n)])
    n_parts, part = connected_parts(2 * n, row, column)
    stored, reversed_ = part[:n], part[n:]
    one_sided = np.flatnonzero(stored == reversed_)
    if len(one_sided):
        # an edge where the stored orientations clash: the strip can be cut there
        clash = np.flatnonzero(~agree & (stored == reversed_)[t[:, 0]])[0]
        middle = _edge_middle(mesh, pairs[clash, 0])
        raise InputError(
            f"{mesh.source}: the surface is one-sided (a Moebius strip) near {place(middle)}, so it has no "
            "top and bottom. Cut it there into two surfaces that share no vertices, or mesh it as two "
            "sheets"
        )
    # of the two components of a sheet keep the one that holds more triangles as stored; ties keep the first
    as_stored = np.bincount(stored, minlength=n_parts)
    as_reversed = np.bincount(reversed_, minlength=n_parts)  # the same count for the opposite component
    better = as_stored[stored] - as_reversed[stored]
    return (better < 0) | ((better == 0) & (stored > reversed_))


def _edge_middle(mesh: Triangulation, flat_position: int) -> NDArray[np.float64]:
    triangle, edge = divmod(int(flat_position), 3)
    middle: NDArray[np.float64] = mesh.points[mesh.triangles[triangle, EDGE_VERTICES[edge]]].mean(axis=0)
    return middle
