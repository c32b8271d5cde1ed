"""Where the entries of the element matrices go in the assembled matrix; found once for a mesh.

Element matrices are symmetric, so only one half of each is stored and summed: half of the traffic, and the sum of
all elements is a single pass over precomputed places. Unknowns come in groups (the three translations of a
node, the p rotations of an edge), so the pattern is found between groups, nine times fewer pairs than between
unknowns at p = 2.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.solvers import kernels

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

# elements whose places are found at a time; bounds the memory of intermediate arrays
BLOCK = 2048


class Sparsity:
    """Pattern of a symmetric matrix assembled from element matrices.

    Parameters
    ----------
    groups : (element, g) int array
        Groups of unknowns of each element, numbered from zero.
    sizes : (group,) int array
        How many unknowns each group has; they are numbered one group after the other.
    unknowns : (element, n) int array
        Unknowns of each element.
    member : (n,) int array
        Position in `groups` of the group that each unknown of the element belongs to.

    Attributes
    ----------
    groups, sizes, unknowns, member : as given
    shape : (int, int)
    indptr, indices : int arrays
        Compressed rows of the whole matrix; columns ascend. They are found when they are first looked at.
    """

    def __init__(self, groups: NDArray, sizes: NDArray, unknowns: NDArray, member: NDArray) -> None:
        self.groups, self.sizes, self.unknowns, self.member = groups, sizes, unknowns, member
        size = int(np.sum(sizes))
        self.shape = (size, size)
        self._local = np.tril_indices(len(member))

    @property
    def indptr(self) -> Ints:
        """(unknowns + 1,)"""
        return self._whole[0]

    @property
    def indices(self) -> Ints:
        """(entries,)"""
        return self._whole[1]

    @cached_property
    def _upper(self) -> tuple[Ints, Ints, Ints]:
        """Compressed rows of the upper triangle, and (element, entries of a half) where element matrices go in them."""
        groups, sizes, unknowns, member = self.groups, self.sizes, self.unknowns, self.member
        first = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
        row, column, place = group_pairs(groups, len(sizes))

        # entries of a row of the upper triangle: what is left of its own group, then the groups behind
        width = np.bincount(row, weights=sizes[column], minlength=len(sizes)).astype(np.int64)
        rank = np.arange(self.shape[0]) - np.repeat(first[:-1], sizes)  # of an unknown within its group
        start = np.concatenate([[0], np.cumsum(np.repeat(width, sizes) - rank)])
        index = np.int32 if start[-1] < 2**30 else np.int64
        start, rank = start.astype(index), rank.astype(index)
        before = np.cumsum(sizes[column]) - sizes[column]
        pairs = np.bincount(row, minlength=len(sizes))
        own = np.cumsum(pairs) - pairs  # the pair of a group with itself comes first
        left = (before - np.repeat(before[own], pairs)).astype(index)  # columns between the two groups

        base = start[:-1] - rank
        places = np.empty((len(groups), len(self._local[0])), dtype=index)
        i, j = self._local
        pair = member[i] * groups.shape[1] + member[j]
        for begin in range(0, len(groups), BLOCK):
            some = slice(begin, begin + BLOCK)
            mine, between = unknowns[some], left[place[some]].reshape(-1, groups.shape[1] ** 2)
            here = np.take(between, pair, axis=1, out=places[some])
            swapped = mine[:, i] < mine[:, j]
            here += np.where(swapped, base[mine][:, i], base[mine][:, j])
            here += np.where(swapped, rank[mine][:, j], rank[mine][:, i])

        upper: Ints = np.empty(int(start[-1]), dtype=index)
        first = first.astype(index)
        for a in range(int(sizes.max())):
            for b in range(int(sizes.max())):
                both = np.flatnonzero((sizes[row] > a) & (sizes[column] > b) & ((row != column) | (b >= a)))
                upper[base[first[row[both]] + a] + left[both] + b] = first[column[both]] + b
        return start, upper, places

    @cached_property
    def _whole(self) -> tuple[Ints, Ints, Ints]:
        """Compressed rows of the whole matrix, and which entry of the upper triangle each of its entries is."""
        start, upper, _ = self._upper
        n, half = self.shape[0], len(upper)
        number = np.arange(half, dtype=upper.dtype)
        lower = sp.csr_matrix((number, upper, start), shape=self.shape).T.tocsr()
        below, above = np.diff(lower.indptr), np.diff(start) - 1  # the diagonal belongs to the lower half
        indptr = np.concatenate([[0], np.cumsum(below + above)]).astype(upper.dtype)
        at_lower = np.arange(half) + np.repeat(indptr[:-1] - lower.indptr[:-1], below)
        off = np.ones(half, dtype=bool)
        off[start[:-1]] = False
        at_upper = np.arange(half - n) + np.repeat(indptr[:-1] + below - (start[:-1] - np.arange(n)), above)
        indices = np.empty(int(indptr[-1]), dtype=upper.dtype)
        source = np.empty_like(indices)
        indices[at_lower], source[at_lower] = lower.indices, lower.data
        indices[at_upper], source[at_upper] = upper[off], number[off]
        return indptr, indices, source

    def empty(self) -> Floats:
        """Room for one half of all element matrices."""
        return np.empty(self._upper[2].shape)

    def put(self, room: Floats, elements: slice, matrices: Floats) -> None:
        """Store the symmetric element matrices (element, n, n) of a range of elements."""
        i, j = self._local
        np.take(matrices.reshape(len(matrices), -1), i * matrices.shape[1] + j, axis=1, out=room[elements])

    def matrix(self, room: Floats) -> sp.csr_matrix:
        """The sum of the element matrices; it shares the pattern with every other one made here."""
        indptr, indices, source = self._whole
        _, upper, places = self._upper
        half = np.bincount(places.ravel(), weights=room.ravel(), minlength=len(upper))
        result = sp.csr_matrix((half[source], indices, indptr), shape=self.shape)
        result.has_canonical_format = True
        return result


def group_pairs(groups: NDArray, count: int) -> tuple[Ints, Ints, Ints]:
    """Coupled pairs of groups, row <= column, sorted, and (element, g, g) the number of each pair of an element."""
    if kernels.compiled is not None:
        return kernels.pairs_of_groups(groups, count)
    low = np.minimum(groups[:, :, None], groups[:, None, :])
    high = np.maximum(groups[:, :, None], groups[:, None, :])
    a, b = np.tril_indices(groups.shape[1])
    # every group couples with itself, also one that no element has
    alone = np.arange(count, dtype=groups.dtype)
    low, high = (np.concatenate([pair[:, a, b].ravel(), alone]) for pair in (low, high))
    order = stable_order(high, count)
    order = order[stable_order(low[order], count)]
    low, high = low[order], high[order]
    new = np.ones(len(low), dtype=bool)
    new[1:] = (low[1:] != low[:-1]) | (high[1:] != high[:-1])
    number = np.empty(len(low), dtype=np.int32)
    number[order] = np.cumsum(new) - 1
    place = np.empty((len(groups), groups.shape[1], groups.shape[1]), dtype=np.int32)
    place[:, a, b] = place[:, b, a] = number[:-count].reshape(len(groups), -1)
    return low[new], high[new], place


def stable_order(keys: Ints, count: int) -> Ints:
    """Order that sorts keys below `count`, equal ones as they come, in linear time."""
    ones = np.ones(len(keys), dtype=np.int8)
    rows = np.arange(len(keys) + 1, dtype=np.int32 if len(keys) < 2**31 else np.int64)
    return np.asarray(sp.csr_matrix((ones, keys, rows), shape=(len(keys), count)).tocsc().indices)


class Added:
    """Adds matrices of one pattern to matrices of another that holds it (springs, loads that turn with the surface)."""

    def __init__(self) -> None:
        self._of: tuple[sp.csr_matrix, sp.csr_matrix] | None = None
        self._slots: Ints | None = None

    def to(self, matrix: sp.csr_matrix, other: sp.csr_matrix, factor: float = 1.0) -> sp.csr_matrix:
        """`matrix` + factor * `other`; in place where the pattern allows it."""
        known = self._of
        if known is None or not (same_pattern(known[0], matrix) and same_pattern(known[1], other)):
            self._of = (pattern_of(matrix), pattern_of(other))
            self._slots = _slots(matrix, other)
        if self._slots is None:
            return (matrix + factor * other).tocsr()
        matrix.data[self._slots] += factor * other.data
        return matrix


def pattern_of(matrix: sp.csr_matrix) -> sp.csr_matrix:
    """The pattern alone: entries that take no room of their own."""
    return sp.csr_matrix((matrix.indices, matrix.indices, matrix.indptr), shape=matrix.shape)


def same_pattern(a: sp.csr_matrix, b: sp.csr_matrix) -> bool:
    """Whether two matrices hold entries at the same places, in the same order."""
    if a.indices is b.indices and a.indptr is b.indptr:
        return True
    return np.array_equal(a.indptr, b.indptr) and np.array_equal(a.indices, b.indices)


def _slots(matrix: sp.csr_matrix, other: sp.csr_matrix) -> Ints | None:
    """Place of each entry of `other` among those of `matrix`; None where it has entries of its own."""
    if not other.has_canonical_format:
        return None
    if not other.nnz:
        return np.zeros(0, dtype=np.int64)
    number = sp.csr_matrix((np.arange(1, matrix.nnz + 1), matrix.indices, matrix.indptr), shape=matrix.shape)
    row = np.repeat(np.arange(other.shape[0]), np.diff(other.indptr))
    slots = np.asarray(number[row, other.indices]).ravel() - 1
    return None if np.any(slots < 0) else slots
