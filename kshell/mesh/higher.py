"""Triangles of order 3 and 4: all their nodes, as a file has them.

A mesh knows its vertices and the middles of its edges; what its triangles have beyond stands beside it, found by the
places of their corners. So it survives when vertices are numbered anew or doubled, triangles turned or left out, and is
gone where a mesh has moved or was cut: then the middles of the edges are what is left.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.triangulation import Higher, Triangulation

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

AROUND = ((0, 1), (1, 2), (2, 0))


@lru_cache(maxsize=4)
def lattice(order: int) -> Ints:
    """(node, 3) barycentric coordinates of the nodes times the order; inside by rising second, then third one."""
    corners = np.eye(3, dtype=np.int64)
    nodes = [order * corner for corner in corners]
    for a, b in AROUND:
        nodes += [(order - k) * corners[a] + k * corners[b] for k in range(1, order)]
    nodes += [np.array([order - i - j, i, j]) for i in range(1, order) for j in range(1, order - i)]
    return np.array(nodes)


def with_inner_nodes(order: int, outer: Floats) -> Floats:
    """All nodes (triangle, node, 3) of triangles with nodes on their edges alone (triangle, 3 order, 3).

    What an edge deviates from its chord, s (1 - s) phi(s), goes on inside as lambda_a lambda_b phi; on quadratic
    triangles that is exact, and of order 3 it is the usual triangle with nine nodes.
    """
    of = lattice(order) / order
    inside = of[3 * order :]
    s = np.arange(1, order) / order
    found = inside @ outer[:, :3]  # (triangle, node, 3)
    for edge, (a, b) in enumerate(AROUND):
        first = 3 + edge * (order - 1)
        x, y = outer[:, a, None], outer[:, b, None]
        off = outer[:, first : first + order - 1] - (x + s[:, None] * (y - x))
        phi = np.linalg.solve(s[:, None] ** np.arange(order - 1), off / (s * (1 - s))[:, None])
        at = (1 + inside[:, b] - inside[:, a]) / 2
        bump = (inside[:, a] * inside[:, b])[:, None] * at[:, None] ** np.arange(order - 1)
        found = found + bump @ phi
    return np.concatenate([outer, found], axis=1)


def higher_nodes(mesh: Triangulation) -> Floats | None:
    """(triangle, node, 3) nodes of the triangles of a mesh in the order of `lattice`; None where they are not known."""
    if mesh.higher is None:
        return None
    if "_higher_nodes" not in mesh.__dict__:
        mesh.__dict__["_higher_nodes"] = _found(mesh, mesh.higher)
    found: Floats | None = mesh.__dict__["_higher_nodes"]
    return found


def _found(mesh: Triangulation, higher: Higher) -> Floats | None:
    wanted = mesh.points[mesh.triangles]
    known = higher.nodes[:, :3]
    if wanted.shape == known.shape and (wanted == known).all():
        return higher.nodes
    # the same places have the same numbers
    both = np.concatenate([known, wanted]).reshape(-1, 3)
    number = np.unique(both, axis=0, return_inverse=True)[1].reshape(-1, 3)
    key = np.unique(np.sort(number, axis=1), axis=0, return_inverse=True)[1].ravel()
    row = np.full(int(key.max()) + 1, -1)
    row[key[: len(known)]] = np.arange(len(known))
    row = row[key[len(known) :]]
    if (row < 0).any():
        return None
    place = (number[row][:, None] == number[len(known) :, :, None]).argmax(
        axis=2
    )  # of each corner in the known one
    order, own = higher.order, lattice(higher.order)
    turned = np.empty((len(row), len(own), 3), dtype=np.int64)
    np.put_along_axis(
        turned, np.repeat(place[:, None], len(own), axis=1), own[None].repeat(len(row), axis=0), 2
    )
    index = np.empty((order + 1, order + 1), dtype=np.int64)
    index[own[:, 0], own[:, 1]] = np.arange(len(own))
    found: Floats = higher.nodes[row[:, None], index[turned[..., 0], turned[..., 1]]]
    return found


def order_of(mesh: Triangulation) -> int:
    """Polynomial order of the geometry of a mesh."""
    return mesh.order if mesh.higher is None or higher_nodes(mesh) is None else mesh.higher.order


def nodes_along(mesh: Triangulation, edges: NDArray[np.integer]) -> Floats:
    """(n, order - 1, 3) nodes on edges between their ends, from the lower to the higher vertex."""
    nodes = higher_nodes(mesh)
    if nodes is None:
        return np.empty((len(edges), 0, 3)) if mesh.midpoints is None else mesh.midpoints[edges][:, None]
    inner = order_of(mesh) - 1
    triangle, local = mesh.edge_owner[edges].T
    # edges (0, 1), (1, 2), (0, 2) of meshes are walked 0 1, 1 2, 2 0 here
    out = nodes[triangle[:, None], 3 + local[:, None] * inner + np.arange(inner)]
    back = mesh.triangles[triangle, local] != mesh.edges[edges, 0]
    out[back] = out[back, ::-1]
    return np.asarray(out)
