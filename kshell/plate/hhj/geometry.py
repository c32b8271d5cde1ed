"""Straight triangles as this element sees them: vertices in ascending order, strains in one product.

With the vertices of every triangle in ascending order its local edges (0, 1), (1, 2), (0, 2) all run from the lower to
the higher vertex, as the edges of the mesh do, and neighbours agree on all polynomials along an edge without any sign.

Symbols
-------
J          |det| of the affine map, h its inverse (rows: reference coordinates), both relative to vertex 0
n, len     unit normal of an edge, its tangent turned by -90 degrees, and its length
s          +1 where n points out of the triangle, -1 elsewhere
B          factor of the stiffness, C = B^T B
l          scaled strains, energy = |l|^2 / 2, moments m = B^T l / sqrt(J):

    l_vk = sqrt(J) B [ int_T psi_k w'' - 1/J sum_E s nn len int_E psi_k (dw/dn - alpha / len) ds ],  nn = n (x) n
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.mesh import EDGE_VERTICES, Mesh
from kshell.plate.domain import Domain

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# the local edge between two local vertices, by the vertex that is not on it
FACING = np.array([1, 2, 0])
FIRST, SECOND = EDGE_VERTICES.T
TURN = np.array([1.0, -1.0])  # of components in reverse: by -90 degrees
WALKED = np.array([1.0, 1.0, -1.0])  # sense of the edges where a triangle is walked around
GRADIENTS = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])  # of the hats on the reference triangle


class Triangles:
    """The triangles of a flat mesh.

    Parameters
    ----------
    mesh : Mesh
    domain : Domain, optional
        With the true shape of curved edges; without it all edges are their chords.

    Attributes
    ----------
    order : (T, 3) int array
        The place in the mesh's own triangle of each of the sorted vertices.
    corners : (T, 3) int array
        Vertices in ascending order.
    edges : (T, 3) int array
        Edges of the mesh between the sorted vertices 0 1, 1 2, 0 2.
    local : (T, 3) int array
        The place that local edges of the mesh's own triangles have here.
    origin : (T, 2), inverse : (T, 2, 2), area : (T,) twice the area J
    lengths : (T, 3), normals : (T, 3, 2), outward : (T, 3) s
    """

    def __init__(self, mesh: Mesh, domain: Domain | None = None) -> None:
        self.mesh, self.domain = mesh, domain
        order = self.order = mesh.triangles.argsort(axis=1)
        row = np.arange(len(order))[:, None]
        self.corners: Ints = mesh.triangles[row, order].astype(np.int64)
        own = FACING[3 - order[:, FIRST] - order[:, SECOND]]  # the mesh's local edge at each place here
        self.edges: Ints = mesh.triangle_edges[row, own].astype(np.int64)
        self.local: Ints = own.argsort(axis=1)
        x = mesh.points[self.corners, :2]
        self.origin = x[:, 0]
        d = x[:, SECOND] - x[:, FIRST]  # (T, edge, xy)
        a, b = d[:, 0], d[:, 2]
        signed = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
        self.area = np.abs(signed)
        h = np.empty((len(x), 2, 2))
        h[:, 0, 0], h[:, 0, 1], h[:, 1, 0], h[:, 1, 1] = b[:, 1], -b[:, 0], -a[:, 1], a[:, 0]
        self.inverse = h / signed[:, None, None]
        self.sides = d[:, ::2].swapaxes(1, 2)  # columns: the map x = origin + sides xi
        self.lengths = np.sqrt((d * d).sum(axis=2))
        self.normals = d[..., ::-1] * TURN / self.lengths[..., None]
        self.outward = np.sign(signed)[:, None] * WALKED

    def __len__(self) -> int:
        return len(self.corners)

    def xy(self, xi: Floats, chosen: Any = slice(None)) -> Floats:
        """(T, point, 2) places of reference points (point, 2) or (T, point, 2)."""
        return self.origin[chosen][:, None] + xi @ self.sides[chosen].swapaxes(1, 2)

    def reference(self, xy: Floats, chosen: Any) -> Floats:
        """Reference coordinates of points (n, point, 2) in some triangles."""
        return (xy - self.origin[chosen][:, None]) @ self.inverse[chosen].swapaxes(1, 2)

    @cached_property
    def curvature_map(self) -> Floats:
        """(T, 3, 3) from second derivatives 11, 22, 12 on the reference triangle to (w_xx, w_yy, 2 w_xy)."""
        a, b = self.inverse[:, 0, 0], self.inverse[:, 0, 1]
        c, d = self.inverse[:, 1, 0], self.inverse[:, 1, 1]
        out = np.empty((len(self), 3, 3))
        out[:, 0, 0], out[:, 0, 1], out[:, 0, 2] = a * a, c * c, 2 * a * c
        out[:, 1, 0], out[:, 1, 1], out[:, 1, 2] = b * b, d * d, 2 * b * d
        out[:, 2, 0], out[:, 2, 1], out[:, 2, 2] = 2 * a * b, 2 * c * d, 2 * (a * d + b * c)
        return out

    def strain_map(self, factor: Floats) -> Floats:
        """(T, 3, 12) from reference strains (`Tables.rows`) to l, for stiffness factors B (T, 3, 3) or (3, 3)."""
        root = np.sqrt(self.area)[:, None, None]
        out = np.empty((len(self), 3, 12))
        out[..., :3] = (factor @ self.curvature_map) * root
        nx, ny = self.normals[..., 0], self.normals[..., 1]
        outer = np.empty((len(self), 3, 3))  # (T, component, edge)
        outer[:, 0], outer[:, 1], outer[:, 2] = nx * nx, ny * ny, 2 * nx * ny
        slope = (factor @ outer) * (self.outward[:, None] / root)
        across = self.lengths[..., None] * (
            self.normals @ self.inverse.swapaxes(1, 2)
        )  # (T, edge, reference)
        out[..., 3:9] = (slope[..., None] * across[:, None]).reshape(len(self), 3, 6)
        out[..., 9:] = slope
        return out

    @cached_property
    def plane_slopes(self) -> Floats:
        """(T, edge, vertex): length times normal derivative of the hats, the slopes of an affine deflection."""
        gradient = GRADIENTS @ self.inverse  # (T, vertex, xy)
        return self.lengths[..., None] * (self.normals @ gradient.swapaxes(1, 2))
