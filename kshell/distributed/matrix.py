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
from kshell.equilibrium.reduced import ReducedPattern
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
    basis : (unknowns, free) sparse
        T.

    Raises
    ------
    InputError
        If the numbers of PETSc at hand are too small for the matrix.
    """

    def __init__(self, numbering: Numbering, basis: sp.csc_matrix) -> None:
        self.numbering, self.basis = numbering, basis
        self._pattern: ReducedPattern | None = None
        self.mat: Any = None

    def fill(self, matrix: Scattered) -> bool:
        """Make `mat` the reduced matrix of K; whether its pattern is a new one."""
        from petsc4py import PETSc

        numbering, team = self.numbering, self.numbering.team
        same = not team.number(lambda: self._pattern is None or not self._pattern.fits(matrix.local))
        if not same:
            pattern = team.together(
                lambda: ReducedPattern(matrix.local, self.basis, numbering.place, lower=False)
            )
            self._pattern = pattern
            if self.mat is not None:
                self.mat.destroy()
            largest = team.largest(float(len(pattern.indices)))
            limit = np.iinfo(PETSc.IntType).max
            if largest > limit or numbering.size > limit:
                raise InputError(
                    f"{numbering.size} unknowns with {largest:.3g} entries on one process: the PETSc at hand counts to "
                    f"{limit}; take more processes, or a PETSc with 64-bit indices"
                )
            self.mat = PETSc.Mat().create(team.communicator)
            self.mat.setSizes(((numbering.mine, numbering.size), (numbering.mine, numbering.size)))
            self.mat.setType("aij")
            columns = np.repeat(np.arange(pattern.size), np.diff(pattern.indptr))
            self.mat.setPreallocationCOO(pattern.indices.astype(PETSc.IntType), columns.astype(PETSc.IntType))
        entries = team.together(lambda: self._entries(matrix))
        self.mat.setValuesCOO(entries)
        self.mat.assemble()
        return not same

    def _entries(self, matrix: Scattered) -> Floats:
        assert self._pattern is not None
        return np.ascontiguousarray(self._pattern.entries(matrix.local))
