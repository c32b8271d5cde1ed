"""Triangles of order 3 and 4 of gmsh: the middles of their edges, as a mesh has them, and all their nodes beside it.

Of order 4 a node lies in the middle of each edge; of order 3 it is put there, on the cubic through the four nodes of
the edge. Where triangles have no nodes inside (incomplete ones), they follow from those on the edges.

Node numbers as in the gmsh reference manual, "Node ordering": vertices, then edge by edge, then inside.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.gmsh_cells import QUADRILATERALS, TRIANGLES, CellBlock
from kshell.mesh.higher import with_inner_nodes
from kshell.mesh.triangulation import Higher

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]

LINE, TRIANGLE_6 = 1, 9
HIGH_LINES = (26, 27)
ORDER_OF_TRIANGLES = {20: 3, 21: 3, 22: 4, 23: 4}
COMPLETE = (21, 23)
# nodes inside as gmsh has them, by their places in `kshell.mesh.higher.lattice`
INSIDE = {3: (0,), 4: (0, 2, 1)}
EDGES = ((0, 1), (1, 2), (2, 0))


def lowered(
    tags: Ints, points: Floats, blocks: list[CellBlock], positions: Callable[[Ints], Ints]
) -> tuple[Ints, Floats, list[CellBlock], Higher | None, list[str]]:
    """Nodes and cells with triangles of order 2 in the place of those of order 3 and 4, these, and what to say of it.

    Parameters
    ----------
    tags, points : (node,), (node, 3) arrays
    positions : function
        From tags to positions in the list of nodes.
    """
    orders = sorted({ORDER_OF_TRIANGLES[b.cell_type] for b in blocks if b.cell_type in ORDER_OF_TRIANGLES})
    if not orders and not any(block.cell_type in HIGH_LINES for block in blocks):
        return tags, points, blocks, None, []
    cubic = [_edges(b.nodes, 3) for b in blocks if ORDER_OF_TRIANGLES.get(b.cell_type) == 3]
    fresh = np.empty((0, 2), dtype=np.int64)
    first = int(tags.max()) + 1
    if cubic:
        edges = np.concatenate(cubic).reshape(-1, 4)  # (edge, its nodes from end to end)
        fresh, at = np.unique(np.sort(edges[:, 1:3], axis=1), axis=0, return_index=True)
        x = points[positions(edges[at])]
        middle = (9.0 * (x[:, 1] + x[:, 2]) - x[:, 0] - x[:, 3]) / 16.0
        tags = np.concatenate([tags, first + np.arange(len(middle))])
        points = np.concatenate([points, middle])
    out = []
    for block in blocks:
        order = ORDER_OF_TRIANGLES.get(block.cell_type)
        if block.cell_type in HIGH_LINES:
            out.append(replace(block, cell_type=LINE, nodes=block.nodes[:, :2]))  # groups know ends alone
        elif order is None:
            out.append(block)
        else:
            edges = _edges(block.nodes, order)
            middles = edges[..., 2] if order == 4 else first + _rows(fresh, np.sort(edges[..., 1:3], axis=2))
            nodes = np.concatenate([block.nodes[:, :3], middles], axis=1)
            out.append(replace(block, cell_type=TRIANGLE_6, nodes=nodes))
    if not orders:
        return tags, points, out, None, []
    words = " and ".join(map(str, orders))
    higher = _all_nodes(points, blocks, positions)
    if higher is None:
        note = f"triangles of order {words} are taken by the middles of their edges, as triangles of order 2"
    else:
        note = f"triangles of order {words}: shells and curved edges of plates have it"
    return tags, points, out, higher, [note]


def _all_nodes(points: Floats, blocks: list[CellBlock], positions: Callable[[Ints], Ints]) -> Higher | None:
    """The nodes of triangles that are all of one order, 3 or 4."""
    cells = [block for block in blocks if block.cell_type in (*TRIANGLES, *ORDER_OF_TRIANGLES)]
    orders = {ORDER_OF_TRIANGLES.get(block.cell_type, 0) for block in cells}
    if len(orders) > 1 or any(block.cell_type in QUADRILATERALS for block in blocks):
        return None
    (order,) = orders
    parts = []
    for block in cells:
        x = points[positions(block.nodes)]
        if block.cell_type in COMPLETE:
            inside = x[:, 3 * order :][:, list(INSIDE[order])]
            parts.append(np.concatenate([x[:, : 3 * order], inside], axis=1))
        else:
            parts.append(with_inner_nodes(order, x))
    return Higher(order, np.concatenate(parts))


def _edges(nodes: Ints, order: int) -> Ints:
    """(cell, edge, order + 1) nodes along the edges, from end to end."""
    between = nodes[:, 3 : 3 * order].reshape(len(nodes), 3, order - 1)
    ends = nodes[:, np.array(EDGES)]
    return np.concatenate([ends[..., :1], between, ends[..., 1:]], axis=2)


def _rows(known: Ints, wanted: Ints) -> Ints:
    """Where pairs (..., 2) stand among sorted pairs (n, 2)."""
    width = int(known.max()) + 1
    return np.searchsorted(known[:, 0] * width + known[:, 1], wanted[..., 0] * width + wanted[..., 1])
