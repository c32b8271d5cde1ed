"""Which triangles are whose: parts of equal size with short borders.

The parts of a file that gmsh has divided (`gmsh -part N`), where there are as many; else METIS on the graph of
neighbours over edges where pymetis is installed, else the centres of triangles cut in halves across the longest side of
their box.
"""

from __future__ import annotations

import importlib.util

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh.mesh import Mesh

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


# what the first process holds of the whole surface, against what all hold of its triangles; see verification/scale.md
HELD_BY_FIRST = 0.25
LEAST = 0.1  # of an even share


def share_of_first(parts: int) -> float:
    """The share of the triangles with which the first process, which holds the whole beside, takes no more than others.

    Two processes have a half each: the time counts that one of them alone would take.
    """
    if parts < 3:
        return 1.0 / parts
    return max((1.0 - HELD_BY_FIRST * (parts - 1)) / parts, LEAST / parts)


def partition(mesh: Mesh, parts: int, first: float | None = None) -> Ints:
    """(triangle,) number of the part of each triangle, from 0; no part is empty.

    Parameters
    ----------
    mesh : Mesh
        Its own parts, of its file, are taken where there are as many.
    parts : int
    first : float, optional
        Share of the first part, of 1; the others are equal. All are if absent.

    Raises
    ------
    InputError
        If there are fewer triangles than parts.
    """
    count = len(mesh.triangles)
    if count < parts:
        raise InputError(f"{parts} processes for {count} triangles: start at most {count} processes, or one")
    if parts == 1:
        return np.zeros(count, dtype=np.int64)
    if mesh.parts is not None and np.array_equal(np.unique(mesh.parts), np.arange(parts)):
        return np.asarray(mesh.parts, dtype=np.int64)
    first = 1.0 / parts if first is None else first
    shares = [first, *[(1.0 - first) / (parts - 1)] * (parts - 1)]
    if importlib.util.find_spec("pymetis") is not None:
        found = _by_metis(mesh, shares)
        if len(np.unique(found)) == parts:  # METIS may leave some empty where they are tiny
            return found
    return cut_by_places(mesh.points[mesh.triangles].mean(axis=1), shares)


def _by_metis(mesh: Mesh, shares: list[float]) -> Ints:
    import pymetis

    edges = mesh.triangle_edges
    number = np.repeat(np.arange(len(edges)), 3)
    shape = (len(edges), len(mesh.edges))
    at = sp.csr_matrix((np.ones(edges.size, dtype=np.int8), (number, edges.ravel())), shape=shape)
    graph = (at @ at.T).tocoo()
    apart = graph.row != graph.col
    graph = sp.csr_matrix((graph.data[apart], (graph.row[apart], graph.col[apart])), shape=graph.shape)
    starts, neighbours = graph.indptr.astype(np.int64), graph.indices.astype(np.int64)
    found = pymetis.part_graph(len(shares), pymetis.CSRAdjacency(starts, neighbours), tpwgts=shares)
    return np.asarray(found[1], dtype=np.int64)


def cut_by_places(centres: Floats, shares: list[float]) -> Ints:
    """(n,) parts of points (n, d) of these shares, by cutting across the longest side, again and again."""
    out = np.zeros(len(centres), dtype=np.int64)
    sizes = np.maximum(np.diff(np.rint(np.cumsum([0.0, *shares]) * len(centres))).astype(np.int64), 1)
    sizes[np.argmax(sizes)] += len(centres) - sizes.sum()
    pending = [(np.arange(len(centres)), 0, len(shares))]
    while pending:
        members, first, count = pending.pop()
        if count == 1:
            out[members] = first
            continue
        axis = int(np.argmax(np.ptp(centres[members], axis=0)))
        left = count // 2
        order = members[np.argsort(centres[members, axis], kind="stable")]
        middle = int(sizes[first : first + left].sum())
        pending += [(order[:middle], first, left), (order[middle:], first + left, count - left)]
    return out
