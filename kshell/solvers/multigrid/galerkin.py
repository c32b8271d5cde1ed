"""The Galerkin product P^T A P, the dearest part of the setup.

Interpolation acts on whole vertices, three columns at a time, and scipy multiplies blocks faster than entries.
A compiled loop goes through A once and makes one triangle of the product.
(Tried and left out: products of scipy with one triangle of A, whose P^T U P is as full as P^T A P.)
"""

from __future__ import annotations

from typing import Any

import numpy as np

from kshell.solvers import kernels

CHUNK = 120_000  # rows of A P at a time: the whole would be the largest matrix of the setup
CONVERTED = 12_000  # rows at a time from blocks to entries


def galerkin(matrix: Any, prolongation: Any) -> Any:
    """P^T A P in 3 x 3 blocks.

    Coarse unknowns that the supports forbid have zero columns in P; they get 1 on the diagonal and stay zero
    in every cycle.

    Parameters
    ----------
    matrix : (n, n) BSR matrix
        Of 1 x 1 blocks (element) or 3 x 3 blocks (vertices).
    prolongation : (n, 3 vertices) BSR matrix of 1 x 3 or 3 x 3 blocks

    Returns
    -------
    (3 vertices, 3 vertices) BSR matrix
    """
    import scipy.sparse as sp

    if kernels.cycles is not None and matrix.indices.dtype == np.int32:
        coarse = prolongation.shape[1] // 3
        indptr, indices, data = kernels.cycles.product(
            matrix.indptr, matrix.indices, np.ascontiguousarray(matrix.data), *_parts(prolongation), coarse
        )
        own = np.flatnonzero(np.repeat(np.arange(coarse), np.diff(indptr)) == indices)
        _made_regular(data, own)
        return sp.bsr_matrix((data, indices, indptr), shape=(3 * coarse, 3 * coarse))
    sums: list[
        tuple[int, Any]
    ] = []  # of ever fewer chunks: added one by one, they would all be copied each time
    for first in range(0, matrix.shape[0], CHUNK):
        chunk = slice(first, min(first + CHUNK, matrix.shape[0]))
        count, part = 1, block_rows(prolongation, chunk).T @ (block_rows(matrix, chunk) @ prolongation)
        while sums and sums[-1][0] == count:
            part = sums.pop()[1] + part
            count *= 2
        sums.append((count, part))
    product = sums.pop()[1]
    while sums:
        product = sums.pop()[1] + product
    rows = np.repeat(np.arange(len(product.indptr) - 1), np.diff(product.indptr))
    own = np.flatnonzero(rows == product.indices)
    if len(own) < len(product.indptr) - 1:  # vertices that no unknown feels
        empty = sp.identity(product.shape[0], format="csr").tobsr((3, 3))
        empty.data *= np.bincount(rows[own], minlength=len(product.indptr) - 1)[:, None, None] == 0
        product = product + empty
        rows = np.repeat(np.arange(len(product.indptr) - 1), np.diff(product.indptr))
        own = np.flatnonzero(rows == product.indices)
    _made_regular(product.data, own)
    return product


def _made_regular(data: Any, own: Any) -> None:
    """1 on the diagonal of what is held; own are the numbers of the blocks on the diagonal."""
    diagonal = data[own][:, range(3), range(3)]
    data[own[:, None], range(3), range(3)] = np.where(diagonal > 0.0, diagonal, 1.0)


def _parts(blocks: Any) -> tuple[Any, Any, Any]:
    return blocks.indptr, blocks.indices, np.ascontiguousarray(blocks.data)


def entries(blocks: Any) -> Any:
    """A matrix of blocks entry by entry, as CSR. It is faster to multiply with.

    Blocks of one row keep their numbers where they are, zeros included. Of larger blocks only what is not zero
    is taken, in sorted rows, some rows at a time.
    """
    import scipy.sparse as sp

    height, width = blocks.blocksize
    if height == 1:
        columns = (width * blocks.indices[:, None] + np.arange(width, dtype=blocks.indices.dtype)).ravel()
        return sp.csr_matrix((blocks.data.ravel(), columns, width * blocks.indptr), shape=blocks.shape)
    count = np.count_nonzero(blocks.data)
    data, indices = np.empty(count), np.empty(count, dtype=blocks.indices.dtype)
    pointer = np.zeros(blocks.shape[0] + 1, dtype=blocks.indptr.dtype)
    for first in range(0, blocks.shape[0], CONVERTED):
        rows = slice(first, min(first + CONVERTED, blocks.shape[0]))
        part = block_rows(blocks, rows).tocsr()
        part.eliminate_zeros()
        part.sort_indices()
        begin = pointer[first]
        data[begin : begin + part.nnz], indices[begin : begin + part.nnz] = part.data, part.indices
        pointer[first + 1 : rows.stop + 1] = begin + part.indptr[1:]
    matrix = sp.csr_matrix((data, indices, pointer), shape=blocks.shape)
    matrix.has_sorted_indices = True
    return matrix


def block_rows(matrix: Any, rows: slice) -> Any:
    """Some rows of a BSR matrix, without a copy; the slice must respect the blocks."""
    import scipy.sparse as sp

    height = matrix.blocksize[0]
    first, last = rows.start // height, rows.stop // height
    begin, end = matrix.indptr[first], matrix.indptr[last]
    pointer = matrix.indptr[first : last + 1] - begin
    return sp.bsr_matrix(
        (matrix.data[begin:end], matrix.indices[begin:end], pointer),
        shape=(rows.stop - rows.start, matrix.shape[1]),
    )
