"""Normals at the vertices of a part of a mesh, for values that depend on them where no element is at hand."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.mesh import Mesh

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


def with_normals(mesh: Mesh, triangles: Ints) -> Floats:
    """(n, 6) vertices of triangles with unit normals: means over the triangles around, by area.

    A vertex at which they cancel has that of one of its triangles.
    """
    corners = mesh.triangles[triangles]
    x = mesh.points[corners]
    area = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    vertices, place = np.unique(corners, return_inverse=True)
    place = place.reshape(corners.shape)
    total = np.zeros((len(vertices), 3))
    np.add.at(total, place.ravel(), np.repeat(area, 3, axis=0))
    one = np.empty_like(total)
    one[place.ravel()] = np.repeat(area, 3, axis=0)
    length = np.linalg.norm(total, axis=1, keepdims=True)
    lost = length <= 1e-9 * np.linalg.norm(one, axis=1, keepdims=True)
    total = np.where(lost, one, total)
    return np.hstack([mesh.points[vertices], total / np.linalg.norm(total, axis=1, keepdims=True)])


def beside(mesh: Mesh, triangles: Ints, points: Floats) -> Floats:
    """(n, 6) points with the normals of the nearest vertices of triangles."""
    known = with_normals(mesh, triangles)
    from scipy.spatial import cKDTree

    _, nearest = cKDTree(known[:, :3]).query(points)
    return np.hstack([points, known[nearest, 3:]])
