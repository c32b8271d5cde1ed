"""Forces and moments of forces on the unknowns: reactions of supports, and their balance with the loads."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

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
