"""Forces and moments of forces on the unknowns of the Argyris discretisation."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.shell.chart.surface import ChartSurface

Floats = NDArray[np.float64]


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
    chosen = [np.zeros((count, 6, 1), dtype=bool), np.zeros((len(mesh.edges), 1), dtype=bool)]
    for flags, members in zip(chosen, (vertices, edges), strict=True):
        flags[slice(None) if members is None else members] = True
    nodes = surface.nodes
    f = forces.reshape(-1, 3) * nodes.spread(*chosen)
    lift = np.zeros((count, 6, 1))
    lift[:, 0] = 1.0
    moment = np.cross(nodes.spread(at_vertices, at_edges), f).sum(axis=0)
    return (nodes.spread(lift, np.zeros((len(mesh.edges), 1))) * f).sum(axis=0), moment
