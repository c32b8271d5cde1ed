"""The stiffness in the free unknowns, T^T K T, straight from element matrices: its lower triangle and nothing else.

Conditions act on few unknowns at a time: of a node they leave all three translations, some of them, or combinations.
So T is block diagonal, a block for each group of unknowns (the translations of a node, the rotations of an edge), and
may as well be applied to the element matrices: rows and columns that are held fall away, and the few elements with
combinations are multiplied by theirs. Then only the lower triangle of the free unknowns has to be numbered and summed.

Where T couples groups (rigid links), see `kshell.equilibrium.reduced`.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.sparsity import Sparsity, group_pairs
from kshell.solvers import kernels

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


class FreePattern:
    """Compressed columns of the lower triangle of T^T K T.

    Parameters
    ----------
    sparsity : Sparsity
        Groups and unknowns of the elements.
    basis : (unknowns, free) sparse
        T, each column within one group.
    place : (group,) int array, optional
        Place of each group in another order.

    Attributes
    ----------
    size : int
        Free unknowns n.
    number : (n,) int array
        Number of each column of T in the order of the matrix.
    indptr, indices : int arrays
    """

    def __init__(self, sparsity: Sparsity, basis: sp.csc_matrix, place: Ints | None = None) -> None:
        self._member, self._unknowns = sparsity.member, sparsity.unknowns
        rank = (np.arange(len(sparsity.sizes)) if place is None else place).astype(sparsity.groups.dtype)
        self._number_slots(sparsity, basis, rank)
        self._number_entries(rank[sparsity.groups])

    @staticmethod
    def possible(sparsity: Sparsity, basis: sp.csc_matrix) -> bool:
        """Whether every column of T has entries, all in one group of unknowns."""
        filled = np.diff(basis.indptr)
        if not len(filled):
            return True
        group = np.repeat(np.arange(len(sparsity.sizes), dtype=np.int32), sparsity.sizes)[basis.indices]
        return bool((filled > 0).all() and (group == np.repeat(group[basis.indptr[:-1]], filled)).all())

    def _number_slots(self, sparsity: Sparsity, basis: sp.csc_matrix, rank: Ints) -> None:
        """Free numbers of unknowns, -1 where held; in groups with combinations their columns take the first places."""
        sizes = sparsity.sizes
        start = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
        group_of = np.repeat(np.arange(len(sizes)), sizes)
        row = basis.indices[basis.indptr[:-1]].astype(np.int64)
        group = group_of[row]
        picks = (np.diff(basis.indptr) == 1) & (basis.data[basis.indptr[:-1]] == 1.0)
        mixed = np.zeros(len(sizes), dtype=bool)
        mixed[group[~picks]] = True
        slot = row
        if mixed.any():
            order = np.argsort(group, kind="stable")
            inside = np.empty(len(group), dtype=np.int64)
            counts = np.bincount(group, minlength=len(sizes))
            inside[order] = np.arange(len(group)) - np.repeat(np.cumsum(counts) - counts, counts)
            slot = np.where(mixed[group], start[group] + inside, row)
        self.size = basis.shape[1]
        self._counts = np.zeros(len(sizes), dtype=np.int64)  # free unknowns of the groups in their order
        self._counts[rank] = np.bincount(group, minlength=len(sizes))
        # numbers ascend with the place of the group, and within it with the slot
        first = (np.cumsum(self._counts) - self._counts)[rank]
        filled = np.zeros(int(start[-1]), dtype=np.int64)
        filled[slot] = 1
        before = np.concatenate([[0], np.cumsum(filled)])
        self.number: Ints = (first[group] + before[slot] - before[start[group]]).astype(np.int32)
        self._number_of_slot = np.full(int(start[-1]), -1, dtype=np.int32)
        self._number_of_slot[slot] = self.number
        self._combine: sp.csr_matrix | None = None
        if mixed.any():
            entry_column = np.repeat(np.arange(basis.shape[1]), np.diff(basis.indptr))
            mine = mixed[group[entry_column]]
            plain = np.flatnonzero(~mixed[group_of])
            rows = np.concatenate([basis.indices[mine], plain])
            columns = np.concatenate([slot[entry_column[mine]], plain])
            data = np.concatenate([basis.data[mine], np.ones(len(plain))])
            self._combine = sp.csr_matrix((data, (rows, columns)), shape=(int(start[-1]),) * 2)
            self._mixed = mixed[sparsity.groups].any(axis=1)

    def _number_entries(self, groups: Ints) -> None:
        counts = self._counts
        first = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
        low, high, self._pair = group_pairs(groups, len(counts))
        # a column has what is left of its own group, then the groups behind
        width = np.bincount(low, weights=counts[high], minlength=len(counts)).astype(np.int64)
        within = np.arange(self.size) - np.repeat(first[:-1], counts)
        start = np.concatenate([[0], np.cumsum(np.repeat(width, counts) - within)])
        self.entries = int(start[-1])
        index = np.int32 if self.entries < 2**31 - 1 else np.int64
        before = np.cumsum(counts[high]) - counts[high]
        pairs = np.bincount(low, minlength=len(counts))
        own = np.cumsum(pairs) - pairs  # the pair of a group with itself comes first
        self._left = (before - np.repeat(before[own], pairs)).astype(index)
        self._within = within.astype(index)
        self._base = (start[:-1] - within).astype(index)
        self.indptr: Ints = start.astype(index)
        self.indices: Ints = np.empty(self.entries, dtype=np.int32)
        if kernels.compiled is not None:
            kernels.compiled.columns(
                np.append(own, len(low)), high.astype(np.int32), counts, first, self.indices
            )
            return
        for a in range(int(counts.max(initial=0))):
            for b in range(int(counts.max(initial=0))):
                both = np.flatnonzero((counts[low] > a) & (counts[high] > b) & ((low != high) | (b >= a)))
                at = self._base[first[low[both]] + a] + self._left[both] + b
                self.indices[at] = first[high[both]] + b

    def add(self, data: Floats, elements: slice, matrices: Floats) -> None:
        """Add symmetric element matrices (element, n, n) of all unknowns to the entries and one more (entries + 1,)."""
        if self._combine is not None:
            matrices = self._combined(elements, matrices)
        if kernels.compiled is not None and self.indptr.dtype == np.int32:
            kernels.compiled.add_lower(
                data,
                kernels.contiguous(self._unknowns[elements], np.int32),
                self._number_of_slot,
                self._base,
                self._within,
                self._left,
                self._pair[elements],
                kernels.contiguous(self._member, np.int64),
                np.ascontiguousarray(matrices),
            )
            return
        number = self._number_of_slot[self._unknowns[elements]]
        base, within = self._base[number], self._within[number]
        left = self._left[self._pair[elements]]
        member, n = self._member, len(self._member)
        held = number < 0
        some_held = held.any()
        places = np.empty((len(number), n * (n + 1) // 2), dtype=self.indptr.dtype)
        values = np.empty(places.shape)
        done = 0
        for j in range(n):
            here = slice(done, done + n - j)
            done += n - j
            values[:, here] = matrices[:, j, j:]
            column = number[:, j:] < number[:, j : j + 1]  # the other one comes first: it is the column
            at = np.where(column, base[:, j:] + within[:, j : j + 1], base[:, j : j + 1] + within[:, j:])
            at += left[:, member[j], member[j:]]
            if some_held:
                at[held[:, j:] | held[:, j : j + 1]] = self.entries
            places[:, here] = at
        np.add.at(data, places.ravel(), values.ravel())

    def _combined(self, elements: slice, matrices: Floats) -> Floats:
        mine = np.flatnonzero(self._mixed[elements])
        if not len(mine) or self._combine is None:
            return matrices
        unknowns = self._unknowns[elements][mine]
        n = unknowns.shape[1]
        rows = np.repeat(unknowns, n, axis=1).ravel()
        columns = np.tile(unknowns, (1, n)).ravel()
        local = np.asarray(self._combine[rows, columns]).reshape(-1, n, n)
        matrices = matrices.copy()
        matrices[mine] = local.swapaxes(1, 2) @ matrices[mine] @ local
        return matrices
