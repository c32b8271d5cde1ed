"""Smoothers of the hierarchy: Gauss-Seidel, and for Argyris at supports whole vertices at once."""

from __future__ import annotations

from typing import Any

import numpy as np

from kshell.solvers.multigrid.cloud import Cloud
from kshell.solvers.system import Floats, Ints, PlateSpace

SMALL_LEVELS = 2  # from this level on, with less than a tenth of the unknowns


def set_smoothers(solver: Any, space: PlateSpace, cloud: Cloud) -> None:
    """Gauss-Seidel sweeps forward before and backward after the coarse correction, on every level.

    One sweep on the large levels, two on the small ones: there they cost little, and the correction from below
    is poorer the more interpolations lie above it.

    On curved supported edges Argyris ties second to first derivatives. Taken one by one, these unknowns slow
    the iteration down by a factor of four (54 instead of 12 on a ring); so after the forward sweep and
    before the backward one the unknowns of every supported vertex and its edges are solved for together.
    """
    from pyamg.relaxation.smoothing import change_smoothers

    sweeps = [1 if level < SMALL_LEVELS else 2 for level in range(len(solver.levels) - 1)]
    before_and_after = (
        [("gauss_seidel", {"sweep": direction, "iterations": count}) for count in sweeps]
        for direction in ("forward", "backward")
    )
    change_smoothers(solver, *before_and_after)
    if space.element != "argyris" or len(solver.levels) < 2:
        return
    members, pointer = supported_patches(space, cloud)
    if len(pointer) < 2:
        return
    finest = solver.levels[0]
    before, after = (
        _schwarz(finest.A, members, pointer, "forward"),
        _schwarz(finest.A, members, pointer, "backward"),
    )
    forward, backward = finest.presmoother, finest.postsmoother

    def presmoother(a: Any, x: Floats, b: Floats) -> None:
        forward(a, x, b)
        before(a, x, b)

    def postsmoother(a: Any, x: Floats, b: Floats) -> None:
        after(a, x, b)
        backward(a, x, b)

    finest.presmoother, finest.postsmoother = presmoother, postsmoother


def supported_patches(space: PlateSpace, cloud: Cloud) -> tuple[Ints, Ints]:
    """Unknowns of each supported vertex and of its edges, as members and pointer into them."""
    import scipy.sparse as sp

    vertices = np.flatnonzero(~cloud.plain)
    place = np.full(len(space.points), -1)
    place[vertices] = np.arange(len(vertices))
    row = np.repeat(np.arange(len(vertices)), 6)
    column = (6 * vertices[:, None] + np.arange(6)).ravel()
    ends = place[space.edges]
    edge, end = np.nonzero(ends >= 0)
    row = np.concatenate([row, ends[edge, end]])
    column = np.concatenate([column, 6 * len(space.points) + edge])
    takes = sp.csr_matrix((np.ones(len(row)), (row, column)), shape=(len(vertices), space.reduction.shape[0]))
    unknowns = (takes @ abs(space.reduction)).tocsr()
    unknowns.eliminate_zeros()
    unknowns.sort_indices()
    counts = np.diff(unknowns.indptr)
    pointer = np.concatenate([[0], np.cumsum(counts[counts > 0])])
    return unknowns.indices.astype(np.int32), pointer.astype(np.int32)


def _schwarz(a: Any, members: Ints, pointer: Ints, sweep: str) -> Any:
    from pyamg.relaxation.relaxation import schwarz, schwarz_parameters

    members, pointer, inverse, inverse_pointer = schwarz_parameters(a, members, pointer)

    def smooth(a: Any, x: Floats, b: Floats) -> None:
        schwarz(
            a,
            x,
            b,
            iterations=1,
            subdomain=members,
            subdomain_ptr=pointer,
            inv_subblock=inverse,
            inv_subblock_ptr=inverse_pointer,
            sweep=sweep,
        )

    return smooth
