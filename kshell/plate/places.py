"""Places of a plate in space, and the triangles its vertices belong to."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.mesh import Mesh
from kshell.plate.domain import Domain
from kshell.scene.loads import Load

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def points_3d(domain: Domain, xy: Floats) -> Floats:
    """Points (..., 2) of the plane of the mesh as (..., 3), for functions of the place."""
    z = np.broadcast_to(domain.mesh.points[0, 2], (*xy.shape[:-1], 1))
    return np.concatenate([xy, z], axis=-1)


def places_of(load: Load, domain: Domain, xy: Floats) -> Floats:
    """What the values of a load are asked at: points (..., 3), with the normal z (..., 6) where they depend on it."""
    points = points_3d(domain, xy)
    if not load.needs_normal:
        return points
    return np.concatenate([points, np.broadcast_to([0.0, 0.0, 1.0], points.shape)], axis=-1)


def first_triangles(mesh: Mesh, vertices: Ints) -> tuple[Ints, Ints]:
    """One triangle at each vertex, and the vertex's place in it."""
    flat = mesh.triangles.ravel()
    first = np.full(len(mesh.points), -1, dtype=np.int64)
    first[flat[::-1]] = np.arange(len(flat))[::-1]
    return first[vertices] // 3, first[vertices] % 3
