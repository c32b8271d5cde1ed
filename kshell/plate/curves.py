"""The true shape of curved edges, rebuilt from the nodes of the mesh.

The nodes of a mesh (vertices, and mid-edge nodes at order 2) lie on the true edge of the plate; the
chords between them do not. A quintic spline through the nodes of each smooth piece, or the circle that they
lie on, gives tangents, curvature and the shape of every edge to high order, so that supports can be imposed
on the edge itself: on the chords a simply supported curved edge would be clamped in the limit (the paradox of
Babuska, see Babuska & Pitkaranta, SIAM J. Math. Anal. 21 (1990) 551-576).

Symbols
-------
gamma(s)   an edge as a curve, s in [0, 1] from its lower to its higher vertex
delta(s)   gamma(s) minus the chord  =  s (1 - s) phi(s), phi a cubic, on arcs of circles of degree 7
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import comb

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.mesh import Mesh
from kshell.plate.circles import COEFFICIENTS, angles_of_arc, arc_derivatives, arc_shapes
from kshell.plate.splines import spline_derivatives

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

SHARPEST_SMOOTH_TURN = np.radians(70.0)
GENTLEST_CORNER = np.radians(12.0)
STRAIGHT = 1e-9
CUBIC = 4  # coefficients of phi of a spline
# from coefficients of a polynomial of s to those of the same one of 1 - s
BACKWARDS = np.array([[(-1.0) ** j * comb(k, j) for k in range(COEFFICIENTS)] for j in range(COEFFICIENTS)])
UNEVEN = 0.02  # relative difference of the lengths of neighbouring edges
REFITS = 2
KEPT = 8  # sets of edges of a mesh whose shapes are kept
ROUNDING = 8.0 * float(np.finfo(float).eps)  # of coordinates: what cannot be told from a straight line


@dataclass(frozen=True)
class EdgeCurves:
    """Shape of a set of edges, in the plane.

    Attributes
    ----------
    edges : (n,) int array
        Edge numbers, sorted.
    tangent : (n, end, 2) array
        Unit tangents at the lower and the higher vertex, pointing from lower to higher. Where a line
        is smooth both neighbouring edges have the same tangent; at a corner each has its own.
    curvature : (n, end, 2) array
        Second derivative of the curve by arc length, a vector across the tangent.
    shape : (n, k, 2) array
        Coefficients of phi(s) in 1, s, s^2, ...: four, or eight where an edge of the set is an arc of a circle.
    sharpest : float
        Largest turn (radians) of the mesh lines that was taken as part of a smooth curve.
    sharpest_at : (2,) array
    """

    edges: Ints
    tangent: Floats
    curvature: Floats
    shape: Floats
    sharpest: float
    sharpest_at: Floats

    def place(self, edges: NDArray[np.integer]) -> NDArray[np.int64]:
        """Positions of given edges in this set."""
        return np.searchsorted(self.edges, edges)

    def deviation(self, place: NDArray[np.integer], s: Floats, order: int = 0) -> Floats:
        """delta(s) of some edges, or its first or second derivative by s: (n, point, 2)."""
        n = self.shape.shape[1]
        power = np.arange(n + 2)
        c = np.zeros((len(place), n + 2, 2))  # s phi(s) - s^2 phi(s)
        c[:, 1:-1] += self.shape[place]
        c[:, 2:] -= self.shape[place]
        for _ in range(order):
            c = c[:, 1:] * power[1 : c.shape[1], None]
        return np.einsum("qk,nkx->nqx", s[:, None] ** np.arange(c.shape[1]), c)

    @cached_property
    def arcs(self) -> NDArray[np.bool_]:
        """(n,) whether an edge is an arc of a circle."""
        return np.asarray(self.shape[:, CUBIC:].any(axis=(1, 2)))

    @cached_property
    def curved(self) -> NDArray[np.bool_]:
        """(n,) whether an edge deviates from its chord by more than rounding."""
        return np.abs(self.shape).max(axis=(1, 2)) > 0.0


def edge_curves(mesh: Mesh, edges: Ints) -> EdgeCurves:
    """Rebuild the shape of a set of edges, such as the boundary or a line inside the plate.

    Parameters
    ----------
    mesh : Mesh
        A planar mesh; x and y are used.
    edges : (n,) int array
        Edges whose shape is wanted. Smoothness is judged within this set: lines are broken where
        more than two of the edges meet, at corners, and where the curvature jumps.

    What was found is kept with the mesh, so its arrays are not to be written to.
    """
    edges = np.unique(edges).astype(np.int32) if len(edges) else np.zeros(0, dtype=np.int32)
    known: dict[bytes, EdgeCurves] = mesh.__dict__.setdefault("_edge_curves", {})
    key = edges.tobytes()
    if key not in known:
        if len(known) >= KEPT:
            known.clear()
        known[key] = _edge_curves(mesh, edges)
    return known[key]


def _edge_curves(mesh: Mesh, edges: Ints) -> EdgeCurves:
    """The same for edges in ascending order."""
    n = len(edges)
    shape = np.zeros((n, COEFFICIENTS, 2))
    out = EdgeCurves(edges, np.zeros((n, 2, 2)), np.zeros((n, 2, 2)), shape, 0.0, np.zeros(2))
    if n == 0:
        return out
    sharpest, where = 0.0, np.zeros(2)
    for line, forward, closed in _lines(mesh.edges[edges]):
        turn, place = _fit_line(mesh, out, line, forward, closed)
        if turn > sharpest:
            sharpest, where = turn, place
    if not shape[:, CUBIC:].any():
        shape = shape[:, :CUBIC]
    return EdgeCurves(edges, out.tangent, out.curvature, shape, sharpest, where)


def joined_curves(one: EdgeCurves, other: EdgeCurves) -> EdgeCurves:
    """Two sets of edges as one."""
    order = np.argsort(np.concatenate([one.edges, other.edges]))
    edges, tangent, curvature = (
        np.concatenate([getattr(one, name), getattr(other, name)])[order]
        for name in ("edges", "tangent", "curvature")
    )
    most = max(one.shape.shape[1], other.shape.shape[1])
    shapes = [np.pad(x.shape, ((0, 0), (0, most - x.shape.shape[1]), (0, 0))) for x in (one, other)]
    shape = np.concatenate(shapes)[order]
    worse = one if one.sharpest >= other.sharpest else other
    return EdgeCurves(edges, tangent, curvature, shape, worse.sharpest, worse.sharpest_at)


def _lines(ends: Ints) -> list[tuple[NDArray[np.int64], NDArray[np.bool_], bool]]:
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


def _fit_line(
    mesh: Mesh, out: EdgeCurves, line: NDArray[np.int64], forward: NDArray[np.bool_], closed: bool
) -> tuple[float, Floats]:
    """Fit the smooth pieces of one line and write its edges into ``out``."""
    edges = out.edges[line]
    step = 1 if mesh.midpoints is None else 2  # nodes per edge
    first = np.where(forward, mesh.edges[edges, 0], mesh.edges[edges, 1])
    last = np.where(forward, mesh.edges[edges, 1], mesh.edges[edges, 0])
    origin = mesh.points[first[0], :2]
    nodes = np.empty((len(line) * step + 1, 2))
    nodes[:-1:step] = mesh.points[first, :2] - origin
    nodes[-1] = mesh.points[last[-1], :2] - origin
    if mesh.midpoints is not None:
        nodes[1::2] = mesh.midpoints[edges, :2] - origin

    rounding = ROUNDING * float(np.abs(nodes + origin).max())
    directions = _polygon(nodes, step, closed, rounding)
    if directions is not None:
        out.tangent[line] = np.where(forward, 1.0, -1.0)[:, None, None] * directions[:, None]
        return 0.0, origin
    corner, jump, turn = _breaks(nodes, step, closed, rounding)
    smooth = np.where(corner, 0.0, turn)[::step]
    worst = int(np.argmax(smooth))
    breaks = np.flatnonzero(corner | jump)
    if closed and len(breaks):  # start at a break so that every piece is an open run of nodes
        shift = int(breaks[0])
        nodes = np.concatenate([np.roll(nodes[:-1], -shift, axis=0), nodes[shift : shift + 1]])
        line, forward = np.roll(line, -shift // step), np.roll(forward, -shift // step)
        corner, jump = (np.append(np.roll(x[:-1], -shift), x[shift]) for x in (corner, jump))
        breaks = np.flatnonzero(corner | jump)
    inner = [int(b) for b in breaks if 0 < b < len(nodes) - 1]
    bounds = [0, *inner, len(nodes) - 1]
    periodic = closed and not len(breaks)
    derivatives = np.empty((len(line), 2, 2, 2))  # (edge, end, first or second by own parameter, xy)
    straight = np.zeros(len(line), dtype=bool)
    theta = np.zeros(len(line))
    for a, b in pairwise(bounds):
        run, place = nodes[a : b + 1], slice(a // step, b // step)
        straight[place] = _is_straight(run, rounding)
        if straight[place].any():
            derivatives[place] = _straight_derivatives(run, step)
            continue
        angles = angles_of_arc(run, step, rounding)
        if angles is None:
            derivatives[place] = _spline_derivatives(run, step, periodic)
        else:
            theta[place] = angles
            derivatives[place] = arc_derivatives(np.diff(run[::step], axis=0), angles)
    joint = jump[::step] & ~corner[::step]
    _store(out, line, forward, nodes[::step], derivatives, straight, theta, joint, closed)
    return float(smooth[worst]), nodes[worst * step] + origin


def _polygon(nodes: Floats, step: int, closed: bool, rounding: float) -> Floats | None:
    """(edge, 2) unit directions of a line of straight sides and sharp corners; None of others.

    All edges of a side have the same direction, as conditions on them ask for.
    """
    chord = np.diff(nodes, axis=0)
    x, y = chord.T
    length = np.hypot(x, y)
    before = np.roll(np.arange(len(chord)), 1) if closed else np.arange(len(chord) - 1)
    after = np.arange(len(chord)) if closed else before + 1
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


def _breaks(
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

    sides = np.maximum(neighbour(turn, 1), neighbour(turn, -1))
    vertex = np.arange(n) % step == 0
    corner = vertex & (turn > GENTLEST_CORNER) & ((turn > 3 * sides) | (turn > SHARPEST_SMOOTH_TURN))
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


def _is_straight(nodes: Floats, rounding: float) -> bool:
    """Whether a run of nodes lies on a straight line as far as rounding lets one see."""
    chord, whole = np.diff(nodes, axis=0), nodes[-1] - nodes[0]
    length = np.linalg.norm(chord, axis=1)
    off = np.abs(whole[0] * (nodes[:, 1] - nodes[0, 1]) - whole[1] * (nodes[:, 0] - nodes[0, 0])).max()
    near = 0.01 * STRAIGHT * length.min() + rounding
    return bool(off < near * length.sum() and (chord @ whole > 0).all())


def _straight_derivatives(nodes: Floats, step: int) -> Floats:
    """What a spline would give on a straight run, all edges along the same direction."""
    whole = nodes[-1] - nodes[0]
    direction = whole / np.linalg.norm(whole)
    out = np.zeros(((len(nodes) - 1) // step, 2, 2, 2))
    length = np.linalg.norm(np.diff(nodes[::step], axis=0), axis=1)
    out[:, :, 0] = (length[:, None] * direction)[:, None]
    return out


def _spline_derivatives(nodes: Floats, step: int, periodic: bool) -> Floats:
    """First and second derivatives at both ends of each edge of a smooth run, by s in [0, 1].

    Returns
    -------
    (edge, end, derivative, 2) array in walking direction.
    """
    chord = np.linalg.norm(np.diff(nodes, axis=0), axis=1)
    degree = min(5, len(nodes) - 1)
    closed = periodic and len(nodes) > 6
    order = 5 if closed else degree - (degree > 1 and degree % 2 == 0)
    parameter = np.concatenate([[0.0], np.cumsum(chord)])
    slopes = spline_derivatives(parameter, nodes, order, closed)
    uneven = len(chord) > 1 and (np.abs(np.diff(np.log(chord))) > UNEVEN).any()
    for _ in range(REFITS if uneven else 0):
        # chords are too short by a share that grows with their length, which between long and short ones bends the
        # curve (a circle with edges of 15 degrees beside some of 1/4 by 1e-4): lengths of arcs do not
        t = slopes[0] / np.linalg.norm(slopes[0], axis=1)[:, None]
        half = 0.5 * np.arctan2(t[:-1, 0] * t[1:, 1] - t[:-1, 1] * t[1:, 0], (t[:-1] * t[1:]).sum(axis=1))
        parameter = np.concatenate([[0.0], np.cumsum(chord / np.sinc(half / np.pi))])
        slopes = spline_derivatives(parameter, nodes, order, closed)
    width = np.diff(parameter[::step])[:, None]
    first, second = (slope[::step] for slope in slopes)
    ends = np.stack([first[:-1] * width, first[1:] * width], axis=1)
    bends = np.stack([second[:-1] * width**2, second[1:] * width**2], axis=1)
    return np.stack([ends, bends], axis=2)


def _store(
    out: EdgeCurves,
    line: NDArray[np.int64],
    forward: NDArray[np.bool_],
    vertices: Floats,
    derivatives: Floats,
    straight: NDArray[np.bool_],
    theta: Floats,
    joint: NDArray[np.bool_],
    closed: bool,
) -> None:
    """Turn derivatives in walking direction into tangents, curvatures and shapes of the edges."""
    chord = np.diff(vertices, axis=0)
    first, second = derivatives[:, :, 0], derivatives[:, :, 1]  # (edge, end, xy)
    speed = np.linalg.norm(first, axis=2, keepdims=True)
    tangent = first / speed
    curvature = (second - (second * tangent).sum(-1, keepdims=True) * tangent) / speed**2

    # gamma'(0) = chord + phi(0), gamma'(1) = chord - phi(1), gamma'' = phi'' s (1 - s) + 2 (1 - 2 s) phi' - 2 phi
    value0, value1 = first[:, 0] - chord, chord - first[:, 1]
    slope0, slope1 = second[:, 0] / 2 + value0, -second[:, 1] / 2 - value1
    rise = value1 - value0
    cubic = np.stack([value0, slope0, 3 * rise - 2 * slope0 - slope1, slope0 + slope1 - 2 * rise], axis=1)
    shape = np.pad(cubic, ((0, 0), (0, COEFFICIENTS - CUBIC), (0, 0)))
    arc = theta != 0.0
    if arc.any():
        shape[arc] = arc_shapes(chord[arc], theta[arc])
    flat = (np.abs(shape).max(axis=(1, 2)) < STRAIGHT * np.linalg.norm(chord, axis=1)) | straight
    shape[flat] = 0.0
    curvature[flat] = 0.0
    flat &= ~straight
    tangent[flat] = (chord / np.linalg.norm(chord, axis=1)[:, None])[flat, None]

    # where only the curvature jumps, both neighbours share the mean tangent and curvature
    for k in np.flatnonzero(joint):
        a, b = (k - 1) % len(line), k % len(line)
        if not closed and (k == 0 or k == len(line)):
            continue
        mean = tangent[a, 1] + tangent[b, 0]
        tangent[a, 1] = tangent[b, 0] = mean / np.linalg.norm(mean)
        curvature[a, 1] = curvature[b, 0] = 0.5 * (curvature[a, 1] + curvature[b, 0])

    back = ~forward
    tangent[back] = -tangent[back, ::-1]
    curvature[back] = curvature[back, ::-1]
    # phi(1 - s): delta keeps its value when the edge is walked backwards
    shape[back] = BACKWARDS @ shape[back]
    out.tangent[line], out.curvature[line], out.shape[line] = tangent, curvature, shape
