"""Dead loads on the Argyris discretisation of a chart. Values as in loads.py."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.elements.quadrature import interval_rule
from kshell.elements.reference import VERTICES
from kshell.mesh.mesh import EDGE_VERTICES
from kshell.shell.chart_surface import ChartSurface, jets_of_basis
from kshell.shell.loads import Value, evaluate
from kshell.shell.vectors import cross, dot, norm

Floats = NDArray[np.float64]

EDGE_POINTS = 5


def traction(surface: ChartSurface, value: Value, triangles: ArrayLike | None = None) -> Floats:
    """Force per area, a vector in space."""
    chosen = _every(surface, triangles)
    force = evaluate(value, np.moveaxis(surface.positions[:, chosen], 0, 2), 3)
    return _spread(surface, chosen, force * surface.area_elements[chosen][..., None])


def pressure(surface: ChartSurface, value: Value, triangles: ArrayLike | None = None) -> Floats:
    """Force per area along the normal of the rest surface."""
    chosen = _every(surface, triangles)
    p = evaluate(value, np.moveaxis(surface.positions[:, chosen], 0, 2), 1)
    normal = cross(*surface.first[:, :, chosen])
    return _spread(surface, chosen, np.moveaxis(normal * p, 0, 2))


def line_force(surface: ChartSurface, value: Value, edges: ArrayLike) -> Floats:
    """Force per length, a vector in space, along edges."""
    result = np.zeros((surface.scalars, 3))
    for triangles, tables, weights, local in _on_edges(surface, edges):
        x, first, _ = surface.geometry(local, triangles)
        length = norm(_along(first, tables))
        force = evaluate(value, np.moveaxis(x, 0, 2), 3) * (length * weights)[..., None]
        shape = surface.shape(jets_of_basis(local)[:1], triangles)[0]
        np.add.at(result, surface.scalar[triangles], np.einsum("tqj,tqx->tjx", shape, force))
    return result.ravel()


def edge_moment(surface: ChartSurface, value: Value, edges: ArrayLike) -> Floats:
    """Moment per length about edges, as the bending moment M_nn of the first triangle there.

    Positive puts the top in tension. Its work is -M n . du/dmu, mu the unit conormal, outwards.
    """
    result = np.zeros((surface.scalars, 3))
    for triangles, tables, weights, local in _on_edges(surface, edges):
        x, first, _ = surface.geometry(local, triangles)
        t = _along(first, tables)
        normal = cross(first[0], first[1])
        n = normal / norm(normal)
        mu = cross(t, n)  # of the length of t: the length element is in it
        # reciprocal tangents g^1 = x,2 x n / J, g^2 = n x x,1 / J
        across = [dot(mu, cross(first[1], n)) / norm(normal), dot(mu, cross(n, first[0])) / norm(normal)]
        moment = evaluate(value, np.moveaxis(x, 0, 2), 1) * weights
        d1, d2 = surface.shape(jets_of_basis(local)[1:3], triangles)
        slope = d1 * across[0][..., None] + d2 * across[1][..., None]
        np.add.at(result, surface.scalar[triangles], -np.einsum("tqj,xtq->tjx", slope * moment[..., None], n))
    return result.ravel()


def point_force(surface: ChartSurface, vertex: int, value: ArrayLike) -> Floats:
    """Force (3,) on a vertex."""
    result = np.zeros(surface.unknowns)
    result[18 * vertex : 18 * vertex + 3] = np.asarray(value, dtype=float)
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
