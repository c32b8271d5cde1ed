"""Edges as lines of nodes: chained, broken at corners and where the curvature jumps, and told from straight ones."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

SHARPEST_SMOOTH_TURN = np.radians(70.0)
GENTLEST_CORNER = np.radians(12.0)
BLUNT_CORNER = np.radians(25.0)  # turn from which a vertex of a smooth line may as well be a corner
STRAIGHT = 1e-9
ALIKE = 1.5  # ratio of turns at both ends of such an edge
FLAT = 1e-6  # angle between edges of one straight side, of nodes with rounding
KINK = 1e-3  # turn from which a single vertex between straight sides is a corner
UNLIKE = 3.0  # ratio of its turn to those at the far ends of these sides


def chained(ends: Ints) -> list[tuple[NDArray[np.int64], NDArray[np.bool_], bool]]:
    """Chain edges (n, 2) into lines: (positions, whether walked from lower to higher, closed)."""
    touching: dict[int, list[int]] = {}
    for k, pair in enumerate(ends.tolist()):
        for v in pair:
            touching.setdefault(v, []).append(k)
    pairs = ends.tolist()
    used = np.zeros(len(ends), dtype=bool)

    def walk(k: int, start: int) -> tuple[list[int], list[bool], int]:
        line, forward, v = [], [], start
        while not used[k]:
            used[k] = True
            a, b = pairs[k]
            line.append(k)
            forward.append(a == v)
            v = b if a == v else a
            onward = touching[v]
            if len(onward) != 2:
                break
            k = onward[1] if onward[0] == k else onward[0]
        return line, forward, v

    lines = []
    for v, around in touching.items():  # open lines start where one or more than two edges meet
        if len(around) != 2:
            for k in around:
                if not used[k]:
                    line, forward, _ = walk(k, v)
                    lines.append((np.array(line), np.array(forward), False))
    for k in range(len(ends)):  # what is left are closed loops
        if not used[k]:
            line, forward, _ = walk(k, pairs[k][0])
            lines.append((np.array(line), np.array(forward), True))
    return lines


def polygon(nodes: Floats, step: int, closed: bool, rounding: float) -> Floats | None:
    """(edge, 2) unit directions of a line of straight sides and sharp corners; None of others.

    All edges of a side have the same direction, as conditions on them ask for.
    """
    chord = nodes[1:] - nodes[:-1]
    x, y = chord.T
    length = np.hypot(x, y)
    before = np.arange(len(chord)) - 1 if closed else np.arange(len(chord) - 1)  # -1: the last one
    after = before + 1
    dot = x[before] * x[after] + y[before] * y[after]
    cross = x[before] * y[after] - y[before] * x[after]
    longer = np.maximum(length[before], length[after])
    ahead = (np.abs(cross) < rounding * longer) & (dot > 0.0)
    corner = dot < np.cos(SHARPEST_SMOOTH_TURN) * length[before] * length[after]
    if not (ahead | corner).all():
        return None
    at = after[corner]  # nodes at which sides end
    if step > 1 and (at % step).any():
        return None
    count = len(chord)
    ends = at if closed else np.concatenate([[0], at, [count]])
    if not len(ends):
        return None
    number = np.searchsorted(ends, np.arange(0, count, step), side="right") - 1  # -1: the side over the start
    begin, end = (ends, np.append(ends[1:], ends[0])) if closed else (ends[:-1], ends[1:])
    sides = nodes[end] - nodes[begin]
    unit = sides / np.hypot(sides[:, 0], sides[:, 1])[:, None]
    return np.asarray(unit[number])


def breaks(
    nodes: Floats, step: int, closed: bool, rounding: float
) -> tuple[NDArray[np.bool_], NDArray[np.bool_], Floats]:
    """Where a line of nodes has corners, where its curvature jumps, and how it turns at each node.

    Turns that rounding of the coordinates makes between very short edges are none.
    """
    n = len(nodes)
    chord = np.diff(nodes, axis=0)
    length = np.linalg.norm(chord, axis=1)
    angle = np.arctan2(chord[:, 1], chord[:, 0])
    before = np.concatenate([[angle[-1] if closed else angle[0]], angle])
    after = np.concatenate([angle, [angle[0] if closed else angle[-1]]])
    signed = (after - before + np.pi) % (2 * np.pi) - np.pi
    length_before = np.concatenate([[length[-1] if closed else length[0]], length])
    length_after = np.concatenate([length, [length[0] if closed else length[-1]]])
    signed[np.abs(signed) * np.minimum(length_before, length_after) < rounding] = 0.0
    turn = np.abs(signed)
    span = 0.5 * (length_before + length_after)
    bend = signed / span

    def neighbour(x: Floats, shift: int) -> Floats:
        if closed:
            return x[(np.arange(n) + shift) % (n - 1)]
        index = np.arange(n) + shift
        inside = (index > 0) & (index < n - 1)
        return np.where(inside, x[np.clip(index, 0, n - 1)], 0.0)

    vertex = np.arange(n) % step == 0
    sharp = vertex & (turn > SHARPEST_SMOOTH_TURN)
    along = np.where(
        sharp, 0.0, turn
    )  # the turn of a corner is no curvature, at which its neighbours would be alike
    sides = np.maximum(neighbour(along, 1), neighbour(along, -1))
    corner = sharp | (vertex & (turn > GENTLEST_CORNER) & (turn > 3 * sides))
    corner |= vertex & _kinks(signed, closed)
    # one edge between straight sides: a side cut off, as no arc of one edge is known; where one of the straight sides
    # has one edge, too, an arc that ran into the other would turn by half as much there
    for k in (-1, 1):
        other = neighbour(turn, k)
        beyond = np.stack([neighbour(turn, -k), neighbour(turn, 2 * k)])
        at_sharp = np.stack([neighbour(along, -k), neighbour(along, 2 * k)])
        alike = (beyond.max(axis=0) < FLAT) | (np.maximum(turn, other) < ALIKE * np.minimum(turn, other))
        straight = (at_sharp.max(axis=0) < FLAT) & (beyond.min(axis=0) < FLAT)
        corner |= vertex & (np.minimum(turn, other) > GENTLEST_CORNER) & straight & alike
    # a zigzag, such as the border of a group on a mesh that does not follow it
    bends = np.where(vertex & ~corner & (turn > GENTLEST_CORNER), signed, 0.0)
    corner |= np.any([bends * neighbour(bends, k) < 0.0 for k in (-2, -1, 1, 2)], axis=0)
    # a jump of curvature (an arc that runs into a straight line) stands out from the change before
    # and after it; where the curvature merely varies fast, as on an ellipse, all changes are alike
    ahead, behind = neighbour(bend, 1), neighbour(bend, -1)
    # the turn of a corner is no curvature, and what lies beyond it belongs to another line
    at_corner = corner.astype(float)
    far_ahead = np.where(neighbour(at_corner, 2) + neighbour(at_corner, 3) > 0, ahead, neighbour(bend, 3))
    far_behind = np.where(
        neighbour(at_corner, -2) + neighbour(at_corner, -3) > 0, behind, neighbour(bend, -3)
    )
    change = np.abs(ahead - behind)
    before_it = np.abs(behind - far_behind)
    after_it = np.abs(far_ahead - ahead)
    scale = np.maximum(np.abs(ahead), np.abs(behind))
    stands_out = (change > 0.5 * scale) & (change > 8 * np.maximum(before_it, after_it))
    # a short arc between straight sides, a fillet of two or three edges: flat on one side is enough
    flat = np.minimum(
        np.maximum(np.abs(behind), np.abs(far_behind)),
        np.maximum(np.abs(ahead), np.abs(far_ahead)),
    )
    stands_out |= flat < 0.02 * scale
    beside_corner = neighbour(at_corner, 1) + neighbour(at_corner, -1) > 0
    jump = vertex & ~corner & ~beside_corner & stands_out & (scale * span > 1e-6)
    if not closed:
        corner[[0, -1]] = jump[[0, -1]] = False
        near_end = np.minimum(np.arange(n), n - 1 - np.arange(n)) <= 3  # no neighbour to compare with
        jump &= ~near_end
    return corner, jump, turn


def _kinks(signed: Floats, closed: bool) -> NDArray[np.bool_]:
    """Nodes that turn alone between straight sides of two edges and more, as no curve does, however little they turn.

    A curve whose chords were divided turns alike, and to the same side, at the other end of one of these sides.
    """
    out = np.zeros(len(signed), dtype=bool)
    last = len(signed) - 1  # of closed lines the first node once more
    own = signed[:-1] if closed else signed
    turning = np.flatnonzero(np.abs(own) > FLAT)
    if closed:
        if len(turning) < 2:
            return out
        before, after = np.roll(turning, 1), np.roll(turning, -1)
        apart = np.minimum((turning - before) % last, (after - turning) % last)
        far = own[np.stack([before, after])]
    else:  # its ends turn as nothing else
        ends = np.concatenate([[0], turning, [last]])
        before, after = ends[:-2], ends[2:]
        apart = np.minimum(turning - before, after - turning)
        far = np.where(np.isin(np.stack([before, after]), turning), own[np.stack([before, after])], 0.0)
    mine = own[turning]
    size = np.abs(far)
    unlike = (far * mine < 0.0) | (size > UNLIKE * np.abs(mine)) | (UNLIKE * size < np.abs(mine))
    out[turning] = (np.abs(mine) > KINK) & (apart > 1) & unlike.all(axis=0)
    if closed:
        out[last] = out[0]
    return out


def is_straight(nodes: Floats, rounding: float) -> bool:
    """Whether a run of nodes lies on a straight line as far as rounding lets one see."""
    chord, whole = np.diff(nodes, axis=0), nodes[-1] - nodes[0]
    length = np.linalg.norm(chord, axis=1)
    off = np.abs(whole[0] * (nodes[:, 1] - nodes[0, 1]) - whole[1] * (nodes[:, 0] - nodes[0, 0])).max()
    near = 0.01 * STRAIGHT * length.min() + rounding
    return bool(off < near * length.sum() and (chord @ whole > 0).all())
