"""Which triangles are whose: parts of equal size with short borders.

METIS on the graph of neighbours over edges where pymetis is installed, else the centres of triangles cut in halves
across the longest side of their box.
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


def partition(mesh: Mesh, parts: int) -> Ints:
    """(triangle,) number of the part of each triangle, from 0; no part is empty.

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
    if importlib.util.find_spec("pymetis") is not None:
        found = _by_metis(mesh, parts)
        if len(np.unique(found)) == parts:  # METIS may leave some empty where they are tiny
            return found
    return halved(mesh.points[mesh.triangles].mean(axis=1), parts)


def _by_metis(mesh: Mesh, parts: int) -> Ints:
    import pymetis

    edges = mesh.triangle_edges
    number = np.repeat(np.arange(len(edges)), 3)
    shape = (len(edges), len(mesh.edges))
    at = sp.csr_matrix((np.ones(edges.size, dtype=np.int8), (number, edges.ravel())), shape=shape)
    graph = (at @ at.T).tolil()
    graph.setdiag(0)
    graph = graph.tocsr()
    graph.eliminate_zeros()
    starts, neighbours = graph.indptr.astype(np.int64), graph.indices.astype(np.int64)
    found = pymetis.part_graph(parts, pymetis.CSRAdjacency(starts, neighbours))
    return np.asarray(found[1], dtype=np.int64)


def halved(centres: Floats, parts: int) -> Ints:
    """(n,) parts of points (n, d) by cutting across the longest side, again and again."""
    out = np.zeros(len(centres), dtype=np.int64)
    pending = [(np.arange(len(centres)), 0, parts)]
    while pending:
        members, first, count = pending.pop()
        if count == 1:
            out[members] = first
            continue
        axis = int(np.argmax(np.ptp(centres[members], axis=0)))
        left = count // 2
        order = members[np.argsort(centres[members, axis], kind="stable")]
        middle = len(order) * left // count
        pending += [(order[:middle], first, left), (order[middle:], first + left, count - left)]
    return out
