"""What a triangle mesh must be for its curvature to mean something, and its corners, angles and normals."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.geometry.components import Floats
from kshell.mesh.connected import connected_parts
from kshell.mesh.mesh import Mesh

FLATTEST = 1e-14  # area of a triangle over its longest side squared


def require_surface(mesh: Mesh) -> None:
    """Raise InputError unless the mesh is an oriented surface of proper triangles.

    Refused, with the place: points that are not finite, vertices of no triangle, triangles without area,
    edges of three or more triangles, neighbours of opposite orientation, and vertices where two sheets
    touch in a point.
    """
    finite = np.isfinite(mesh.points).all(axis=1)
    if not finite.all():
        lost = int(np.argmin(finite))
        raise InputError(f"{mesh.source}: vertex {lost} is at {mesh.points[lost]}: give finite coordinates")
    corners_at = np.bincount(mesh.triangles.ravel(), minlength=len(mesh.points))
    if not corners_at.all():
        alone = int(np.argmin(corners_at))
        raise InputError(f"{mesh.source}: vertex {alone} at {_at(mesh.points[alone])} belongs to no triangle")
    sides = np.linalg.norm(edge_vectors(mesh), axis=2)
    flat = mesh.areas <= FLATTEST * sides.max(axis=1) ** 2
    if flat.any():
        first = int(np.argmax(flat))
        where = _at(mesh.points[mesh.triangles[first]].mean(axis=0))
        raise InputError(f"{mesh.source}: triangle {first} at {where} has no area")
    if mesh.edge_counts.max() > 2:
        worst = int(np.argmax(mesh.edge_counts))
        raise InputError(
            f"{mesh.source}: {mesh.edge_counts[worst]} triangles meet at {_edge_place(mesh, worst)}: "
            "curvature needs a surface with at most two; take the sheets one by one"
        )
    ahead = mesh.triangles[:, [1, 2, 0]] > mesh.triangles  # local edges (0, 1), (1, 2), (2, 0)
    order = mesh.triangle_edges
    walked_up = np.bincount(order[ahead], minlength=len(mesh.edges))
    twice = (mesh.edge_counts == 2) & (walked_up != 1)
    if twice.any():
        worst = int(np.argmax(twice))
        raise InputError(
            f"{mesh.source}: the triangles at the edge at {_edge_place(mesh, worst)} turn opposite ways: "
            "orient the mesh (a Moebius strip has no orientation and no signed curvature)"
        )
    touching = _pinched(mesh)
    if len(touching):
        raise InputError(
            f"{mesh.source}: two sheets touch only in vertex {touching[0]} at "
            f"{_at(mesh.points[touching[0]])}: give each its own vertex"
        )


def require_closed(mesh: Mesh, what: str) -> None:
    """Raise InputError, with a place on the boundary, unless the mesh is closed."""
    if len(mesh.boundary_edges):
        count = len(mesh.boundary_edges)
        raise InputError(
            f"{mesh.source}: {what} needs a closed surface, but {count} edges are boundary, one of them at "
            f"{_edge_place(mesh, int(mesh.boundary_edges[0]))}"
        )


def _at(x: Floats) -> str:
    return "(" + ", ".join(f"{c:.6g}" for c in x) + ")"


def _edge_place(mesh: Mesh, edge: int) -> str:
    return _at(mesh.points[mesh.edges[edge]].mean(axis=0))


def _pinched(mesh: Mesh) -> NDArray[np.int64]:
    """Vertices whose triangles do not form one fan: corners linked across edges fall into several parts."""
    # corner number = 3 * triangle + local vertex; across an edge the corners at each of its ends are linked
    edge_of_side = mesh.triangle_edges.ravel()
    by_edge = np.argsort(edge_of_side, kind="stable")
    pairs = by_edge[np.repeat(mesh.edge_counts == 2, mesh.edge_counts)].reshape(-1, 2)
    triangle, side = pairs // 3, pairs % 3
    ends = np.array([[0, 1], [1, 2], [0, 2]])[side]  # (pair, which triangle, end)
    corner = 3 * triangle[..., None] + ends
    vertex = mesh.triangles.ravel()[corner]
    corner[:, 1] = np.where(vertex[:, 1] == vertex[:, 0], corner[:, 1], corner[:, 1, ::-1])
    n = mesh.triangles.size
    a, b = corner[:, 0].ravel(), corner[:, 1].ravel()
    fans, label = connected_parts(n, a, b)
    fan_vertex = np.zeros(fans, dtype=np.int64)
    fan_vertex[label] = mesh.triangles.ravel()
    return np.flatnonzero(np.bincount(fan_vertex, minlength=len(mesh.points)) > 1)


def edge_vectors(mesh: Mesh) -> Floats:
    """(triangle, 3, 3) sides as vectors, the k-th opposite vertex k and counter-clockwise."""
    x = mesh.points[mesh.triangles]
    return np.roll(x, -2, axis=1) - np.roll(x, -1, axis=1)


def corner_cotangents(mesh: Mesh) -> Floats:
    """(triangle, 3) cotangent of the angle at each corner."""
    e = edge_vectors(mesh)
    before, after = np.roll(e, -1, axis=1), np.roll(e, -2, axis=1)  # the two sides that meet in corner k
    return -np.sum(before * after, axis=2) / (2.0 * mesh.areas)[:, None]


def corner_angles(mesh: Mesh) -> Floats:
    """(triangle, 3) angle at each corner."""
    return np.arctan2(1.0, corner_cotangents(mesh))


def triangle_normals(mesh: Mesh) -> Floats:
    """(triangle, 3) unit normals."""
    e = edge_vectors(mesh)
    return np.cross(e[:, 0], e[:, 1]) / (2.0 * mesh.areas)[:, None]


def vertex_normals(mesh: Mesh) -> Floats:
    """(vertex, 3) unit normals, triangle normals weighted by their angle (Thuermer & Wuethrich 1998).

    Raises
    ------
    InputError
        If the mesh is no oriented surface.
    """
    require_surface(mesh)
    total = at_vertices(mesh, triangle_normals(mesh)[:, None, :] * corner_angles(mesh)[..., None])
    return total / np.linalg.norm(total, axis=1, keepdims=True)


def at_vertices(mesh: Mesh, corner_values: Floats) -> Floats:
    """Sum of (triangle, 3, ...) corner values over the corners at each vertex, (vertex, ...)."""
    n = len(mesh.points)
    flat = corner_values.reshape(mesh.triangles.size, -1)
    columns = [np.bincount(mesh.triangles.ravel(), weights=c, minlength=n) for c in flat.T]
    return np.stack(columns, axis=1).reshape(n, *corner_values.shape[2:]).astype(np.float64)


def boundary_vertices(mesh: Mesh) -> NDArray[np.bool_]:
    """(vertex,) whether the vertex lies on the boundary."""
    on = np.zeros(len(mesh.points), dtype=bool)
    on[mesh.edges[mesh.boundary_edges]] = True
    return on


def euler_characteristic(mesh: Mesh) -> int:
    """Vertices - edges + triangles: 2 for a sphere, 0 for a torus, 1 for a disc."""
    return len(np.unique(mesh.triangles)) - len(mesh.edges) + len(mesh.triangles)
