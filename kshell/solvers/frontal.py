"""Cholesky factors by fronts (multifrontal method, Duff and Reid, ACM Trans. Math. Softw. 9 (1983) 302), compiled.

The unknowns come in a good order of elimination. What is eliminated at once is a small full matrix, its front: the
columns of the matrix, and what the fronts before it left there. Fronts are eliminated by the BLAS and LAPACK of scipy.
What a factor looks like is found from blocks of columns with one pattern, five times fewer than columns.

Where kshell was installed without a C compiler there are the libraries of `kshell.solvers.repeated`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.solvers import kernels
from kshell.solvers.backends import Singular
from kshell.solvers.repeated import Factor
from kshell.solvers.system import Floats

Ints = NDArray[np.integer]

NAME = "Cholesky (kshell)"
# zeros that a front may have, as a share of its entries, where it has up to so many columns: fewer and longer products
ZEROS = np.array([1.0, 0.8, 0.1, 0.05])
COLUMNS = np.array([4.0, 16.0, 48.0, np.inf])


def installed() -> bool:
    """Whether the loops were compiled."""
    return kernels.fronts() is not None


@dataclass(frozen=True)
class Fronts:
    """What the factor of a matrix with a given pattern looks like.

    Attributes
    ----------
    indptr, indices : int arrays
        Compressed columns of the lower triangle.
    unknown, place : (n,) int32 arrays
        The unknown that is eliminated in each place, and the other way round.
    first : (fronts + 1,) int32 array
        Place of the first unknown of each front.
    start : (blocks + 1,) int32 array
        Place of the first unknown of each block.
    begin, left : int arrays
        Where the blocks that are left in each front begin, and they.
    rest : (fronts,) int64 array
        Unknowns that are left in each front.
    child, sibling : (fronts,) int32 arrays
        The first child of each front in the tree of elimination, and the next one of the same parent; -1 for none.
    panel, update : int64 arrays
        Where the columns of each front begin in the factor, and what it leaves in the stack.
    stacked : int
        Entries of the stack.
    """

    indptr: Ints
    indices: Ints
    unknown: Ints
    place: Ints
    first: Ints
    start: Ints
    begin: Ints
    left: Ints
    rest: Ints
    child: Ints
    sibling: Ints
    panel: Ints
    update: Ints
    stacked: int

    @property
    def entries(self) -> int:
        """Entries of the factor, with the room of its full columns."""
        return int(self.panel[-1])

    @property
    def operations(self) -> float:
        """Multiplications and additions of the factorisation."""
        p, m = np.diff(self.first).astype(float), self.rest.astype(float)
        return float(np.sum(p * (p * p / 3.0 + p * m + m * m)))


def fronts_of(indptr: Ints, indices: Ints) -> Fronts:
    """The fronts of a matrix.

    Parameters
    ----------
    indptr, indices : int arrays
        Compressed columns of the lower triangle, rows ascending from the diagonal, in a good order of elimination.
    """
    loops, n = kernels.fronts(), len(indptr) - 1
    indptr, indices = kernels.contiguous(indptr, np.int64), kernels.contiguous(indices, np.int32)
    block, start = np.empty(n, dtype=np.int32), np.empty(n + 1, dtype=np.int32)
    count = loops.alike(indptr, indices, block, start)
    start = start[: count + 1].copy()
    pointer, after = np.empty(count + 1, dtype=np.int64), _none(0)
    after = _none(loops.coupled(indptr, indices, block, start, pointer, after))
    if len(after):
        loops.coupled(indptr, indices, block, start, pointer, after)
    parent, height = _none(count), np.empty(count, dtype=np.int64)
    row = np.zeros(count + 1, dtype=np.int64)
    loops.tree(pointer, after, start, row, _none(len(after)), _none(count), parent, height)

    node, child, sibling = _none(count), _none(count + 1), _none(count + 1)
    wide, tall, zeros = np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64), np.empty(count)
    loops.merged(parent, start, height, ZEROS, COLUMNS, node, child, sibling, wide, tall, zeros)
    nodes = _none(count)
    nodes = nodes[: loops.ordered(child, sibling, _none(count + 2), nodes)]
    rank = _none(count)
    rank[nodes] = np.arange(len(nodes), dtype=np.int32)
    up = parent[nodes]
    above = np.where(up >= 0, rank[node[up]], -1).astype(np.int32)
    rest = (tall - wide)[nodes]

    of_block = rank[node]
    order = np.argsort(of_block, kind="stable")  # the block in each place
    block_place = _none(count)
    block_place[order] = np.arange(count, dtype=np.int32)
    sizes = np.diff(start)[order]
    begins = _summed(sizes, np.int32)
    unknown = np.repeat(start[order] - begins[:-1], sizes) + np.arange(n, dtype=np.int32)
    place = _none(n)
    place[unknown] = np.arange(n, dtype=np.int32)

    first = _summed(np.bincount(of_block, minlength=len(nodes)), np.int32)
    head, next_ = _none(len(nodes)), _none(len(nodes))
    begin, left = np.empty(len(nodes) + 1, dtype=np.int64), _none(int(rest.sum()))
    total = loops.rows(
        pointer,
        after,
        block_place,
        order.astype(np.int32),
        first,
        above,
        _none(count),
        head,
        next_,
        begin,
        left,
    )
    update, freed = np.empty(len(nodes), dtype=np.int64), np.zeros(len(nodes), dtype=np.int64)
    stacked = loops.room(above, rest, _none(len(nodes)), update, freed)
    first = begins[first]
    pivots = np.diff(first).astype(np.int64)
    panel = _summed(pivots * (pivots + rest), np.int64)
    return Fronts(
        indptr, indices, unknown.astype(np.int32), place, first, begins, begin, left[:total].copy(), rest,
        head, next_, panel, update, stacked,
    )  # fmt: skip


class Frontal:
    """Cholesky factors by fronts; `Singular` where the matrix is not positive definite.

    Parameters
    ----------
    indptr, indices : int arrays
        As of `fronts_of`.
    """

    def __init__(self, indptr: Ints, indices: Ints) -> None:
        self.fronts = fronts_of(indptr, indices)

    def another(self, indptr: Ints, indices: Ints) -> Frontal:
        """For further matrices of this pattern: factors are independent of each other."""
        return self

    def factorise(self, entries: Floats) -> Factor:
        of = self.fronts
        panels, n = kernels.panels(), len(of.place)
        factor, stack = np.zeros(of.entries), np.empty(of.stacked + 1)
        longest = int(np.diff(of.begin).max(initial=0))
        bad = panels.factorise(
            of.indptr, of.indices, np.ascontiguousarray(entries), of.unknown, of.place, of.first, of.begin,
            of.left, of.start, of.panel, of.update, of.child, of.sibling, _none(n),
            np.empty(3 * longest, dtype=np.int64), factor, stack,
        )  # fmt: skip
        if bad >= 0:
            raise Singular(f"{NAME}: the pivot of unknown {bad} is not positive")
        return Factor(lambda rhs: _solved(of, factor, rhs), lambda: 0, True)


def _solved(of: Fronts, factor: Floats, rhs: Any) -> Floats:
    """(n,) or (n, load) to the same."""
    given = np.asarray(rhs, dtype=float)
    columns = given.reshape(len(of.place), -1)
    x = np.asfortranarray(columns[of.unknown])
    work = np.empty(int(of.rest.max(initial=0)) * x.shape[1] + 1)
    kernels.panels().solve(of.first, of.begin, of.left, of.start, of.panel, factor, work, x)
    return np.ascontiguousarray(x[of.place]).reshape(given.shape)


def _none(count: int) -> Ints:
    return np.full(count, -1, dtype=np.int32)


def _summed(sizes: Ints, kind: type) -> Ints:
    """Where each of so many begins behind the others, and where the last ends."""
    return np.concatenate([[0], np.cumsum(sizes)]).astype(kind)
