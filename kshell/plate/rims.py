"""The true shape of curved edges, rebuilt from the nodes of the mesh.

The nodes of a mesh (vertices, and those on edges at order 2, 3 and 4) lie on the true edge of the plate; the
chords between them do not. A spline through the nodes of each smooth piece, or the circle or ellipse
that they lie on, gives tangents, curvature and the shape of every edge to high order, so that supports can be imposed
on the edge itself: on the chords a simply supported curved edge would be clamped in the limit (the paradox of
Babuska, see Babuska & Pitkaranta, SIAM J. Math. Anal. 21 (1990) 551-576).
"""

from __future__ import annotations

from itertools import pairwise
from math import comb

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.distinct import distinct
from kshell.mesh.higher import nodes_along, order_of
from kshell.mesh.mesh import Mesh
from kshell.plate.chains import SHARPEST_SMOOTH_TURN, STRAIGHT, breaks, chained, is_straight, polygon
from kshell.plate.conics import COEFFICIENTS, FEWEST_ALONE, FEWEST_AT_JOINTS, Arc, arc_of
from kshell.plate.curves import EdgeCurves
from kshell.plate.joints import beside, tangent_joints
from kshell.plate.smooth import smooth_shapes

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

FEWEST = 4  # coefficients of phi
# from coefficients of a polynomial of s to those of the same one of 1 - s
BACKWARDS = np.array([[(-1.0) ** j * comb(k, j) for k in range(COEFFICIENTS)] for j in range(COEFFICIENTS)])
EVEN = 1.5  # ratio of lengths of chords up to which a closed line on a circle has no corners
KEPT = 8  # sets of edges of a mesh whose shapes are kept
ROUNDING = 8.0 * float(np.finfo(float).eps)  # of coordinates: what cannot be told from a straight line


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
    edges = distinct(len(mesh.edges), edges).astype(np.int32)
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
    shape, arcs = np.zeros((n, COEFFICIENTS, 2)), np.zeros(n, dtype=bool)
    out = EdgeCurves(edges, np.zeros((n, 2, 2)), np.zeros((n, 2, 2)), shape, arcs, 0.0, np.zeros(2))
    if n == 0:
        return out
    sharpest, where = 0.0, np.zeros(2)
    for line, forward, closed in chained(mesh.edges[edges]):
        turn, place = _fit_line(mesh, out, line, forward, closed)
        if turn > sharpest:
            sharpest, where = turn, place
    used = np.flatnonzero(shape.any(axis=(0, 2)))
    shape = np.ascontiguousarray(shape[:, : 1 + int(used.max(initial=FEWEST - 1))])
    return EdgeCurves(edges, out.tangent, out.curvature, shape, arcs, sharpest, where)


def _fit_line(
    mesh: Mesh, out: EdgeCurves, line: NDArray[np.int64], forward: NDArray[np.bool_], closed: bool
) -> tuple[float, Floats]:
    """Fit the smooth pieces of one line and write its edges into ``out``."""
    edges = out.edges[line]
    step = order_of(mesh)  # nodes per edge
    pairs = mesh.edges[edges]
    first = np.where(forward, pairs[:, 0], pairs[:, 1])
    origin = mesh.points[first[0], :2]
    nodes = np.empty((len(line) * step + 1, 2))
    nodes[:-1:step] = mesh.points[first, :2] - origin
    nodes[-1] = mesh.points[pairs[-1, 1 if forward[-1] else 0], :2] - origin
    if step > 1:
        between = (
            nodes_along(mesh, edges)[..., :2] - origin
        )  # (edge, node, xy) from the lower to the higher vertex
        between[~forward] = between[~forward, ::-1]
        for k in range(1, step):
            nodes[k::step] = between[:, k - 1]

    rounding = ROUNDING * float(np.abs(nodes + origin).max())
    directions = polygon(nodes, step, closed, rounding)
    if directions is not None:
        out.tangent[line] = np.where(forward, 1.0, -1.0)[:, None, None] * directions[:, None]
        return 0.0, origin
    all_round = _circle(nodes, step, rounding) if closed else None
    if all_round is not None:
        circle, turns = all_round
        chord, none = nodes[step::step] - nodes[:-step:step], np.zeros(len(line), dtype=bool)
        found = circle.derivatives(chord), circle.shapes(chord), none, ~none
        _store(out, line, forward, nodes[::step], found, none, closed)
        worst = int(np.argmax(turns))
        return float(turns[worst]), nodes[worst * step] + origin
    corner, jump, turn = breaks(nodes, step, closed, rounding)
    joint = tangent_joints(nodes, step, closed, rounding)
    if joint.any():  # known to rounding: what was seen around it was the same jump
        corner &= ~joint
        jump = joint | (jump & ~beside(joint, closed))
    if jump.any():
        _join(jump, corner, nodes, step, closed, rounding)
    smooth = np.where(corner, 0.0, turn)[::step]
    worst = int(np.argmax(smooth))
    ends = np.flatnonzero(corner | jump)
    if closed and len(ends):  # start at a break so that every piece is an open run of nodes
        shift = int(ends[0])
        nodes = np.concatenate([np.roll(nodes[:-1], -shift, axis=0), nodes[shift : shift + 1]])
        line, forward = np.roll(line, -shift // step), np.roll(forward, -shift // step)
        corner, jump, joint = (np.append(np.roll(x[:-1], -shift), x[shift]) for x in (corner, jump, joint))
        ends = np.flatnonzero(corner | jump)
    inner = [int(b) for b in ends if 0 < b < len(nodes) - 1]
    bounds = [0, *inner, len(nodes) - 1]
    periodic = closed and not len(ends)
    derivatives = np.empty((len(line), 2, 2, 2))  # (edge, end, first or second by own parameter, xy)
    shape = np.zeros((len(line), COEFFICIENTS, 2))
    straight = np.zeros(len(line), dtype=bool)
    arc = np.zeros(len(line), dtype=bool)
    for a, b in pairwise(bounds):
        run, place = nodes[a : b + 1], slice(a // step, b // step)
        straight[place] = is_straight(run, rounding)
        if straight[place].any():
            derivatives[place] = _straight_derivatives(run, step)
            continue
        known = arc_of(run, step, rounding, FEWEST_AT_JOINTS if joint[a] or joint[b] else FEWEST_ALONE)
        if known is None:
            derivatives[place], phi = smooth_shapes(run, step, periodic)
        else:
            chord = np.diff(run[::step], axis=0)
            arc[place] = True
            derivatives[place], phi = known.derivatives(chord), known.shapes(chord)
        shape[place, : phi.shape[1]] = phi
    bends = jump[::step] & ~corner[::step]
    _store(out, line, forward, nodes[::step], (derivatives, shape, straight, arc), bends, closed)
    return float(smooth[worst]), nodes[worst * step] + origin


def _circle(nodes: Floats, step: int, rounding: float) -> tuple[Arc, Floats] | None:
    """The circle that a closed line of nodes is, and how it turns at vertices; None where it may have corners."""
    chord = np.diff(nodes, axis=0)
    z = chord[:, 0] + 1j * chord[:, 1]
    length = np.abs(z)
    turn = np.angle(z * z[np.arange(len(z)) - 1].conj())
    if length.max() > EVEN * length.min() or turn.min() * turn.max() <= 0.0:
        return None
    turn = np.abs(turn)
    if turn.max() > SHARPEST_SMOOTH_TURN:
        return None
    found = arc_of(nodes, step, rounding)
    return None if found is None or not found.circular else (found, turn[::step])


def _join(
    jump: NDArray[np.bool_],
    corner: NDArray[np.bool_],
    nodes: Floats,
    step: int,
    closed: bool,
    rounding: float,
) -> None:
    """Take back jumps of the curvature between corners where all nodes are on one ellipse, as at a sharp tip."""
    last = len(nodes) - 1
    at = np.flatnonzero(corner[:-1] if closed else corner)
    round_about = closed and len(at) > 0
    at = np.append(at, at[0] + last) if round_about else np.unique([0, *at, last])
    for a, b in pairwise(at.tolist()):
        run = np.arange(a, b + 1) % last if closed else np.arange(a, b + 1)
        if jump[run].any() and arc_of(nodes[run], step, rounding) is not None:
            jump[run] = False
            if closed:
                jump[last] = jump[0]


def _straight_derivatives(nodes: Floats, step: int) -> Floats:
    """What a spline would give on a straight run, all edges along the same direction."""
    whole = nodes[-1] - nodes[0]
    direction = whole / np.linalg.norm(whole)
    out = np.zeros(((len(nodes) - 1) // step, 2, 2, 2))
    length = np.linalg.norm(np.diff(nodes[::step], axis=0), axis=1)
    out[:, :, 0] = (length[:, None] * direction)[:, None]
    return out


def _store(
    out: EdgeCurves,
    line: NDArray[np.int64],
    forward: NDArray[np.bool_],
    vertices: Floats,
    found: tuple[Floats, Floats, NDArray[np.bool_], NDArray[np.bool_]],
    joint: NDArray[np.bool_],
    closed: bool,
) -> None:
    """Turn derivatives in walking direction into tangents, curvatures and shapes of the edges."""
    derivatives, shape, straight, arc = found
    chord = vertices[1:] - vertices[:-1]
    length = np.hypot(chord[:, 0], chord[:, 1])
    first, second = derivatives[:, :, 0], derivatives[:, :, 1]  # (edge, end, xy)
    speed = np.hypot(first[..., :1], first[..., 1:])
    tangent = first / speed
    curvature = (second - (second * tangent).sum(-1, keepdims=True) * tangent) / speed**2

    flat = (np.abs(shape).max(axis=(1, 2)) < STRAIGHT * length) | straight
    if flat.any():
        shape[flat] = 0.0
        curvature[flat] = 0.0
        flat &= ~straight
        tangent[flat] = (chord / length[:, None])[flat, None]

    # where only the curvature jumps, both neighbours share the mean tangent and curvature
    for k in np.flatnonzero(joint):
        a, b = (k - 1) % len(line), k % len(line)
        if not closed and (k == 0 or k == len(line)):
            continue
        mean = tangent[a, 1] + tangent[b, 0]
        tangent[a, 1] = tangent[b, 0] = mean / np.linalg.norm(mean)
        curvature[a, 1] = curvature[b, 0] = 0.5 * (curvature[a, 1] + curvature[b, 0])

    back = (~forward).nonzero()[0]
    if len(back):
        tangent[back] = -tangent[back, ::-1]
        curvature[back] = curvature[back, ::-1]
        # phi(1 - s): delta keeps its value when the edge is walked backwards
        shape[back] = BACKWARDS @ shape[back]
    out.tangent[line], out.curvature[line], out.shape[line] = tangent, curvature, shape
    out.arcs[line] = arc & ~flat
