"""The sparsity pattern of a plate matrix, built once from the mesh, and the map of element entries into it.

Vertices and edges (nodes, here) couple as whole blocks, so the pattern is found between nodes (36 pairs
per triangle) and expanded to unknowns; no list of all element entries is ever sorted or stored.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.plate.reduction import Reduction

Ints = NDArray[np.int64]


class Pattern:
    """Compressed rows of the reduced matrix.

    Attributes
    ----------
    indptr, indices : int arrays
        As in scipy's CSR; 32 bit where the number of entries allows it.
    """

    def __init__(self, reduction: Reduction) -> None:
        layout = reduction.layout
        mesh, b = layout.mesh, layout.per_vertex
        self.reduction = reduction
        n_vertices, n_edges = len(mesh.points), len(mesh.edges)
        n_nodes = n_vertices + n_edges
        free = reduction.unknown >= 0
        sizes = np.concatenate(
            [free[: b * n_vertices].reshape(n_vertices, b).sum(axis=1), free[b * n_vertices :]]
        ).astype(np.int64)
        starts = np.concatenate([[0], np.cumsum(sizes)])  # first unknown of each node

        self.nodes = np.concatenate([mesh.triangles, n_vertices + mesh.triangle_edges], axis=1)  # (triangle, 6)
        graph = self._node_graph(n_nodes)
        near_size = sizes[graph.indices]
        before = np.concatenate([[0], np.cumsum(near_size)])
        # offset of each neighbour's columns within the rows of a node
        self.offsets = before[:-1] - np.repeat(before[graph.indptr[:-1]], np.diff(graph.indptr))
        width = before[graph.indptr[1:]] - before[graph.indptr[:-1]]  # entries in each row of a node
        row_width = np.repeat(width, sizes)
        indptr = np.concatenate([[0], np.cumsum(row_width)])
        self.entries = int(indptr[-1])
        kind = np.int32 if self.entries < 2**31 else np.int64
        self.indptr = indptr.astype(kind)

        # columns: for every row of a node the same list of unknowns of its neighbours
        self.indices = np.empty(self.entries, dtype=kind)
        for size in np.unique(sizes[sizes > 0]):
            self._fill_columns(graph, np.flatnonzero(sizes == size), int(size), sizes, starts)
        self.graph = graph
        self.first_row = indptr[starts[:-1]]  # position of the first entry of the first row of each node
        self.width = width
        # rank of each degree of freedom among the free ones of its node
        node_of_dof = np.concatenate([np.repeat(np.arange(n_vertices), b), n_vertices + np.arange(n_edges)])
        self.rank = np.where(free, reduction.unknown - starts[node_of_dof], -1).astype(np.int64)

    def _node_graph(self, n_nodes: int) -> sp.csr_matrix:
        """Which nodes share a triangle, columns sorted."""
        rows = np.repeat(np.arange(len(self.nodes) + 1, dtype=np.int32)[:-1], 6)
        member = sp.csr_matrix(
            (np.ones(self.nodes.size, dtype=np.int8), (rows, self.nodes.ravel())),
            shape=(len(self.nodes), n_nodes),
        )
        graph = (member.T @ member).tocsr()
        graph.sort_indices()
        return graph

    def _fill_columns(
        self, graph: sp.csr_matrix, nodes: Ints, size: int, sizes: Ints, starts: Ints
    ) -> None:
        """Write the column numbers of all rows of nodes that have ``size`` unknowns."""
        counts = np.diff(graph.indptr)[nodes]
        link = _ranges(graph.indptr[nodes].astype(np.int64), counts)
        near = graph.indices[link]
        columns = _ranges(starts[near], sizes[near])
        width = np.zeros(len(nodes), dtype=np.int64)
        np.add.at(width, np.repeat(np.arange(len(nodes)), counts), sizes[near])
        place = self.indptr[starts[nodes]].astype(np.int64)
        for r in range(size):
            self.indices[_ranges(place + r * width, width)] = columns

    def positions(self, triangles: Ints, unknown: NDArray[np.int32]) -> NDArray[np.intp]:
        """Where the entries of element matrices go in the data array.

        Parameters
        ----------
        triangles : (n,) int array
        unknown : (n, local) int array
            Unknown numbers, -1 for fixed columns.

        Returns
        -------
        (n, local, local) int array; entries of fixed rows or columns point one past the end.
        """
        b = self.reduction.layout.per_vertex
        nodes = self.nodes[triangles]  # (n, 6)
        pairs = self._pairs(nodes)  # (n, 6, 6) offsets of the neighbour's columns
        local_node = np.concatenate([np.repeat(np.arange(3), b), [3, 4, 5]])
        rank = self.rank[self.reduction.layout.triangle_dofs(triangles)]  # (n, local)
        row = self.first_row[nodes][:, local_node] + rank * self.width[nodes][:, local_node]
        out = row[:, :, None] + pairs[:, local_node][:, :, local_node] + rank[:, None, :]
        fixed = unknown < 0
        out[fixed[:, :, None] | fixed[:, None, :]] = self.entries
        return out

    def _pairs(self, nodes: Ints) -> Ints:
        """(n, 6, 6) offset of node j's columns within node i's rows."""
        n = len(nodes)
        row = np.repeat(nodes, 6, axis=1).ravel()
        column = np.tile(nodes, (1, 6)).ravel()
        low = self.graph.indptr[row].astype(np.int64)
        high = self.graph.indptr[row + 1].astype(np.int64)
        while True:  # bisection in the sorted columns of each row, all at once
            active = high - low > 1
            if not active.any():
                break
            middle = (low + high) // 2
            right = self.graph.indices[middle] <= column
            low = np.where(active & right, middle, low)
            high = np.where(active & ~right, middle, high)
        return self.offsets[low].reshape(n, 6, 6)


def _ranges(starts: Ints, counts: Ints) -> Ints:
    """Concatenation of start, start + 1, ... for each start and count."""
    starts, counts = np.asarray(starts, dtype=np.int64), np.asarray(counts, dtype=np.int64)
    total = int(counts.sum())
    ends = np.cumsum(counts)
    return np.arange(total) + np.repeat(starts - (ends - counts), counts)
