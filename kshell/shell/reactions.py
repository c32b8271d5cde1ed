"""Forces and moments of forces on the unknowns: reactions of supports, and their balance with the loads."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.shell.chart.surface import ChartSurface
from kshell.shell.koiter.edges import first_triangle
from kshell.shell.koiter.surface import Surface
from kshell.shell.vectors import norm

Floats = NDArray[np.float64]


def rotation_axes(surface: Surface, u: Floats | None = None) -> Floats:
    """(rotation, 3) unit tangents of the edges, from the lower to the higher vertex, at their Gauss points.

    At rest, or displaced by (node, 3) `u`.
    """
    sign = np.repeat(surface.edge_sign, surface.order, axis=1)
    tangent = surface.edge_tangents
    if u is not None:
        jets = surface.jets(u, surface.reference.edge_first)
        along = surface.reference.edge_tangents.T
        tangent = tangent + along[0] * jets[0] + along[1] * jets[1]
    tangent = tangent * sign / norm(tangent)
    return np.ascontiguousarray(tangent.reshape(3, -1)[:, first_triangle(surface)].T)


def resultant(
    surface: Surface,
    forces: Floats,
    nodes: NDArray | None = None,
    rotations: NDArray | None = None,
    about: ArrayLike = (0.0, 0.0, 0.0),
) -> tuple[Floats, Floats]:
    """Force (3,) and moment (3,) of a vector of forces on unknowns.

    Parameters
    ----------
    forces : (unknowns,)
    nodes, rotations : int arrays, optional
        Which nodes, and which unknown numbers of rotations, take part; all if absent.
    about : (3,)
        Where moments are taken.
    """
    f, moments = forces[: surface.rotation_start].reshape(-1, 3), forces[surface.rotation_start :]
    x = surface.nodes - np.asarray(about, dtype=float)
    axes = rotation_axes(surface)
    if nodes is not None:
        f, x = f[nodes], x[nodes]
    if rotations is not None:
        some = np.asarray(rotations) - surface.rotation_start
        moments, axes = moments[some], axes[some]
    return f.sum(axis=0), np.cross(x, f).sum(axis=0) + moments @ axes


def chart_resultant(
    surface: ChartSurface,
    forces: Floats,
    vertices: NDArray | None = None,
    edges: NDArray | None = None,
    about: ArrayLike = (0.0, 0.0, 0.0),
) -> tuple[Floats, Floats]:
    """Force (3,) and moment (3,) of forces on the unknowns of the Argyris discretisation.

    The moment is the work on an infinitesimal rotation w x X and its derivatives, interpolated at the degrees of
    freedom; it is exact on a flat chart and as accurate as the interpolation of X elsewhere.

    Parameters
    ----------
    forces : (unknowns,)
    vertices, edges : int arrays, optional
        Which of them take part; all if absent.
    """
    mesh, chart = surface.mesh, surface.chart
    count = len(mesh.points)
    x, x_a, x_ab = chart.derivatives(*mesh.points[:, :2].T, order=2)
    arms = [
        x - np.asarray(about, dtype=float),
        x_a[:, 0],
        x_a[:, 1],
        x_ab[:, 0, 0],
        x_ab[:, 0, 1],
        x_ab[:, 1, 1],
    ]
    at_vertices = np.stack(arms, axis=1)  # (vertex, 6, 3)
    a, b = mesh.points[mesh.edges[:, 0], :2], mesh.points[mesh.edges[:, 1], :2]
    t = (b - a) / np.linalg.norm(b - a, axis=1, keepdims=True)
    _, slope = chart.derivatives(*(0.5 * (a + b)).T, order=1)
    at_edges = t[:, 1:] * slope[:, 0] - t[:, :1] * slope[:, 1]  # along the normal of kshell.elements.affine
    f = forces.reshape(-1, 3)
    on_vertices, on_edges = f[: 6 * count].reshape(count, 6, 3), f[6 * count :]
    if vertices is not None:
        on_vertices, at_vertices = on_vertices[vertices], at_vertices[vertices]
    if edges is not None:
        on_edges, at_edges = on_edges[edges], at_edges[edges]
    moment = np.cross(at_vertices, on_vertices).sum(axis=(0, 1)) + np.cross(at_edges, on_edges).sum(axis=0)
    return on_vertices[:, 0].sum(axis=0), moment
