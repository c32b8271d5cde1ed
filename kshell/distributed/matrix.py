"""Matrices of which every process has the terms of its own triangles, on the unknowns that these have.

Symbols
-------
K_p      what process p has of K: the sum over its triangles, on their unknowns alone
S        what the first process knows of K besides, such as springs, on all unknowns
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.distributed.calls import Shared, on_all
from kshell.distributed.shares import Share
from kshell.distributed.team import Team

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

TERMS = 14  # tag of the messages with terms of a matrix


class Terms(Shared):
    """The terms that the processes have.

    Parameters
    ----------
    team : Team
    share : Share
        Of the unknowns.
    local : sparse CSR
        K_p of this process, on its unknowns.
    """

    def __init__(self, team: Team, share: Share, local: sp.csr_matrix) -> None:
        super().__init__(team)
        self.share, self.local = share, local

    @on_all
    def product(self, x: Floats) -> Floats:
        """K x of (unknowns,) or (unknowns, k)."""
        mine = self.share.spread(x)
        return self.share.collect(lambda: self.local @ mine)

    @on_all
    def diagonal(self) -> Floats:
        """(unknowns,)."""
        return self.share.collect(self.local.diagonal)

    @on_all
    def combined(self, factor: float, other: Terms | None, times: float) -> Terms:
        """factor * these + times * others."""
        local = factor * self.local
        return Terms(self.team, self.share, local if other is None else (local + times * other.local).tocsr())

    @on_all
    def sizes(self) -> Terms:
        """Not less than the sizes of the entries of the sum."""
        return Terms(self.team, self.share, abs(self.local))

    @on_all
    def finite(self) -> bool:
        """Whether all entries are, on all processes."""
        return not self.team.largest(0.0 if np.isfinite(self.local.data).all() else 1.0)

    @on_all
    def whole(self) -> sp.csr_matrix | None:
        """The sum on the first process, None on others."""
        team, share = self.team, self.share
        if team.rank:
            team.send(self.local, 0, TERMS)
            return None
        parts = [self.local, *(team.receive(r, TERMS) for r in range(1, team.size))]
        shape = (share.count, share.count)
        total = sp.csr_matrix(shape)
        for rows, part in zip(share.of_all, parts, strict=True):
            entries = part.tocoo()
            total = total + sp.csr_matrix((entries.data, (rows[entries.row], rows[entries.col])), shape=shape)
        return total


class Scattered:
    """A square matrix that is the sum of what the processes have and of what the first one knows.

    Parameters
    ----------
    terms : Terms
    known : sparse CSR, optional
        S; the same on all where they work alongside.
    """

    def __init__(self, terms: Terms, known: sp.csr_matrix | None = None) -> None:
        self.terms, self.known = terms, known
        self.team, self.share = terms.team, terms.share
        self.shape, self.dtype = (self.share.count, self.share.count), np.dtype(np.float64)

    def __matmul__(self, x: Floats) -> Floats:
        """The product with vectors (unknowns,) or (unknowns, k)."""
        found = self.terms.product(x)
        return found if self.known is None else found + self.known @ x

    def diagonal(self) -> Floats:
        """(unknowns,)."""
        found = self.terms.diagonal()
        return found if self.known is None else found + self.known.diagonal()

    def plus(self, other: sp.spmatrix, factor: float = 1.0) -> Scattered:
        """The sum with a multiple of a matrix that is known whole."""
        known = factor * other
        return type(self)(self.terms, (known if self.known is None else self.known + known).tocsr())

    def __add__(self, other: sp.spmatrix | Scattered) -> Scattered:
        return self._with(1.0, other, 1.0) if isinstance(other, Scattered) else self.plus(other)

    def __sub__(self, other: Scattered) -> Scattered:
        return self._with(1.0, other, -1.0)

    def __rmul__(self, factor: float) -> Scattered:
        return self._with(factor, None, 0.0)

    def __abs__(self) -> Scattered:
        """Not less than the sizes of the entries of the sum."""
        return type(self)(self.terms.sizes(), None if self.known is None else abs(self.known))

    def _with(self, factor: float, other: Scattered | None, times: float) -> Scattered:
        terms = self.terms.combined(float(factor), None if other is None else other.terms, float(times))
        known = None if self.known is None else factor * self.known
        if other is not None and other.known is not None:
            more = times * other.known
            known = more if known is None else known + more
        return type(self)(terms, None if known is None else known.tocsr())

    def tocsr(self) -> Scattered:
        """Itself."""
        return self

    def whole(self) -> sp.csr_matrix | None:
        """All of it on the first process, None on others: of small matrices."""
        found = self.terms.whole()
        return found if found is None or self.known is None else found + self.known

    def toarray(self) -> Floats:
        """All of it, on all processes that have vectors: of small matrices."""
        found = self.whole()
        if not self.team.calls.led:
            found = self.team.communicator.bcast(found)
        assert found is not None
        return np.asarray(found.toarray())

    def matvec(self, x: Floats) -> Floats:
        """The product with one vector."""
        return self @ np.ravel(x)
