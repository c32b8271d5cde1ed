"""Forces on the unknowns of a shell from pressures, tractions, line loads, edge moments and points.

A value is a number or a vector, or a callable that gives one per point: it takes (n, 3) points of the rest
surface. All loads below are dead loads; `follower_pressure` turns with the surface.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import scipy.sparse as sp
from numpy.typing import ArrayLike, NDArray

from kshell.shell.evaluate import Value, evaluate
from kshell.shell.koiter.surface import Surface
from kshell.shell.reference import edge_quadrature, first_derivatives, lagrange
from kshell.shell.vectors import cross, dot, norm

Floats = NDArray[np.float64]


def surface_points(surface: Surface, triangles: NDArray) -> Floats:
    """Interior quadrature points of triangles on the rest surface: (triangle, q, 3)."""
    return np.einsum(
        "qn,tnx->tqx", surface.reference.values, surface.nodes[surface.triangle_nodes[triangles]]
    )


def _every(surface: Surface, triangles: ArrayLike | None) -> NDArray:
    return (
        np.arange(len(surface.mesh.triangles)) if triangles is None else np.asarray(triangles, dtype=np.int64)
    )


def _add_to_nodes(surface: Surface, nodes: NDArray, forces: Floats) -> Floats:
    """Sum nodal forces (n, 3) on nodes (n,) into a vector of unknowns."""
    result = np.zeros(surface.unknowns)
    for axis in range(3):
        result[axis : surface.rotation_start : 3] = np.bincount(
            nodes.ravel(), weights=forces[..., axis].ravel(), minlength=surface.node_count
        )
    return result


def _normals(surface: Surface, triangles: NDArray) -> Floats:
    """(triangle, q, 3) normals at interior quadrature points, as long as the area element J."""
    return np.moveaxis(cross(*surface.tangents(surface.reference.first, triangles)), 0, 2)


def traction(surface: Surface, value: Value, triangles: ArrayLike | None = None) -> Floats:
    """Force per area, a vector in space, on some triangles (all if absent)."""
    chosen = _every(surface, triangles)
    ref = surface.reference
    normal = partial(_normals, surface, chosen)
    force = evaluate(value, surface_points(surface, chosen), 3, normal)
    force = force * (surface.area_elements[chosen] * ref.weights)[..., None]
    nodal = np.einsum("qn,tqx->tnx", ref.values, force)
    return _add_to_nodes(surface, surface.triangle_nodes[chosen], nodal)


def pressure(surface: Surface, value: Value, triangles: ArrayLike | None = None) -> Floats:
    """Force per area along the normal of the rest surface."""
    chosen = _every(surface, triangles)
    ref = surface.reference
    normal = _normals(surface, chosen)
    p = evaluate(value, surface_points(surface, chosen), 1, lambda: normal)
    nodal = np.einsum("qn,tqx->tnx", ref.values, normal * (p * ref.weights)[..., None])
    return _add_to_nodes(surface, surface.triangle_nodes[chosen], nodal)


def follower_pressure(
    surface: Surface, x: Floats, value: Value, triangles: ArrayLike | None = None
) -> tuple[Floats, sp.csr_matrix]:
    """Force per deformed area along the deformed normal, and its derivative by the unknowns.

    From p (x,1 x x,2): the derivative by x_j is p (N_j,1 [ ]x x,2 + x,1 x N_j,2 [ ]). The matrix is
    symmetric up to terms on the boundary; `value` is evaluated on the rest surface.
    """
    chosen = _every(surface, triangles)
    ref = surface.reference
    u, _ = surface.split(x)
    at_rest = partial(_normals, surface, chosen)
    weight = evaluate(value, surface_points(surface, chosen), 1, at_rest) * ref.weights
    x1, x2 = surface.tangents(ref.first, chosen) + surface.jets(u, ref.first, chosen)
    normal = np.moveaxis(cross(x1, x2), 0, 2)
    nodes = surface.triangle_nodes[chosen]
    forces = _add_to_nodes(surface, nodes, np.einsum("qn,tqx->tnx", ref.values, normal * weight[..., None]))

    # N_i (x,1 N_j,2 - x,2 N_j,1) is a vector a with the block [a]x between nodes i and j
    first = np.einsum("qi,qj->qij", ref.values, ref.first[0]).reshape(len(ref.points), -1)
    second = np.einsum("qi,qj->qij", ref.values, ref.first[1]).reshape(len(ref.points), -1)
    a = (x1 * weight) @ second - (x2 * weight) @ first  # (3, triangle, i j)
    n = nodes.shape[1]
    i, j = 3 * np.repeat(nodes, n, axis=1).ravel(), 3 * np.tile(nodes, (1, n)).ravel()
    rows, columns, entries = [], [], []
    for r, c, axis, sign in (
        (0, 1, 2, -1),
        (0, 2, 1, 1),
        (1, 0, 2, 1),
        (1, 2, 0, -1),
        (2, 0, 1, -1),
        (2, 1, 0, 1),
    ):
        rows.append(i + r)
        columns.append(j + c)
        entries.append(sign * a[axis].ravel())
    shape = (surface.unknowns, surface.unknowns)
    pattern = (np.concatenate(rows), np.concatenate(columns))
    return forces, sp.csr_matrix((np.concatenate(entries), pattern), shape=shape)


def edge_table(surface: Surface, edges: ArrayLike, count: int) -> tuple[NDArray, Floats, Floats, Floats]:
    """Quadrature along edges, walked by the first triangle at each.

    Returns
    -------
    nodes (edge, n), shape functions (edge, point, n), weights with the length element (edge, point), points
    (edge, point, 3)
    """
    edges = np.atleast_1d(np.asarray(edges, dtype=np.int64))
    triangle, local = surface.mesh.edge_owner[edges].T
    points, weights, tangents = edge_quadrature(count)
    pick = local[:, None] * count + np.arange(count)
    shape = lagrange(surface.order, points)[pick]
    first = first_derivatives(surface.order, points)
    along = (tangents[:, 0, None] * first[0] + tangents[:, 1, None] * first[1])[pick]
    nodes = surface.triangle_nodes[triangle]
    x = surface.nodes[nodes]
    length = np.linalg.norm(np.einsum("epn,enx->epx", along, x - x[:, :1]), axis=2)
    return nodes, shape, length * weights[pick], np.einsum("epn,enx->epx", shape, x)


def edge_normals(surface: Surface, edges: ArrayLike, count: int) -> Floats:
    """(edge, point, 3) unit normals of the first triangle at each edge, at the points of `edge_table`."""
    triangle, local = surface.mesh.edge_owner[np.atleast_1d(np.asarray(edges, dtype=np.int64))].T
    points, _, _ = edge_quadrature(count)
    pick = local[:, None] * count + np.arange(count)
    x = surface.nodes[surface.triangle_nodes[triangle]]
    x1, x2 = (d[pick] @ x for d in first_derivatives(surface.order, points))
    normal = np.cross(x1, x2)
    return np.asarray(normal / np.linalg.norm(normal, axis=2, keepdims=True))


def surface_normals(surface: Surface, triangles: ArrayLike) -> Floats:
    """(triangle, point, 3) unit normals at the points of `surface_points`."""
    normal = np.moveaxis(cross(*surface.tangents(surface.reference.first, np.asarray(triangles))), 0, 2)
    return np.asarray(normal / np.linalg.norm(normal, axis=2, keepdims=True))


def line_force(surface: Surface, value: Value, edges: ArrayLike) -> Floats:
    """Force per length, a vector in space, along edges."""
    nodes, shape, weight, points = edge_table(surface, edges, surface.order + 1)
    force = evaluate(value, points, 3) * weight[..., None]
    return _add_to_nodes(surface, nodes, np.einsum("epn,epx->enx", shape, force))


def edge_moment(surface: Surface, value: Value, edges: ArrayLike) -> Floats:
    """Moment per length about edges, as the bending moment M_nn of the first triangle there.

    Positive puts the top, the side of the normal, in tension.
    """
    _, _, weight, points = edge_table(surface, edges, surface.order)
    unknowns, sign = edge_rotations(surface, edges)
    result = np.zeros(surface.unknowns)
    np.add.at(result, unknowns, evaluate(value, points, 1) * weight * sign)
    return result


def edge_rotations(surface: Surface, edges: ArrayLike) -> tuple[NDArray, Floats]:
    """Rotations of edges in the order of the points of `edge_table` (edge, order), of as many points.

    Returns
    -------
    unknowns (edge, order), and signs (edge, 1): 1 where they are positive as a positive edge moment turns
    """
    triangle, local = surface.mesh.edge_owner[np.atleast_1d(np.asarray(edges, dtype=np.int64))].T
    place = surface.order * local[:, None] + np.arange(surface.order)
    unknowns = surface.rotation_start + surface.triangle_rotations[triangle[:, None], place]
    return unknowns, surface.edge_sign[triangle, local][:, None]


def point_force(surface: Surface, node: int, value: ArrayLike) -> Floats:
    """Force (3,) on a node; vertices come first and keep their numbers."""
    result = np.zeros(surface.unknowns)
    result[3 * node : 3 * node + 3] = np.asarray(value, dtype=float)
    return result


def point_moment(surface: Surface, vertex: int, value: ArrayLike) -> Floats:
    """Moment vector (3,) on a vertex: work on the mean rotation of the triangles there, by their angles.

    The rotation of a surface is n x (dn) in the tangent plane and half the curl of u about n.
    """
    triangle, corner = np.nonzero(surface.mesh.triangles == vertex)
    share = surface.corner_angles[triangle, corner]
    share = share / share.sum()
    tables = surface.corner_tables
    x1, x2 = (x[:, np.arange(len(triangle)), corner] for x in surface.tangents(tables, triangle))
    normal = cross(x1, x2)
    j = norm(normal)
    n = normal / j
    moment = np.broadcast_to(np.asarray(value, dtype=float)[:, None], n.shape)
    drill = dot(moment, n)
    # dn = -(n . u,a) g^a, so omega = n x dn has the part -(n . u,a) (n x g^a), and n x g^1 = x,2 / J,
    # n x g^2 = -x,1 / J; the normal part is half of (x,2 . u,1 - x,1 . u,2) / J
    by_1 = -n * (dot(moment, x2) / j) + 0.5 * x2 * (drill / j)
    by_2 = n * (dot(moment, x1) / j) - 0.5 * x1 * (drill / j)
    first = tables[:, corner]  # (2, n, node)
    nodal = by_1.T[:, None, :] * first[0][:, :, None] + by_2.T[:, None, :] * first[1][:, :, None]
    return _add_to_nodes(surface, surface.triangle_nodes[triangle], nodal * share[:, None, None])
