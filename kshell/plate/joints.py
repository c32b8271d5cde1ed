"""Where an arc of a circle runs into a straight edge, or into another arc, without a corner: told by the nodes alone.

The circle through the last three nodes of an arc has a tangent at its end. That the next chord, or the circle through
the nodes behind, has the same direction to rounding is no chance, however long that chord is beside those of the arc;
of other curves chords turn from the tangent by about half of what the chord before turned.

Symbols
-------
c, d, e, f         a node, and those that follow it on one side
half               half the angle that the arc from c to d subtends: that at e between de and ce (inscribed)
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

SAME = 1e-7  # of half, between directions that agree
LEAST = 1e-3  # half from which the arc is told from a straight line
WIDEST = 0.6  # half of an edge of an arc
BENT = 1e-6  # relative difference of curvatures that is one


def tangent_joints(nodes: Floats, step: int, closed: bool, rounding: float) -> Bools:
    """(n,) whether a vertex of a line of nodes (n, 2) is where an arc ends in its own tangent.

    Parameters
    ----------
    step : int
        Nodes per edge; vertices are every so many.
    closed : bool
        Whether the last node is the first one again.
    rounding : float
        Of the coordinates.
    """
    n = len(nodes)
    if n < 4:
        return np.zeros(n, dtype=bool)

    ahead, before = _Side(nodes, closed, 1), _Side(nodes, closed, -1)
    rough = 4.0 * rounding / np.minimum(ahead.shortest, before.shortest)
    found = np.zeros(n, dtype=bool)
    with np.errstate(divide="ignore", invalid="ignore"):  # where there are too few nodes
        for arc, other in ((before, ahead), (ahead, before)):
            size = np.abs(arc.half)
            near = SAME * size + rough
            sure = arc.enough[2] & other.enough[1] & (size > LEAST) & (size < WIDEST) & (rough < 0.01 * size)
            straight = np.abs(np.angle(-other.chord / arc.tangent)) < near
            # three nodes on both sides of a point of inflection may give one tangent: four are asked for
            differ = np.abs(arc.bend + other.bend) > BENT * np.abs(arc.bend)
            both = arc.is_round(near) & other.is_round(near) & differ
            both &= np.abs(np.angle(-other.tangent / arc.tangent)) < near
            found |= sure & (straight | both)
    return found & (np.arange(n) % step == 0)


def beside(joints: Bools, closed: bool) -> Bools:
    """(n,) whether a node is one of the two next to a joint on either side."""
    inner = joints[:-1] if closed else np.pad(joints, 2)
    found = np.any([np.roll(inner, shift) for shift in (-2, -1, 1, 2)], axis=0)
    return np.append(found, found[0]) if closed else found[2:-2]


class _Side:
    """What lies on one side of each node c: d, e and f, the next ones, the first of them the nearest.

    Attributes
    ----------
    enough : (4, n) bool array
        Whether there are so many.
    chord, tangent : (n,) complex array
        From c to d, and the unit tangent at c of the circle through c, d and e; away from c.
    half, bend : (n,) array
        Positive to the left, away from c; bend is the curvature of that circle.
    shortest : (n,) array
        Distance of these nodes.
    """

    def __init__(self, nodes: Floats, closed: bool, way: int) -> None:
        n = len(nodes)
        index = np.arange(n) + way * np.arange(4)[:, None]
        inside = (index >= 0) & (index < n)
        self.enough = np.ones((4, n), dtype=bool) if closed else inside
        x, y = nodes[index % (n - 1) if closed else np.clip(index, 0, n - 1)].transpose(2, 0, 1)
        c, d, e, f = x + 1j * y
        self.chord = d - c
        with np.errstate(divide="ignore", invalid="ignore"):
            self.half: Floats = np.angle((e - d) / (e - c))
            self._further: Floats = np.angle((f - d) / (f - c))
            self.tangent = self.chord / np.abs(self.chord) * np.exp(-1j * self.half)
            self.bend: Floats = 2.0 * np.sin(self.half) / np.abs(self.chord)
        apart = np.where(self.enough[2], np.abs(e - d), np.inf)
        self.shortest: Floats = np.maximum(np.minimum(np.abs(d - c), apart), np.finfo(float).tiny)

    def is_round(self, near: Floats) -> Bools:
        """Whether f is on the circle, too."""
        return self.enough[3] & (np.abs(self._further - self.half) < near)
