"""The direction in which a surface leaves a straight line, from its shape and nothing else.

A straight line lies in many planes, so the plane of symmetry through it follows from the surface: from the formulas of
its chart, or, where it has none, from quadrics fitted to the vertices around those on the line, which are exact on
planes, cylinders, cones and all other surfaces of second degree however coarse the triangles are. Where they do not
fit, as at the flat sides of a prism, the triangles themselves say it. No coordinate axis takes part.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.mesh.curving.fits import QUADRIC, Fits, Neighbourhoods
from kshell.mesh.curving.sheets import find_sheets
from kshell.mesh.higher import higher_nodes, order_of
from kshell.mesh.triangulation import Triangulation
from kshell.shell.koiter.edges import first_triangle
from kshell.shell.koiter.surface import Surface
from kshell.shell.reference import lattice
from kshell.shell.vectors import cross, norm

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

RINGS = 4  # of triangles around the line that are looked at
CREASE = np.radians(30.0)  # from which neighbours belong to different surfaces
FITTED = 1e-3  # distance from the quadric, over the size of the neighbourhood, up to which it says more than triangles


def edge_conormals(surface: Surface, edges: ArrayLike) -> Floats:
    """Unit vectors in the surface, across the edge and outwards from the first triangle: (n, p, 3)."""
    p = surface.order
    edges = np.asarray(edges, dtype=np.int64)
    place = first_triangle(surface).reshape(-1, p)[edges]
    triangles, number = np.unique(place // (3 * p), return_inverse=True)
    x1, x2 = surface.tangents(surface.reference.edge_first, triangles)
    t = surface.reference.edge_tangents
    result = cross(x1 * t[:, 0] + x2 * t[:, 1], cross(x1, x2))
    local = 3 * p * number.reshape(place.shape) + place % (3 * p)
    return np.moveaxis((result / norm(result)).reshape(3, -1)[:, local], 0, 2)


def across_line(surface: Surface, edges: ArrayLike) -> Floats:
    """(3,) unit direction in the surface at right angles to edges that form a straight line, in the mean."""
    edges = np.asarray(edges, dtype=np.int64)
    vertices = np.unique(surface.mesh.edges[edges])
    x = surface.nodes[vertices]
    line = np.linalg.svd(x - x.mean(axis=0), full_matrices=False)[2][0]
    normals = surface.exact_normals(vertices)
    if normals is None:
        normals = _fitted_normals(surface, vertices)
    directions = edge_conormals(surface, edges).reshape(-1, 3) if normals is None else np.cross(line, normals)
    mean: Floats = np.linalg.svd(directions, full_matrices=False)[2][0]
    mean = mean - line * (line @ mean)
    return mean / np.linalg.norm(mean)


def _fitted_normals(surface: Surface, vertices: Ints) -> Floats | None:
    """(n, 3) normals of quadrics at those vertices that they fit; None where they fit none."""
    points, triangles = _around(surface, vertices)
    used, local = np.unique(triangles, return_inverse=True)
    part = Triangulation(points[used], local.reshape(-1, 3).astype(np.int32))
    sheets = find_sheets(part, CREASE)
    wanted = np.flatnonzero(np.isin(used[sheets.vertex], vertices))
    near = Neighbourhoods(part.points, sheets)
    fits = Fits(near, QUADRIC)
    fits.fit(wanted)
    fit = fits.determined[wanted] & (fits.residual[wanted] <= FITTED * fits.length[wanted])
    good = wanted[fit]
    return fits.normals(good) if len(good) else None


def _around(surface: Surface, vertices: Ints) -> tuple[Floats, Ints]:
    """Nodes of the surface, and the triangles between them within some rings of the given vertices."""
    mesh = surface.mesh
    inside = np.zeros(len(mesh.points), dtype=bool)
    inside[vertices] = True
    for _ in range(RINGS):
        near = inside[mesh.triangles].any(axis=1)
        inside[mesh.triangles[near]] = True
    if surface.nodes is not surface.flat_nodes:  # all nodes lie on the true surface
        return surface.nodes, surface.triangle_nodes[near][:, _parts(surface.order)].reshape(-1, 3)
    own = higher_nodes(mesh)
    if own is not None:
        places, number = np.unique(own[near].reshape(-1, 3), axis=0, return_inverse=True)
        # vertices keep their numbers
        points = np.concatenate([mesh.points, places])
        own_nodes: Ints = len(mesh.points) + number.reshape(own[near].shape[:2]).astype(np.int64)
        own_nodes[:, :3] = mesh.triangles[near]
        return points, own_nodes[:, _parts(order_of(mesh))].reshape(-1, 3)
    points, nodes = mesh.points, mesh.triangles[near]
    if mesh.midpoints is not None:
        points = np.concatenate([points, mesh.midpoints])
        nodes = np.concatenate([nodes, mesh.triangle_edges[near] + len(mesh.points)], axis=1)
    return points, nodes[:, _parts(mesh.order)].reshape(-1, 3)


def _parts(order: int) -> Ints:
    """(order^2, 3) small triangles between the Lagrange nodes of a triangle."""
    grid = np.rint(order * lattice(order)).astype(int).tolist()
    at = {(i, j): k for k, (i, j) in enumerate(grid)}
    upright = [[at[i, j], at[i + 1, j], at[i, j + 1]] for i, j in at if i + j < order]
    turned = [[at[i + 1, j], at[i + 1, j + 1], at[i, j + 1]] for i, j in at if i + j < order - 1]
    return np.array(upright + turned)
