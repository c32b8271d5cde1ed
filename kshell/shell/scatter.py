"""Blocks of elements summed into a sparse matrix."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def along_directions(weight: Floats, shape: Floats, direction: Floats) -> Floats:
    """Blocks of springs, (element, 3 n, 3 n), component by component of each of n functions.

    The sum over points of weight N_i N_j d d^T.

    Parameters
    ----------
    weight : (element, q)
        Stiffness times weight of quadrature.
    shape : (q, n) or (element, q, n)
    direction : (3,) or (element, q, 3)
        Unit vectors d.
    """
    moved = shape[..., None] * np.broadcast_to(direction, (*weight.shape, 3))[:, :, None, :]  # (e, q, n, 3)
    moved = moved.reshape(*weight.shape, -1)
    blocks: Floats = np.matmul(moved.swapaxes(1, 2), weight[..., None] * moved)
    return blocks


def scattered(numbers: NDArray[Any], blocks: Floats, size: int) -> sp.csr_matrix:
    """Sum of blocks (element, n, n) at the rows and columns `numbers` (element, n) of a matrix (size, size)."""
    n = numbers.shape[1]
    place = (np.repeat(numbers, n, axis=1).ravel(), np.tile(numbers, (1, n)).ravel())
    return sp.csr_matrix((blocks.ravel(), place), shape=(size, size))
