"""What curved borders lose where they are taken as their chords: flat parts of shells, and Morley plates.

A clamped disk on a polygon with edges that turn by phi stores less energy by phi^2 / 2, on parabolas by phi^4 / 170
(12, 24 and 48 edges).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.error.curve_doubt import turns
from kshell.mesh.higher import order_of
from kshell.mesh.mesh import Mesh
from kshell.plate.rims import edge_curves

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

CHORDS, PARABOLAS = 0.6, 1e-2  # of phi^2 and phi^4
PLANE = 1e-9  # of the normal
TOLD = 1e-3  # share from which it is told


def share_of_chords(turn: Floats, length: Floats) -> float:
    """Relative error because edges (edge,) of some lengths, which turn by some angles, are chords."""
    return float(CHORDS * (turn**2 * length).sum() / length.sum())


def share_of_flat_parts(mesh: Mesh, pieces: Ints) -> float:
    """The same of the borders of a shell where it is flat; of those of order 2, which are parabolas.

    Parameters
    ----------
    pieces : (triangle,) int array
        Smooth parts.
    """
    order = order_of(mesh)
    if order > 2:
        return 0.0
    x = mesh.points[mesh.triangles]
    normal = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    missed, whole = 0.0, 0.0
    for piece in np.unique(pieces):
        triangles = np.flatnonzero(pieces == piece)
        if np.linalg.norm(np.cross(normal[triangles], normal[triangles[0]]), axis=1).max() > PLANE:
            continue
        flat = _in_its_plane(mesh, triangles)
        curves = edge_curves(flat, flat.boundary_edges)
        turn, length = np.where(curves.curved, turns(curves), 0.0), flat.edge_lengths[curves.edges]
        missed += float(((CHORDS * turn**2 if order == 1 else PARABOLAS * turn**4) * length).sum())
        whole += float(length.sum())
    return missed / whole if missed > 0.0 else 0.0


def words(share: float) -> str:
    """What the user should know of it."""
    return (
        f"curved borders of flat parts are taken as chords, which may change displacements by {share:.1e} of "
        "themselves: mesh with order 2, or name the geometry the mesh was made from"
    )


def _in_its_plane(mesh: Mesh, triangles: NDArray[np.integer]) -> Mesh:
    """Some triangles of one plane, in two of its axes."""
    vertices, corners = np.unique(mesh.triangles[triangles].ravel(), return_inverse=True)
    x = mesh.points[vertices] - mesh.points[vertices[0]]
    a, b, c = x[corners.reshape(-1, 3)[0]]
    first = (b - a) / np.linalg.norm(b - a)
    second = (c - a) - ((c - a) @ first) * first
    axes = np.stack([first, second / np.linalg.norm(second)])
    flat = x @ axes.T
    own = corners.reshape(-1, 3)
    edge = flat[own]
    turned = np.linalg.det(np.stack([edge[:, 1] - edge[:, 0], edge[:, 2] - edge[:, 0]], axis=1)) < 0.0
    own = np.where(turned[:, None], own[:, ::-1], own)
    return Mesh(
        np.column_stack([flat, np.zeros(len(flat))]), own.astype(np.int32), None, {}
    )  # checked as a part
