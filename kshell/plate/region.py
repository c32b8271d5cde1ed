"""Quadrature over triangles with curved edges, on their true region, and places along curved edges.

A triangle with one curved edge is swept by rays from the opposite corner c to the edge gamma(s),

    x(s, t) = c + t (gamma(s) - c),    dx/ds x dx/dt = t (gamma(s) - c) x gamma'(s),

so that polynomials keep their degree along t. One with more is mapped: with x(xi) the affine map, lambda_i the
barycentric coordinates and an edge from its lower vertex a to its higher vertex b,

    x(xi) + lambda_a lambda_b phi(s),    s = (1 + lambda_b - lambda_a) / 2

(phi as in `kshell.plate.curves`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.elements.affine import AffineTriangles
from kshell.elements.quadrature import interval_rule, triangle_rule
from kshell.elements.reference import powers
from kshell.errors import InputError
from kshell.mesh.mesh import EDGE_VERTICES, Mesh
from kshell.plate.curves import EdgeCurves

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

OPPOSITE = np.array([2, 0, 1])  # the vertex that is not on a local edge
BEYOND = 6  # points along a curved edge more than polynomials of its chord ask for
JACOBIAN = 8  # degree of the Jacobian of the map of quintics, nearly that of others
GRADIENTS = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])  # of the barycentric coordinates


def motion(mesh: Mesh, curves: EdgeCurves, edges: Ints, s: Floats) -> tuple[Floats, Floats, Floats]:
    """Places, first and second derivatives (n, point, 2) of edges by s, 0 to 1 from lower to higher vertex."""
    ends = mesh.points[mesh.edges[edges], :2]
    speed = np.repeat((ends[:, 1] - ends[:, 0])[:, None], len(s), axis=1)
    offset = speed * s[:, None]
    bend = np.zeros_like(speed)
    place, bent = _among(curves, edges)
    here = np.flatnonzero(bent)
    if len(here):
        bubble, slope, second = curves.deviations(place[here], s)
        offset[here] += bubble
        speed[here] += slope
        bend[here] = second
    return ends[:, :1] + offset, speed, bend


def _among(curves: EdgeCurves, edges: NDArray[np.integer]) -> tuple[Ints, NDArray[np.bool_]]:
    """Places of edges in the set of curves, and whether they are curved edges of it."""
    if not len(curves.edges):
        return np.zeros(edges.shape, dtype=np.int64), np.zeros(edges.shape, dtype=bool)
    place = np.minimum(curves.place(edges), len(curves.edges) - 1)
    return place, (curves.edges[place] == edges) & curves.curved[place]


def region_points(mesh: Mesh, curves: EdgeCurves, block: Ints, degree: int) -> tuple[Floats, Floats]:
    """Places (n, point, 2) and weights (n, point) for polynomials of a degree on triangles with curved edges.

    Raises
    ------
    InputError
        If a triangle folds over.
    """
    bent = _among(curves, mesh.triangle_edges[block])[1]
    one = bent.sum(axis=1) == 1
    local = bent.argmax(axis=1)
    xy, weights = _rays(mesh, curves, block, local, degree)
    one &= (weights > 0).all(axis=1)
    if not one.all():
        rest = np.flatnonzero(~one)
        more_xy, more = _bulged(mesh, curves, block[rest], degree)
        short = more.shape[1] - weights.shape[1]
        pad = ((0, 0), (0, max(short, 0)))
        xy, weights = np.pad(xy, (*pad, (0, 0)), mode="edge"), np.pad(weights, pad)
        pad = ((0, 0), (0, max(-short, 0)))
        xy[rest], weights[rest] = np.pad(more_xy, (*pad, (0, 0)), mode="edge"), np.pad(more, pad)
    return xy, weights


def _rays(
    mesh: Mesh, curves: EdgeCurves, block: Ints, local: NDArray[np.integer], degree: int
) -> tuple[Floats, Floats]:
    """Places and weights on rays from the corner opposite a curved edge."""
    t, along_ray = interval_rule((degree + 3) // 2)
    s, across = interval_rule(degree // 2 + BEYOND)
    edges = mesh.triangle_edges[block, local]
    place, speed, _ = motion(mesh, curves, edges, s)
    corner = mesh.points[mesh.triangles[block, OPPOSITE[local]], :2]
    spoke = place - corner[:, None]
    area = spoke[..., 0] * speed[..., 1] - spoke[..., 1] * speed[..., 0]
    # triangles run counter-clockwise, edges from the lower to the higher vertex
    first, second = EDGE_VERTICES[local].T
    ends = mesh.triangles[block[:, None], np.stack([first, second], axis=1)]
    area *= np.where((ends[:, 0] < ends[:, 1]) == (local != 2), 1.0, -1.0)[:, None]
    xy = corner[:, None, None] + t[:, None, None] * spoke[:, None]
    weights = (t * along_ray)[:, None] * (area * across)[:, None]
    return xy.reshape(len(block), -1, 2), weights.reshape(len(block), -1)


def _bulged(mesh: Mesh, curves: EdgeCurves, block: Ints, degree: int) -> tuple[Floats, Floats]:
    """Places and weights by the curved map, for triangles with more than one curved edge."""
    xi, w = triangle_rule(degree + JACOBIAN)
    affine = AffineTriangles.of_arrays(np.ascontiguousarray(mesh.points[:, :2]), mesh.triangles[block])
    shift, gradient = bulge(mesh, curves, block, xi)
    xy = affine.corners[:, None, 0] + xi @ np.swapaxes(affine.jacobian, 1, 2) + shift
    j = affine.jacobian[:, None] + gradient
    area = j[..., 0, 0] * j[..., 1, 1] - j[..., 0, 1] * j[..., 1, 0]
    if np.any(area <= 0):
        t = block[int(np.argmin(area.min(axis=1)))]
        x, y = mesh.points[mesh.triangles[t], :2].mean(axis=0)
        raise InputError(
            f"the triangle at ({x:g}, {y:g}) folds over: its curved edge bulges past the opposite corner; "
            "refine the mesh along that edge"
        )
    return xy, area * w


def bulge(mesh: Mesh, curves: EdgeCurves, block: Ints, xi: Floats) -> tuple[Floats, Floats]:
    """Displacement (n, point, 2) of the curved map and its gradient (n, point, 2, d / d xi)."""
    barycentric = np.stack([1 - xi[:, 0] - xi[:, 1], xi[:, 0], xi[:, 1]], axis=1)  # (point, vertex)
    shift = np.zeros((len(block), len(xi), 2))
    gradient = np.zeros((len(block), len(xi), 2, 2))
    for k, (v, w) in enumerate(EDGE_VERTICES):
        edge = mesh.triangle_edges[block, k]
        place, bent = _among(curves, edge)
        here = np.flatnonzero(bent)
        ends = mesh.triangles[block[here]][:, [v, w]]
        for a, b, part in ((v, w, ends[:, 0] < ends[:, 1]), (w, v, ends[:, 0] > ends[:, 1])):
            chosen = here[part]
            if not len(chosen):
                continue
            s = (1 + barycentric[:, b] - barycentric[:, a]) / 2
            shape = curves.shape[place[chosen]]
            last = shape.shape[1] - 1
            phi = np.einsum("qk,nkx->nqx", powers(s, last), shape)
            by_s = powers(s, last - 1) * np.arange(1.0, last + 1)
            slope = np.einsum("qk,nkx->nqx", by_s, shape[:, 1:])
            product = barycentric[:, a] * barycentric[:, b]
            d_product = (
                barycentric[:, a, None] * GRADIENTS[b] + barycentric[:, b, None] * GRADIENTS[a]
            )  # (point, d xi)
            d_s = (GRADIENTS[b] - GRADIENTS[a]) / 2
            shift[chosen] += product[:, None] * phi
            gradient[chosen] += phi[..., None] * d_product[:, None, :]
            gradient[chosen] += (product[:, None] * slope)[..., None] * d_s
    return shift, gradient
