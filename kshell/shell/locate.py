"""The nearest point of a surface of triangles of order 1 or 2 to a point in space."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from kshell.mesh.mesh import Mesh
from kshell.shell.reference import EDGES, VERTICES, first_derivatives, lagrange

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

CANDIDATES = 12  # triangles looked at per point, nearest centroids first
STEPS = 30
INSIDE = -1e-9  # smallest barycentric coordinate of a point of a triangle


class Nearest(NamedTuple):
    """Points of a surface.

    Attributes
    ----------
    triangles : (n,)
    xi : (n, 2) reference coordinates
    x : (n, 3)
    distance : (n,) from the points asked for
    """

    triangles: Ints
    xi: Floats
    x: Floats
    distance: Floats


class Locator:
    """Nearest points on a mesh in space."""

    def __init__(self, mesh: Mesh) -> None:
        self.order = mesh.order
        nodes = mesh.points[mesh.triangles]
        if mesh.midpoints is not None:
            nodes = np.concatenate([nodes, mesh.midpoints[mesh.triangle_edges]], axis=1)
        self.nodes = nodes
        self.tree = cKDTree(mesh.points[mesh.triangles].mean(axis=1))
        self.vertices = cKDTree(mesh.points)
        self.mesh = mesh
        self._last: tuple[Floats, Nearest] | None = None

    def find(self, points: Floats) -> Nearest:
        """The nearest points to (n, 3) points; asked again for the same ones, as along a path, it knows them."""
        if self._last is None or not np.array_equal(self._last[0], points):
            self._last = points.copy(), self._find(points)
        return self._last[1]

    def _find(self, points: Floats) -> Nearest:
        candidates = [self._candidates(point) for point in points]
        which = np.repeat(np.arange(len(points)), [len(c) for c in candidates])
        triangle = np.concatenate(candidates)
        xi, x = self._feet(triangle, points[which])
        distance = np.linalg.norm(x - points[which, None], axis=2)  # (pair, foot)
        foot = distance.argmin(axis=1)
        pair = np.arange(len(which))
        order = np.lexsort((distance[pair, foot], which))
        first = order[np.searchsorted(which[order], np.arange(len(points)))]
        f = foot[first]
        return Nearest(triangle[first], xi[first, f], x[first, f], distance[first, f])

    def _candidates(self, point: Floats) -> Ints:
        """Triangles around the nearest vertex and those with the nearest centroids."""
        _, near = self.tree.query(point, k=min(CANDIDATES, len(self.nodes)))
        _, vertex = self.vertices.query(point)
        around = np.flatnonzero((self.mesh.triangles == vertex).any(axis=1))
        return np.unique(np.concatenate([np.atleast_1d(near), around])).astype(np.int64)

    def _feet(self, triangles: Ints, points: Floats) -> tuple[Floats, Floats]:
        """Reference coordinates (n, 4, 2) and points (n, 4, 3): inside each triangle, and on its edges."""
        nodes = self.nodes[triangles]
        start = np.full((len(triangles), 2), 1 / 3)
        inside = self._descend(nodes, points, start, np.eye(2))
        smallest = np.minimum(inside.min(axis=1), 1 - inside.sum(axis=1))
        inside = np.where((smallest >= INSIDE)[:, None], inside, VERTICES[0])
        feet = [inside]
        for a, b in EDGES:
            along = (VERTICES[b] - VERTICES[a])[None]
            feet.append(
                self._descend(nodes, points, np.tile(VERTICES[[a, b]].mean(axis=0), (len(points), 1)), along)
            )
        xi = np.stack(feet, axis=1)
        return xi, np.einsum("nfk,nkx->nfx", lagrange(self.order, xi), nodes)

    def _descend(self, nodes: Floats, points: Floats, xi: Floats, directions: Floats) -> Floats:
        """Gauss-Newton along directions (k, 2) of the reference triangle; one direction stays on its edge."""
        for _ in range(STEPS):
            shape = lagrange(self.order, xi)
            off = points - np.einsum("nk,nkx->nx", shape, nodes)
            first = first_derivatives(self.order, xi)  # (2, n, k)
            tangents = np.einsum("da,ank,nkx->ndx", directions, first, nodes)
            gram = tangents @ tangents.swapaxes(1, 2)
            gram += 1e-14 * np.trace(gram, axis1=1, axis2=2)[:, None, None] * np.eye(len(directions))
            step = np.linalg.solve(gram, (tangents @ off[:, :, None]))[..., 0]
            xi = np.clip(xi + np.clip(step, -0.5, 0.5) @ directions, -0.5, 1.5)
            if len(directions) == 1:
                xi = self._onto_edge(xi, directions[0])
            if np.abs(step).max(initial=0.0) < 1e-14:
                break
        return xi

    @staticmethod
    def _onto_edge(xi: Floats, along: Floats) -> Floats:
        """Back onto the edge of the reference triangle that runs along a direction."""
        for a, b in EDGES:
            if np.allclose(VERTICES[b] - VERTICES[a], along):
                s = np.clip((xi - VERTICES[a]) @ along / (along @ along), 0.0, 1.0)
                return VERTICES[a] + s[:, None] * along
        raise ValueError("not the direction of an edge")
