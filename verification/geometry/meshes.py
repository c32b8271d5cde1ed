"""Families of triangle meshes of surfaces whose curvature is known."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

import kshell.geometry as g
from kshell.mesh.mesh import Mesh

Floats = NDArray[np.float64]


def mesh_of(points: Floats, triangles: NDArray[np.integer]) -> Mesh:
    """A mesh without groups."""
    return Mesh(np.asarray(points, dtype=np.float64), np.asarray(triangles, dtype=np.int32))


@dataclass(frozen=True)
class TorusMesh:
    """A mesh of the torus R = 2, r = 1 with the exact geometry at its vertices, edges and triangles.

    Attributes
    ----------
    n : int
        Cells around the tube, half as many as around the axis.
    pattern : str
        "diagonal" (valence 6), "crossed" (valences 4 and 8) or "alternate" (4 and 8 in another order).
    shake : float
        Part of a cell by which vertices are moved at random along the surface.
    """

    n: int
    pattern: str = "diagonal"
    shake: float = 0.0

    @property
    def torus(self) -> g.Chart:
        """The chart."""
        return g.Torus(2, 1)

    @cached_property
    def _regular(self) -> Mesh:
        return self.torus.mesh(2 * self.n, self.n, order=1, pattern=self.pattern)

    @cached_property
    def parameters(self) -> tuple[Floats, Floats]:
        """u and v of the vertices."""
        u, v = parameters_on_torus(self._regular.points)
        random = np.random.default_rng(self.n)
        cell = 2 * np.pi / self.n
        u = u + self.shake * cell / 2 * random.uniform(-1, 1, u.shape)
        v = v + self.shake * cell * random.uniform(-1, 1, v.shape)
        return u, v

    @cached_property
    def mesh(self) -> Mesh:
        """The triangles, normals inward."""
        return mesh_of(self.torus(*self.parameters), self._regular.triangles)

    @cached_property
    def at_vertices(self) -> g.SurfacePoint:
        """The exact geometry at the vertices."""
        return self.torus.at(*self.parameters)

    @cached_property
    def at_triangles(self) -> g.SurfacePoint:
        """The exact geometry nearest to the triangle centres."""
        return self.torus.at(*parameters_on_torus(self.mesh.points[self.mesh.triangles].mean(axis=1)))

    @cached_property
    def edge_normals(self) -> Floats:
        """(edge, 3) exact normals nearest to the middles of the edges."""
        middle = self.mesh.points[self.mesh.edges].mean(axis=1)
        return self.torus.at(*parameters_on_torus(middle)).normal


def parameters_on_torus(points: Floats) -> tuple[Floats, Floats]:
    """u and v of the nearest points of the torus R = 2."""
    x, y, z = points.T
    return np.arctan2(y, x), np.arctan2(-z, np.hypot(x, y) - 2)


def random_sphere(n: int, seed: int, radius: float = 1.0) -> Mesh:
    """The Delaunay triangulation of random points on a sphere, normals inward."""
    from scipy.spatial import ConvexHull

    x = np.random.default_rng(seed).normal(size=(n, 3))
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    t = ConvexHull(x).simplices
    a, b, c = (x[t[:, k]] for k in range(3))
    outward = np.sum(np.cross(b - a, c - a) * a, axis=1) > 0
    t[outward] = t[outward][:, ::-1]
    return mesh_of(radius * x, t)


def lantern(n: int, bands: int) -> Mesh:
    """Schwarz's lantern in the cylinder of radius and height 1: bands of 2 n triangles, every other one turned."""
    j, i = np.meshgrid(np.arange(bands + 1), np.arange(n), indexing="ij")
    angle = 2 * np.pi * (i + 0.5 * (j % 2)) / n
    points = np.stack([np.cos(angle), np.sin(angle), j / bands], axis=-1).reshape(-1, 3)
    b, p = j[:-1], i[:-1]
    low_p, low_q = b * n + p, b * n + (p + 1) % n
    high_p, high_q = low_p + n, low_q + n
    even = np.moveaxis([[low_p, low_q, high_p], [low_q, high_q, high_p]], (0, 1), (2, 3))
    odd = np.moveaxis([[low_p, high_q, high_p], [low_p, low_q, high_q]], (0, 1), (2, 3))
    return mesh_of(points, np.where((b % 2 == 0)[..., None, None], even, odd).reshape(-1, 3))


def vertex_ring(n: int, k1: float, k2: float, turn: float, eta: float) -> Mesh:
    """A vertex of valence n on z = (k1 x^2 + k2 y^2)/2, its neighbours equally spaced at the distance eta."""
    angle = turn + 2 * np.pi * np.arange(n) / n
    x, y = np.cos(angle), np.sin(angle)
    r = np.full(n, eta)
    for _ in range(30):  # the distance in space is eta
        z = 0.5 * (k1 * (r * x) ** 2 + k2 * (r * y) ** 2)
        r = r * eta / np.hypot(r, z)
    z = 0.5 * (k1 * (r * x) ** 2 + k2 * (r * y) ** 2)
    points = np.vstack([[0, 0, 0], np.stack([r * x, r * y, z], axis=1)])
    return mesh_of(points, np.array([[0, 1 + i, 1 + (i + 1) % n] for i in range(n)]))
