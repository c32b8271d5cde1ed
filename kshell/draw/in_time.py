"""Loads that depend on the time, for pictures: as they are when they are largest."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.scene.loads import Load
from kshell.values.time import at_time, depends_on_time

MOMENTS = 41


def largest_values(load: Load, points: NDArray[np.float64], end: float | None) -> NDArray[np.float64]:
    """Values of a load at points (n, 3), at that of a few times up to the end at which the largest is largest."""
    if not any(depends_on_time(getattr(load, key, None)) for key in (*load.scaling, *load.placing)):
        return load.at(points)
    found = [_at(load, time).at(points) for time in np.linspace(0.0, end or 1.0, MOMENTS)]
    return max(found, key=lambda values: float(np.abs(values).max(initial=0.0)))


def _at(load: Any, time: float) -> Load:
    keys = (*load.scaling, *load.placing)
    frozen: Load = replace(load, **{key: at_time(getattr(load, key), time) for key in keys})
    return frozen
