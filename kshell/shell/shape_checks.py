"""What is doubtful about the shape of a shell, with numbers and places: too thick, faceted, touching itself."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from kshell.mesh.facets import facets
from kshell.mesh.mesh import Mesh
from kshell.mesh.words import count, place
from kshell.section import Section

Floats = NDArray[np.float64]

# thin-shell theory neglects t / R against 1; beyond this part of the radius it says little
THICK = 0.5
# the search for triangles that cross each other looks at pairs, up to so many triangles
SEARCHED = 30_000
BESIDE = 1e-9  # barycentric coordinate below which a crossing is on the border


def shape_warnings(mesh: Mesh, discretisation: Any, section: Section) -> list[str]:
    """Warnings about the shape of a shell.

    Parameters
    ----------
    mesh : Mesh
        In space.
    discretisation : KoiterDiscretisation or ArgyrisDiscretisation
    section : Section
    """
    return [*_thick(mesh, discretisation, section), *_faceted(mesh), *_crossing(mesh)]


def _thick(mesh: Mesh, discretisation: Any, section: Section) -> list[str]:
    triangles = np.arange(len(mesh.triangles))
    centres = mesh.points[mesh.triangles].mean(axis=1)
    t = section.thickness(triangles, centres[:, None])[:, 0]
    curvature = discretisation.largest_curvature()
    worst = int(np.argmax(t * curvature))
    if t[worst] * curvature[worst] <= THICK:
        return []
    return [
        f"the shell is thick: at {place(centres[worst])} the thickness {t[worst]:.4g} is more than half of the radius "
        f"of curvature {1 / curvature[worst]:.4g}; a thin-shell model is not to be trusted there"
    ]


def _faceted(mesh: Mesh) -> list[str]:
    found = facets(mesh)
    if found is None:
        return []
    return [
        "the mesh has flat triangles (order 1) on a curved surface: neighbours meet at up to "
        f"{np.degrees(found.angle):.2g} degrees, e.g. at {place(found.at)}, and these facets limit the accuracy; mesh "
        "with order 2 (mesh_order = 2, in the .geo file Mesh.ElementOrder = 2), name the geometry it was made from "
        '(geometry = "shell.geo") or give the chart'
    ]


def _crossing(mesh: Mesh) -> list[str]:
    if len(mesh.triangles) > SEARCHED or np.ptp(mesh.points[:, 2]) == 0.0:
        return []
    edge, triangle, where = crossings(mesh)
    if not len(edge):
        return []
    return [
        f"the surface crosses itself at {count(len(np.unique(triangle)), 'triangle')}, e.g. at {place(where[0])}, "
        "without being joined there: the sheets pass through each other freely. If they should hold together, join "
        "them in the geometry (`BooleanFragments` in gmsh) and mesh again"
    ]


def crossings(mesh: Mesh) -> tuple[NDArray[np.integer], NDArray[np.integer], Floats]:
    """Edges that pierce triangles with which they share no vertex: edges, triangles, and places (n, 3)."""
    corners = mesh.points[mesh.triangles]
    centre = corners.mean(axis=1)
    radius = np.linalg.norm(corners - centre[:, None], axis=2).max(axis=1)
    ends = mesh.points[mesh.edges]
    middle, half = ends.mean(axis=1), 0.5 * mesh.edge_lengths
    pairs_edge, pairs_triangle = [], []
    # triangles by size, so that one large one does not widen the search around all
    level = np.floor(np.log2(radius / radius.min() + 1e-12)).astype(int)
    for k in np.unique(level):
        mine = np.flatnonzero(level == k)
        near = cKDTree(centre[mine]).query_ball_point(middle, half + radius[mine].max())
        pairs_edge.append(np.repeat(np.arange(len(near)), [len(n) for n in near]))
        pairs_triangle.append(mine[np.concatenate([np.asarray(n, dtype=np.int64) for n in near])])
    edge, triangle = np.concatenate(pairs_edge), np.concatenate(pairs_triangle)
    apart = ~(mesh.triangles[triangle][:, :, None] == mesh.edges[edge][:, None, :]).any(axis=(1, 2))
    edge, triangle = edge[apart], triangle[apart]
    # Moeller and Trumbore 1997: start + s along = a + u (b - a) + v (c - a)
    start, along = ends[edge, 0], ends[edge, 1] - ends[edge, 0]
    a, b, c = (corners[triangle, k] for k in range(3))
    p = np.cross(along, c - a)
    determinant = np.sum((b - a) * p, axis=1)
    size = np.linalg.norm(along, axis=1) * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    crossing = np.abs(determinant) > 1e-9 * size
    inverse = 1.0 / np.where(crossing, determinant, 1.0)
    offset = start - a
    u = np.sum(offset * p, axis=1) * inverse
    q = np.cross(offset, b - a)
    v = np.sum(along * q, axis=1) * inverse
    s = np.sum((c - a) * q, axis=1) * inverse
    for coordinate in (u, v, 1.0 - u - v, s, 1.0 - s):
        crossing &= coordinate > BESIDE
    return edge[crossing], triangle[crossing], (start + s[:, None] * along)[crossing]
