"""Where the degrees of freedom of a plate live: first those of the vertices, then those of the edges.

The numbers stored are scaled: a derivative of order k is multiplied by h^k, with h the mean edge
length at a vertex or the length of an edge, so that all are of the size of a deflection and the
matrix is well balanced on graded meshes.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from kshell.elements.base import PlateElement
from kshell.mesh.mesh import Mesh

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]


class Layout:
    """Numbering and scaling of the degrees of freedom of an element on a mesh."""

    def __init__(self, mesh: Mesh, element: PlateElement) -> None:
        self.mesh = mesh
        self.element = element
        self.per_vertex = len(element.vertex_powers)
        self.vertex_count = len(mesh.points)
        self.count = self.per_vertex * self.vertex_count + len(mesh.edges)

    def vertex_dofs(self, vertices: NDArray[np.integer]) -> NDArray[np.int64]:
        """(n, per_vertex) numbers of the degrees of freedom of vertices."""
        return self.per_vertex * np.asarray(vertices, dtype=np.int64)[:, None] + np.arange(self.per_vertex)

    def edge_dofs(self, edges: NDArray[np.integer]) -> NDArray[np.int64]:
        """(n,) numbers of the degrees of freedom of edges."""
        return self.per_vertex * self.vertex_count + np.asarray(edges, dtype=np.int64)

    def triangle_dofs(self, triangles: NDArray[np.integer] | slice) -> NDArray[np.int64]:
        """(n, local) numbers of the degrees of freedom of triangles, vertices first."""
        corners = self.mesh.triangles[triangles]
        at_vertices = self.vertex_dofs(corners.ravel()).reshape(len(corners), -1)
        return np.concatenate([at_vertices, self.edge_dofs(self.mesh.triangle_edges[triangles])], axis=1)

    @cached_property
    def vertex_sizes(self) -> Floats:
        """(vertex,) mean length of the edges at a vertex."""
        ends = self.mesh.edges.ravel()
        total = np.bincount(ends, np.repeat(self.mesh.edge_lengths, 2), self.vertex_count)
        return total / np.maximum(np.bincount(ends, minlength=self.vertex_count), 1)

    @cached_property
    def scale(self) -> Floats:
        """(dof,) physical value = scale times stored number."""
        powers = np.array(self.element.vertex_powers)
        at_vertices = self.vertex_sizes[:, None] ** -powers
        return np.concatenate([at_vertices.ravel(), 1.0 / self.mesh.edge_lengths])
