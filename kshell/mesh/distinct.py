"""Numbers of vertices, edges or triangles, each once: marked instead of sorted."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.int64]


def distinct(count: int, *parts: NDArray[np.integer]) -> Ints:
    """(n,) numbers from 0 to below ``count`` that occur in some of the arrays, ascending."""
    marked = np.zeros(count, dtype=bool)
    for numbers in parts:
        marked[numbers] = True
    return marked.nonzero()[0]


def renumbered(numbers: NDArray[np.integer]) -> Ints:
    """The places of numbers, at least 0, among the distinct ones: as the inverse of `np.unique`, without sorting.

    It needs room for the largest of them.
    """
    there = np.zeros(int(numbers.max(initial=-1)) + 1, dtype=bool)
    there[numbers] = True
    place: Ints = np.cumsum(there, dtype=np.int64) - 1
    return place[numbers]
