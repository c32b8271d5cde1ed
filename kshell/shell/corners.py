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
ROUNDING = 1e-6  # of angles: two right ones at a fold are no more than 180 degrees
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
    ends, turn, plain = _turns(mesh)
    known = mesh.midpoints is not None
    sharp = np.flatnonzero(plain & (turn > (LEAST if known else POLYGON)))
    sharp = sharp[_angles(mesh, sharp) > np.pi + ROUNDING] if len(sharp) else sharp
    if len(sharp) and not known:
        beside = np.zeros(len(turn))  # the larger turn of both next vertices
        for here, there in (ends.T, ends.T[::-1]):
            np.maximum.at(beside, here, np.where(plain[there], turn[there], 0.0))
        sharp = sharp[turn[sharp] > np.minimum(SURELY, SHARPER * beside[sharp])]
    if not len(sharp):
        return {}
    lowest, highest = np.full(len(turn), len(mesh.triangles)), np.full(len(turn), -1)
    np.minimum.at(lowest, mesh.triangles, np.repeat(patches[:, None], 3, axis=1))
    np.maximum.at(highest, mesh.triangles, np.repeat(patches[:, None], 3, axis=1))
    return dict.fromkeys(sharp[lowest[sharp] == highest[sharp]].tolist(), RE_ENTRANT)


def _turns(mesh: Mesh) -> tuple[Ints, Floats, NDArray[np.bool_]]:
    """Ends of the edges of the border, by what angle it turns (vertex,), and where just two of its edges meet.

    Of unit vectors a and b that leave a vertex |a + b|^2 = 2 - 2 cos of the turn.
    """
    border, count = mesh.boundary_edges, len(mesh.points)
    ends = mesh.edges[border]
    x = mesh.points[ends]
    leaving = x[:, ::-1] - x
    if mesh.midpoints is not None:
        leaving = 4.0 * (mesh.midpoints[border][:, None] - x) - leaving
    leaving /= np.maximum(np.sqrt(np.einsum("nex,nex->ne", leaving, leaving)), 1e-300)[..., None]
    vertex, leaving = ends.ravel(), leaving.reshape(-1, 3)
    square = sum(np.bincount(vertex, leaving[:, k], count) ** 2 for k in range(3))
    turn = np.arccos(np.clip(1.0 - 0.5 * square, -1.0, 1.0))
    return ends, turn, np.bincount(vertex, minlength=count) == 2


def _angles(mesh: Mesh, vertices: Ints) -> Floats:
    """(n,) the sum of the angles of the triangles around vertices (n,)."""
    chosen = np.zeros(len(mesh.points), dtype=bool)
    chosen[vertices] = True
    triangle, local = np.nonzero(chosen[mesh.triangles])
    at, after, before = (mesh.triangles[triangle, (local + step) % 3] for step in range(3))
    a, b = mesh.points[after] - mesh.points[at], mesh.points[before] - mesh.points[at]
    product = np.sqrt(np.einsum("nx,nx->n", a, a) * np.einsum("nx,nx->n", b, b))
    cosine = np.einsum("nx,nx->n", a, b) / np.maximum(product, 1e-300)
    total = np.bincount(at, np.arccos(np.clip(cosine, -1.0, 1.0)), len(mesh.points))
    return np.asarray(total[vertices], dtype=float)
