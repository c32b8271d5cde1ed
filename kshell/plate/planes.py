"""Deflections of triangles less the planes through their vertices: what bends them, without what rounds.

The curvature of a smooth deflection makes up h^2 of the differences between its values. A plane bends nothing; taken
off beforehand it leaves products that are as accurate as the curvatures.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.plate.domain import Domain
from kshell.plate.layout import Layout

Floats = NDArray[np.floating[Any]]


def less_planes(domain: Domain, layout: Layout, triangles: NDArray[np.integer], d: Floats) -> Floats:
    """(n, local) physical degrees of freedom of some triangles, from all (dof,), less the planes."""
    return take_planes_off(domain, layout, triangles, d[layout.triangle_dofs(triangles)])


def take_planes_off(domain: Domain, layout: Layout, triangles: NDArray[np.integer], local: Floats) -> Floats:
    """The same in place, from those of the triangles (n, local)."""
    mesh, step = domain.mesh, layout.per_vertex
    slope = plane_slopes(domain.points[mesh.triangles[triangles]], local[:, : 3 * step : step])
    local[:, : 3 * step : step] = 0.0
    if step > 1:
        for k in range(3):
            local[:, k * step + 1 : k * step + 3] -= slope
    edges = mesh.triangle_edges[triangles]
    vector = domain.points[mesh.edges[edges, 1]] - domain.points[mesh.edges[edges, 0]]
    across = vector[..., 1] * slope[:, None, 0] - vector[..., 0] * slope[:, None, 1]
    local[:, 3 * step :] -= across / mesh.edge_lengths[edges]
    return local


def plane_slopes(corners: Floats, values: Floats) -> Floats:
    """Gradients (n, xy) of the planes through values (n, 3) at corners (n, 3, xy)."""
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    u, v = values[:, 1] - values[:, 0], values[:, 2] - values[:, 0]
    twice_area = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return np.stack([u * b[:, 1] - v * a[:, 1], v * a[:, 0] - u * b[:, 0]], axis=1) / twice_area[:, None]
