"""Fans: the triangles around a vertex between edges that are cut there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.connected import connected_parts
from kshell.mesh.mesh import EDGE_VERTICES, Mesh

Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]


def fans_between(mesh: Mesh, cut: Flags) -> tuple[Ints, Ints]:
    """Fans of all vertices, numbered from 0: first one for each vertex, then the further ones.

    Parameters
    ----------
    cut : (edge, 2)
        Whether an edge separates fans at its lower and at its higher vertex.

    Returns
    -------
    corner : (triangle, 3)
        Fan of each corner of each triangle.
    vertex : (fan,)
        Vertex of each fan.
    """
    corner, vertex = mesh.triangles.astype(np.int64, order="C"), np.arange(len(mesh.points))
    touched = np.zeros(len(mesh.points), dtype=bool)
    touched[mesh.edges[cut]] = True
    triangles = np.flatnonzero(touched[mesh.triangles].any(axis=1))
    if not len(triangles):
        return corner, vertex
    # corners (3 t + c) are joined across the edges at their vertex that are not cut there
    sides: dict[tuple[int, int], int] = {}
    first, second = [], []
    for t in triangles.tolist():
        for k, local in enumerate(EDGE_VERTICES.tolist()):
            e = int(mesh.triangle_edges[t, k])
            for c in local:
                v = int(mesh.triangles[t, c])
                if not touched[v] or cut[e, int(mesh.edges[e, 1] == v)]:
                    continue
                other = sides.setdefault((e, v), 3 * t + c)
                if other != 3 * t + c:
                    first.append(other)
                    second.append(3 * t + c)
    size = 3 * len(mesh.triangles)
    label = connected_parts(size, np.array(first, dtype=np.int64), np.array(second, dtype=np.int64))[1]
    at = np.flatnonzero(touched[mesh.triangles.ravel()])
    # fans in the order of their first corners; the first of each vertex has the vertex's number
    _, where, inverse = np.unique(label[at], return_index=True, return_inverse=True)
    of_fan = mesh.triangles.ravel()[at[where]].astype(np.int64)
    order = np.argsort(where, kind="stable")
    is_first = np.zeros(len(where), dtype=bool)
    is_first[order[np.unique(of_fan[order], return_index=True)[1]]] = True
    number = of_fan.copy()
    further = order[~is_first[order]]
    number[further] = len(vertex) + np.arange(len(further))
    corner.reshape(-1)[at] = number[inverse]
    return corner, np.concatenate([vertex, of_fan[further]])
