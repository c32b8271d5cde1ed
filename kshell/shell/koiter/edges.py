"""Directors at the edges, from which all triangles at an edge measure the angle to their normals.

The director is a unit vector across the edge, fixed in space. The angle between it and the normals on
both sides tells how the edge folds; the rotation unknown of the edge turns it about the tangent. After a
converged step of a large deflection the directors take up that rotation, so that they never lag behind.

Everything here is kept at the Gauss points of the edges: `rotation` numbers them as the unknowns do.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kshell.shell.kinematics import angle_change
from kshell.shell.koiter.surface import Surface
from kshell.shell.vectors import cross, dot, norm

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Directors:
    """Directors and the state from which changes of the angle are counted.

    Attributes
    ----------
    vectors : (3, rotation)
        Unit directors.
    base : (node, 3)
        Displacement of the state in which they were last set.
    angle : (triangle, 3 p)
        Change of the angle between normal and director from the rest state to the base state.
    """

    vectors: Floats
    base: Floats
    angle: Floats


def first_triangle(surface: Surface) -> NDArray[np.int64]:
    """(rotation,) position in the flat (triangle, 3 p) arrays of the first edge point with that rotation."""
    flat = surface.triangle_rotations.ravel()
    first = np.empty(surface.order * len(surface.rotation_owner), dtype=np.int64)
    first[flat[::-1]] = np.arange(len(flat))[::-1]
    return first


def rest_directors(surface: Surface) -> Directors:
    """The mean of the normals of the triangles at each edge.

    Normals that point to the other side of the first one (a sheet of opposite orientation) are reversed,
    so the mean never vanishes.
    """
    normal = cross(*surface.tangents(surface.reference.edge_first))
    normal = (normal / norm(normal)).reshape(3, -1)
    place = surface.triangle_rotations.ravel()
    first = normal[:, first_triangle(surface)]
    side = np.where(dot(normal, first[:, place]) >= 0, 1.0, -1.0)
    sums = [np.bincount(place, weights=c * side, minlength=first.shape[1]) for c in normal]
    total = np.asarray(np.stack(sums), dtype=float)
    return Directors(
        total / norm(total), np.zeros_like(surface.nodes), np.zeros(surface.triangle_rotations.shape)
    )


def edge_angles(surface: Surface, directors: Directors, u: Floats) -> Floats:
    """(triangle, 3 p) change of the angle since rest, for directors that did not turn since the base state."""
    first = surface.reference.edge_first
    base = surface.tangents(first) + surface.jets(directors.base, first)
    d = directors.vectors[:, surface.triangle_rotations]
    along = surface.reference.edge_tangents.T
    return directors.angle + angle_change(base, surface.jets(u - directors.base, first), along, d).change


def turn_directors(
    surface: Surface, directors: Directors, x: Floats, keep: NDArray | None = None
) -> tuple[Floats, Directors]:
    """Let the directors take up the rotations of the state x.

    Parameters
    ----------
    x : (unknowns,)
    keep : (n,) int array, optional
        Unknown numbers of rotations that are prescribed: they stay as they are.

    Returns
    -------
    (unknowns,) array
        x with the rotations taken up set to zero.
    Directors
    """
    u, rotation = surface.split(x)
    turned = rotation.ravel().copy()
    if keep is not None:
        turned[np.asarray(keep) - surface.rotation_start] = 0.0
    angle = edge_angles(surface, directors, u)

    first = surface.reference.edge_first
    tangents = surface.tangents(first) + surface.jets(u, first)
    along = surface.reference.edge_tangents.T
    t = along[0] * tangents[0] + along[1] * tangents[1]
    sign = np.repeat(surface.edge_sign, surface.order, axis=1)  # (triangle, 3 p)
    t = (t * sign / norm(t)).reshape(3, -1)[:, first_triangle(surface)]  # from the lower to the higher vertex
    d = directors.vectors - t * dot(directors.vectors, t)
    d /= norm(d)
    d = d * np.cos(turned) + cross(t, d) * np.sin(turned)

    result = x.copy()
    result[surface.rotation_start :] -= turned
    angle = angle + sign * turned[surface.triangle_rotations]
    return result, replace(directors, vectors=d, base=u.copy(), angle=angle)
