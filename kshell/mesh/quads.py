"""Quadrilaterals split into triangles, said in notes.

Each is cut along its shorter diagonal; one that is not convex along the diagonal inside it. A quadrilateral with two
equal neighbouring corners, as many programs write triangles, is a triangle. The centre of an 8-node quadrilateral,
which becomes the mid-edge node of the diagonal, is that of the serendipity functions,

    x(0, 0) = 1/2 sum of the 4 mid-side nodes - 1/4 sum of the 4 corners
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh.words import count, place

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

EQUAL = (
    1e-6  # relative difference of diagonals that counts as none: the first one is taken, on a grid everywhere
)
WARPED = 1e-3  # distance of the two diagonals from each other, in their mean length, from which on it is said
THIN = (
    1e-12  # product of the doubled areas of two halves, in the fourth power of the diagonal, that is no area
)

# the two halves on each diagonal: corners, then the mid-side nodes 4 to 7 of sides (0, 1), (1, 2), (2, 3), (3, 0) and
# the centre 8
HALVES = np.array(
    [
        [[0, 1, 2, 4, 5, 8], [0, 2, 3, 8, 6, 7]],
        [[0, 1, 3, 4, 8, 7], [1, 2, 3, 5, 6, 8]],
    ]
)


@dataclass(frozen=True)
class Split:
    """Triangles of quadrilaterals.

    Attributes
    ----------
    points : (k, 3) float array
        Nodes made on the way, the centres of 8-node quadrilaterals; they follow those given.
    triangles : (n, 3 or 6) int array
    origin : (n,) int array
        The row of the quadrilateral that each triangle is of, ascending.
    warped : int
        How many 4-node quadrilaterals are not plane.
    worst : float
        The largest distance of two diagonals from each other, in their mean length.
    """

    points: Floats
    triangles: Ints
    origin: Ints
    warped: int
    worst: float


def split(points: Floats, quads: Ints, source: str) -> Split:
    """Split quadrilaterals.

    Parameters
    ----------
    points : (node, 3) float array
    quads : (n, 4, 8 or 9) int array
        Corners, mid-side nodes, centre.
    source : str
        For messages.

    Raises
    ------
    InputError
        If two sides of a quadrilateral cross each other, or corners that do not follow each other are the same.
    """
    n_given = len(points)
    if quads.size and (quads.min() < 0 or quads.max() >= n_given):
        raise InputError(f"{source}: a quadrilateral names a node that does not exist. Write the file again")
    collapsed, folded_at = _equal_neighbours(quads, points, source)
    whole = np.flatnonzero(~collapsed)
    cells = quads[whole]
    made = np.empty((0, 3))
    if quads.shape[1] == 8:
        x = points[cells]
        made = 0.5 * x[:, 4:].sum(axis=1) - 0.25 * x[:, :4].sum(axis=1)
        cells = np.column_stack([cells, n_given + np.arange(len(cells))])
    width = 3 if quads.shape[1] == 4 else 6
    first = _diagonals(points[cells[:, :4]], source)
    halves = HALVES[first][:, :, :width]  # (cell, half, node)
    parts = np.take_along_axis(cells[:, None, :], halves, axis=2).reshape(-1, width)
    triangles = np.concatenate([parts, _as_triangles(quads[collapsed], folded_at[collapsed], width)])
    origin = np.concatenate([np.repeat(whole, 2), np.flatnonzero(collapsed)])
    order = np.argsort(origin, kind="stable")
    warp = _warp(points[cells[:, :4]]) if width == 3 else np.zeros(1)
    warped = int(np.count_nonzero(warp > WARPED))
    return Split(made, triangles[order], origin[order], warped, float(warp.max(initial=0.0)))


def note(number: int, warped: int, worst: float) -> str:
    """Words for quadrilaterals that were split."""
    text = f"{count(number, 'quadrilateral')} split into triangles along the shorter diagonal"
    if warped:
        text += (
            f"; {warped} of them {'is' if warped == 1 else 'are'} warped, their diagonals up to {worst:.2%} of the "
            "diagonal apart: there the surface depends on the diagonal chosen"
        )
    return text


def _equal_neighbours(quads: Ints, points: Floats, source: str) -> tuple[NDArray[np.bool_], Ints]:
    """Which quadrilaterals have two equal neighbouring corners, and the first of the two."""
    corners = quads[:, :4]
    same = np.equal(corners, np.roll(corners, -1, axis=1))  # (quad, side)
    crosswise = (corners[:, 0] == corners[:, 2]) | (corners[:, 1] == corners[:, 3]) | (same.sum(axis=1) > 1)
    if crosswise.any():
        row = int(np.flatnonzero(crosswise)[0])
        raise InputError(
            f"{source}: {count(int(crosswise.sum()), 'quadrilateral')} with fewer than three different corners, e.g. "
            f"at {place(points[corners[row, 0]])}. Remove such cells, or mesh again"
        )
    collapsed: NDArray[np.bool_] = np.any(same, axis=1)
    return collapsed, np.argmax(same, axis=1)


def _as_triangles(quads: Ints, side: Ints, width: int) -> Ints:
    """Quadrilaterals whose corners `side` and `side + 1` are one node."""
    corner = (side[:, None] + np.array([1, 2, 3])) % 4
    triangles = np.take_along_axis(quads, corner, axis=1)
    if width == 3:
        return triangles
    return np.column_stack([triangles, np.take_along_axis(quads, 4 + corner, axis=1)])


def _diagonals(x: Floats, source: str) -> Ints:
    """0 for the diagonal (0, 2), 1 for (1, 3), of corners x (quad, 4, 3)."""
    longest = np.maximum(np.sum((x[:, 2] - x[:, 0]) ** 2, axis=1), np.sum((x[:, 3] - x[:, 1]) ** 2, axis=1))
    valid = np.empty((len(x), 2), dtype=bool)
    for diagonal, halves in enumerate(HALVES):
        one, other = (
            np.cross(x[:, b] - x[:, a], x[:, c] - x[:, a]) for a, b, c, *_ in halves.tolist()
        )  # twice the areas
        valid[:, diagonal] = np.sum(one * other, axis=1) > THIN * longest**2
    crossed = np.flatnonzero(~valid.any(axis=1))
    if len(crossed):
        raise InputError(
            f"{source}: {count(len(crossed), 'quadrilateral')} without area or with sides that cross each other, e.g. "
            f"at {place(x[crossed[0]].mean(axis=0))}. Mend the order of its corners, or mesh again"
        )
    length = np.stack(
        [np.linalg.norm(x[:, 2] - x[:, 0], axis=1), np.linalg.norm(x[:, 3] - x[:, 1], axis=1)], axis=1
    )
    second = length[:, 1] < length[:, 0] * (1 - EQUAL)
    return np.where(valid.all(axis=1), second, valid[:, 1]).astype(np.int64)


def _warp(x: Floats) -> Floats:
    """(quad,) distance of the two diagonals from each other, in their mean length."""
    one, other = x[:, 2] - x[:, 0], x[:, 3] - x[:, 1]
    normal = np.cross(one, other)
    size = np.linalg.norm(normal, axis=1)
    mean = 0.5 * (np.linalg.norm(one, axis=1) + np.linalg.norm(other, axis=1))
    apart = np.abs(np.sum((x[:, 1] - x[:, 0]) * normal, axis=1))
    return np.divide(apart, size * mean, out=np.zeros(len(x)), where=size > 0)
