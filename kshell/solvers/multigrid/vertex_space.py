"""From (w, w_x, w_y) at the vertices to the unknowns of the element.

Morley takes the deflection, and for the edges the mean of the normal derivatives at their ends. Argyris needs
second derivatives besides: those of the least-squares fit of the gradients at the neighbours. Both reproduce
quadratic deflections.

Symbols
-------
T     reduction of the space, u = T q
W     diagonal weights that make all degrees of freedom u comparable: 1, h^2, h^4 for w, grad w, hess w
Q     left inverse of T: (T^T W T)^-1 T^T W
H     second derivatives (w_xx, w_xy, w_yy) at vertices from gradients
"""

from __future__ import annotations

from typing import Any

import numpy as np

from kshell.solvers.multigrid.cloud import Cloud
from kshell.solvers.multigrid.interpolate import block_matrix, split_rows
from kshell.solvers.nearest import picked
from kshell.solvers.system import Floats, Ints, PlateSpace

SWEEPS = 4  # of Jacobi's method for T^T W T, which is diagonal but for a few boundary vertices


def element_interpolation(space: PlateSpace, cloud: Cloud) -> Any:
    """The unknowns of the element from the admissible (w, w_x, w_y) of the vertices.

    Returns
    -------
    (unknowns, 3 active vertices) BSR matrix of 1 x 3 blocks
    """
    import scipy.sparse as sp

    size = np.zeros(len(space.points))
    np.add.at(size, space.edges.ravel(), np.repeat(space.lengths, 2))
    size /= np.maximum(np.bincount(space.edges.ravel(), minlength=len(size)), 1)
    if space.element == "morley":
        full, scale = _morley(space, sp), np.concatenate([np.ones(len(size)), space.lengths])
    else:
        full = _argyris(space, sp)
        per_vertex = np.stack([np.ones_like(size), size, size, size**2, size**2, size**2], axis=1)
        scale = np.concatenate([per_vertex.ravel(), space.lengths])
        if space.fan_vertex is not None:
            scale = np.append(scale, np.repeat(size[space.fan_vertex[len(size) :]] ** 2, 3))
        if space.second_slopes is not None:
            scale = np.append(scale, space.lengths[space.second_slopes])

    result = _left_inverse(space.reduction, scale**2, full, sp)
    column = result.indices
    if not cloud.active.all():
        keep = cloud.active[column]
        pointer = np.concatenate([[0], np.cumsum(keep)])[result.indptr].astype(np.int32)
        column, data = column[keep], result.data[keep]
    else:
        pointer, data = result.indptr, result.data
    turned = np.flatnonzero(~cloud.plain[column])
    data[turned] = data[turned] @ cloud.columns[column[turned]]
    shape = (result.shape[0], 3 * int(cloud.active.sum()))
    return sp.bsr_matrix((data, cloud.number[column].astype(np.int32), pointer), shape=shape)


def _left_inverse(reduction: Any, weight: Floats, full: Any, sp: Any) -> Any:
    """Q times the interpolation of all degrees of freedom."""
    rows = picked(reduction.tocsc())
    if rows is not None:  # each unknown is one of them, scaled
        result = take_rows(full, rows, sp)
        _scale_rows(result, 1.0 / reduction.tocsc().data)
        return result
    weighted = (sp.diags(weight) @ reduction).T.tocsr()
    gram = (weighted @ reduction).tocsr()
    diagonal = gram.diagonal()
    rhs = _rows_as_blocks(weighted, sp) @ full
    inverse = 1.0 / diagonal
    rest = (gram - sp.diags(diagonal)).tocsr()
    rest.data[np.abs(rest.data) < 1e-12 * diagonal.max()] = 0.0
    rest.eliminate_zeros()
    result = rhs.copy()
    _scale_rows(result, inverse)
    if rest.nnz:
        rest = _rows_as_blocks(rest, sp)
        for _ in range(SWEEPS):
            result = rhs - rest @ result
            _scale_rows(result, inverse)
    return result


def _rows_as_blocks(matrix: Any, sp: Any) -> Any:
    return sp.bsr_matrix((matrix.data[:, None, None], matrix.indices, matrix.indptr), shape=matrix.shape)


def _scale_rows(matrix: Any, factor: Floats) -> None:
    matrix.data *= np.repeat(factor, np.diff(matrix.indptr))[:, None, None]


def _edge_rows(ends: Ints, at_lower: Floats, at_higher: Floats, count: int, sp: Any) -> Any:
    """(edge, 3 vertices) BSR: a row (1, 3) for the lower vertex (or fan) of each edge and one for the higher."""
    blocks = np.stack([at_lower, at_higher], axis=1).reshape(-1, 1, 3)
    pointer = np.arange(0, 2 * len(ends) + 1, 2, dtype=np.int32)
    columns = ends.ravel().astype(np.int32)
    return sp.bsr_matrix((blocks, columns, pointer), shape=(len(ends), 3 * count))


def _mean_normal_derivative(space: PlateSpace, sp: Any) -> Any:
    """(edge, 3 vertices): n.(g_a + g_b)/2."""
    half = np.zeros((len(space.edges), 3))
    half[:, 1:] = 0.5 * space.edge_normals
    return _edge_rows(space.edges, half, half, len(space.points), sp)


def _morley(space: PlateSpace, sp: Any) -> Any:
    n = len(space.points)
    value = np.zeros((n, 1, 3))
    value[:, 0, 0] = 1.0
    values = sp.bsr_matrix(
        (value, np.arange(n, dtype=np.int32), np.arange(n + 1, dtype=np.int32)), shape=(n, 3 * n)
    )
    return _stack(values, _mean_normal_derivative(space, sp), sp)


def _argyris(space: PlateSpace, sp: Any) -> Any:
    n = len(space.points)
    hessian = fitted_hessian(space, sp)
    fans = hessian.shape[0] // 3
    by_row = split_rows(hessian)
    # vertex rows: the values themselves, then the second derivatives, in turn
    identity = sp.bsr_matrix(
        (np.tile(np.eye(3), (n, 1, 1)), np.arange(n), np.arange(n + 1)), shape=(3 * n, 3 * n)
    )
    both = _stack(split_rows(identity), by_row, sp)
    order = np.arange(6 * n).reshape(2, n, 3).transpose(1, 0, 2).ravel()

    # the derivative along an edge is cubic: at its middle (g_a + g_b)/2 + L/8 d_t (g_a - g_b)
    (nx, ny), length = space.edge_normals.T, space.lengths
    tx, ty = -ny, nx
    twist = (length / 8.0)[:, None] * np.stack([nx * tx, nx * ty + ny * tx, ny * ty], axis=1)
    ends = _edge_fans(space)
    edges = _mean_normal_derivative(space, sp) + _edge_rows(ends, twist, -twist, fans, sp) @ hessian
    full = _stack(take_rows(both, order, sp), edges, sp)
    if fans > n:
        full = _stack(full, take_rows(by_row, np.arange(3 * n, 3 * fans), sp), sp)
    if space.second_slopes is not None:
        full = _stack(full, take_rows(edges, np.asarray(space.second_slopes), sp), sp)
    return full


def _edge_fans(space: PlateSpace) -> Ints:
    """(edge, 2) fans at the ends of each edge, on one of its sides; its vertices where these have one fan each."""
    if space.corner_fan is None:
        return space.edges
    n = len(space.points)
    out = space.edges.astype(np.int64)
    key = out[:, 0] * n + out[:, 1]
    for a, b in ((0, 1), (1, 2), (0, 2)):
        ends, fans = space.triangles[:, [a, b]].astype(np.int64), space.corner_fan[:, [a, b]]
        order = np.argsort(ends, axis=1)
        ends, fans = np.take_along_axis(ends, order, axis=1), np.take_along_axis(fans, order, axis=1)
        out[np.searchsorted(key, ends[:, 0] * n + ends[:, 1])] = fans
    return out


def _spokes(space: PlateSpace) -> tuple[Ints, Ints, Ints]:
    """(fan, vertex, other vertex) of the edges that go out from each fan."""
    if space.corner_fan is None or space.fan_vertex is None:
        start = np.concatenate([space.edges[:, 0], space.edges[:, 1]])
        return start, start, np.concatenate([space.edges[:, 1], space.edges[:, 0]])
    pairs = [
        np.stack([space.corner_fan[:, c], space.triangles[:, (c + step) % 3]], axis=1)
        for c in range(3)
        for step in (1, 2)
    ]
    fan, end = np.unique(np.concatenate(pairs), axis=0).T
    return fan, space.fan_vertex[fan], end


def fitted_hessian(space: PlateSpace, sp: Any) -> Any:
    """H: at each vertex (or fan) the second derivatives that fit the differences of gradients along its edges best.

    For the edge d from vertex v to u:   (d_x w_xx + d_y w_xy, d_x w_xy + d_y w_yy) = g_u - g_v,
    weighted with 1/|d|^2. Returned as BSR matrix (3 fans, 3 vertices) of 3 x 3 blocks.
    """
    fan, start, end = _spokes(space)
    n = len(space.points) if space.fan_vertex is None else len(space.fan_vertex)
    length = np.linalg.norm(space.points[end] - space.points[start], axis=1)
    d = (space.points[end] - space.points[start]) / length[:, None]
    rows = np.zeros((len(d), 2, 3))
    rows[:, 0, 0] = rows[:, 1, 1] = d[:, 0]
    rows[:, 0, 1] = rows[:, 1, 2] = d[:, 1]
    normal = np.zeros((n, 3, 3))
    np.add.at(normal, fan, rows.transpose(0, 2, 1) @ rows)
    share = np.linalg.inv(normal)[fan] @ rows.transpose(0, 2, 1) / length[:, None, None]
    blocks = np.zeros((len(d) + n, 3, 3))
    blocks[: len(d), :, 1:] = share
    np.subtract.at(blocks[len(d) :, :, 1:], fan, share)
    vertices = np.arange(len(space.points)) if space.fan_vertex is None else space.fan_vertex
    row, column = np.concatenate([fan, np.arange(n)]), np.concatenate([end, vertices])
    return block_matrix(row, column, blocks, n, len(space.points), sp)


def _stack(above: Any, below: Any, sp: Any) -> Any:
    """One BSR matrix of 1 x 3 blocks above another (scipy's vstack would lose the blocks)."""
    pointer = np.concatenate([above.indptr, above.indptr[-1] + below.indptr[1:]])
    indices, data = np.concatenate([above.indices, below.indices]), np.concatenate([above.data, below.data])
    return sp.bsr_matrix((data, indices, pointer), shape=(above.shape[0] + below.shape[0], above.shape[1]))


def take_rows(matrix: Any, order: Any, sp: Any) -> Any:
    """Rows of a BSR matrix of 1 x 3 blocks in another order."""
    count = np.diff(matrix.indptr)[order]
    pointer = np.concatenate([[0], np.cumsum(count)])
    place = np.arange(pointer[-1]) + np.repeat(matrix.indptr[order] - pointer[:-1], count)
    return sp.bsr_matrix(
        (matrix.data[place], matrix.indices[place], pointer), shape=(len(order), matrix.shape[1])
    )
