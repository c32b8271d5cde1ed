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
from kshell.mesh.vectors import cross
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
    normal = cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    _, first, piece = np.unique(pieces, return_index=True, return_inverse=True)
    bent = np.linalg.norm(cross(normal, normal[first[piece]]), axis=1) > PLANE
    flat = np.ones(len(first), dtype=bool)
    flat[piece[bent]] = False
    if not flat.any():
        return 0.0
    found = _in_their_planes(mesh, np.flatnonzero(flat[piece]), piece, first)
    curves = edge_curves(found, found.boundary_edges)
    turn, length = np.where(curves.curved, turns(curves), 0.0), found.edge_lengths[curves.edges]
    missed = float(((CHORDS * turn**2 if order == 1 else PARABOLAS * turn**4) * length).sum())
    return missed / float(length.sum()) if missed > 0.0 else 0.0


def words(share: float) -> str:
    """What the user should know of it."""
    return (
        f"curved borders of flat parts are taken as chords, which may change displacements by {share:.1e} of "
        "themselves: mesh with order 2, or name the geometry the mesh was made from"
    )


def _in_their_planes(mesh: Mesh, triangles: Ints, piece: Ints, first: Ints) -> Mesh:
    """Triangles of flat pieces, each piece in two axes of its plane and with vertices of its own.

    Parameters
    ----------
    triangles : (n,) int array
    piece : (triangle,) int array
        Of all triangles.
    first : (piece,) int array
        A triangle of each.
    """
    count = len(mesh.points)
    key, own = np.unique(piece[triangles, None] * count + mesh.triangles[triangles], return_inverse=True)
    of, vertex = np.divmod(key, count)
    some, begin, number = np.unique(of, return_index=True, return_inverse=True)
    a, b, c = np.moveaxis(mesh.points[mesh.triangles[first[some]]], 1, 0)
    one = (b - a) / np.linalg.norm(b - a, axis=1, keepdims=True)
    other = (c - a) - ((c - a) * one).sum(axis=1, keepdims=True) * one
    axes = np.stack([one, other / np.linalg.norm(other, axis=1, keepdims=True)], axis=1)
    x = mesh.points[vertex] - mesh.points[vertex[begin[number]]]
    flat = np.einsum("nax,nx->na", axes[number], x)
    own = own.reshape(-1, 3)
    (u, v), (s, t) = (flat[own[:, k]].T - flat[own[:, 0]].T for k in (1, 2))
    own = np.where((u * t - v * s < 0.0)[:, None], own[:, ::-1], own)
    return Mesh(
        np.column_stack([flat, np.zeros(len(flat))]), own.astype(np.int32), None, {}
    )  # checked as a part
