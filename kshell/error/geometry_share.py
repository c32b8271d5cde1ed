"""What the shape of a mesh adds to the error: it follows curves and surfaces by polynomials.

Relative, weighted with the energy that each triangle stores. A quadratic triangle whose normal turns by an angle phi
changes deflections by about 0.2 phi^4 at most (Scordelis-Lo roof, pinched cylinder and hemisphere with three meshes
each: 1e-5 to 1e-3 at phi = 0.17 to 0.39), facets that meet at an angle phi by about phi (the same roof: 18, 8 and 4 %).
Cubic interpolants of a chart change them by at most 5e-4 phi^3 + 1e-2 phi^5 (tubes and bent strips under edge loads and
couples, spheres under pressure on regular meshes; phi = 0.05 to 0.54), and by 0.03 phi^3 where membrane forces are
carried by a dome (spheres under pressure and edge loads on meshes that grow finer toward
some place; phi = 0.05 to 0.13).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.mesh import quadratic
from kshell.mesh.mesh import Mesh

Floats = NDArray[np.float64]

QUADRATIC, QUADRATIC_POWER = 0.2, 4
CUBIC, DOME, QUINTIC = 5e-4, 3e-2, 1e-2
ROUND = 0.2  # area on the unit sphere that the normals of a triangle enclose, over the square of its turn: a sphere's
FLAT = 1e-9  # angle that is rounding


def turn_of_triangles(mesh: Mesh) -> Floats:
    """(triangle,) largest angle between normals at the corners of triangles of order 2; 0 for flat ones."""
    if mesh.midpoints is None:
        return np.zeros(len(mesh.triangles))
    n = _normals(mesh)
    out = np.zeros(len(mesh.triangles))
    for i, j in ((0, 1), (1, 2), (0, 2)):
        out = np.maximum(
            out, np.arctan2(np.linalg.norm(np.cross(n[i], n[j]), axis=1), (n[i] * n[j]).sum(axis=1))
        )
    return np.where(out < FLAT, 0.0, out)


def domed(mesh: Mesh) -> Floats:
    """(triangle,) from 1 on spheres to 0 on cylinders, cones, planes and saddles, of triangles of order 2."""
    if mesh.midpoints is None:
        return np.zeros(len(mesh.triangles))
    n = _normals(mesh)
    area = 0.5 * (np.cross(n[1] - n[0], n[2] - n[0]) * n[0]).sum(axis=1)
    turn = np.maximum(turn_of_triangles(mesh), FLAT)
    return np.asarray(np.clip(area / (ROUND * turn**2), 0.0, 1.0))


def _normals(mesh: Mesh) -> Floats:
    """(corner, triangle, 3) unit normals at the corners of triangles of order 2."""
    assert mesh.midpoints is not None
    n = quadratic.normals(quadratic.node_points(mesh, mesh.midpoints), np.eye(3))
    return np.asarray(n / np.linalg.norm(n, axis=2, keepdims=True))


def turn_between(mesh: Mesh, pieces: NDArray[np.integer]) -> Floats:
    """(triangle,) largest angle to a neighbour of the same smooth piece, of flat triangles."""
    x = mesh.points[mesh.triangles]
    n = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    order = np.argsort(mesh.triangle_edges.ravel(), kind="stable")
    edges, triangles = mesh.triangle_edges.ravel()[order], order // 3
    pair = np.flatnonzero(edges[1:] == edges[:-1])
    one, other = triangles[pair], triangles[pair + 1]
    smooth = pieces[one] == pieces[other]
    one, other = one[smooth], other[smooth]
    angle = np.arctan2(
        np.linalg.norm(np.cross(n[one], n[other]), axis=1), np.abs((n[one] * n[other]).sum(axis=1))
    )
    out = np.zeros(len(mesh.triangles))
    np.maximum.at(out, one, angle)
    np.maximum.at(out, other, angle)
    return np.where(out < FLAT, 0.0, out)


def share_of_quadratics(turn: Floats) -> Floats:
    """(triangle,) of triangles of order 2."""
    return np.asarray(QUADRATIC * turn**QUADRATIC_POWER)


def share_of_cubics(turn: Floats, dome: Floats, membrane: Floats | float) -> Floats:
    """(triangle,) of cubic interpolants of a chart.

    Parameters
    ----------
    turn, dome : (triangle,)
        `turn_of_triangles`, `domed`.
    membrane : (triangle,) or float
        Share of the membrane in the energy.
    """
    return np.asarray((CUBIC + DOME * membrane * dome) * turn**3 + QUINTIC * turn**5)


def share_of_facets(turn: Floats) -> Floats:
    """(triangle,) of flat triangles in the place of a curved surface."""
    return turn


def weighted(values: Floats, weights: Floats) -> float:
    """Mean of values with weights; the largest value where these are zero."""
    total = float(weights.sum())
    return float((values * weights).sum() / total) if total > 0.0 else float(values.max(initial=0.0))
