"""What is doubtful about the shape of a shell, with numbers and places: too thick or thin, faceted, touching itself."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kshell.material.section import Section
from kshell.mesh.facets import facets
from kshell.mesh.mesh import Mesh
from kshell.mesh.near import in_balls
from kshell.mesh.vectors import cross
from kshell.mesh.words import count, place
from kshell.shell.discretisation import Discretisation
from kshell.shell.limits import THINNEST

Floats = NDArray[np.float64]

# thin-shell theory neglects t / R against 1; beyond this part of the radius it says little
THICK = 0.5
# thickness against the size below which triangles of order 1 lock where they are irregular
THINNEST_LINEAR = 1e-3
# sine of the angle between triangles of a flat shell: rounding
FLAT = 1e-6
# the search for triangles that cross each other looks at pairs, up to so many triangles
SEARCHED = 30_000
ON_TRIANGLE = 1e-6  # distance from a triangle, in its size, that is none
ROUNDED = 1e-6  # of a tolerance
BESIDE = 1e-9  # barycentric coordinate below which a crossing is on the border


def shape_warnings(mesh: Mesh, discretisation: Discretisation, section: Section) -> list[str]:
    """Warnings about the shape of a shell.

    Parameters
    ----------
    mesh : Mesh
        In space.
    discretisation : KoiterDiscretisation or ArgyrisDiscretisation
    section : Section
    """
    return [
        *_thick(mesh, discretisation, section),
        *_locking(mesh, discretisation, section),
        *_faceted(mesh),
        *_crossing(mesh),
    ]


def _thick(mesh: Mesh, discretisation: Discretisation, section: Section) -> list[str]:
    t = section.thickness_per_triangle
    curvature = discretisation.largest_curvature()
    worst = int(np.argmax(t * curvature))
    if t[worst] * curvature[worst] <= THICK:
        return []
    centre = mesh.points[mesh.triangles[worst]].mean(axis=0)
    return [
        f"the shell is thick: at {place(centre)} the thickness {t[worst]:.4g} is more than half of the radius "
        f"of curvature {1 / curvature[worst]:.4g}; a thin-shell model is not to be trusted there"
    ]


def _locking(mesh: Mesh, discretisation: Discretisation, section: Section) -> list[str]:
    """Elements that cannot bend a thin curved shell without stretching it; taken only where they were asked for."""
    argyris = discretisation.name == "argyris"
    if not argyris and discretisation.order > 1:
        return []
    if mesh.curving is not None and mesh.curving.order == 1:
        return []  # what the vertices do not tell is worse, and said
    t = float(section.thickness_per_triangle.min())
    size = float(np.linalg.norm(np.ptp(mesh.points, axis=0)))
    if t >= (THINNEST if argyris else THINNEST_LINEAR) * size:
        return []
    corners = mesh.points[mesh.triangles]
    normal = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    if np.linalg.norm(cross(normal, normal[0]), axis=1).max() < FLAT:
        return []
    what, instead = (
        ('element = "argyris" on a chart', 'leave element out or take "koiter"')
        if argyris
        else ("order = 1 on irregular triangles", "leave order out or take 2 or 3")
    )
    return [
        f"the shell is thin, {t:.3g} at a size of {size:.3g}: {what} is too stiff then, because it cannot bend without "
        f"stretching (membrane locking); {instead}"
    ]


def _faceted(mesh: Mesh) -> list[str]:
    if mesh.curving is not None:  # looked at when the scene read its mesh
        return list(mesh.curving.warnings)
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
    join = (
        "If they should hold together, join them in the geometry (`BooleanFragments` in gmsh, `Coherence;` in a .geo "
        "file) and mesh again"
    )
    out = []
    edge, triangle, where = crossings(mesh)
    if len(edge):
        out.append(
            f"the surface crosses itself at {count(len(np.unique(triangle)), 'triangle')}, e.g. at {place(where[0])}, "
            f"without being joined there: the sheets pass through each other freely. {join}"
        )
    vertex, triangle = contacts(mesh)
    if len(vertex):
        out.append(
            f"the surface touches itself without being joined: {count(len(np.unique(vertex)), 'vertex', 'vertices')} "
            f"lie on triangles they do not belong to, e.g. the one at {place(mesh.points[vertex[0]])}: the sheets move "
            f"apart freely there. {join}"
        )
    return out


def contacts(mesh: Mesh) -> tuple[NDArray[np.integer], NDArray[np.integer]]:
    """Vertices that lie on triangles they do not belong to: vertices (n,) and triangles (n,).

    Vertices on the boundary of the other sheet are left out: when the mesh was read they were found to be sides of a
    slit. On a curved triangle a vertex lies if it is no farther from its chord plane than the mid-edge nodes.
    """
    corners = mesh.points[mesh.triangles]
    near, triangle = _near(corners, mesh.points, np.zeros(len(mesh.points)))
    tolerance = ON_TRIANGLE * np.sqrt(2.0 * mesh.areas)
    if mesh.midpoints is not None:
        bulge = np.linalg.norm(mesh.midpoints - mesh.points[mesh.edges].mean(axis=1), axis=1)
        tolerance = tolerance + bulge[mesh.triangle_edges].max(axis=1)
    apart = np.abs(_heights(corners, mesh.points, (near,), triangle)[0]) <= tolerance[triangle] * (
        1 + ROUNDED
    )
    near, triangle = near[apart], triangle[apart]
    apart = ~_is_corner(mesh.triangles, near, triangle)
    near, triangle = near[apart], triangle[apart]
    a, b, c = (corners[triangle, k] for k in range(3))
    normal = cross(b - a, c - a)
    twice = np.linalg.norm(normal, axis=1)
    offset = mesh.points[near] - a
    height = np.abs(np.sum(offset * normal, axis=1)) / twice
    second = np.sum(cross(offset, c - a) * normal, axis=1) / twice**2
    third = np.sum(cross(b - a, offset) * normal, axis=1) / twice**2
    barycentric = np.stack([1.0 - second - third, second, third], axis=1)
    side = barycentric < ON_TRIANGLE  # on the edge opposite to the corner
    opposite = mesh.triangle_edges[triangle][:, [1, 2, 0]]
    border = (side & (mesh.edge_counts[opposite] == 1)).any(axis=1)
    on = (
        (height <= tolerance[triangle])
        & (barycentric > -ON_TRIANGLE).all(axis=1)
        & (side.sum(axis=1) < 2)
        & ~border
    )
    return near[on], triangle[on]


def _near(corners: Floats, centres: Floats, reach: Floats) -> tuple[NDArray[np.integer], NDArray[np.integer]]:
    """Pairs of a ball (centres, reach) and a triangle that may meet: two arrays of numbers."""
    centre = corners.mean(axis=1)
    radius = np.linalg.norm(corners - centre[:, None], axis=2).max(axis=1)
    balls, triangles = [], []
    # triangles by size, so that one large one does not widen the search around all
    level = np.floor(np.log2(radius / radius.min() + 1e-12)).astype(int)
    for k in np.unique(level):
        mine = np.flatnonzero(level == k)
        ball, near = in_balls(centre[mine], centres, reach + radius[mine].max(), ordered=False)
        balls.append(ball)
        triangles.append(mine[near])
    return np.concatenate(balls), np.concatenate(triangles)


def _heights(
    corners: Floats, points: Floats, those: Sequence[NDArray[np.integer]], triangle: NDArray[np.integer]
) -> list[Floats]:
    """(pair,) heights above the planes of triangles, of one point each or several."""
    normal = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    across, first = normal[triangle], corners[:, 0][triangle]
    return [np.einsum("px,px->p", across, points[point] - first) for point in those]


def _is_corner(
    triangles: NDArray[np.integer], vertex: NDArray[np.integer], triangle: NDArray[np.integer]
) -> NDArray[np.bool_]:
    """(pair,) whether vertices are corners of triangles."""
    return np.any([column[triangle] == vertex for column in triangles.T], axis=0)


def crossings(mesh: Mesh) -> tuple[NDArray[np.integer], NDArray[np.integer], Floats]:
    """Edges that pierce triangles with which they share no vertex: edges, triangles, and places (n, 3)."""
    corners = mesh.points[mesh.triangles]
    ends = mesh.points[mesh.edges]
    edge, triangle = _near(corners, ends.mean(axis=1), 0.5 * mesh.edge_lengths)
    # the ends lie on different sides of its plane, which few do
    start, end = mesh.edges.T
    one, other = _heights(corners, mesh.points, (start[edge], end[edge]), triangle)
    apart = (one < 0.0) != (other < 0.0)
    edge, triangle = edge[apart], triangle[apart]
    apart = ~(
        _is_corner(mesh.triangles, start[edge], triangle) | _is_corner(mesh.triangles, end[edge], triangle)
    )
    edge, triangle = edge[apart], triangle[apart]
    # Moeller and Trumbore 1997: start + s along = a + u (b - a) + v (c - a)
    start, along = ends[edge, 0], ends[edge, 1] - ends[edge, 0]
    a, b, c = (corners[triangle, k] for k in range(3))
    p = cross(along, c - a)
    determinant = np.sum((b - a) * p, axis=1)
    size = np.linalg.norm(along, axis=1) * np.linalg.norm(cross(b - a, c - a), axis=1)
    crossing = np.abs(determinant) > 1e-9 * size
    inverse = 1.0 / np.where(crossing, determinant, 1.0)
    offset = start - a
    u = np.sum(offset * p, axis=1) * inverse
    q = cross(offset, b - a)
    v = np.sum(along * q, axis=1) * inverse
    s = np.sum((c - a) * q, axis=1) * inverse
    for coordinate in (u, v, 1.0 - u - v, s, 1.0 - s):
        crossing &= coordinate > BESIDE
    return edge[crossing], triangle[crossing], (start + s[:, None] * along)[crossing]
