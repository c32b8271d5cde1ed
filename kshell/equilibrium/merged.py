"""Lower triangles of one pattern with another matrix added, or with the upper triangle: places are found once."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


class Columns(NamedTuple):
    """Compressed columns of a square matrix, rows ascending."""

    indptr: Ints
    indices: Ints
    entries: Any  # None where the pattern alone is meant

    def filled(self, entries: Any) -> sp.csc_matrix:
        """The sparse matrix with these entries."""
        size = len(self.indptr) - 1
        return sp.csc_matrix((entries, self.indices, self.indptr), shape=(size, size))


class Merged:
    """Matrices of one pattern with the same other matrix added.

    Parameters
    ----------
    pattern : Columns
    other : (n, n) sparse
    """

    def __init__(self, pattern: Columns, other: sp.spmatrix) -> None:
        other = sp.csc_matrix(other)
        other.sum_duplicates()
        # both hold a number each, so that a sum tells which of them has an entry there
        ones = pattern.filled(np.ones(len(pattern.indices), dtype=np.int8))
        twos = Columns(other.indptr, other.indices, None).filled(np.full(other.nnz, 2, dtype=np.int8))
        both = sp.csc_matrix(ones + twos)
        both.sort_indices()
        self._slots = np.flatnonzero(both.data & 1)
        self._entries = np.zeros(both.nnz)
        self._entries[(both.data & 2) > 0] = other.data
        self._indptr, self._indices = both.indptr, both.indices

    def with_other(self, entries: Floats | None) -> Columns:
        """The sum; None for its pattern alone."""
        if entries is None:
            return Columns(self._indptr, self._indices, None)
        total = self._entries.copy()
        total[self._slots] += entries
        return Columns(self._indptr, self._indices, total)


class Mirrored:
    """Symmetric matrices of one pattern, from their lower triangles.

    Parameters
    ----------
    lower : Columns
    """

    def __init__(self, lower: Columns) -> None:
        numbered = lower.filled(np.arange(1, len(lower.indices) + 1))
        whole = sp.csc_matrix(numbered + sp.tril(numbered, -1).T)
        whole.sort_indices()
        self._source = whole.data - 1
        self._indptr, self._indices = whole.indptr, whole.indices

    def whole(self, entries: Floats) -> Columns:
        """The whole matrix."""
        return Columns(self._indptr, self._indices, entries[self._source])
