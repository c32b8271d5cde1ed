"""Nodes and unknowns of order p on a mesh of triangles.

Unknowns, in this order: three translations per node, then p rotations per edge, one at each of its Gauss
points. The rotation turns the director of the edge about its tangent, which runs from the vertex of lower
to that of higher index; all triangles at the edge share it, whether there are one, two or more.
A hinge gives every triangle at the edge rotations of its own.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.mesh.mesh import Mesh
from kshell.shell.reference import EDGES

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]


class NumberedMesh:
    """Numbers of the nodes and unknowns of order p on a mesh.

    Parameters
    ----------
    mesh : Mesh
    order : int
    hinges : (n,) int array
        Edges across which the sheets may turn freely.

    Attributes
    ----------
    node_count : int
    triangle_nodes : (triangle, n) node of each Lagrange node of the reference triangle
    edge_sign : (triangle, 3) +1 where the triangle walks the edge from the lower to the higher vertex
    rotation_edge : (triangle, 3) number of the set of p rotations
    rotation_owner : (rotation set,) the edge each set belongs to
    rotation_start : int
        The first unknown that is a rotation.
    unknowns : int
    triangle_unknowns : (triangle, 3 n + 3 p)
    """

    def __init__(self, mesh: Mesh, order: int, hinges: ArrayLike = ()) -> None:
        self.mesh = mesh
        self.order = order
        self._number_nodes()
        self._number_rotations(np.asarray(hinges, dtype=np.int64))

    def _number_nodes(self) -> None:
        mesh, p = self.mesh, self.order
        vertices, edges = len(mesh.points), len(mesh.edges)
        triangles = len(mesh.triangles)
        corner = mesh.triangles[:, EDGES]  # (triangle, edge, 2)
        self.edge_sign = np.where(corner[..., 0] < corner[..., 1], 1, -1).astype(np.int8)

        columns: list[NDArray[Any]] = [mesh.triangles[:, k] for k in range(3)]
        for edge in range(3):
            first = vertices + mesh.triangle_edges[:, edge].astype(np.int64) * (p - 1)
            ahead = self.edge_sign[:, edge] > 0
            columns += [first + np.where(ahead, k, p - 2 - k) for k in range(p - 1)]
        inner = (p - 1) * (p - 2) // 2
        start = vertices + edges * (p - 1)
        columns += [start + np.arange(triangles) * inner + k for k in range(inner)]
        self.triangle_nodes: Ints = np.stack(columns, axis=1).astype(np.int32)
        self.node_count = start + triangles * inner

    def _number_rotations(self, hinges: NDArray[np.int64]) -> None:
        mesh = self.mesh
        number = mesh.triangle_edges.astype(np.int64).copy()
        owner = [np.arange(len(mesh.edges))]
        hinged = np.isin(number, hinges)
        # the first triangle found at a hinge keeps the number of the edge, the others get new ones
        keeps = np.zeros_like(hinged)
        keeps[mesh.edge_owner[:, 0], mesh.edge_owner[:, 1]] = True
        extra = np.flatnonzero((hinged & ~keeps).ravel())
        owner.append(number.ravel()[extra])
        number.ravel()[extra] = len(mesh.edges) + np.arange(len(extra))
        self.rotation_owner: Ints = np.concatenate(owner).astype(np.int32)
        self._number_unknowns(number.astype(np.int32))

    def _number_unknowns(self, rotation_edge: Ints) -> None:
        """All unknowns of triangles, from their nodes and the numbers of the rotations of their edges."""
        p, triangles = self.order, len(self.triangle_nodes)
        self.rotation_edge = rotation_edge
        gauss = np.where(self.edge_sign[..., None] > 0, np.arange(p), np.arange(p)[::-1])
        # (triangle, 3 p): place of the edge point among all rotations, edges walked by the triangle
        self.triangle_rotations: Ints = (
            (p * self.rotation_edge[..., None] + gauss).reshape(triangles, 3 * p).astype(np.int32)
        )
        self.rotation_start = 3 * self.node_count
        self.unknowns = self.rotation_start + p * len(self.rotation_owner)
        # component by component: all x of the nodes of the triangle, then y, then z
        translations = (3 * self.triangle_nodes[:, None, :] + np.arange(3)[:, None]).reshape(triangles, -1)
        self.triangle_unknowns: Ints = np.concatenate(
            [translations, self.rotation_start + self.triangle_rotations], axis=1
        ).astype(np.int32)

    @property
    def inner_columns(self) -> NDArray[np.int64]:
        """(i,) columns of `triangle_unknowns` that belong to nodes inside triangles."""
        n = self.triangle_nodes.shape[1]
        return (n * np.arange(3)[:, None] + np.arange(3 * self.order, n)).ravel()

    def nodes_of_edges(self, edges: ArrayLike) -> Ints:
        """Nodes on edges, sorted, without repetition."""
        edges = np.asarray(edges, dtype=np.int64)
        vertices, p = len(self.mesh.points), self.order
        between = vertices + edges[:, None] * (p - 1) + np.arange(p - 1)
        return np.unique(np.concatenate([self.mesh.edges[edges].ravel(), between.ravel()])).astype(np.int32)

    def nodes_of_triangles(self, triangles: ArrayLike) -> Ints:
        """Nodes of triangles, sorted, without repetition."""
        return np.unique(self.triangle_nodes[np.asarray(triangles, dtype=np.int64)])

    def rotations_of_edges(self, edges: ArrayLike) -> Ints:
        """Unknown numbers of the rotations of edges, all sets at a hinge."""
        sets = np.flatnonzero(np.isin(self.rotation_owner, edges))
        return (
            (self.rotation_start + self.order * sets[:, None] + np.arange(self.order))
            .ravel()
            .astype(np.int32)
        )

    def split(self, x: Floats) -> tuple[Floats, Floats]:
        """Translations (node, 3) and rotations (rotation set, p) of a vector of unknowns."""
        return x[: self.rotation_start].reshape(-1, 3), x[self.rotation_start :].reshape(-1, self.order)
