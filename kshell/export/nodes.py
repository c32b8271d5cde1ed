"""Triangles of order 2 with numbered nodes: what other programs call S6. Those of order 1 get nodes on their edges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kshell.mesh import quadratic
from kshell.mesh.mesh import Mesh

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

# 1/6, 4/6, 1/6 integrates cubics; forces on curves are smooth, so that is enough of them
SIMPSON = np.array([1.0, 4.0, 1.0]) / 6.0


@dataclass(frozen=True, eq=False)
class Nodes:
    """Nodes of a mesh: its vertices, then the middles of its edges.

    Attributes
    ----------
    mesh : Mesh
    points : (node, 3)
    triangles : (triangle, 6)
        Corners, and the nodes on the edges 01, 12, 02.
    """

    mesh: Mesh
    points: Floats
    triangles: Ints

    @classmethod
    def of(cls, mesh: Mesh) -> Nodes:
        """Of a mesh in space."""
        middles = mesh.points[mesh.edges].mean(axis=1) if mesh.midpoints is None else mesh.midpoints
        numbers = np.hstack([mesh.triangles, len(mesh.points) + mesh.triangle_edges])
        return cls(mesh, np.vstack([mesh.points, middles]), numbers)

    def on(self, dimension: int, members: Ints) -> Ints:
        """Nodes of vertices, edges or triangles."""
        if dimension == 0:
            return np.unique(members)
        if dimension == 1:
            return np.unique(
                np.concatenate([self.mesh.edges[members].ravel(), len(self.mesh.points) + members])
            )
        return np.unique(self.triangles[members])

    def edge(self, edges: Ints) -> Ints:
        """(edge, 3) ends and middle of edges: first, middle, last."""
        ends = self.mesh.edges[edges]
        return np.stack([ends[:, 0], len(self.mesh.points) + edges, ends[:, 1]], axis=1)

    def quadrature(self, triangles: Ints) -> tuple[Floats, Floats, Floats]:
        """Points (triangle, q, 3), unit normals and weights (triangle, q) with the area."""
        nodes = self.points[self.triangles[triangles]]
        points = np.einsum("qn,tnx->tqx", shapes(), nodes)
        normal = np.moveaxis(quadratic.normals(nodes, quadratic.RULE_POINTS), 0, 1)
        length = np.linalg.norm(normal, axis=2)
        return points, normal / length[..., None], 0.5 * length * quadratic.RULE_WEIGHTS


def shapes() -> Floats:
    """(q, 6) functions of triangles of order 2 at the points of the rule."""
    a, b, c = quadratic.RULE_POINTS.T
    return np.stack(
        [a * (2 * a - 1), b * (2 * b - 1), c * (2 * c - 1), 4 * a * b, 4 * b * c, 4 * a * c], axis=1
    )
