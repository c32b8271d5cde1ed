"""Values of loads, springs and supports: constants, or functions of places, or of places and normals."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
OfPlace = Callable[[Floats], Floats]
Value = ArrayLike | Callable[[Floats], ArrayLike]


@dataclass(frozen=True)
class OfNormal:
    """A function of places with normals (n, 6); kernels of loads on surfaces know the normal."""

    function: OfPlace

    def __call__(self, places: Floats) -> Floats:
        return self.function(places)


def evaluate(value: Value, points: Floats, size: int, normal: Callable[[], Floats] | None = None) -> Floats:
    """Value at points (..., 3): (..., size), or (...) for size 1.

    Parameters
    ----------
    normal : function, optional
        Gives normals (..., 3) of any length at the points; called only for values that depend on them.
    """
    flat = points.reshape(-1, 3)
    if isinstance(value, OfNormal):
        assert normal is not None, "a load that is not on a surface"
        n = normal().reshape(-1, 3)
        flat = np.hstack([flat, n / np.linalg.norm(n, axis=1, keepdims=True)])
    found = np.asarray(value(flat) if callable(value) else value, dtype=float)
    shape = (len(flat),) if size == 1 else (len(flat), size)
    return np.broadcast_to(found, shape).reshape(points.shape[:-1] if size == 1 else points.shape)
