"""Bases of eigenvectors that do not depend on how they were found, and the clusters that make that necessary."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


# eigenvalues closer than this, relative, belong to one cluster
CLUSTER = 1e-6
# entries of a vector as large as the largest up to this
NEARLY = 1e-3


def gap_behind(values: Floats, count: int) -> int | None:
    """How many values, `count` at least, lie before the first gap."""
    for n in range(count, len(values)):
        if values[n] - values[n - 1] > CLUSTER * max(abs(values[n]), abs(values[n - 1])):
            return n
    return None


def canonical(values: Floats, vectors: Floats, weight: Floats) -> Floats:
    """The same vectors with signs, and bases of clusters, that do not depend on where an iteration began.

    In a cluster the first vector takes all of the motion of the entry that moves most, the second all that is left of
    the next one, and so on; every vector is positive there. Of entries that move alike the first one counts.

    Parameters
    ----------
    weight : (n,) array
        By which entries are compared.
    """
    out = vectors.copy()
    for begin, end in clusters(values):
        part = out[:, begin:end]
        left = part * weight[:, None]
        rows = []
        for _ in range(end - begin):
            size = np.linalg.norm(left, axis=1)
            place = int(np.argmax(size >= (1.0 - NEARLY) * size.max()))
            direction = left[place] / size[place]
            rows.append(direction)
            left = left - np.outer(left @ direction, direction)
        out[:, begin:end] = part @ np.array(rows).T
    return out


def clusters(values: Floats, apart: float = CLUSTER) -> list[tuple[int, int]]:
    """(begin, end) of values, ascending, that lie closer to their neighbours than `apart`, relative."""
    out, begin = [], 0
    for n in range(1, len(values) + 1):
        if n == len(values) or values[n] - values[n - 1] > apart * max(abs(values[n]), abs(values[n - 1])):
            out.append((begin, n))
            begin = n
    return out


def orthonormal(mass: Any, vectors: Floats) -> Floats:
    """M-orthonormal combinations of independent vectors (n, k), by Cholesky factors of their Gram matrix, twice."""
    for _ in range(2):
        gram = vectors.T @ (mass @ vectors)
        vectors = np.asarray(np.linalg.solve(np.linalg.cholesky(0.5 * (gram + gram.T)), vectors.T).T, float)
    return vectors
