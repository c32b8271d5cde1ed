"""The sparsity pattern of a plate matrix, built once from the mesh, and the map of element entries into it.

Vertices and edges (nodes, here) couple as whole blocks. Which pairs of nodes couple follows from the mesh: a vertex
with itself, with the other end of an edge, with an edge it ends, with an edge opposite to it; an edge with itself and
with the others of its triangle. Numbering these pairs directly gives every triangle its 36 pairs without any search,
and no list of all element entries is ever sorted or stored.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.mesh.mesh import EDGE_VERTICES, Mesh
from kshell.plate.reduction import Reduction
from kshell.solvers import kernels

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
        layout = reduction.layout
        mesh, b = layout.mesh, layout.per_vertex
        self.reduction = reduction
        sizes = reduction.sizes
        starts = np.concatenate([[0], np.cumsum(sizes)])  # first unknown of each node

        self.pairs = NodePairs(mesh)
        count = np.diff(self.pairs.indptr)
        # an entry for every unknown of a neighbour, in the rows of nodes that have unknowns
        near_size = sizes[self.pairs.columns]
        near_size[np.repeat(sizes == 0, count)] = 0
        before = np.concatenate([[0], np.cumsum(near_size)])
        first_of_row = before[self.pairs.indptr]
        width = np.diff(first_of_row)  # entries in each row of a node
        indptr = np.concatenate([[0], np.cumsum(np.repeat(width, sizes))])
        self.entries = int(indptr[-1])
        kind = np.int32 if self.entries < 2**31 else np.int64
        self.indptr = indptr.astype(kind)
        # where the block of a pair begins: the first unknown of the neighbour in the first row of the node
        shift = self.indptr[starts[:-1]] - first_of_row[:-1].astype(kind)
        self._block = before[:-1].astype(kind) + np.repeat(shift, count)
        if b == 1:
            self.indices = starts[self.pairs.columns[near_size > 0]].astype(kind)
        else:
            self.indices = np.empty(self.entries, dtype=kind)
            for size in np.unique(sizes[sizes > 0]):
                self._fill_columns(np.flatnonzero(sizes == size), int(size), sizes, starts, width)
        self._starts, self._width = starts, width.astype(np.int32)

    def _fill_columns(self, nodes: Ints, size: int, sizes: Ints, starts: Ints, width: Ints) -> None:
        """Write the column numbers of all rows of nodes that have ``size`` unknowns."""
        begin = self.pairs.indptr[nodes].astype(np.int64)
        near = self.pairs.columns[ranges(begin, self.pairs.indptr[nodes + 1] - begin)]
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
        out = self._block[self.pairs.of_triangles(triangles)].astype(np.intp)  # (n, 6, 6)
        if per_vertex > 1:
            local_node, nodes = self._nodes(triangles, unknown.shape[1])
            rank = np.where(unknown < 0, 0, unknown - self._starts[nodes])  # among the unknowns of the node
            out = out[:, local_node][:, :, local_node]
            out += (rank * self._width[nodes])[:, :, None]
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
        local_node, nodes = self._nodes(triangles, unknown.shape[1])
        kernels.compiled.add_blocks(
            data,
            kernels.contiguous(self._block[self.pairs.of_triangles(triangles)], np.int32),
            local_node,
            kernels.contiguous(unknown - self._starts[nodes], np.int32),
            kernels.contiguous(self._width[nodes], np.int32),
            np.ascontiguousarray(unknown, dtype=np.int32),
            np.ascontiguousarray(matrices),
        )

    def _nodes(self, triangles: Ints, columns: int) -> tuple[Ints, Ints]:
        """(columns,) local node of each column of element matrices, and (n, columns) its node."""
        at_each = (columns - 3) // 3  # columns of a vertex, more where lines cross the plate
        local_node = np.concatenate([np.repeat(np.arange(3), at_each), [3, 4, 5]]).astype(np.int64)
        mesh = self.reduction.layout.mesh
        whole = np.concatenate(
            [mesh.triangles[triangles], len(mesh.points) + mesh.triangle_edges[triangles]], axis=1
        )
        return local_node, whole[:, local_node]

    def matrix(self, data: Floats) -> Any:
        """The CSR matrix with these entries."""
        shape = (self.reduction.count, self.reduction.count)
        matrix = sp.csr_matrix((data, self.indices, self.indptr), shape=shape)
        matrix.has_sorted_indices = True
        return matrix


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
