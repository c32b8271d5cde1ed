"""The tangent in the free unknowns, T^T K T, for many K of one pattern: every entry is a fixed sum of entries of K.

The sums are found once. In a Newton iteration the supports then cost one pass over the entries, in the order
in which the factorisation wants them.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.sparsity import pattern_of, same_pattern, stable_order

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


class ReducedPattern:
    """Compressed columns of T^T K T.

    Parameters
    ----------
    matrix : sparse CSR
        K, or any matrix of its pattern.
    basis : (unknowns, free) sparse
        T.
    place : (free,) int array, optional
        New place of each free unknown, where the matrix is wanted in another order.
    lower : bool
        Only the lower triangle, which tells a symmetric matrix.

    Attributes
    ----------
    indptr, indices : int arrays
    size : int
    """

    def __init__(
        self, matrix: sp.csr_matrix, basis: sp.spmatrix, place: Ints | None = None, lower: bool = True
    ) -> None:
        self._of = pattern_of(matrix)
        self.size = int(basis.shape[1])
        row, column, source, factor = _terms(matrix, basis.tocsr(), place, lower)
        order = stable_order(row, self.size)
        order = order[stable_order(column[order], self.size)]
        row, column = row[order], column[order]
        new = np.ones(len(row), dtype=bool)
        new[1:] = (row[1:] != row[:-1]) | (column[1:] != column[:-1])
        self.indices = row[new]
        self.indptr = np.concatenate(
            [[0], np.cumsum(np.bincount(column[new], minlength=self.size))]
        ).astype(np.int32)  # fmt: skip
        self._source, self._factor = source[order], factor[order]
        self._begin = None if new.all() else np.append(np.flatnonzero(new), len(row)).astype(source.dtype)
        self._plain = self._begin is None and bool(np.all(self._factor == 1.0))

    def fits(self, matrix: sp.csr_matrix) -> bool:
        """Whether a matrix has the pattern this was made for."""
        return same_pattern(matrix, self._of)

    def entries(self, matrix: sp.csr_matrix) -> Floats:
        """The entries of T^T K T, for `indices` and `indptr`."""
        if self._plain:
            return np.take(matrix.data, self._source)
        if self._begin is None:
            return self._factor * matrix.data[self._source]
        shape = (len(self.indices), len(matrix.data))
        return np.asarray(sp.csr_matrix((self._factor, self._source, self._begin), shape=shape) @ matrix.data)


def _terms(
    matrix: sp.csr_matrix, basis: sp.csr_matrix, place: Ints | None, lower: bool
) -> tuple[Ints, Ints, Ints, Floats]:
    """Row, column, source entry and factor of every product T_ai K_ab T_bj.

    Most rows of T have one entry, those of unknowns at inclined supports have more: the first entry of each row is
    taken for all of K at once, the others only where there are any.
    """
    number = (basis.indices if place is None else place[basis.indices]).astype(np.int32)
    begin, count = basis.indptr[:-1], np.diff(basis.indptr)
    first = np.full(len(count), -1, dtype=np.int32)
    first[count > 0] = number[begin[count > 0]]
    a = np.repeat(np.arange(matrix.shape[0], dtype=np.int32), np.diff(matrix.indptr))
    b = matrix.indices
    index = np.int32 if len(b) < 2**31 else np.int64

    row, column = np.repeat(first, np.diff(matrix.indptr)), first[b]
    kept = np.flatnonzero((row >= column) & (column >= 0) if lower else (row >= 0) & (column >= 0)).astype(
        index
    )
    parts = [(row[kept], column[kept], kept, _factor(basis.data, begin[a[kept]], begin[b[kept]]))]
    some = np.flatnonzero((count > 1)[a] | (count > 1)[b]).astype(index)
    a, b = a[some], b[some]
    most = int(count.max(initial=0))
    for k, m in [(k, m) for k in range(most) for m in range(most) if k + m > 0]:
        both = np.flatnonzero((count[a] > k) & (count[b] > m))
        left, right = begin[a[both]] + k, begin[b[both]] + m
        if lower:
            below = np.flatnonzero(number[left] >= number[right])
            both, left, right = both[below], left[below], right[below]
        parts.append((number[left], number[right], some[both], _factor(basis.data, left, right)))
    row, column, source, factor = (np.concatenate(part) for part in zip(*parts, strict=True))
    return row, column, source, factor


def _factor(data: Floats, left: Ints, right: Ints) -> Floats:
    return data[left] * data[right] if np.any(data != 1.0) else np.ones(len(left))
