"""Which points lie in which balls: sorted into cells of a grid, without trees and without loops over points."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

CLASS = 2.0  # ratio of the largest and the smallest ball that are looked for together
FINEST = 1e-6  # of the size of everything: smaller cells would need more digits than an integer has
FEW = 4_096  # pairs that are all looked at
HELD = 2_000_000  # pairs held at once


def in_balls(points: Floats, centres: Floats, reach: Floats, ordered: bool = True) -> tuple[Ints, Ints]:
    """Pairs of a ball and a point in it or on its border.

    Parameters
    ----------
    points : (point, 3) array
    centres, reach : (ball, 3), (ball,) arrays
        Middles and radii, 0 or more.
    ordered : bool
        By ball, then by point; else as they are found.

    Returns
    -------
    balls, points : two (pair,) arrays of numbers
    """
    none = np.zeros(0, dtype=np.int64)
    if not len(points) or not len(centres):
        return none, none
    if len(points) * len(centres) <= FEW:
        off = points - centres[:, None]
        ball, point = np.nonzero(np.einsum("bpx,bpx->bp", off, off) <= (reach**2)[:, None])
        return ball, point
    found = [(none, none)]
    least = FINEST * float(np.ptp(points, axis=0).max())
    size = np.maximum(reach, least)
    if size.max() <= CLASS * size.min():
        found += _in_class(points, centres, reach, np.arange(len(centres)))
    else:
        level = np.floor(np.log(np.maximum(size, 1e-300)) / np.log(CLASS)).astype(np.int64)
        for k in np.unique(level):
            found += _in_class(points, centres, reach, np.flatnonzero(level == k))
    ball, point = (np.concatenate(part) for part in zip(*found, strict=True))
    if not ordered:
        return ball, point
    order = np.lexsort((point, ball))
    return ball[order], point[order]


def _in_class(points: Floats, centres: Floats, reach: Floats, which: Ints) -> Iterator[tuple[Ints, Ints]]:
    """The pairs of some balls of about one size: a ball reaches into its cell and those around it."""
    low = points.min(axis=0)
    extent = np.ptp(points, axis=0)
    cell = max(float(reach[which].max()), FINEST * float(extent.max())) * (1 + 1e-9)
    if cell == 0.0:  # all points are at one place
        cell = 1.0
    counts = np.floor(extent / cell).astype(np.int64) + 1
    home = np.minimum(np.floor((points - low) / cell).astype(np.int64), counts - 1)
    key = (home[:, 2] * counts[1] + home[:, 1]) * counts[0] + home[:, 0]
    order = np.argsort(key, kind="stable")
    key = key[order]
    # as floats: balls may lie far outside
    own = np.floor((centres[which] - low) / cell)
    near = ((own >= -1) & (own <= counts)).all(axis=1)
    which, own = which[near], own[near].astype(np.int64)
    first = np.clip(own[:, 0] - 1, 0, counts[0] - 1)
    last = np.clip(own[:, 0] + 1, 0, counts[0] - 1)
    for z in (-1, 0, 1) if counts[2] > 1 else (0,):
        for y in (-1, 0, 1) if counts[1] > 1 else (0,):
            row_y = own[:, 1] + y if counts[1] > 1 else np.zeros_like(first)
            row_z = own[:, 2] + z if counts[2] > 1 else np.zeros_like(first)
            inside = (row_y >= 0) & (row_y < counts[1]) & (row_z >= 0) & (row_z < counts[2])
            row = (row_z[inside] * counts[1] + row_y[inside]) * counts[0]
            start = np.searchsorted(key, row + first[inside], side="left")
            stop = np.searchsorted(key, row + last[inside], side="right")
            yield from _of_ranges(points, centres, reach, which[inside], order, start, stop)


def _of_ranges(
    points: Floats, centres: Floats, reach: Floats, balls: Ints, order: Ints, start: Ints, stop: Ints
) -> Iterator[tuple[Ints, Ints]]:
    """The pairs among balls and ranges of points, so many at a time that they fit."""
    length = stop - start
    ends = np.cumsum(length)
    begin = 0
    while begin < len(balls):
        before = ends[begin - 1] if begin else 0
        end = max(begin + 1, int(np.searchsorted(ends, before + HELD, side="right")))
        here = slice(begin, end)
        begin = end
        number = length[here]
        total = int(number.sum())
        if not total:
            continue
        ball = np.repeat(balls[here], number)
        place = np.arange(total) + np.repeat(start[here] - (np.cumsum(number) - number), number)
        point = order[place]
        off = points[point] - centres[ball]
        keep = np.einsum("ij,ij->i", off, off) <= reach[ball] ** 2
        yield ball[keep], point[keep]
