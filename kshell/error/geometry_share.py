"""What the shape of a mesh adds to the error: it follows curves and surfaces by polynomials.

Relative, weighted with the energy that each triangle stores. A quadratic triangle whose normal turns by an angle phi
changes deflections by about 0.2 phi^4 at most (Scordelis-Lo roof, pinched cylinder and hemisphere with three meshes
each: 1e-5 to 1e-3 at phi = 0.17 to 0.39); elements on parts of it, which see the angles between such triangles, by
0.12 m phi^3 more (the roof on regular meshes, exactly as phi^3: 4e-3 to 8e-6 at phi = 0.35 to 0.044; less on others), m
the share of the membrane in the energy. Facets that meet at an angle phi change them by 0.5 phi (the same roof: 18, 8
and 4 %) to 5 phi (the cylinder: 46 % at phi = 0.1), and thin ones hold what bends by any factor: of 70 shells whose
facets met at 0.2 to 0.6 the energies of 30 were off by more than twice, up to 10,000 times: above 0.1 nothing is said.

Interpolants of a chart, by regular meshes, such as grow finer toward some place, and such with triangles cut at random;
d is 1 on domes and 0 on cylinders and saddles, t / R the thickness over
the smallest radius of curvature:

    cubic      (5e-4 + 0.03 m d) phi^3 + 0.06 m phi^4 + 0.01 phi^5 + 0.01 (t / R)^2 phi^2
    quartic    1e-2 m d phi^4 + (1e-3 + 0.02 m d) phi^6 + 5e-4 (t / R)^2 phi^4

Cubics have the term m phi^4 of tubes under forces on a free rim, where an ovalling that hardly stretches them turns a
membrane strain of 1e-6 into 3e-4 of the deflection (phi = 0.26, t / R = 0.01, triangles cut here and there; 6e-5 on a
regular mesh); quartics lose 3e-7 there. Those with m d are spheres under pressure and edge loads, those with t / R
strips bent to a quarter of a circle (t / R = 0.1, 0.001); phi = 0.05 to 0.54.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.mesh import quadratic
from kshell.mesh.mesh import Mesh
from kshell.mesh.vectors import cross

Floats = NDArray[np.float64]

QUADRATIC, QUADRATIC_POWER = 0.2, 4
CUT = 0.12  # m phi^3, of parts of quadratic triangles
CUBIC = 5e-4, 3e-2, 6e-2, 1e-2, 1e-2  # phi^3, m d phi^3, m phi^4, phi^5, (t / R)^2 phi^2
QUARTIC = 1e-2, 1e-3, 2e-2, 5e-4  # m d phi^4, phi^6, m d phi^6, (t / R)^2 phi^4
FACETS = 5.0  # phi
MOST_OF_FACETS = 0.5  # share from which nothing is said
ROUND = 0.2  # area on the unit sphere that the normals of a triangle enclose, over the square of its turn: a sphere's
FLAT = 1e-9  # angle that is rounding
PAIRS = ((0, 1), (1, 2), (0, 2))  # of corners


def turn_of_triangles(mesh: Mesh) -> Floats:
    """(triangle,) largest angle between normals at the corners of triangles of order 2; 0 for flat ones."""
    return np.asarray(_angles(mesh).max(axis=1))


def curvature_of_triangles(mesh: Mesh) -> Floats:
    """(triangle,) largest angle between normals at two corners over their distance."""
    x = mesh.points[mesh.triangles]
    length = np.stack([np.linalg.norm(x[:, j] - x[:, i], axis=1) for i, j in PAIRS], axis=1)
    return np.asarray((_angles(mesh) / length).max(axis=1))


def _angles(mesh: Mesh) -> Floats:
    """(triangle, 3) angles between the normals at two corners."""
    if mesh.midpoints is None:
        return np.zeros((len(mesh.triangles), 3))
    n = _normals(mesh)
    angle = [
        np.arctan2(np.linalg.norm(cross(n[i], n[j]), axis=1), (n[i] * n[j]).sum(axis=1)) for i, j in PAIRS
    ]
    return np.where(np.stack(angle, axis=1) < FLAT, 0.0, np.stack(angle, axis=1))


def domed(mesh: Mesh) -> Floats:
    """(triangle,) from 1 on spheres to 0 on cylinders, cones, planes and saddles, of triangles of order 2."""
    if mesh.midpoints is None:
        return np.zeros(len(mesh.triangles))
    n = _normals(mesh)
    area = 0.5 * (cross(n[1] - n[0], n[2] - n[0]) * n[0]).sum(axis=1)
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
    n = cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    order = np.argsort(mesh.triangle_edges.ravel(), kind="stable")
    edges, triangles = mesh.triangle_edges.ravel()[order], order // 3
    pair = np.flatnonzero(edges[1:] == edges[:-1])
    one, other = triangles[pair], triangles[pair + 1]
    smooth = pieces[one] == pieces[other]
    one, other = one[smooth], other[smooth]
    angle = np.arctan2(
        np.linalg.norm(cross(n[one], n[other]), axis=1), np.abs((n[one] * n[other]).sum(axis=1))
    )
    out = np.zeros(len(mesh.triangles))
    np.maximum.at(out, one, angle)
    np.maximum.at(out, other, angle)
    return np.where(out < FLAT, 0.0, out)


def share_of_quadratics(turn: Floats) -> Floats:
    """(triangle,) of triangles of order 2."""
    return np.asarray(QUADRATIC * turn**QUADRATIC_POWER)


def share_of_cut_quadratics(turn: Floats, membrane: Floats | float) -> Floats:
    """(triangle,) of triangles of order 2 that are cut into smaller ones on the same surface."""
    return np.asarray(share_of_quadratics(turn) + CUT * membrane * turn**3)


def share_of_chart(
    order: int, turn: Floats, dome: Floats, membrane: Floats | float, slender: Floats | float
) -> Floats:
    """(triangle,) of interpolants of a chart of order 3 or 4.

    Parameters
    ----------
    order : int
    turn, dome : (triangle,)
        `turn_of_triangles`, `domed`.
    membrane : (triangle,) or float
        Share of the membrane in the energy.
    slender : (triangle,) or float
        Thickness over the smallest radius of curvature.
    """
    stretched = membrane * dome
    if order > 3:
        dome_4, all_6, dome_6, thick = QUARTIC
        return np.asarray(
            (dome_4 * stretched + thick * slender**2) * turn**4 + (all_6 + dome_6 * stretched) * turn**6
        )
    all_3, dome_3, tube, all_5, thick = CUBIC
    cubic = (all_3 + dome_3 * stretched) * turn**3 + thick * (slender * turn) ** 2
    return np.asarray(cubic + tube * membrane * turn**4 + all_5 * turn**5)


def share_of_facets(turn: Floats) -> Floats:
    """(triangle,) of flat triangles in the place of a curved surface."""
    return FACETS * turn


def weighted(values: Floats, weights: Floats) -> float:
    """Mean of values with weights; the largest value where these are zero."""
    total = float(weights.sum())
    return float((values * weights).sum() / total) if total > 0.0 else float(values.max(initial=0.0))
