"""Equivalent and principal values of plane tensors given as xx, yy, xy."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def von_mises(stress: Floats) -> Floats:
    """Equivalent stress (...) of plane stress (..., 3)."""
    xx, yy, xy = np.moveaxis(stress, -1, 0)
    return np.sqrt(np.maximum(xx**2 - xx * yy + yy**2 + 3 * xy**2, 0.0))


def principal(tensor: Floats) -> Floats:
    """Principal values (..., 2), the larger first, of symmetric tensors (..., 3)."""
    xx, yy, xy = np.moveaxis(tensor, -1, 0)
    mean, radius = (xx + yy) / 2, np.hypot((xx - yy) / 2, xy)
    return np.stack([mean + radius, mean - radius], axis=-1)


def principal_angle(tensor: Floats) -> Floats:
    """Angle (...) from axis 1 to the direction of the larger principal value, in (-pi/2, pi/2]."""
    xx, yy, xy = np.moveaxis(tensor, -1, 0)
    return np.asarray(0.5 * np.arctan2(2.0 * xy, xx - yy))
