"""Signs for vectors that point at the reader or away: a ring with a dot or a cross.

As paths of their own: to set them as formulas loads the reader of formulas, and takes longer than the picture.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from matplotlib.path import Path

Floats = NDArray[np.float64]

RING, DOT = (
    0.22,
    0.18,
)  # of the radius of a sign: how thick its ring and the bars of its cross are, and its dot


@cache
def toward() -> Path:
    """A ring of radius 1 with a dot."""
    return _ring_with(DOT * _circle(17))


@cache
def away() -> Path:
    """A ring of radius 1 with two bars along the diagonals."""
    long, half = 1.0 - RING, 0.5 * RING
    bar = np.array([[-long, -half], [long, -half], [long, half], [-long, half], [-long, -half]])
    turn = np.sqrt(0.5) * np.array([[1.0, -1.0], [1.0, 1.0]])
    return _ring_with(bar @ turn.T, bar @ turn)


def _circle(points: int) -> Floats:
    angle = np.linspace(0.0, 2.0 * np.pi, points)
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


def _ring_with(*parts: Floats) -> Path:
    """A ring and closed polygons (n, 2)."""
    from matplotlib.path import Path

    outer = _circle(49)
    every = (outer, (1.0 - RING) * outer[::-1], *parts)  # the other way round: a hole
    codes = [[Path.MOVETO, *[Path.LINETO] * (len(part) - 2), Path.CLOSEPOLY] for part in every]
    return Path(np.concatenate(every), np.concatenate(codes))
