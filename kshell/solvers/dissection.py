"""Nested dissection by coordinates: an order of elimination with little fill, for meshes of any shape.

Elements are halved across their longest extent again and again (George 1973). What belongs to elements of both
halves separates them and is eliminated after them. All parts of one level are halved at once.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

# parts are halved down to this many elements
SMALLEST_PART = 4


def dissected(centres: Floats, members: Ints, count: int) -> Ints:
    """Place of each thing in the order of elimination.

    Parameters
    ----------
    centres : (element, d)
    members : (element, k) int array
        Things (nodes, edges) of each element, which couple with each other.
    count : int
        How many things there are.

    Returns
    -------
    (count,) int array, a permutation
    """
    elements = len(centres)
    order = np.arange(elements)
    bounds = np.array([0, elements])
    part = np.zeros(elements, dtype=np.int64)  # one binary digit for each level
    for _ in range(max(0, int(np.ceil(np.log2(max(elements, 1) / SMALLEST_PART))))):
        starts, sizes = bounds[:-1], np.diff(bounds)
        x = centres[order]
        extent = np.maximum.reduceat(x, starts) - np.minimum.reduceat(x, starts)
        number = np.repeat(np.arange(len(starts)), sizes)
        along = x[np.arange(elements), np.argmax(extent, axis=1)[number]]
        order = order[np.lexsort((along, number))]
        middle = starts + sizes // 2
        part[order] = 2 * part[order] + (np.arange(elements) >= np.repeat(middle, sizes))
        bounds = np.sort(np.concatenate([bounds, middle]))

    # a thing lies in the smallest part that holds all of its elements: the digits these have in common
    of_member = np.repeat(part, members.shape[1])
    low, high = np.full(count, part.max(initial=0)), np.zeros(count, dtype=np.int64)
    np.minimum.at(low, members.ravel(), of_member)
    np.maximum.at(high, members.ravel(), of_member)
    level = np.frexp((low ^ high).astype(float))[1].astype(np.int64)  # digits not in common
    last = (high | ((1 << level) - 1)).astype(np.int64)  # part after which the separator may go
    place = np.empty(count, dtype=np.int64)
    place[np.lexsort((level, last))] = np.arange(count)
    return place
