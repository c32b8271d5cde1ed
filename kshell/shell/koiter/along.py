"""Forces of supports along edges of Koiter triangles, from their forces on nodes and rotations.

Displacements are polynomials of degree p on every edge, by values at nodes at equal distances: force per length is of
degree p, component by component (`kshell.elements.along`); that of springs, which end without concentrated forces, is
such a polynomial on the outermost edges, too. The rotations of an edge are those at its p Gauss points: the moment per
length there is the moment on each over weight and length, between them a polynomial of degree p - 1.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.elements.along import ChainFunctions, chains, turns
from kshell.elements.quadrature import interval_rule
from kshell.result.along_supports import SAMPLES, AlongSupport, moment_about_origin
from kshell.shell.koiter.reactions import rotation_axes
from kshell.shell.koiter.surface import Surface

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

CORNER = np.radians(25.0)  # lines that turn by more have forces there; chords of a curve turn, too
MORE_POINTS = 4  # Gauss points of an edge, over its order


def edge_nodes(surface: Surface, edges: Ints) -> NDArray[np.int64]:
    """(edge, p + 1) nodes of edges: the lower vertex, the higher one, and those between in that direction."""
    p = surface.order
    between = len(surface.mesh.points) + edges[:, None].astype(np.int64) * (p - 1) + np.arange(p - 1)
    return np.concatenate([surface.mesh.edges[edges].astype(np.int64), between], axis=1)


def lagrange_on_edge(order: int, s: Floats, derivative: bool = False) -> Floats:
    """(point, p + 1) Lagrange polynomials, or their derivatives by s, in the order of `edge_nodes`."""
    nodes = np.concatenate([[0.0, 1.0], np.arange(1, order) / order])
    power = np.arange(order + 1)
    coefficients = np.linalg.inv(nodes[:, None] ** power)  # (power, node)
    if derivative:
        return np.asarray((power * s[:, None] ** np.maximum(power - 1, 0)) @ coefficients)
    return np.asarray(s[:, None] ** power @ coefficients)


def along_edges(
    surface: Surface,
    edges: Ints,
    points: Ints,
    forces: Floats,
    springs: Floats,
    stops: NDArray[np.bool_],
    moved: Floats | None = None,
) -> tuple[AlongSupport, NDArray[np.bool_]]:
    """What forces on the unknowns of edges and single vertices are per length, and where lines are divided.

    Parameters
    ----------
    edges, points : int arrays
    forces, springs : (unknowns,)
        Of what is held, and of springs.
    stops : (vertex,) bool array
        Further vertices with concentrated forces.
    moved : (unknowns,), optional
        Motion to the state in which forces have their arms.
    """
    mesh, p = surface.mesh, surface.order
    nodal = surface.split(forces)[0]
    elastic = surface.split(springs)[0].copy()
    moments = surface.split(forces + springs)[1]
    nodes = edge_nodes(surface, edges)
    x = surface.nodes[nodes]  # (edge, node, 3)
    directions = np.stack(
        [lagrange_on_edge(p, np.array([at]), derivative=True)[0] @ x for at in (0.0, 1.0)], axis=1
    )
    directions /= np.linalg.norm(directions, axis=2, keepdims=True)
    stops = stops | turns(mesh, edges.astype(np.int64), directions, float(np.cos(CORNER)))
    stops[points] = True
    found = chains(mesh, edges.astype(np.int64), stops)
    functions = ChainFunctions(mesh, found, p, stops)
    open_ends = [c.vertices[[0, -1]] for c in found if not c.closed or stops[c.vertices[0]]]
    ends = np.unique(np.concatenate([points.astype(np.int64), *open_ends]))

    s, w = interval_rule(p + MORE_POINTS)
    place = np.argsort(edges, kind="stable")
    order = place[np.searchsorted(edges, functions.edges, sorter=place)]
    speed = np.linalg.norm(lagrange_on_edge(p, s, derivative=True) @ x, axis=2)  # (edge, point)
    tests = lagrange_on_edge(p, s)
    b = functions.coupled(nodes[order], tests, speed[order] * w, s, surface.node_count)
    inner = np.setdiff1d(nodes, ends)
    coefficients = np.zeros((functions.count, 3))
    from scipy.sparse.linalg import splu  # not loaded by what solves nothing

    if len(inner):
        coefficients = splu(b[inner].tocsc()).solve(nodal[inner])
    at_ends = (nodal - b @ coefficients)[ends]
    at_ends[np.isin(ends, points)] += elastic[ends[np.isin(ends, points)]]
    elastic[points] = 0.0

    shown, weighted = np.zeros((len(edges), len(SAMPLES), 3)), np.zeros((len(edges), len(s), 3))
    shown[order], weighted[order] = functions.at(coefficients, SAMPLES), functions.at(coefficients, s)
    if len(edges) and elastic.any():
        mine, local = np.unique(nodes, return_inverse=True)
        local = local.reshape(nodes.shape)
        mass = tests.T @ ((speed * w)[..., None] * tests)  # (edge, node, node)
        i, j = (np.broadcast_to(part, mass.shape).ravel() for part in (local[..., None], local[:, None]))
        whole = sp.csc_matrix((mass.ravel(), (i, j)), shape=(len(mine), len(mine)))
        density = splu(whole).solve(elastic[mine])[local]
        shown += lagrange_on_edge(p, SAMPLES) @ density
        weighted += tests @ density
    weighted *= (speed * w)[..., None]

    # the sets of rotations at a hinge turn about the same axes
    g, weight = interval_rule(p)
    u = np.zeros_like(surface.nodes) if moved is None else surface.split(moved)[0]
    turned = moments[..., None] * rotation_axes(surface, u).reshape(-1, p, 3)
    by_edge = np.zeros((len(mesh.edges), p, 3))
    np.add.at(by_edge, surface.rotation_owner, turned)
    by_edge = by_edge[edges]
    lengths = np.linalg.norm(lagrange_on_edge(p, g, derivative=True) @ x, axis=2) * weight
    through = np.linalg.inv(g[:, None] ** np.arange(p))  # (power, Gauss point)
    moment = (SAMPLES[:, None] ** np.arange(p) @ through) @ (by_edge / lengths[..., None])

    total = np.stack(
        [
            weighted.sum(axis=(0, 1)) + at_ends.sum(axis=0),
            moment_about_origin(tests @ (x + u[nodes]), weighted)
            + moment_about_origin(surface.nodes[ends] + u[ends], at_ends)
            + by_edge.sum(axis=(0, 1)),
        ]
    )
    places = lagrange_on_edge(p, SAMPLES) @ x
    out = AlongSupport(
        edges.astype(np.int64), places, (speed * w).sum(axis=1), shown, moment, total, ends, at_ends
    )
    return out, stops
