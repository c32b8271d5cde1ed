"""Bending energies of meshes of known surfaces: hinges at the edges, and Koiter triangles of order 1, 2, 3."""

from __future__ import annotations

import numpy as np
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

from kshell.mesh.mesh import Mesh
from kshell.shell.koiter.edges import Directors, first_triangle
from kshell.shell.koiter.energy import Koiter
from kshell.shell.koiter.recovery import energies
from kshell.shell.koiter.surface import Surface
from kshell.shell.reference import lagrange
from kshell.shell.section import Section
from kshell.shell.vectors import cross, dot, norm
from verification.failures.bent import NU, Bent

Floats = NDArray[np.float64]

YOUNG, THICKNESS = 1e11, 1e-4
STIFFNESS = YOUNG * THICKNESS**3 / (12 * (1 - NU**2))  # D

#: what a hinge makes of the angle between the normals of its two triangles
HINGES = {
    "hinge, angle": lambda angle: angle,
    "hinge, tangent": lambda angle: 2 * np.tan(angle / 2),
    "hinge, sine": lambda angle: 2 * np.sin(angle / 2),
}


def inner_edges(mesh: Mesh) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Edges (n,) with two triangles, and these (n, 2)."""
    edge = mesh.triangle_edges.ravel()
    order = np.argsort(edge, kind="stable")
    triangle = order // 3
    same = np.flatnonzero(edge[order][:-1] == edge[order][1:])
    return edge[order][same], np.stack([triangle[same], triangle[same + 1]], axis=1)


def hinge_energy(bent: Bent, form: str) -> float:
    """Sum over inner edges of  1/2 D 3 |e|^2 f(angle)^2 / (A1 + A2),  over D.

    Lengths and areas A1, A2 are those at rest. With f(angle) = angle: Grinspun, Hirani, Desbrun and Schroeder,
    Discrete shells, 2003.
    """
    mesh = bent.mesh
    at_rest = bent.place(mesh.points) if bent.rest is None else bent.rest(mesh.points)
    edges, pairs = inner_edges(mesh)

    def areas(points: Floats) -> Floats:
        a, b, c = (points[mesh.triangles[:, k]] for k in range(3))
        return np.asarray(0.5 * np.cross(b - a, c - a))

    area = np.linalg.norm(areas(at_rest), axis=1)[pairs].sum(axis=1)
    length = np.linalg.norm(np.diff(at_rest[mesh.edges[edges]], axis=1)[:, 0], axis=1)
    n1, n2 = np.moveaxis(areas(bent.place(mesh.points))[pairs], 1, 0)
    angle = np.arctan2(np.linalg.norm(np.cross(n1, n2), axis=1), np.sum(n1 * n2, axis=1))
    return float(1.5 * np.sum(length**2 * HINGES[form](angle) ** 2 / area))


def koiter_energy(bent: Bent, order: int) -> float:
    """Bending energy over D of kshell's triangles with their nodes on the surface.

    The directors of the edges are free, as they are in every solution, and take the positions of least energy;
    those on the boundary are normal to the surface.
    """
    surface = Surface(bent.mesh, order, bent.rest or bent.place)
    koiter = Koiter(surface, Section.isotropic(YOUNG, NU, THICKNESS))
    u = bent.place(surface.flat_nodes) - surface.nodes
    directors = exact_directors(surface, bent, u)
    initial = np.zeros((len(bent.mesh.triangles), koiter.strains))
    if bent.rest is None:  # b instead of b - B: without curvature at rest
        ref = surface.reference
        normal = cross(*surface.tangents(ref.first)) / surface.area_elements
        form = np.stack([dot(normal, x) for x in surface.jets(surface.nodes, ref.second)])
        interior = koiter.tables.bending(form / surface.area_elements, np.zeros_like(surface.edge_stretch))
        initial[:, ref.strains :] = -interior
    x = np.zeros(surface.unknowns)
    x[: surface.rotation_start] = u.ravel()
    found = koiter.energy(x, 2, directors, initial=initial)
    fixed = surface.rotations_of_edges(bent.mesh.boundary_edges)
    free = np.setdiff1d(np.arange(surface.rotation_start, surface.unknowns), fixed)
    # the energy is a quadratic function of the rotations
    x[free] -= spla.spsolve(found.hessian.tocsr()[free][:, free].tocsc(), found.gradient[free])
    return float(energies(koiter, koiter.strain(x, directors) - initial)[1].sum()) / STIFFNESS


def exact_directors(surface: Surface, bent: Bent, u: Floats) -> Directors:
    """Directors along the normals of the true surface, across the edges of the displaced triangles."""
    ref = surface.reference
    points = lagrange(surface.order, ref.edge_points) @ surface.flat_nodes[surface.triangle_nodes]
    d = np.moveaxis(bent.normal(points.reshape(-1, 3)).reshape(points.shape), 2, 0)  # (3, triangle, g)
    x = surface.tangents(ref.edge_first) + surface.jets(u, ref.edge_first)
    t = ref.edge_tangents[:, 0] * x[0] + ref.edge_tangents[:, 1] * x[1]
    t /= norm(t)
    d -= t * dot(d, t)
    vectors = (d / norm(d)).reshape(3, -1)[:, first_triangle(surface)]
    d = vectors[:, surface.triangle_rotations]
    m = cross(*x)
    angle = np.arctan2(dot(d, cross(t, m)), dot(d, m))
    return Directors(vectors, u, angle)
