"""Sizes of triangles that meet a tolerance: every triangle of the new mesh is to have the same error.

A triangle of size h with the mark m, its share of the half width, is like m = c h^(q + 2), q the rate of the half
width. As few triangles as can be have a sum of marks M' if all have the same mark m', so that h' = h (m'/m)^(1/(q + 2))
and there are (m/m')^(2/(q + 2)) of them in the place of one; their number times m' is M':

    m' = (M' / sum m^(2 / (q + 2)))^((q + 2) / q)

Source: Onate & Bugeda, Eng. Comput. 10 (1993) 307-321 (equal shares of the error for all elements), with marks in the
place of squares of norms.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

MOST_GROWTH = 5.0  # of the number of triangles from one mesh to the next
SMALLEST = 1.0 / 8.0  # of the size before
BISECTIONS = 60
LEAST = 1e-12  # reduction, where the half width is not known at all


def wanted_ratios(marks: Floats, reduction: float, rate: float, most: float = MOST_GROWTH) -> Floats:
    """(triangle,) wanted sizes over present ones, at most 1.

    Parameters
    ----------
    marks : (triangle,) array
        What each triangle adds to the half width.
    reduction : float
        Wanted half width over the present one.
    rate : float
        Power of the size with which the half width falls.
    most : float
        Growth of the number of triangles.
    """
    if not marks.sum() > 0.0:
        return np.ones(len(marks))
    power = 1.0 / (rate + 2.0)
    share = marks / marks.sum()
    spread = float((share ** (2.0 * power)).sum())
    each = (max(reduction, LEAST) / spread) ** ((rate + 2.0) / rate)

    def ratios(each: float) -> Floats:
        return np.clip((each / np.maximum(share, 1e-300)) ** power, SMALLEST, 1.0)

    low, high = np.log(each), 0.0
    if _growth(ratios(each)) <= most:
        return ratios(each)
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _growth(ratios(float(np.exp(middle)))) > most else (low, middle)
    return ratios(float(np.exp(high)))


def _growth(ratios: Floats) -> float:
    return float((ratios**-2.0).mean())
