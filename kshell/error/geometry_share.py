"""What the shape of a mesh adds to the error: it follows curves and surfaces by polynomials.

Relative, weighted with the energy that each triangle stores. A quadratic triangle whose normal turns by an angle phi
changes deflections by about 0.2 phi^4 at most (Scordelis-Lo roof, pinched cylinder and hemisphere with three meshes
each: 1e-5 to 1e-3 at phi = 0.17 to 0.39), a cubic interpolant of a chart by about 2.5e-4 phi^3 (a tube under edge
loads), facets that meet at an angle phi by about phi (the same roof: 18, 8 and 4 %).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.mesh import quadratic
from kshell.mesh.mesh import Mesh

Floats = NDArray[np.float64]

QUADRATIC, QUADRATIC_POWER = 0.2, 4
CUBIC, CUBIC_POWER = 2.5e-4, 3
FLAT = 1e-9  # angle that is rounding


def turn_of_triangles(mesh: Mesh) -> Floats:
    """(triangle,) largest angle between normals at the corners of triangles of order 2; 0 for flat ones."""
    if mesh.midpoints is None:
        return np.zeros(len(mesh.triangles))
    corners = np.eye(3)
    n = quadratic.normals(quadratic.node_points(mesh, mesh.midpoints), corners)
    n = n / np.linalg.norm(n, axis=2, keepdims=True)
    out = np.zeros(len(mesh.triangles))
    for i, j in ((0, 1), (1, 2), (0, 2)):
        out = np.maximum(
            out, np.arctan2(np.linalg.norm(np.cross(n[i], n[j]), axis=1), (n[i] * n[j]).sum(axis=1))
        )
    return np.where(out < FLAT, 0.0, out)


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


def share_of_quadratics(turn: Floats, energy: Floats) -> float:
    """Of triangles of order 2."""
    return QUADRATIC * _mean(turn**QUADRATIC_POWER, energy)


def share_of_cubics(turn: Floats, energy: Floats) -> float:
    """Of cubic interpolants of a chart."""
    return CUBIC * _mean(turn**CUBIC_POWER, energy)


def share_of_facets(turn: Floats, energy: Floats) -> float:
    """Of flat triangles in the place of a curved surface."""
    return _mean(turn, energy)


def _mean(values: Floats, weights: Floats) -> float:
    total = float(weights.sum())
    return float((values * weights).sum() / total) if total > 0.0 else float(values.max(initial=0.0))
