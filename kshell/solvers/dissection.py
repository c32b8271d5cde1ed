"""Nested dissection by coordinates: an order of elimination with little fill, for meshes of any shape.

Elements are cut in two across one of their longest extents again and again (George 1973). What belongs to elements
of both parts separates them and is eliminated after them. Each cut lies where the fewest things straddle it,
within a window about the middle: in the middle itself it often follows the diagonals of a regular mesh, which
separates with twice as many unknowns as the next grid line. All parts of one level are cut at once.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.solvers import kernels

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

# parts are cut down to this many elements
SMALLEST_PART = 4
# a cut leaves on each side at least this share of its part
SMALLEST_SHARE = 0.35
# a cut away from the middle by a share x of its part counts as 1 + UNEVEN x times what straddles it
UNEVEN = 2.0
# coordinates along which cuts are tried, those of the longest extents
AXES_TRIED = 2


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
    part = parts(centres, members, count)
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


def parts(centres: Floats, members: Ints, count: int) -> Ints:
    """(element,) part of each element, one binary digit for each level of cuts; parameters as of `dissected`."""
    elements, axes = centres.shape
    part = np.zeros(elements, dtype=np.int64)
    bounds = np.array([0, elements])
    # per axis the elements of each part in the order of their coordinate, kept from level to level
    orders: list[Ints] = [
        np.argsort(centres[:, axis], kind="stable").astype(np.int32) for axis in range(axes)
    ]
    # the elements of each thing that lie in one part, behind each other; what is alone there separates nothing
    flat = members.ravel()
    owners = (np.argsort(flat, kind="stable") // members.shape[1]).astype(np.int32)
    starts = np.concatenate([[0], np.cumsum(np.bincount(flat, minlength=count))])
    owners, starts = _not_alone(owners, starts)
    while np.diff(bounds).max() > SMALLEST_PART:
        middle, along = _cuts(centres, orders, bounds, owners, starts)
        number = np.repeat(np.arange(len(middle)), np.diff(bounds))
        beyond = np.zeros(elements, dtype=bool)
        late = np.arange(elements) >= middle[number]
        for axis in range(axes):
            mine = along[number] == axis
            beyond[orders[axis][mine]] = late[mine]
        part = 2 * part + beyond
        orders = [_halved(order, beyond, bounds, middle) for order in orders]
        bounds = _refined(bounds, middle)
        late = np.concatenate([[0], np.cumsum(beyond[owners])])
        cut = starts[1:] - (late[starts[1:]] - late[starts[:-1]])
        owners = _halved(owners, beyond, starts, cut)
        owners, starts = _not_alone(owners, _refined(starts, cut))
    return part


def _not_alone(owners: Ints, starts: Ints) -> tuple[Ints, Ints]:
    """Groups of more than one element: the elements behind each other, and where each group starts and ends."""
    sizes = np.diff(starts)
    kept = sizes > 1
    return owners[np.repeat(kept, sizes)], np.concatenate([[0], np.cumsum(sizes[kept])])


def _refined(bounds: Ints, middle: Ints) -> Ints:
    """The bounds of groups with one more inside each, but where it lies at the end of its group."""
    both = np.append(np.stack([bounds[:-1], middle], axis=1).ravel(), bounds[-1])
    return both[np.append(np.diff(both) > 0, True)]


def _halved(order: Ints, beyond: NDArray[np.bool_], bounds: Ints, middle: Ints) -> Ints:
    """The order with the elements beyond the cut of each group moved to its end, otherwise unchanged."""
    if kernels.compiled is not None:
        moved = np.empty_like(order)
        kernels.compiled.halved(
            order,
            beyond.view(np.uint8),
            kernels.contiguous(bounds, np.int64),
            kernels.contiguous(middle, np.int64),
            moved,
        )
        return moved
    number = np.repeat(np.arange(len(middle)), np.diff(bounds))
    later = beyond[order]
    before = np.concatenate([[0], np.cumsum(later, dtype=np.int32)])
    past = before[:-1] - before[bounds[:-1]][number]  # elements beyond the cut that came earlier in the group
    result = np.empty_like(order)
    result[np.where(later, middle[number] + past, np.arange(len(order)) - past)] = order
    return result


def _cuts(centres: Floats, orders: list[Ints], bounds: Ints, owners: Ints, starts: Ints) -> tuple[Ints, Ints]:
    """Place at which each part is cut, and the axis along which; small parts are not cut: their end, and axis 0."""
    begin, sizes = bounds[:-1], np.diff(bounds)
    elements, count = int(bounds[-1]), len(begin)
    extents = [centres[o[bounds[1:] - 1], axis] - centres[o[begin], axis] for axis, o in enumerate(orders)]
    rank = np.argsort(np.argsort(-np.stack(extents), axis=0, kind="stable"), axis=0, kind="stable")
    best, middle, along = np.full(count, np.inf), bounds[1:].copy(), np.zeros(count, dtype=np.int64)
    position = np.empty(elements, dtype=np.int32)
    across = _across if kernels.compiled is None else _across_compiled
    for axis, order in enumerate(orders):
        position[order] = np.arange(elements)
        least, first = across(position, bounds, owners, starts)
        better = (least < best) & (rank[axis] < AXES_TRIED) & (sizes > SMALLEST_PART)
        best[better], middle[better], along[better] = least[better], first[better] + 1, axis
    return middle, along


def _across(position: Ints, bounds: Ints, owners: Ints, starts: Ints) -> tuple[Floats, Ints]:
    """The least cost (part,) of a cut across the axis along which elements have a position, and the last before it."""
    begin, sizes = bounds[:-1], np.diff(bounds)
    elements = len(position)
    number = np.repeat(np.arange(len(begin)), sizes)
    # a cut at place p + 1 leaves p - begin + 1 elements before it
    off = np.abs((np.arange(elements) - begin[number] + 1) / sizes[number] - 0.5)
    allowed = off <= np.maximum(0.5 - SMALLEST_SHARE, 0.51 / sizes)[number]
    allowed[bounds[1:] - 1] = False
    places = position[owners]
    opens = np.bincount(np.minimum.reduceat(places, starts[:-1]), minlength=elements) if len(owners) else 0
    ends = np.bincount(np.maximum.reduceat(places, starts[:-1]), minlength=elements) if len(owners) else 0
    straddling = np.cumsum(np.broadcast_to(opens - ends, elements))
    cost = np.where(allowed, straddling * (1.0 + UNEVEN * off), np.inf)
    least = np.minimum.reduceat(cost, begin)
    hit = np.flatnonzero(cost == least[number])
    first = np.full(len(begin), elements)
    np.minimum.at(first, number[hit], hit)
    return least, first


def _across_compiled(position: Ints, bounds: Ints, owners: Ints, starts: Ints) -> tuple[Floats, Ints]:
    least, first = np.empty(len(bounds) - 1), np.empty(len(bounds) - 1, dtype=np.int64)
    kernels.compiled.cut_places(
        position,
        owners,
        kernels.contiguous(starts, np.int64),
        kernels.contiguous(bounds, np.int64),
        0.5 - SMALLEST_SHARE,
        UNEVEN,
        np.zeros(len(position), dtype=np.int64),
        least,
        first,
    )
    return least, first
