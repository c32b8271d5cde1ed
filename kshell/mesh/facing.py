"""Which way a surface faces: where its normal, its top and a positive pressure point, in words; turned on demand."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.errors import InputError
from kshell.mesh.build import reversed_triangles
from kshell.mesh.connected import connected_parts
from kshell.mesh.orient import shared_edges
from kshell.mesh.triangulation import M, Triangulation
from kshell.mesh.vectors import cross
from kshell.mesh.words import place

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

ALIKE = 0.9  # length of the mean normal from which the surface faces one way
MOSTLY = 0.95  # part of the area that faces away from the middle, or towards it, to be said of all
AXIS = np.cos(np.radians(20.0))  # between the mean normal and an axis by which it is called
NO_WAY = 1e-6  # part of the area, or of the solid angle, that tells no direction
MANY = 6  # groups spoken of


def top_words(mesh: Triangulation) -> list[str]:
    """For each surface group, or for the whole mesh where there are none, where a positive pressure pushes."""
    groups = [(f"surface '{name}'", g.members) for name, g in mesh.groups.items() if g.dimension == 2]
    parts = [(name, members.astype(np.int64)) for name, members in groups if len(members)]
    if not parts:
        parts = [("the surface", np.arange(len(mesh.triangles)))]
    words = [f"{name}: positive pressure pushes {_way(mesh, members)}" for name, members in parts[:MANY]]
    return words + ([f"and {len(parts) - MANY} more surfaces"] if len(parts) > MANY else [])


def _area_vectors(mesh: Triangulation) -> Floats:
    a, b, c = (mesh.points[mesh.triangles[:, k]] for k in range(3))
    return 0.5 * cross(b - a, c - a)


def _way(mesh: Triangulation, members: Ints) -> str:
    vectors = _area_vectors(mesh)[members]
    areas = np.linalg.norm(vectors, axis=1)
    centres = mesh.points[mesh.triangles[members]].mean(axis=1)
    middle = (areas[:, None] * centres).sum(axis=0) / areas.sum()
    edges = np.bincount(mesh.triangle_edges[members].ravel(), minlength=len(mesh.edges))
    if not (edges == 1).any() and (edges <= 2).all():
        volume = ((centres - middle) * vectors).sum()
        return f"{'outwards' if volume > 0 else 'inwards'} of the closed surface"
    mean = vectors.sum(axis=0) / areas.sum()
    size = float(np.linalg.norm(mean))
    if size >= ALIKE:
        return f"towards {_direction(mean / size)}"
    away = ((centres - middle) * vectors).sum(axis=1)
    for sign, words in ((1, "away from"), (-1, "towards")):
        if areas[sign * away > 0].sum() >= MOSTLY * areas.sum():
            return f"{words} the middle of the surface, {place(middle)}"
    return f"on the whole towards {_direction(mean / size)}" if size > NO_WAY else "in no one direction"


def _direction(unit: Floats) -> str:
    axis = int(np.argmax(np.abs(unit)))
    if abs(unit[axis]) >= AXIS:
        return f"{'+' if unit[axis] > 0 else '-'}{'xyz'[axis]}"
    return "(" + ", ".join(f"{c + 0.0:.2g}" for c in unit) + ")"


def towards(mesh: M, direction: ArrayLike | None = None, point: ArrayLike | None = None) -> M:
    """The mesh with each sheet turned so that its top looks along a direction, or at a point.

    Parameters
    ----------
    direction : (3,), optional
        The mean normal of each sheet gets a positive component along it.
    point : (3,), optional
        From there each sheet shows its top: the solid angle it fills is positive.

    Raises
    ------
    InputError
        If a sheet faces as much one way as the other.
    """
    pairs, _ = shared_edges(mesh)
    n = len(mesh.triangles)
    one, other = pairs.T // 3
    sheet = connected_parts(n, one, other)[1]
    if point is not None:
        part = -_solid_angles(mesh, np.asarray(point, dtype=float))
        whole: Floats = np.full(int(sheet.max()) + 1, 4 * np.pi)
    else:
        vectors, unit = _area_vectors(mesh), np.asarray(direction, dtype=float)
        part = vectors @ (unit / np.linalg.norm(unit))
        whole = np.bincount(sheet, weights=np.linalg.norm(vectors, axis=1)).astype(float)
    share = np.bincount(sheet, weights=part) / whole
    lost = np.flatnonzero(np.abs(share) <= NO_WAY)
    if len(lost):
        at = place(mesh.points[mesh.triangles[np.flatnonzero(sheet == lost[0])[0]]].mean(axis=0))
        what = "direction" if point is None else "point"
        raise InputError(
            f"top_towards: the sheet at {at} faces as much towards this {what} as away from it; of a closed surface "
            "give a point inside, top_towards = {point = [x, y, z]}"
        )
    reverse = share[sheet] < 0
    return reversed_triangles(mesh, reverse) if reverse.any() else mesh


def _solid_angles(mesh: Triangulation, eye: Floats) -> Floats:
    """(triangle,) solid angle that each fills, seen from a point; positive where its back is seen.

    Van Oosterom & Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125-126.
    """
    a, b, c = (mesh.points[mesh.triangles[:, k]] - eye for k in range(3))
    la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
    volume = (a * cross(b, c)).sum(axis=1)
    rest = la * lb * lc + (a * b).sum(axis=1) * lc + (b * c).sum(axis=1) * la + (a * c).sum(axis=1) * lb
    return 2 * np.arctan2(volume, rest)
