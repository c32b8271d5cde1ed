"""Corners of the border of a shell that turn into it, where membrane forces and moments grow without bound.

Near a corner with more than 180 degrees of material stresses go like r^(lambda - 1) and moments like r^(lambda - 2),
with exponents that make both infinite, whatever holds the edges there (M. L. Williams, J. Appl. Mech. 19 (1952)
526-528; Proc. 1st US Nat. Congr. Appl. Mech. (1952) 325-329). Of a shell that holds in its tangent plane, since its
curvature is a smaller term there. The end of a slit is one, with 360 degrees.

A border of straight edges may stand for a curve: its vertices are corners where it turns by more than the border does
at the next vertices. Curved edges have tangents, which tell.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.mesh import Mesh

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

RE_ENTRANT = "re-entrant corner"
LEAST = np.radians(10.0)  # turns that count where tangents are known
POLYGON = np.radians(30.0)  # of straight edges, if it is SHARPER times the turns beside it
SHARPER = 2.0
SURELY = np.radians(60.5)  # whatever is beside it: no curve is told by five edges


def re_entrant_corners(mesh: Mesh, patches: Ints) -> dict[int, str]:
    """Vertices where the border of one smooth piece turns into it, with the kind of corner.

    Parameters
    ----------
    mesh : Mesh
        In space.
    patches : (triangle,)
        Smooth piece of each triangle; where pieces meet at a vertex it is not looked at, for the other one holds it.
    """
    border = np.flatnonzero(mesh.edge_counts == 1)
    ends, count = mesh.edges[border], len(mesh.points)
    degree = np.bincount(ends.ravel(), minlength=count)
    turn, following = _turns(mesh, border, ends, degree == 2)
    beside = np.maximum(turn[following[:, 0]], turn[following[:, 1]])
    corner = turn > (
        LEAST if mesh.midpoints is not None else np.minimum(SURELY, np.maximum(POLYGON, SHARPER * beside))
    )
    corner &= degree == 2
    if not corner.any():
        return {}
    corner &= _angles(mesh) > np.pi
    lowest, highest = np.full(count, len(mesh.triangles)), np.full(count, -1)
    np.minimum.at(lowest, mesh.triangles, np.repeat(patches[:, None], 3, axis=1))
    np.maximum.at(highest, mesh.triangles, np.repeat(patches[:, None], 3, axis=1))
    return dict.fromkeys(np.flatnonzero(corner & (lowest == highest)).tolist(), RE_ENTRANT)


def _turns(mesh: Mesh, border: Ints, ends: Ints, plain: NDArray[np.bool_]) -> tuple[Floats, Ints]:
    """(vertex,) by what angle the border turns, and (vertex, 2) the next vertices on it; zero, itself elsewhere."""
    count = len(mesh.points)
    start, end = mesh.points[ends[:, 0]], mesh.points[ends[:, 1]]
    middle = 0.5 * (start + end) if mesh.midpoints is None else mesh.midpoints[border]
    leaving = np.concatenate([4 * middle - 3 * start - end, 4 * middle - 3 * end - start])
    leaving /= np.maximum(np.linalg.norm(leaving, axis=1, keepdims=True), 1e-300)
    vertex, other = ends.T.ravel(), ends[:, ::-1].T.ravel()
    order = np.argsort(vertex, kind="stable")
    order = order[plain[vertex[order]]].reshape(-1, 2)  # both edges at each vertex that has two
    at = vertex[order[:, 0]]
    turn, following = np.zeros(count), np.repeat(np.arange(count)[:, None], 2, axis=1)
    cosine = -np.sum(leaving[order[:, 0]] * leaving[order[:, 1]], axis=1)
    turn[at] = np.arccos(np.clip(cosine, -1.0, 1.0))
    following[at] = other[order]
    return turn, following


def _angles(mesh: Mesh) -> Floats:
    """(vertex,) the sum of the angles of the triangles around each vertex."""
    out = np.zeros(len(mesh.points))
    x = mesh.points[mesh.triangles]
    for k in range(3):
        a, b = x[:, (k + 1) % 3] - x[:, k], x[:, (k + 2) % 3] - x[:, k]
        sine, cosine = np.linalg.norm(np.cross(a, b), axis=1), np.sum(a * b, axis=1)
        np.add.at(out, mesh.triangles[:, k], np.arctan2(sine, cosine))
    return out
