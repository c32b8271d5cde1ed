"""Mass and elastic supports: matrices that multiply displacements, not strains."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import ArrayLike, NDArray

from kshell.shell.evaluate import Value, evaluate
from kshell.shell.koiter.loads import edge_table, surface_points
from kshell.shell.koiter.surface import Surface
from kshell.shell.reference import weighted_products
from kshell.shell.scatter import scattered

Floats = NDArray[np.float64]


def _spread(surface: Surface, nodes: NDArray, blocks: Floats, directions: Floats) -> sp.csr_matrix:
    """Assemble scalar blocks (element, n, n) times the matrix `directions` (3, 3)."""
    scalar = scattered(nodes, blocks, surface.node_count)
    rotations = surface.unknowns - surface.rotation_start
    return sp.block_diag([sp.kron(scalar, directions), sp.csr_matrix((rotations, rotations))], format="csr")


def mass(surface: Surface, density: Value, triangles: ArrayLike | None = None) -> sp.csr_matrix:
    """Consistent mass matrix; rotations carry no mass, rotary inertia of the normal is neglected.

    Parameters
    ----------
    density : number, (triangle, 1) or callable
        Mass per area.
    """
    return foundation(surface, density, np.eye(3), triangles)


def foundation(
    surface: Surface, stiffness: Value, directions: ArrayLike, triangles: ArrayLike | None = None
) -> sp.csr_matrix:
    """Springs spread over triangles.

    Parameters
    ----------
    stiffness : number, (triangle, 1) or callable
        Force per area and displacement.
    directions : (3, 3)
        Positive semidefinite, e.g. diag(0, 0, 1) or the dyad of a unit vector.
    """
    chosen = np.arange(len(surface.mesh.triangles)) if triangles is None else np.asarray(triangles)
    points = surface_points(surface, chosen)
    if callable(stiffness):
        factor = evaluate(stiffness, points, 1)
    else:
        factor = np.broadcast_to(np.asarray(stiffness, dtype=float), points.shape[:-1])
    weight = factor * surface.area_elements[chosen] * surface.reference.weights
    blocks = weighted_products(surface.reference.values, weight)
    return _spread(surface, surface.triangle_nodes[chosen], blocks, np.asarray(directions, dtype=float))


def line_springs(
    surface: Surface, stiffness: Value, directions: ArrayLike, edges: ArrayLike
) -> sp.csr_matrix:
    """Springs along edges; stiffness in force per length and displacement."""
    nodes, shape, weight, points = edge_table(surface, edges, surface.order + 1)
    blocks = weighted_products(shape, evaluate(stiffness, points, 1) * weight)
    return _spread(surface, nodes, blocks, np.asarray(directions, dtype=float))


def rotation_springs(surface: Surface, stiffness: Value, edges: ArrayLike) -> sp.csr_matrix:
    """Springs against the rotation about edges; stiffness in moment per length and radian."""
    edges = np.atleast_1d(np.asarray(edges, dtype=np.int64))
    _, _, weight, points = edge_table(surface, edges, surface.order)
    triangle, local = surface.mesh.edge_owner[edges].T
    p = surface.order
    place = p * local[:, None] + np.arange(p)
    diagonal = np.zeros(surface.unknowns)
    unknowns = surface.rotation_start + surface.triangle_rotations[triangle[:, None], place]
    np.add.at(diagonal, unknowns, evaluate(stiffness, points, 1) * weight)
    return sp.diags(diagonal, format="csr")


def point_springs(surface: Surface, stiffness: ArrayLike, nodes: ArrayLike) -> sp.csr_matrix:
    """Springs at nodes; stiffness (3,) along x, y, z in force per displacement."""
    diagonal = np.zeros(surface.unknowns)
    nodes = np.atleast_1d(np.asarray(nodes, dtype=np.int64))
    np.add.at(diagonal, 3 * nodes[:, None] + np.arange(3), np.asarray(stiffness, dtype=float))
    return sp.diags(diagonal, format="csr")
