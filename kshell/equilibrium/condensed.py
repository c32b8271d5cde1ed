"""Unknowns that belong to one element alone, eliminated there before anything is summed.

What is left is the stiffness of the others, whose pattern and factor are smaller; the rest is found element by element
when it is solved (static condensation; Guyan, AIAA J. 3 (1965) 380).

Symbols
-------
i, b     unknowns inside an element, and its others
W        K_ii^-1 K_ib
S        K_bb - K_bi W
T        basis of the free motions; the columns of what is inside are unit vectors
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.solvers.backends import Singular

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


class Condensed:
    """The unknowns inside elements, and how they follow from the others.

    Parameters
    ----------
    unknowns : (element, n) int array
    inner : (i,) int array
        Which of them lie inside.
    basis : (unknowns, free) sparse CSC
        T.

    Attributes
    ----------
    possible : bool
        Whether they are all free, each on its own.
    outer : (unknowns, others) sparse CSC
        Columns of T of the others.
    """

    def __init__(self, unknowns: Ints, inner: Ints, basis: sp.csc_matrix) -> None:
        self.inside = unknowns[:, inner]
        self.inner, self.others = inner, np.setdiff1d(np.arange(unknowns.shape[1]), inner)
        self.beside = unknowns[:, self.others]
        column = np.full(basis.shape[0], -1, dtype=np.int64)
        first = basis.indptr[:-1]
        plain = np.flatnonzero((np.diff(basis.indptr) == 1) & (basis.data[first] == 1.0))
        column[basis.indices[first[plain]]] = plain
        self.column = column[self.inside]  # (element, i)
        entries = np.bincount(basis.indices, minlength=basis.shape[0])
        self.possible = bool(len(inner)) and bool(
            (self.column >= 0).all() and (entries[self.inside] == 1).all()
        )
        kept = np.ones(basis.shape[1], dtype=bool)
        kept[self.column] = False
        self.kept = np.flatnonzero(kept)
        self.outer = basis[:, self.kept] if self.possible else basis

    def of_matrix(self) -> Condensation:
        """What becomes of them in one matrix."""
        return Condensation(self)


class Condensation:
    """The unknowns inside elements and their elimination from one matrix."""

    def __init__(self, condensed: Condensed) -> None:
        self._of = condensed
        count, inner = condensed.inside.shape
        self._inverse = np.empty((count, inner, inner))
        self._w = np.empty((count, inner, condensed.beside.shape[1]))

    def reduce(self, elements: slice, matrices: Floats, definite: bool = False) -> None:
        """S in place of K_bb in element matrices (element, n, n), symmetric; the other entries are lost.

        `definite`: K_ii is looked at, so that K is positive definite if S is (Haynsworth, 1968).

        Raises
        ------
        Singular
            If K_ii is, of an element, or not positive definite.
        """
        i = self._of.inner
        inside = matrices[:, i[:, None], i]
        try:
            if definite:
                np.linalg.cholesky(inside)
            inverse = np.linalg.inv(inside)
        except np.linalg.LinAlgError as error:
            raise Singular(f"what is inside triangles has no stiffness ({error})") from error
        beside = matrices[:, i]
        w = np.matmul(inverse, beside)
        self._inverse[elements], self._w[elements] = inverse, w[:, :, self._of.others]
        matrices -= np.matmul(beside.swapaxes(1, 2), w)  # of all entries, which is quicker than to pick some

    def solving(self, solve: Callable[[Floats], Floats]) -> Callable[[Floats], Floats]:
        """From a solution for the others to that for all free unknowns, (free,) or (free, k)."""

        def whole(rhs: Floats) -> Floats:
            inside = rhs[self._of.column]  # (element, i) or (element, i, k)
            one = inside.ndim == 2
            inside = inside[..., None] if one else inside
            force = np.matmul(self._w.swapaxes(1, 2), inside)
            size, k = self._of.outer.shape[0], inside.shape[2]
            where = self._of.beside.ravel()
            total = np.stack([np.bincount(where, force[..., c].ravel(), size) for c in range(k)], axis=1)
            out = np.empty_like(rhs)
            given = rhs[self._of.kept] - self._of.outer.T @ (total[:, 0] if one else total)
            out[self._of.kept] = found = solve(np.ascontiguousarray(given))
            beside = (self._of.outer @ found).reshape(size, k)[self._of.beside]
            step = np.matmul(self._inverse, inside) - np.matmul(self._w, beside)
            out[self._of.column] = step[..., 0] if one else step
            return out

        return whole
