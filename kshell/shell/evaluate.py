"""Values of loads, springs and supports: constants, or functions of places."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
OfPlace = Callable[[Floats], Floats]
Value = ArrayLike | Callable[[Floats], ArrayLike]


def evaluate(value: Value, points: Floats, size: int) -> Floats:
    """Value at points (..., 3): (..., size), or (...) for size 1."""
    flat = points.reshape(-1, 3)
    found = np.asarray(value(flat) if callable(value) else value, dtype=float)
    shape = (len(flat),) if size == 1 else (len(flat), size)
    return np.broadcast_to(found, shape).reshape(points.shape[:-1] if size == 1 else points.shape)
