"""Dead loads on the Argyris discretisation of a chart. Values as in loads.py."""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.elements.quadrature import interval_rule
from kshell.elements.reference import VERTICES
from kshell.mesh.mesh import EDGE_VERTICES
from kshell.shell.chart.surface import ChartSurface, jets_of_basis
from kshell.shell.evaluate import Value, evaluate
from kshell.shell.vectors import cross, dot, norm

Floats = NDArray[np.float64]

EDGE_POINTS = 5


def _normals(surface: ChartSurface, triangles: NDArray) -> Floats:
    """(triangle, q, 3) normals at quadrature points, as long as the area element."""
    return np.moveaxis(cross(*surface.first[:, :, triangles]), 0, 2)


def traction(surface: ChartSurface, value: Value, triangles: ArrayLike | None = None) -> Floats:
    """Force per area, a vector in space."""
    chosen = _every(surface, triangles)
    normal = partial(_normals, surface, chosen)
    force = evaluate(value, np.moveaxis(surface.positions[:, chosen], 0, 2), 3, normal)
    return _spread(surface, chosen, force * surface.area_elements[chosen][..., None])


def pressure(surface: ChartSurface, value: Value, triangles: ArrayLike | None = None) -> Floats:
    """Force per area along the normal of the rest surface."""
    chosen = _every(surface, triangles)
    normal = _normals(surface, chosen)
    p = evaluate(value, np.moveaxis(surface.positions[:, chosen], 0, 2), 1, lambda: normal)
    return _spread(surface, chosen, normal * p[..., None])


def line_force(surface: ChartSurface, value: Value, edges: ArrayLike) -> Floats:
    """Force per length, a vector in space, along edges."""
    result = np.zeros((surface.scalars, 3))
    for triangles, points, weights, shape in values_on_edges(surface, edges):
        force = evaluate(value, points, 3) * weights[..., None]
        np.add.at(result, surface.scalar[triangles], np.einsum("tqj,tqx->tjx", shape, force))
    return result.ravel()


def edge_moment(surface: ChartSurface, value: Value, edges: ArrayLike) -> Floats:
    """Moment per length about edges, as the bending moment M_nn of the first triangle there.

    Positive puts the top in tension. Its work is -M n . du/dmu, mu the unit conormal, outwards.
    """
    result = np.zeros((surface.scalars, 3))
    for triangles, points, weights, n, slope in slopes(surface, edges):
        moment = evaluate(value, points, 1) * weights
        np.add.at(result, surface.scalar[triangles], -np.einsum("tqj,xtq->tjx", slope * moment[..., None], n))
    return result.ravel()


def point_force(surface: ChartSurface, vertex: int, value: ArrayLike) -> Floats:
    """Force (3,) on a vertex."""
    result = np.zeros(surface.unknowns)
    result[18 * vertex : 18 * vertex + 3] = np.asarray(value, dtype=float)
    return result


def point_moment(surface: ChartSurface, vertex: int, value: ArrayLike) -> Floats:
    """Moment vector (3,) on a vertex: work on the rotation of the surface there. See `loads.point_moment`."""
    x1, x2 = surface.chart.derivatives(*surface.mesh.points[[vertex], :2].T, order=1)[1][0]
    normal = np.cross(x1, x2)
    j = np.linalg.norm(normal)
    n, moment = normal / j, np.asarray(value, dtype=float)
    drill = 0.5 * (moment @ n) / j
    result = np.zeros(surface.unknowns)
    # the unknowns of a vertex: u, then its derivatives by the two parameters
    result[18 * vertex + 3 : 18 * vertex + 6] = -n * (moment @ x2) / j + drill * x2
    result[18 * vertex + 6 : 18 * vertex + 9] = n * (moment @ x1) / j - drill * x1
    return result


def slopes(surface: ChartSurface, edges: ArrayLike) -> list[tuple[NDArray, Floats, Floats, Floats, Floats]]:
    """What turns about edges, at their quadrature points.

    Returns
    -------
    list of (triangles, points (triangle, q, 3), weights (triangle, q) with the length element, n (3, triangle, q),
    slope (triangle, q, 21) of the functions along the unit conormal, outwards)
    """
    result = []
    for triangles, tangent, weights, local in _on_edges(surface, edges):
        x, first, _ = surface.geometry(local, triangles)
        t = _along(first, tangent)
        length, normal = norm(t), cross(first[0], first[1])
        n = normal / norm(normal)
        mu = cross(t, n) / length
        # reciprocal tangents g^1 = x,2 x n / J, g^2 = n x x,1 / J
        across = [dot(mu, cross(first[1], n)) / norm(normal), dot(mu, cross(n, first[0])) / norm(normal)]
        d1, d2 = surface.shape(jets_of_basis(local)[1:3], triangles)
        slope = d1 * across[0][..., None] + d2 * across[1][..., None]
        result.append((triangles, np.moveaxis(x, 0, 2), weights * length, n, slope))
    return result


def values_on_edges(surface: ChartSurface, edges: ArrayLike) -> list[tuple[NDArray, Floats, Floats, Floats]]:
    """Triangles, points (triangle, q, 3), weights (triangle, q) with the length element, functions (..., 21)."""
    result = []
    for triangles, tangent, weights, local in _on_edges(surface, edges):
        x, first, _ = surface.geometry(local, triangles)
        shape = surface.shape(jets_of_basis(local)[:1], triangles)[0]
        result.append((triangles, np.moveaxis(x, 0, 2), weights * norm(_along(first, tangent)), shape))
    return result


def _every(surface: ChartSurface, triangles: ArrayLike | None) -> NDArray:
    return np.arange(len(surface.scalar)) if triangles is None else np.asarray(triangles, dtype=np.int64)


def _spread(surface: ChartSurface, triangles: NDArray, force: Floats) -> Floats:
    """int N_j force of forces (triangle, q, 3) per area of the reference triangle."""
    weighted = np.einsum("qr,tqx->trx", surface.tables[0], force * surface.weights[:, None])
    nodal = np.einsum("trj,trx->tjx", surface.transformation[triangles], weighted)
    result = np.zeros((surface.scalars, 3))
    np.add.at(result, surface.scalar[triangles], nodal)
    return result.ravel()


def _on_edges(surface: ChartSurface, edges: ArrayLike) -> list[tuple[NDArray, Floats, Floats, Floats]]:
    """For each local edge: triangles, the tangent in reference coordinates (counterclockwise), weights, points."""
    s, weights = interval_rule(EDGE_POINTS)
    triangle, local = surface.mesh.edge_owner[np.atleast_1d(np.asarray(edges, dtype=np.int64))].T
    result = []
    for k, (a, b) in enumerate(EDGE_VERTICES):
        mine = triangle[local == k]
        points = VERTICES[a] + s[:, None] * (VERTICES[b] - VERTICES[a])
        tangent = (VERTICES[b] - VERTICES[a]) * (-1.0 if k == 2 else 1.0)
        if len(mine):
            result.append((mine, tangent, weights, points))
    return result


def _along(first: Floats, tangent: Floats) -> Floats:
    return tangent[0] * first[0] + tangent[1] * first[1]
