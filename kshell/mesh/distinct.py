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
