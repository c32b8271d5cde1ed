"""Nodes of a smooth line that do not lie where their neighbours say.

Symbols
-------
E_k        distance of a node from the polynomial through k neighbours on either side, by their chords
r          of the best k, E_k over E_(k - 1): small where nodes tell the curve, near 1 at a node that lies off
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

NEIGHBOURS = (2, 3, 4, 5)  # k
COMMON = 3.0  # times the median of E_k on the line: what curves that few nodes tell are off everywhere
COUNTED = 0.7  # of what is left


def outlying(parameter: Floats, nodes: Floats, closed: bool) -> Floats:
    """(node,) by how much nodes (n, 2) lie off a line that their neighbours tell; 0 where all do alike.

    Parameters
    ----------
    parameter : (n,) array
        Ascending, about the length from the first node on.
    closed : bool
        Whether the last node is the first one again.
    """
    last = len(nodes) - 1
    count = last if closed else last + 1
    off = np.array([_from_neighbours(parameter, nodes, closed, k) for k in NEIGHBOURS if 2 * k < count - 1])
    if len(off) == 0 or not np.isfinite(off).any():
        return np.zeros(len(nodes))
    around = [_beside(off, shift, closed) for shift in (-1, 0, 1)]  # a difference may be zero by chance
    large = np.max(around, axis=0)
    best, every = np.argmin(large, axis=0), np.arange(count)
    before = large[np.maximum(best - 1, 0), every]
    ratio = np.ones(count)
    told = (best > 0) & np.isfinite(before) & (before > 0.0)
    ratio[told] = np.minimum(large[best, every][told] / before[told], 1.0)
    which = np.argmin(off, axis=0)
    whole = np.isfinite(off[-1])
    # beside the ends of open lines few neighbours tell less than elsewhere, and as much as so few do there
    common = np.array([np.median(of[np.isfinite(of)]) if np.isfinite(of).any() else np.inf for of in off])[
        which
    ]
    if whole.any():
        common[whole] = np.median(off.min(axis=0)[whole])
    known = np.isfinite(off).any(axis=0)
    rest = off[which, every][known] - COMMON * common[known]
    out = np.zeros(len(nodes))
    out[np.flatnonzero(known)] = COUNTED * ratio[known] ** 2 * np.maximum(rest, 0.0)
    if closed:
        out[-1] = out[0]
    return out


def _beside(off: Floats, shift: int, closed: bool) -> Floats:
    moved = np.roll(off, shift, axis=1)
    if not closed and shift:
        end = 0 if shift > 0 else -1
        moved[:, end] = off[:, end]
    return moved


def _from_neighbours(parameter: Floats, nodes: Floats, closed: bool, k: int) -> Floats:
    """(node,) E_k, without the last node where closed; infinite where an open line has no k neighbours."""
    last = len(nodes) - 1
    ahead = np.delete(np.arange(-k, k + 1), k)
    if closed:
        every = np.arange(last)
        of = every[:, None] + ahead
        away = parameter[of % last] + parameter[-1] * (of // last) - parameter[every, None]
        at = nodes[of % last]
    else:
        every = np.arange(k, last + 1 - k)
        of = every[:, None] + ahead
        away, at = parameter[of] - parameter[every, None], nodes[of]
    out = np.full(last if closed else last + 1, np.inf)
    if len(every) == 0:
        return out
    # Lagrange's weights at 0 of places t: the product of t_b / (t_b - t_a) over all b but a
    same = np.eye(2 * k, dtype=bool)
    between = np.where(same, 1.0, away[:, None, :] - away[:, :, None])
    weights = (np.where(same, 1.0, away[:, None, :]) / between).prod(axis=2)
    off = np.einsum("na,nac->nc", weights, at) - nodes[every]
    along = at[:, k] - at[:, k - 1]
    out[every] = np.abs(off[:, 0] * along[:, 1] - off[:, 1] * along[:, 0]) / np.linalg.norm(along, axis=1)
    return out
