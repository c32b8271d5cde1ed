"""From coarse to fine: each vertex finds a coarse triangle around it and takes its HCT values."""

from __future__ import annotations

from typing import Any

import numpy as np

from kshell.solvers.multigrid.cloud import STIFFNESS_JUMP, TIE, Cloud
from kshell.solvers.multigrid.coarsen import Coarsening
from kshell.solvers.multigrid.hct import interpolation_weights
from kshell.solvers.system import Floats, Ints

OUTSIDE = -0.5  # a barycentric coordinate below this: too far outside to extrapolate a cubic
NEAR = -0.05  # a barycentric coordinate below this: look further afield first
FLAT = 0.05  # height / longest side below which a triangle is a last resort
PENALTY = 0.25  # of a flat triangle, or of one on the softer side of an interface, as barycentric coordinate


def interpolation(fine: Cloud, coarsening: Coarsening) -> Any:
    """The prolongation between the admissible (w, w_x, w_y) of two levels.

    Returns
    -------
    (3 active fine vertices, 3 active coarse vertices) BSR matrix of 3 x 3 blocks
    """
    import scipy.sparse as sp

    coarse = coarsening.cloud
    chosen = np.zeros(len(fine.points), dtype=bool)
    chosen[coarsening.chosen] = True
    moving = np.flatnonzero(~chosen & fine.active)
    triangle = locate(fine, coarsening, moving)
    inside = moving[triangle >= 0]
    corners = coarse.triangles[triangle[triangle >= 0]]
    alone = moving[triangle < 0]
    stay = np.flatnonzero(chosen & fine.active)

    weights = interpolation_weights(fine.points[inside], coarse.points[corners])
    # without a triangle: the linear function through the nearest chosen vertex
    shift = np.zeros((len(alone), 3, 3))
    shift[:, range(3), range(3)] = 1.0
    shift[:, 0, 1:] = fine.points[alone] - coarse.points[coarsening.region[alone]]

    rows = np.concatenate([np.repeat(inside, 3), alone, stay])
    columns = np.concatenate([corners.ravel(), coarsening.region[alone], coarsening.region[stay]])
    blocks = np.concatenate([weights.reshape(-1, 3, 3), shift, np.broadcast_to(np.eye(3), (len(stay), 3, 3))])
    del weights

    use = coarse.active[columns]
    if not use.all():
        rows, columns, blocks = rows[use], columns[use], blocks[use]
    turned = np.flatnonzero(~fine.plain[rows])
    blocks[turned] = fine.columns[rows[turned]].transpose(0, 2, 1) @ blocks[turned]
    turned = np.flatnonzero(~coarse.plain[columns])
    blocks[turned] = blocks[turned] @ coarse.columns[columns[turned]]

    return block_matrix(
        fine.number[rows],
        coarse.number[columns],
        blocks,
        int(fine.active.sum()),
        int(coarse.active.sum()),
        sp,
    )


def block_matrix(rows: Ints, columns: Ints, blocks: Floats, n_rows: int, n_columns: int, sp: Any) -> Any:
    """BSR matrix from blocks at distinct places, its columns in no particular order."""
    order = np.argsort(rows, kind="stable")  # in linear time for the few sorted runs that rows consist of
    pointer = np.zeros(n_rows + 1, dtype=np.int32)
    np.cumsum(np.bincount(rows, minlength=n_rows), out=pointer[1:])
    height, width = blocks.shape[1:]
    return sp.bsr_matrix(
        (blocks[order], columns[order].astype(np.int32), pointer), shape=(height * n_rows, width * n_columns)
    )


def split_rows(matrix: Any) -> Any:
    """BSR of 3 x 3 blocks as BSR of 1 x 3 blocks."""
    import scipy.sparse as sp

    count = np.diff(matrix.indptr)
    pointer = np.concatenate([[0], np.cumsum(np.repeat(count, 3))])
    row = np.repeat(np.arange(3 * len(count)), np.repeat(count, 3))
    place = np.arange(pointer[-1]) - pointer[row] + matrix.indptr[row // 3]
    data = matrix.data[place, row % 3][:, None, :]
    return sp.bsr_matrix((data, matrix.indices[place], pointer), shape=matrix.shape)


def locate(fine: Cloud, coarsening: Coarsening, vertices: Ints) -> Ints:
    """The coarse triangle at its region that holds each vertex best, -1 where there is none near enough.

    Triangles at the vertex's own coarse vertex, or at a neighbour of that: across a slit there are none, however
    near they are.
    """
    coarse = coarsening.cloud
    count = np.bincount(coarse.triangles.ravel(), minlength=len(coarse.points))
    pointer = np.concatenate([[0], np.cumsum(count)])
    star = np.argsort(coarse.triangles.ravel(), kind="stable") // 3  # triangles at each coarse vertex

    corner = coarse.points[coarse.triangles]  # (triangle, corner, xy)
    d, e = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    twice_area = d[:, 0] * e[:, 1] - d[:, 1] * e[:, 0]
    longest = np.maximum(
        np.maximum(np.sum(d * d, axis=1), np.sum(e * e, axis=1)), np.sum((d - e) ** 2, axis=1)
    )
    flatness = np.abs(twice_area) / np.maximum(longest, 1e-300)
    usable = flatness > 1e-6
    inverse = (
        np.stack([e[:, 1], -e[:, 0], -d[:, 1], d[:, 0]], axis=1) / np.where(usable, twice_area, 1.0)[:, None]
    )
    penalty = np.where(usable, PENALTY * (1.0 - np.minimum(flatness / FLAT, 1.0)), np.inf)

    best = np.full(len(vertices), -1)
    score = np.full(len(vertices), OUTSIDE - TIE)
    own = (
        None
        if fine.vertex_stiffness is None
        else fine.vertex_stiffness[vertices] / STIFFNESS_JUMP / (1 + TIE)
    )

    def search(which: Ints, start: Ints) -> None:
        """Look through the triangles at a coarse vertex for each of some vertices."""
        first, many = pointer[start], count[start]
        for slot in range(int(many.max(initial=0))):
            here = np.flatnonzero(many > slot)
            t, v = star[first[here] + slot], which[here]
            x = fine.points[vertices[v]] - corner[t, 0]
            lam1 = inverse[t, 0] * x[:, 0] + inverse[t, 1] * x[:, 1]
            lam2 = inverse[t, 2] * x[:, 0] + inverse[t, 3] * x[:, 1]
            value = np.minimum(np.minimum(np.minimum(lam1, lam2), 1.0 - lam1 - lam2), 0.0) - penalty[t]
            if own is not None and coarse.stiffness is not None:
                value -= np.where(coarse.stiffness[t] < own[v], PENALTY, 0.0)
            better = value > score[v] + TIE  # of equals the first
            score[v[better]] = value[better]
            best[v[better]] = t[better]

    region = coarsening.region[vertices]
    search(np.arange(len(vertices)), region)
    # where merging left a flat triangle on a line, the right one is at a neighbour of the coarse vertex
    outside = np.flatnonzero((score < NEAR - TIE) & (count[region] > 0))
    around = star[pointer[region[outside]]] if len(outside) else outside
    around = np.where(best[outside] >= 0, best[outside], around)
    for k in range(3):
        search(outside, coarse.triangles[around, k])
    return best
