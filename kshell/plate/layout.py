"""Where the degrees of freedom of a plate live: first those of the vertices, then those of the edges.

Behind them come, where lines cross the plate at which second derivatives may jump, the second derivatives of the
further fans of vertices, and for the second side of curved lines inside a slope at the middle of its own chord.

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
from kshell.plate.fans import Fans, one_fan

Floats = NDArray[np.float64]
Ints64 = NDArray[np.int64]


class Layout:
    """Numbering and scaling of the degrees of freedom of an element on a mesh.

    Parameters
    ----------
    fans : Fans, optional
        Fans of the vertices; one each if not given.
    bent : (n,) int array, optional
        Curved edges inside, sorted, whose triangles have a slope each.
    """

    def __init__(
        self, mesh: Mesh, element: PlateElement, fans: Fans | None = None, bent: Ints64 | None = None
    ) -> None:
        self.mesh = mesh
        self.element = element
        self.per_vertex = len(element.vertex_powers)
        self.vertex_count = len(mesh.points)
        self.fans = one_fan(mesh) if fans is None or self.per_vertex == 1 else fans
        self.bent = np.zeros(0, dtype=np.int64) if bent is None or self.per_vertex == 1 else bent
        self.first_hessian = self.per_vertex * self.vertex_count + len(mesh.edges)
        self.first_side = self.first_hessian + 3 * self.fans.extra
        self.count = self.first_side + len(self.bent)

    def vertex_dofs(self, vertices: NDArray[np.integer]) -> NDArray[np.int64]:
        """(n, per_vertex) numbers of the degrees of freedom of vertices, of their first fans."""
        return self.per_vertex * np.asarray(vertices, dtype=np.int64)[:, None] + np.arange(self.per_vertex)

    def fan_dofs(self, fans: NDArray[np.integer]) -> NDArray[np.int64]:
        """(n, per_vertex) numbers of the degrees of freedom of fans; w and grad w are those of their vertices."""
        out = self.vertex_dofs(self.fans.vertex[fans])
        further = np.flatnonzero(fans >= self.vertex_count)
        if len(further):
            first = self.first_hessian + 3 * (fans[further] - self.vertex_count)
            out[further, 3:] = first[:, None] + np.arange(3)
        return out

    def edge_dofs(self, edges: NDArray[np.integer]) -> NDArray[np.int64]:
        """(n,) numbers of the degrees of freedom of edges."""
        return self.per_vertex * self.vertex_count + np.asarray(edges, dtype=np.int64)

    def triangle_dofs(self, triangles: NDArray[np.integer] | slice) -> NDArray[np.int64]:
        """(n, local) numbers of the degrees of freedom of triangles, vertices first."""
        corners = self.mesh.triangles[triangles]
        at_vertices = (
            self.fan_dofs(self.fans.corner[triangles].ravel())
            if self.fans.extra
            else self.vertex_dofs(corners.ravel())
        )
        at_edges = self.edge_dofs(self.mesh.triangle_edges[triangles])
        if len(self.bent):
            at_edges = np.where(self._second_side[triangles] >= 0, self._second_side[triangles], at_edges)
        return np.concatenate([at_vertices.reshape(len(corners), -1), at_edges], axis=1)

    @cached_property
    def _second_side(self) -> NDArray[np.int64]:
        """(triangle, 3) number of the slope of a triangle that is the second one at a curved edge inside, or -1."""
        edges = self.mesh.triangle_edges
        place = np.minimum(np.searchsorted(self.bent, edges), len(self.bent) - 1)
        owner = self.mesh.edge_owner[edges, 0] == np.arange(len(edges))[:, None]
        return np.where((self.bent[place] == edges) & ~owner, self.first_side + place, -1)

    @cached_property
    def node(self) -> NDArray[np.int64]:
        """(dof,) node of each degree of freedom: vertices first, then edges."""
        vertices = np.arange(self.vertex_count)
        return np.concatenate(
            [
                np.repeat(vertices, self.per_vertex),
                self.vertex_count + np.arange(len(self.mesh.edges)),
                np.repeat(self.fans.vertex[self.vertex_count :], 3),
                self.vertex_count + self.bent,
            ]
        )

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
        further = self.vertex_sizes[self.fans.vertex[self.vertex_count :]] ** -2
        lengths = self.mesh.edge_lengths
        return np.concatenate(
            [at_vertices.ravel(), 1.0 / lengths, np.repeat(further, 3), 1.0 / lengths[self.bent]]
        )
