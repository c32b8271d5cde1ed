"""Reactions at vertices that several supports hold: what falls to each of them.

Each gets what its conditions carry, equal ones equally: with R the rows of all of them, the smallest multipliers with
R^T lambda = residual.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.plate.domain import Domain
from kshell.plate.held import Supports
from kshell.plate.layout import Layout
from kshell.plate.reduction import Reduction

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SAME_ROWS = 1e-2  # singular value of rows, over the largest, below which they depend on each other


def rows_of_groups(
    domain: Domain, layout: Layout, reduction: Reduction, supports: Supports
) -> dict[int, tuple[Floats, Ints]]:
    """Rows (n, width) of the conditions at vertices that several groups hold, and the group (n,) of each.

    What ties of the reduction hold there belongs to none: its group is -1.
    """
    held, conditions = supports.held, supports.conditions
    count = np.zeros(len(domain.mesh.points), dtype=np.int64)
    for group in held:
        count[group.vertices] += 1
    several = count > 1
    rows: dict[int, list[Floats]] = {v: [] for v in np.flatnonzero(several).tolist()}
    owner: dict[int, list[int]] = {v: [] for v in rows}
    for number, group in enumerate(held):
        for k in group.rows:
            fans = conditions.fans[k]
            vertices = layout.fans.vertex[fans]
            mine = np.flatnonzero(several[vertices])
            on_vertices = reduction.rows_at_vertices(conditions.rows[k][mine], fans[mine])
            for v, row in zip(vertices[mine].tolist(), on_vertices, strict=True):
                rows[v].append(row)
                owner[v].append(number)
    for v, tie_rows in reduction.ties_of(list(rows)):
        rows[v] += list(tie_rows)
        owner[v] += [-1] * len(tie_rows)
    return {v: (np.array(rows[v]), np.array(owner[v])) for v in rows}


def shared_at(
    vertex: int, rows: Floats, owner: Ints, r: Floats, layout: Layout, reduction: Reduction
) -> dict[int, Floats]:
    """Work (per_vertex,) of the residual at one vertex that falls to each group.

    Parameters
    ----------
    vertex : int
    rows, owner : (n, width), (n,)
        Of `rows_of_groups`.
    r : (dof,)
        The residual.
    layout : Layout
    reduction : Reduction
    """
    slots = reduction.slots[reduction.vertex_place[vertex]]
    scale = layout.scale[slots]
    scaled = np.where(slots >= 0, r[slots] * scale, 0.0)
    multiplier = np.linalg.lstsq(rows.T, scaled, rcond=SAME_ROWS)[0]
    b = layout.per_vertex
    first = scale[:b]
    groups = [number for number in np.unique(owner).tolist() if number >= 0]
    rest = (scaled - rows.T @ multiplier)[:b] / len(groups)
    tied = owner < 0
    ties = (rows[tied].T @ multiplier[tied])[:b] / len(groups)  # of w and grad w none: both are common
    return {
        number: ((rows[owner == number].T @ multiplier[owner == number])[:b] + rest + ties) / first
        for number in groups
    }
