"""Blocks of elements summed into a sparse matrix."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def scattered(numbers: NDArray[Any], blocks: Floats, size: int) -> sp.csr_matrix:
    """Sum of blocks (element, n, n) at the rows and columns `numbers` (element, n) of a matrix (size, size)."""
    n = numbers.shape[1]
    place = (np.repeat(numbers, n, axis=1).ravel(), np.tile(numbers, (1, n)).ravel())
    return sp.csr_matrix((blocks.ravel(), place), shape=(size, size))
