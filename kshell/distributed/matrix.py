"""Matrices of which every process has some terms, and the same in PETSc.

Symbols
-------
K_p      what process p has of K: the sum over its triangles, numbered as the whole
T        basis of the free motions, known to all
A        T^T K T = sum_p T^T K_p T, its rows divided among the processes
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.distributed.team import Team
from kshell.equilibrium.reduction import Reduction
from kshell.errors import InputError

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


class Scattered:
    """A square matrix that is the sum of what the processes have.

    Parameters
    ----------
    team : Team
    local : sparse CSR
        What this process has, of the size of the whole.
    owner : (unknowns,) int array
        The process that each row of a matrix known to all belongs to.
    """

    def __init__(self, team: Team, local: sp.csr_matrix, owner: Ints) -> None:
        self.team, self.local, self.owner = team, local, owner
        self.shape, self.dtype = local.shape, local.dtype

    def __matmul__(self, x: Floats) -> Floats:
        """The product with vectors (unknowns,) or (unknowns, k), on all processes."""
        return self.team.sum(np.shape(x), lambda: self.local @ x)

    def diagonal(self) -> Floats:
        """(unknowns,), on all processes."""
        return self.team.sum(self.shape[:1], self.local.diagonal)

    def plus(self, other: sp.spmatrix, factor: float = 1.0) -> Scattered:
        """The sum with a multiple of a matrix that all processes know: each adds its rows."""
        mine = sp.diags((self.owner == self.team.rank).astype(float))
        return self._with(self.local + factor * (mine @ other))

    def __add__(self, other: sp.spmatrix | Scattered) -> Scattered:
        if isinstance(other, Scattered):
            return self._with(self.local + other.local)
        return self.plus(other)

    def __sub__(self, other: Scattered) -> Scattered:
        return self._with(self.local - other.local)

    def __rmul__(self, factor: float) -> Scattered:
        return self._with(factor * self.local)

    def __abs__(self) -> Scattered:
        """Not less than the sizes of the entries of the sum."""
        return self._with(abs(self.local))

    def _with(self, local: sp.spmatrix) -> Scattered:
        return type(self)(self.team, local.tocsr(), self.owner)

    def tocsr(self) -> Scattered:
        """Itself."""
        return self

    def toarray(self) -> Floats:
        """All of it, on all processes: of small matrices."""
        return self.team.sum(self.shape, self.local.toarray)

    def matvec(self, x: Floats) -> Floats:
        """The product with one vector."""
        return self @ np.ravel(x)


class Numbering:
    """Numbers of the free unknowns in PETSc, where those of a process come one after the other.

    Parameters
    ----------
    team : Team
    basis : (unknowns, free) sparse
        T.
    owner : (unknowns,) int array
        The process of each unknown. A free unknown belongs to that of the first unknown it moves.

    Attributes
    ----------
    size, mine : int
        How many there are, and how many of them are of this process.
    place : (free,) int array
        New number of each.
    order : (free,) int array
        The free unknowns in their new order.
    own : (mine,) int array
        Those of this process.
    """

    def __init__(self, team: Team, basis: sp.csc_matrix, owner: Ints) -> None:
        self.team, self.size = team, int(basis.shape[1])
        first = basis.indices[basis.indptr[:-1]] if self.size else np.zeros(0, dtype=np.int64)
        of = owner[first]
        self.order = np.argsort(of, kind="stable")
        self.place = np.empty(self.size, dtype=np.int32)
        self.place[self.order] = np.arange(self.size, dtype=np.int32)
        counts = np.bincount(of, minlength=team.size)
        ends = np.cumsum(counts)
        self.members = [self.order[end - count : end] for end, count in zip(ends, counts, strict=True)]
        self.own = self.members[team.rank]
        self.mine = len(self.own)


class Reduced:
    """A = T^T K T in PETSc, for many K of one pattern.

    Parameters
    ----------
    numbering : Numbering
    reduction : Reduction
        T.
    half : bool
        Whether the upper triangle alone is kept, which tells a symmetric matrix.

    Attributes
    ----------
    mat : petsc4py.PETSc.Mat
    """

    def __init__(self, numbering: Numbering, reduction: Reduction, half: bool) -> None:
        self.numbering, self.reduction, self.half = numbering, reduction, half
        self._pattern: tuple[Ints, Ints] | None = None
        self.mat: Any = None

    def fill(self, matrix: Scattered) -> bool:
        """Make `mat` the reduced matrix of K; whether its pattern is a new one.

        Raises
        ------
        InputError
            If the numbers of PETSc at hand are too small for the matrix.
        """
        team = self.numbering.team
        rows = self._own_rows(matrix)
        known = self._pattern
        new = known is None or not (
            np.array_equal(known[0], rows.indptr) and np.array_equal(known[1], rows.indices)
        )
        if not team.number(lambda: new):
            self.mat.zeroEntries()
            self.mat.setValuesCSR(rows.indptr, rows.indices, rows.data)
            self.mat.assemble()
            return False
        self._pattern = (rows.indptr, rows.indices)
        self._create(rows)
        return True

    def _own_rows(self, matrix: Scattered) -> sp.csr_matrix:
        """(mine, free) the rows of this process, with what all others have of them."""
        team = self.numbering.team
        given = team.communicator.alltoall(team.together(lambda: self._rows_by_process(matrix.local)))
        return team.together(lambda: _added(given))

    def _create(self, rows: sp.csr_matrix) -> None:
        from petsc4py import PETSc

        numbering, kind = self.numbering, PETSc.IntType
        limit = np.iinfo(kind).max
        largest = numbering.team.largest(float(rows.nnz))
        if largest > limit or numbering.size > limit:
            raise InputError(
                f"{numbering.size} unknowns with {largest:.3g} entries on one process: the PETSc at hand counts to "
                f"{limit}; take more processes, or a PETSc with 64-bit indices"
            )
        if self.mat is not None:
            self.mat.destroy()
        size = ((numbering.mine, numbering.size), (numbering.mine, numbering.size))
        csr = (rows.indptr.astype(kind), rows.indices.astype(kind), rows.data)
        make = PETSc.Mat().createSBAIJ if self.half else PETSc.Mat().createAIJ
        self.mat = make(size, *([1] if self.half else []), csr=csr, comm=numbering.team.communicator)
        self.mat.assemble()

    def _rows_by_process(self, local: sp.csr_matrix) -> list[sp.csr_matrix | None]:
        """What this process has of the rows of each, in the new numbers; None where that is nothing."""
        numbering = self.numbering
        reduced = self.reduction.reduce(local)[numbering.order]
        column = numbering.place[reduced.indices]
        row = np.repeat(np.arange(numbering.size, dtype=np.int32), np.diff(reduced.indptr))
        # unknowns of other processes have a zero on the diagonal here, and nothing else
        kept = (reduced.data != 0.0) | (np.diff(reduced.indptr)[row] > 1)
        if self.half:
            kept &= column >= row
        count = np.bincount(row[kept], minlength=numbering.size)
        del row
        start = np.concatenate([[0], np.cumsum(count)])
        data, column = reduced.data[kept], column[kept]
        del reduced, kept
        out: list[sp.csr_matrix | None] = []
        end = 0
        for members in numbering.members:
            begin, end = end, end + len(members)
            some = slice(start[begin], start[end])
            shape = (end - begin, numbering.size)
            block = (data[some], column[some], start[begin : end + 1] - start[begin])
            out.append(sp.csr_matrix(block, shape=shape) if start[end] > start[begin] else None)
        mine = numbering.team.rank
        if out[mine] is None:
            out[mine] = sp.csr_matrix((numbering.mine, numbering.size))
        return out


def _added(parts: list[sp.csr_matrix | None]) -> sp.csr_matrix:
    """The sum of what all processes have of some rows."""
    present = [part for part in parts if part is not None]
    total = sum(present[1:], present[0]).tocsr()
    total.sort_indices()
    return total
