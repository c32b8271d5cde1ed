"""Matrices of a team on its free unknowns, in PETSc.

Symbols
-------
T        basis of the free motions
T_p      the rows of T of the unknowns of process p, and the columns that are not zero there
A        T^T K T = sum_p T_p^T K_p T_p + T^T S T, its rows divided among the processes
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.distributed.calls import ELSEWHERE, Shared, on_all
from kshell.distributed.matrix import Scattered, Terms
from kshell.distributed.shares import Share
from kshell.distributed.team import Team
from kshell.equilibrium.reduction import Reduction
from kshell.errors import InputError

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


class Numbering(Shared):
    """Numbers of unknowns in PETSc, where those of a process come one after the other.

    Parameters
    ----------
    team : Team
    owner : (unknowns,) int array
        The process of each unknown; looked at by the first process alone.

    Attributes
    ----------
    size, mine : int
        How many there are, and how many of them are of this process.
    starts : (process + 1,) int array
        The first number of each process.
    place, order : (unknowns,) int array
        On the first process the new number of each, and the unknowns in their new order.
    own : Share
        Those of each process, in their new order.
    """

    def __init__(self, team: Team, owner: Ints) -> None:
        super().__init__(team)

        def counted(rank: int) -> Ints:
            return np.concatenate([[0], np.cumsum(np.bincount(owner, minlength=team.size))])

        self.starts: Ints = team.deal(counted)
        self.size = int(self.starts[-1])
        self.mine = int(self.starts[team.rank + 1] - self.starts[team.rank])
        self.order: Ints = np.zeros(0, dtype=np.int64)
        self.place: Ints = np.zeros(0, dtype=np.int32)
        if not team.rank:
            self.order = np.argsort(owner, kind="stable")
            self.place = np.empty(self.size, dtype=np.int32)
            self.place[self.order] = np.arange(self.size, dtype=np.int32)
        members = [self.order[a:b] for a, b in pairwise(self.starts)]
        self.own = Share(team, members, self.size)


class Basis(Shared):
    """What each process has of T.

    Parameters
    ----------
    team : Team
    reduction : Reduction
        T; looked at by the first process alone.
    share : Share
        Of all unknowns.

    Attributes
    ----------
    local : Reduction
        T_p.
    free : Share
        Of the free unknowns; those that no triangle moves are of no process.
    """

    def __init__(self, team: Team, reduction: Reduction, share: Share) -> None:
        super().__init__(team)
        rows = sp.csr_matrix(reduction.basis) if team.rank == 0 else None
        every = rows is not None and _is_identity(rows)

        def columns_of(rank: int) -> Ints:
            assert rows is not None
            return share.of_all[rank] if every else np.unique(rows[share.of_all[rank]].indices)

        columns = [] if team.rank else [columns_of(rank) for rank in range(team.size)]

        def part(rank: int) -> sp.csc_matrix:
            assert rows is not None
            if every:
                return sp.identity(len(columns[rank]), format="csc")
            return sp.csc_matrix(rows[share.of_all[rank]][:, columns[rank]])

        self.local = Reduction(team.deal(part), np.zeros(0), np.zeros(0, dtype=np.int64))
        self.free = Share(team, columns, 0 if rows is None else rows.shape[1])

    @on_all
    def reduced(self, terms: Terms) -> Terms:
        """T^T K T."""
        return Terms(self.team, self.free, self.team.together(lambda: self.local.reduce(terms.local)))


def _is_identity(matrix: sp.csr_matrix) -> bool:
    n = matrix.shape[0]
    found = matrix.shape == (n, n) and matrix.nnz == n and bool((matrix.indices == np.arange(n)).all())
    return found and bool((np.diff(matrix.indptr) == 1).all() and (matrix.data == 1.0).all())


def reduced(matrix: Scattered, reduction: Reduction) -> Scattered:
    """T^T K T of a matrix on all unknowns."""
    basis = matrix.team.calls.run(Basis, matrix.team, reduction, matrix.share)
    known = None if matrix.known is None else reduction.reduce(matrix.known)
    return Scattered(basis.reduced(matrix.terms), known)


class Assembled(Shared):
    """A in PETSc, for many K of one pattern.

    Parameters
    ----------
    basis : Basis
    numbering : Numbering
        Of the free unknowns.
    half : bool
        Whether the upper triangle alone is kept, which tells a symmetric matrix.

    Attributes
    ----------
    mat : petsc4py.PETSc.Mat
    """

    def __init__(self, basis: Basis, numbering: Numbering, half: bool) -> None:
        super().__init__(basis.team)
        self.basis, self.numbering, self.half = basis, numbering, half
        self._place: Ints = self.team.deal(lambda rank: numbering.place[basis.free.of_all[rank]])
        self._pattern: tuple[Ints, Ints] | None = None
        self.mat: Any = None

    def fill(self, terms: Terms, known: sp.csr_matrix | None, last: bool = False) -> bool:
        """Make `mat` the reduced matrix of K; whether its pattern is a new one.

        Parameters
        ----------
        terms : Terms
        known : (free, free) sparse, optional
            T^T S T; looked at by the first process alone.
        last : bool
            Whether K is needed no more, and no other one will come: it makes room.

        Raises
        ------
        InputError
            If the numbers of PETSc at hand are too small for the matrix.
        """
        rows = self.own_rows(terms, known, last)
        pattern = self._pattern
        new = pattern is None or not (
            np.array_equal(pattern[0], rows.indptr) and np.array_equal(pattern[1], rows.indices)
        )
        if not self.team.number(lambda: new):
            self.mat.zeroEntries()
            self.mat.setValuesCSR(rows.indptr, rows.indices, rows.data)
            self.mat.assemble()
            return False
        self._pattern = None if last else (rows.indptr, rows.indices)
        self._create(rows)
        return True

    def own_rows(self, terms: Terms, known: sp.csr_matrix | None, last: bool = False) -> sp.csr_matrix:
        """(mine, free) the rows of this process, with what all others have of them."""
        team, numbering = self.team, self.numbering

        def given() -> list[list[Block]]:
            found = [[block] for block in self._blocks(terms.local)]
            if last:
                terms.local = sp.csr_matrix(terms.local.shape)
            if known is not None and known is not ELSEWHERE and team.rank == 0:
                more = blocks_of(known.tocsr(), numbering.place, numbering.starts, self.half)
                found = [[*some, block] for some, block in zip(found, more, strict=True)]
            return found

        parts = team.together(given)
        own, parts[team.rank] = parts[team.rank], []  # what stays is not sent
        own += [block for some in team.communicator.alltoall(parts) for block in some]
        del parts
        return team.together(lambda: added(own, (numbering.mine, numbering.size)))

    def _blocks(self, local: sp.csr_matrix) -> list[Block]:
        """T_p^T K_p T_p by the rows of each process."""
        basis, starts = self.basis.local.basis, self.numbering.starts
        if basis.nnz > basis.shape[1] or np.any(basis.data != 1.0):
            return blocks_of(self.basis.local.reduce(local), self._place, starts, self.half)
        place = np.full(local.shape[0], -1, dtype=np.int32)  # T picks unknowns, and leaves the others out
        place[basis.indices] = self._place
        return blocks_of(local, place, starts, self.half)

    def _create(self, rows: sp.csr_matrix) -> None:
        from petsc4py import PETSc

        numbering, kind = self.numbering, PETSc.IntType
        limit = np.iinfo(kind).max
        largest = self.team.largest(float(rows.nnz))
        if largest > limit or numbering.size > limit:
            raise self.team.alike(
                InputError(
                    f"{numbering.size} unknowns with {largest:.3g} entries on one process: the PETSc at hand counts "
                    f"to {limit}; take more processes, or a PETSc with 64-bit indices"
                )
            )
        if self.mat is not None:
            self.mat.destroy()
        size = ((numbering.mine, numbering.size), (numbering.mine, numbering.size))
        csr = (rows.indptr.astype(kind), rows.indices.astype(kind), rows.data)
        make = PETSc.Mat().createSBAIJ if self.half else PETSc.Mat().createAIJ
        self.mat = make(size, *([1] if self.half else []), csr=csr, comm=self.team.communicator)
        self.mat.assemble()


# some rows of a matrix: their numbers, and what they hold
Block = tuple[Ints, sp.csr_matrix]


def blocks_of(matrix: sp.csr_matrix, place: Ints, starts: Ints, half: bool) -> list[Block]:
    """The rows of a square matrix for each process, counted from its first one; of a symmetric one the upper triangle.

    Parameters
    ----------
    place : (n,) int array
        The new number of each row and column, -1 of those that are left out.
    starts : (process + 1,) int array
        The first new number of each process.
    """
    column = place[matrix.indices]
    row = np.repeat(place, np.diff(matrix.indptr))
    kept = (row >= 0) & (column >= (row if half else 0))
    column, data = column[kept], matrix.data[kept]
    indptr = np.concatenate([[0], np.cumsum(kept)])[matrix.indptr]
    del kept, row
    order = np.argsort(place, kind="stable")
    size, row = int(starts[-1]), place[order]
    moved = sp.csr_matrix((data, column, indptr), shape=(len(place), size))[order]
    del data, column
    out = []
    for first, last in pairwise(starts):
        a, b = np.searchsorted(row, [first, last])
        part = moved[a:b]
        filled = np.diff(part.indptr) > 0
        out.append((row[a:b][filled] - first, part if filled.all() else part[filled]))
    return out


def added(blocks: list[Block], shape: tuple[int, int]) -> sp.csr_matrix:
    """The sum of blocks of rows."""
    total = sp.csr_matrix(shape)
    for rows, block in sorted(blocks, key=lambda pair: pair[1].nnz):
        if not len(rows):
            continue
        if len(rows) == shape[0]:  # all of them, in their order
            total = total + block if total.nnz else block
        else:
            count = np.zeros(shape[0], dtype=block.indptr.dtype)
            count[rows] = np.diff(block.indptr)
            indptr = np.concatenate([[0], np.cumsum(count)])
            total = total + sp.csr_matrix((block.data, block.indices, indptr), shape=shape)
    total = total.tocsr()
    total.sort_indices()
    return total
