"""The sparsity pattern of a plate matrix, built once from the mesh, and the map of element entries into it.

Vertices and edges (nodes, here) couple as whole blocks. Which pairs of nodes couple follows from the mesh: a vertex
with itself, with the other end of an edge, with an edge it ends, with an edge opposite to it; an edge with itself and
with the others of its triangle. Numbering these pairs directly gives every triangle its 36 pairs without any search,
and no list of all element entries is ever sorted or stored.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.mesh.mesh import EDGE_VERTICES, Mesh
from kshell.plate.reduction import Reduction
from kshell.solvers import kernels
from kshell.solvers.kernels import contiguous

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Ints32 = NDArray[np.int32]

OPPOSITE_EDGE = (1, 2, 0)  # the local edge that does not touch local vertex 0, 1, 2


class NodePairs:
    """The coupled pairs of nodes of a mesh: vertices first, then edges.

    Attributes
    ----------
    indptr, columns : int arrays
        For each node the nodes it couples with, sorted.
    slot : (pair,) int array
        Position in `columns` of each pair, by pair number.
    """

    def __init__(self, mesh: Mesh) -> None:
        self.mesh = mesh
        nv, ne = len(mesh.points), len(mesh.edges)
        low, high = mesh.edges.T
        v, e = np.arange(nv, dtype=np.int32), np.arange(nv, nv + ne, dtype=np.int32)
        opposite = mesh.triangles.ravel()
        facing = nv + mesh.triangle_edges[:, OPPOSITE_EDGE].ravel()
        sides = nv + mesh.triangle_edges
        first, second = sides[:, [0, 0, 1, 1, 2, 2]].ravel(), sides[:, [1, 2, 0, 2, 0, 1]].ravel()
        blocks = (
            (v, v), (low, high), (high, low),  # vertices
            (low, e), (high, e), (e, low), (e, high), (opposite, facing), (facing, opposite),  # mixed
            (e, e), (first, second),  # edges
        )  # fmt: skip
        self._starts = np.concatenate([[0], np.cumsum([len(row) for row, _ in blocks])]).astype(np.int32)
        count = int(self._starts[-1])
        row = np.concatenate([row for row, _ in blocks], dtype=np.int32, casting="unsafe")
        column = np.concatenate([column for _, column in blocks], dtype=np.int32, casting="unsafe")
        number = np.arange(count, dtype=np.int32)
        graph = sp.csr_matrix((number, (row, column)), shape=(nv + ne, nv + ne))
        graph.sort_indices()
        self.indptr, self.columns = graph.indptr, graph.indices
        self.slot = np.empty(count, dtype=np.int32)
        self.slot[graph.data] = number

    def of_triangles(self, triangles: Ints) -> Ints32:
        """(n, 6, 6) slots of the pairs of each triangle's nodes: three vertices, three edges."""
        mesh, s = self.mesh, self._starts
        corner, edge = mesh.triangles[triangles], mesh.triangle_edges[triangles]
        t = np.asarray(triangles, dtype=np.int32)
        n_e = np.int32(len(mesh.edges))
        out = np.empty((6, 6, len(t)), dtype=np.int32)
        for a in range(3):
            out[a, a] = corner[:, a]
            out[3 + a, 3 + a] = s[9] + edge[:, a]
            facing = 3 + OPPOSITE_EDGE[a]
            out[a, facing] = s[7] + 3 * t + a
            out[facing, a] = s[8] + 3 * t + a
        for k, (a, b) in enumerate(EDGE_VERTICES):
            backwards = n_e * (
                corner[:, a] > corner[:, b]
            )  # the second half of each list is for the higher end
            out[a, b] = s[1] + edge[:, k] + backwards
            out[b, a] = s[1] + edge[:, k] + (n_e - backwards)
            out[a, 3 + k] = s[3] + edge[:, k] + backwards
            out[b, 3 + k] = s[3] + edge[:, k] + (n_e - backwards)
            out[3 + k, a] = s[5] + edge[:, k] + backwards
            out[3 + k, b] = s[5] + edge[:, k] + (n_e - backwards)
        for number, (i, j) in enumerate(((0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1))):
            out[3 + i, 3 + j] = s[10] + 6 * t + number
        return self.slot[out.transpose(2, 0, 1)]


class Pattern:
    """Compressed rows of the reduced matrix.

    Attributes
    ----------
    indptr, indices : int arrays
        As in scipy's CSR; 32 bit where the number of entries allows it.
    entries : int
    """

    def __init__(self, reduction: Reduction) -> None:
        self.reduction = reduction
        self._starts = np.concatenate([[0], np.cumsum(reduction.sizes)])  # first unknown of each node
        if kernels.compiled is None or not self._made_by_loops():
            self._made_by_arrays()

    def _made_by_loops(self) -> bool:
        """Rows by compiled loops; False where 32 bits are too few for their entries."""
        sizes, starts = (contiguous(part, np.int64) for part in (self.reduction.sizes, self._starts))
        pairs, near = kernels.neighbours_of_groups(self._nodes_of(slice(None)), len(sizes), True)
        none = np.empty(0, dtype=np.int32)
        self.entries = kernels.compiled.rows_of_nodes(pairs, near, sizes, starts, none, none)
        if self.entries >= 2**31:
            return False
        self.indptr: Any = np.zeros(self.reduction.count + 1, dtype=np.int32)
        self.indices: Any = np.empty(self.entries, dtype=np.int32)
        kernels.compiled.rows_of_nodes(pairs, near, sizes, starts, self.indptr, self.indices)
        return True

    def _made_by_arrays(self) -> None:
        sizes, starts = self.reduction.sizes, self._starts
        pairs, before, first_of_row = self._blocks
        width = np.diff(first_of_row)  # entries in each row of a node
        indptr = np.concatenate([[0], np.cumsum(np.repeat(width, sizes))])
        self.entries = int(indptr[-1])
        kind = np.int32 if self.entries < 2**31 else np.int64
        self.indptr = indptr.astype(kind)
        if self.reduction.layout.per_vertex == 1:
            self.indices = starts[pairs.columns[np.diff(before) > 0]].astype(kind)
            return
        self.indices = np.empty(self.entries, dtype=kind)
        for size in np.unique(sizes[sizes > 0]):
            self._fill_columns(np.flatnonzero(sizes == size), int(size), width)

    @cached_property
    def _blocks(self) -> tuple[NodePairs, Ints, Ints]:
        """Pairs of nodes, entries of one row before each of them, (pair + 1,), and before each node, (node + 1,)."""
        pairs, sizes = NodePairs(self.reduction.layout.mesh), self.reduction.sizes
        # an entry for every unknown of a neighbour, in the rows of nodes that have unknowns
        near_size = sizes[pairs.columns]
        near_size[np.repeat(sizes == 0, np.diff(pairs.indptr))] = 0
        before = np.concatenate([[0], np.cumsum(near_size)])
        return pairs, before, before[pairs.indptr]

    @cached_property
    def _block(self) -> Ints:
        """(pair,) where the block of a pair begins: the first unknown of the neighbour in the first row of the node."""
        pairs, before, first_of_row = self._blocks
        kind = self.indptr.dtype
        shift = self.indptr[self._starts[:-1]] - first_of_row[:-1].astype(kind)
        return np.asarray(before[:-1].astype(kind) + np.repeat(shift, np.diff(pairs.indptr)))

    def _fill_columns(self, nodes: Ints, size: int, width: Ints) -> None:
        """Write the column numbers of all rows of nodes that have ``size`` unknowns."""
        pairs, sizes, starts = self._blocks[0], self.reduction.sizes, self._starts
        begin = pairs.indptr[nodes].astype(np.int64)
        near = pairs.columns[ranges(begin, pairs.indptr[nodes + 1] - begin)]
        columns = ranges(starts[near], sizes[near])
        place = self.indptr[starts[nodes]].astype(np.int64)
        for r in range(size):
            self.indices[ranges(place + r * width[nodes], width[nodes])] = columns

    def positions(self, triangles: Ints, unknown: Ints32) -> NDArray[np.intp]:
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
        per_vertex = self.reduction.layout.per_vertex
        out = self._block[self._blocks[0].of_triangles(triangles)].astype(np.intp)  # (n, 6, 6)
        if per_vertex > 1:
            local_node = _local_nodes(unknown.shape[1])
            nodes = self._nodes_of(triangles)[:, local_node]
            rank = np.where(unknown < 0, 0, unknown - self._starts[nodes])  # among the unknowns of the node
            out = out[:, local_node][:, :, local_node]
            out += (rank * np.diff(self._blocks[2])[nodes])[:, :, None]
            out += rank[:, None, :]
        fixed = unknown < 0
        if fixed.any():
            out[fixed[:, :, None] | fixed[:, None, :]] = self.entries
        return out

    def add(self, data: Floats, triangles: Ints, unknown: Ints32, matrices: Floats) -> None:
        """Add element matrices (n, local, local) to the entries and one more (entries + 1,); see `positions`."""
        if kernels.compiled is None or self.indptr.dtype != np.int32:
            np.add.at(data, self.positions(triangles, unknown).ravel(), matrices.ravel())
            return
        kernels.compiled.add_nodes(
            data,
            self.indptr,
            self.indices,
            contiguous(self._starts, np.int64),
            self._nodes_of(triangles),
            _local_nodes(unknown.shape[1]),
            contiguous(unknown, np.int32),
            np.ascontiguousarray(matrices),
        )

    def _nodes_of(self, triangles: Ints | slice) -> Ints32:
        """(n, 6) nodes of triangles: vertices, then edges."""
        mesh = self.reduction.layout.mesh
        parts = mesh.triangles[triangles], len(mesh.points) + mesh.triangle_edges[triangles]
        return np.concatenate(parts, axis=1, dtype=np.int32, casting="unsafe")

    def matrix(self, data: Floats) -> Any:
        """The CSR matrix with these entries."""
        shape = (self.reduction.count, self.reduction.count)
        matrix = sp.csr_matrix((data, self.indices, self.indptr), shape=shape)
        matrix.has_sorted_indices = True
        return matrix


def _local_nodes(columns: int) -> Ints:
    """(columns,) local node of each column of element matrices; a vertex has more where lines cross the plate."""
    return np.concatenate([np.repeat(np.arange(3), (columns - 3) // 3), [3, 4, 5]]).astype(np.int64)


class FullPattern:
    """The same for a small matrix with all its entries, zero or not."""

    def __init__(self, reduction: Reduction) -> None:
        self.count = reduction.count
        self.entries = reduction.count**2

    def positions(self, triangles: Ints, unknown: Ints32) -> NDArray[np.intp]:
        """As `Pattern.positions`."""
        at = unknown.astype(np.intp)
        out = at[:, :, None] * self.count + at[:, None, :]
        fixed = at < 0
        if fixed.any():
            out[fixed[:, :, None] | fixed[:, None, :]] = self.entries
        return out

    def add(self, data: Floats, triangles: Ints, unknown: Ints32, matrices: Floats) -> None:
        """As `Pattern.add`."""
        np.add.at(data, self.positions(triangles, unknown).ravel(), matrices.ravel())

    def matrix(self, data: Floats) -> Any:
        """The dense array with these entries."""
        return data.reshape(self.count, self.count)


def ranges(starts: Ints, counts: Ints) -> Ints:
    """Concatenation of start, start + 1, ... for each start and count."""
    if len(counts) == 0 or counts.max() <= 1:
        return starts[counts > 0]
    ends = np.cumsum(counts)
    return np.arange(ends[-1]) + np.repeat(starts - (ends - counts), counts)
