"""Which triangles to refine, and how far a mesh is to be graded toward what is known to be singular."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MOST_HALVINGS = (
    36  # toward a corner: coordinates have 53 bits, and triangles need some of them for their shape
)


def doerfler(marks: Floats, share: float) -> Ints:
    """The fewest triangles that have a share of a sum.

    Source: Doerfler, SIAM J. Numer. Anal. 33 (1996) 1106-1124.
    """
    order = np.argsort(-marks, kind="stable")
    total = np.cumsum(marks[order])
    if not total[-1] > 0.0:
        return order
    return order[: int(np.searchsorted(total, share * total[-1])) + 1]


def halvings(exponent: float, tolerance: float) -> int:
    """How often the triangles at a corner are to be halved, where the deflection is like r^exponent.

    The energy within r of the corner is like r^(2 (exponent - 1)): that of the innermost ring is to be below the
    tolerance; two rings are left to the estimate.
    """
    wanted = np.log2(1.0 / tolerance) / (2.0 * (exponent - 1.0)) - 2.0
    return int(np.clip(np.ceil(wanted), 0, MOST_HALVINGS))
