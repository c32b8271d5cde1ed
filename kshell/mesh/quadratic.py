"""Triangles of order 2 in space: corners and a node on each edge, in the order of `Mesh.triangle_edges`."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.triangulation import EDGE_VERTICES, Triangulation
from kshell.mesh.vectors import cross

Floats = NDArray[np.float64]

# the six nodes in barycentric coordinates
NODES = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [0.5, 0.5, 0], [0, 0.5, 0.5], [0.5, 0, 0.5]])

# rule of degree 4 with six points: barycentric coordinates, and weights of sum 1 (Dunavant 1985)
RULE_POINTS = np.array(
    [np.roll([1 - 2 * p, p, p], k) for p in (0.091576213509771, 0.445948490915965) for k in range(3)]
)
RULE_WEIGHTS = np.array([0.109951743655322] * 3 + [0.223381589678011] * 3)

# part of the normal of the flat triangle that must be left at every node
LEAST_NORMAL = 1e-6


def node_points(mesh: Triangulation, midpoints: Floats) -> Floats:
    """(triangle, 6, 3) places of the nodes."""
    return np.concatenate([mesh.points[mesh.triangles], midpoints[mesh.triangle_edges]], axis=1)


@lru_cache(maxsize=1)
def _at_nodes() -> Floats:
    """(direction, node, node) gradients at the nodes."""
    return np.ascontiguousarray(gradients(NODES).swapaxes(0, 1))


def gradients(barycentric: Floats) -> Floats:
    """(point, direction, node) gradients of L (2 L - 1) and 4 L L' along the edges 01 and 02."""
    along = np.array(
        [[-1.0, 1.0, 0.0], [-1.0, 0.0, 1.0]]
    )  # (direction, corner) of the barycentric coordinates
    i, j = EDGE_VERTICES.T
    at = barycentric[:, None, :]
    corner = (4 * at - 1) * along
    edge = 4 * (at[..., i] * along[:, j] + at[..., j] * along[:, i])
    return np.concatenate([corner, edge], axis=2)


def normals(nodes: Floats, barycentric: Floats) -> Floats:
    """(point, triangle, 3) normals, as long as twice the area of the triangle where it is flat and straight.

    Parameters
    ----------
    nodes : (triangle, 6, 3) array
    barycentric : (point, 3) array
    """
    tangents = np.einsum("pdn,tnx->dptx", gradients(barycentric), nodes)
    return cross(tangents[0], tangents[1])


def inside_out(mesh: Triangulation, midpoints: Floats) -> NDArray[np.int64]:
    """Triangles whose normal turns back at one of their nodes, the worst first."""
    x = node_points(mesh, midpoints)
    normal = cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    tangents = _at_nodes()[:, None] @ x  # (direction, triangle, node, 3)
    at_nodes = cross(tangents[0], tangents[1])
    # 1 for a flat triangle with straight edges
    worst = (at_nodes @ normal[..., None])[..., 0].min(axis=1) / (normal * normal).sum(axis=1)
    bad = (worst <= LEAST_NORMAL).nonzero()[0]
    return bad[worst[bad].argsort(kind="stable")]
