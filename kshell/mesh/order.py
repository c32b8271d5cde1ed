"""Vertices in spatial order: neighbours get near numbers, and everything that follows stays in the cache.

Mesh generators number vertices as they insert them, all over the plate. On a mesh of 250,000 vertices that makes
the assembly 1.3 times and the setup of multigrid 1.5 times slower.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.mesh import Group, Mesh
from kshell.mesh.triangulation import changed

BITS = 15  # of each coordinate
ASIDE = (
    0.382  # of a cell: regular meshes have vertices on the lines between cells, where rounding would decide
)


def spatial_order(points: NDArray[np.floating]) -> NDArray[np.int64]:
    """Points along Morton's curve, which visits a square quarter by quarter.

    Parameters
    ----------
    points : (n, 2 or more) float array
        The first two coordinates count.

    Returns
    -------
    (n,) int array, the numbers of the points in that order.
    """
    if len(points) == 0:
        return np.zeros(0, dtype=np.int64)
    xy = points[:, :2] - points[:, :2].min(axis=0)
    cells = (xy * ((2**BITS - 1) / max(float(xy.max()), 1e-300)) + ASIDE).astype(np.uint64)
    return np.argsort(_spread(cells[:, 0]) | (_spread(cells[:, 1]) << np.uint64(1)), kind="stable")


def _spread(bits: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """A zero put between all bits of numbers below 2^16."""
    for shift, mask in ((8, 0x00FF00FF), (4, 0x0F0F0F0F), (2, 0x33333333), (1, 0x55555555)):
        bits = (bits | (bits << np.uint64(shift))) & np.uint64(mask)
    return bits


def in_spatial_order(mesh: Mesh) -> tuple[Mesh, NDArray[np.int64]]:
    """The same mesh with vertices, triangles and edges numbered along Morton's curve.

    Returns
    -------
    mesh : Mesh
    order : (vertex,) int array
        The number that each vertex had before, so that new.points == old.points[order].
    """
    order = spatial_order(mesh.points)
    number = np.empty(len(order), dtype=np.int32)
    number[order] = np.arange(len(order), dtype=np.int32)
    renumbered = number[mesh.triangles]
    triangle_order = np.argsort(renumbered.min(axis=1), kind="stable")
    result = Mesh(mesh.points[order], renumbered[triangle_order], notes=mesh.notes, source=mesh.source)
    midpoints = None
    maps: list[NDArray[np.integer]] = [number, np.zeros(0, dtype=np.int32), np.argsort(triangle_order)]
    if mesh.midpoints is not None or any(group.dimension == 1 for group in mesh.groups.values()):
        maps[1] = result.edge_index(number[mesh.edges])
    if mesh.midpoints is not None:
        midpoints = np.empty_like(mesh.midpoints)
        midpoints[maps[1]] = mesh.midpoints
    groups = {
        name: Group(group.dimension, np.sort(maps[group.dimension][group.members]).astype(np.int32))
        for name, group in mesh.groups.items()
    }
    parts = None if mesh.parts is None else mesh.parts[triangle_order]
    return changed(result, midpoints=midpoints, groups=groups, higher=mesh.higher, parts=parts), order
