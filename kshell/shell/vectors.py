"""Vector algebra on arrays whose first axis holds the three Cartesian components.

The components come first so that every operation below runs over long contiguous arrays.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

AXES = {"x": 0, "y": 1, "z": 2}  # place of each component


def cross(a: Floats, b: Floats) -> Floats:
    """Vector product of (3, ...) arrays."""
    result = np.empty(np.broadcast_shapes(a.shape, b.shape))
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        np.multiply(a[j], b[k], out=result[i])
        result[i] -= a[k] * b[j]
    return result


def dot(a: Floats, b: Floats) -> Floats:
    """Scalar product of (3, ...) arrays."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def norm(a: Floats) -> Floats:
    """Length of (3, ...) arrays."""
    return np.sqrt(dot(a, a))


def outer(a: Floats, b: Floats) -> Floats:
    """Dyadic product of (m, ...) and (n, ...): (m, n, ...)."""
    return a[:, None] * b[None]


def skew(a: Floats) -> Floats:
    """Matrix [a]x with [a]x b = a x b, of (3, ...): (3, 3, ...)."""
    zero = np.zeros_like(a[0])
    return np.array([[zero, -a[2], a[1]], [a[2], zero, -a[0]], [-a[1], a[0], zero]])
