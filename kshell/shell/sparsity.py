"""Where the entries of the element matrices go in the assembled matrix; found once for a mesh.

Unknowns come in groups (the three translations of a node, the p rotations of an edge), so the pattern is
found between groups, nine times fewer pairs than between unknowns at p = 2.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Sparsity:
    """Pattern of a matrix assembled from element matrices.

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
    """

    def __init__(self, groups: NDArray, sizes: NDArray, unknowns: NDArray, member: NDArray) -> None:
        count = len(sizes)
        first = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
        wide = groups.astype(np.int64)
        keys, place = np.unique((wide[:, :, None] * count + wide[:, None, :]).ravel(), return_inverse=True)
        row, column = keys // count, keys % count

        width = np.bincount(row, weights=sizes[column], minlength=count).astype(np.int64)  # entries per row
        start = np.concatenate([[0], np.cumsum(sizes * width)])
        entries = int(start[-1])
        index = np.int32 if entries < 2**31 else np.int64
        # columns to the left within the row of the group
        left = np.concatenate([[0], np.cumsum(sizes[column])[:-1]])
        left -= left[np.searchsorted(row, row)]
        self._base = (start[row] + left)[place].reshape(*groups.shape, groups.shape[1]).astype(index)
        self._row_width = width[groups].astype(index)  # (element, g)
        self._offset = (unknowns - first[groups][:, member]).astype(
            index
        )  # (element, n) place within the group
        self._member = member

        self.shape = (int(first[-1]), int(first[-1]))
        self.indptr = np.concatenate([[0], np.cumsum(np.repeat(width, sizes))]).astype(index)
        self.indices = np.empty(entries, dtype=index)
        for i in range(int(sizes.max())):
            for j in range(int(sizes.max())):
                both = (sizes[row] > i) & (sizes[column] > j)
                r = row[both]
                self.indices[start[r] + i * width[r] + left[both] + j] = first[column[both]] + j

    def empty(self) -> Floats:
        """Room for the entries of a matrix, all zero."""
        return np.zeros(len(self.indices))

    def add(self, data: Floats, elements: slice, matrices: Floats) -> None:
        """Add element matrices (element, n, n) of a range of elements to the entries `data`."""
        member = self._member
        place = self._base[elements][:, member][:, :, member]
        offset = self._offset[elements]
        place += (self._row_width[elements][:, member] * offset)[:, :, None]
        place += offset[:, None, :]
        data += np.bincount(place.ravel(), weights=matrices.ravel(), minlength=len(data))

    def matrix(self, data: Floats) -> sp.csr_matrix:
        """The assembled matrix; it shares the pattern with every other one made here."""
        return sp.csr_matrix((data, self.indices, self.indptr), shape=self.shape)
