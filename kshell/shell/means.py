"""Means of values at the corners of triangles, and the patches over which they are taken."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.connected import connected_parts
from kshell.mesh.mesh import Mesh

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


def patch_means(vertices: Ints, corner_angles: Floats, values: Floats, patches: Ints) -> Floats:
    """Mean of corner values at each vertex of each patch, by the angles of the triangles.

    Parameters
    ----------
    vertices : (triangle, 3) int array
        The corners of the triangles.
    corner_angles : (triangle, 3)
    values : (triangle, 3, n)
        At the corners.
    patches : (triangle,)

    Returns
    -------
    (triangle, 3, n), the mean at each corner.
    """
    key = patches.astype(np.int64)[:, None] * (int(vertices.max(initial=0)) + 1) + vertices
    _, place = np.unique(key.ravel(), return_inverse=True)
    weight = corner_angles.ravel()
    total = np.bincount(place, weights=weight)
    flat = values.reshape(len(place), -1)
    means = np.stack([np.bincount(place, weights=weight * column) / total for column in flat.T], axis=1)
    return means[place].reshape(values.shape)


def split_patches(mesh: Mesh, patches: Ints, lines: NDArray[np.bool_]) -> Ints:
    """(triangle,) the patches, cut along lines (edge,) of two triangles each that part them."""
    if not lines.any():
        return patches
    order = np.argsort(mesh.triangle_edges.ravel(), kind="stable")
    start = np.concatenate([[0], np.cumsum(mesh.edge_counts)[:-1]])
    edges = np.flatnonzero((mesh.edge_counts == 2) & ~lines)
    one, other = order[start[edges]] // 3, order[start[edges] + 1] // 3
    joined = patches[one] == patches[other]
    return connected_parts(len(mesh.triangles), one[joined], other[joined])[1]
