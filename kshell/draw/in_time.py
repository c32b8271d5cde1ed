"""Loads that depend on the time, for pictures: as they are when they are largest."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.scene.loads import Load
from kshell.scene.placed_pressures import Patch
from kshell.values.time import at_time, depends_on_time

MOMENTS = 41


def largest_values(load: Load, points: NDArray[np.float64], end: float | None) -> NDArray[np.float64]:
    """Values of a load at points (n, 3), at that of a few times up to the end at which the largest is largest."""
    return at_largest(load, points, end).at(points)


def at_largest(load: Load, points: NDArray[np.float64], end: float | None) -> Load:
    """The load at that moment; of a patch that moves, the first at which most of it is on the points."""
    if not any(depends_on_time(getattr(load, key, None)) for key in (*load.scaling, *load.placing)):
        return load
    patch = isinstance(load, Patch)

    def size(frozen: Load) -> float:
        values = np.abs(frozen.at(points))
        return float(values.sum() if patch else values.max(initial=0.0))

    return max((_at(load, time) for time in np.linspace(0.0, end or 1.0, MOMENTS)), key=size)


def pressed(
    load: Patch, centres: NDArray[np.float64], members: NDArray[np.int32], end: float | None
) -> tuple[Patch, NDArray[np.int32]]:
    """A patch when most of it is on a surface, and the triangles it presses on then.

    Parameters
    ----------
    load : Patch
    centres : (n, 3)
        Of triangles.
    members : (n,) int array
        Their numbers.
    end : float or None
        Of the time.
    """
    frozen = at_largest(load, centres, end)
    assert isinstance(frozen, Patch)
    return frozen, members[frozen.at(centres) != 0.0]


def _at(load: Any, time: float) -> Load:
    keys = (*load.scaling, *load.placing)
    frozen: Load = replace(load, **{key: at_time(getattr(load, key), time) for key in keys})
    return frozen
