"""A triangle divided evenly: its points, and the smaller triangles between them."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def lattice(parts: int) -> Floats:
    """(point, corner) barycentric coordinates of the points of a triangle whose sides have so many parts."""
    i, j = _steps(parts).T
    return np.stack([parts - i - j, i, j], axis=-1) / parts


@lru_cache(maxsize=16)
def _steps(parts: int) -> Ints:
    """(point, 2) steps along both axes of the reference triangle; not to be written to."""
    i, j = np.meshgrid(np.arange(parts + 1), np.arange(parts + 1), indexing="ij")
    return np.stack([i, j], axis=-1)[i + j <= parts]


def numbers(parts: int) -> tuple[Ints, Ints, Ints]:
    """Which points of a lattice are the corners (3,), and lie on the edges (3, parts - 1), and the others.

    Edges are (0, 1), (1, 2), (0, 2), their points from the first vertex to the second.
    """
    i, j = _steps(parts).T
    place = np.full((parts + 1, parts + 1), -1)
    place[i, j] = np.arange(len(i))
    k = np.arange(1, parts)
    edges = np.stack([place[k, 0], place[parts - k, k], place[0, k]])
    inside = np.flatnonzero((i > 0) & (j > 0) & (i + j < parts))
    return place[[0, parts, 0], [0, 0, parts]], edges, inside


def pieces(parts: int) -> Ints:
    """(parts^2, 3) the smaller triangles, as numbers of points, turning as the large one."""
    i, j = _steps(parts).T
    place = np.full((parts + 2, parts + 2), -1)
    place[i, j] = np.arange(len(i))
    upward = np.stack([place[i, j], place[i + 1, j], place[i, j + 1]], axis=1)
    downward = np.stack([place[i + 1, j], place[i + 1, j + 1], place[i, j + 1]], axis=1)
    both = np.concatenate([upward, downward])
    return both[(both >= 0).all(axis=1)]
