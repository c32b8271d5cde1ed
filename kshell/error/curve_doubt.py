"""How well the nodes of a mesh tell the shape of its curved edges.

Every other node is left out, and missed by so much. Splines of degree k through nodes h apart are off by h^(k + 1):
through every other node by 2^(k + 1) times as much. A quarter of that factor is relied on. Pieces with too few nodes
are known to the difference of an arc from the cubic with its ends and tangents, length times turn^3 / 384.

A node that lies off the others, by a typing error or because the edge has a bump there, is missed by its neighbours by
as much whatever the degree (outlying.py): 0.7 of that counts along its two edges, so that the interval holds the plate
with the bump as drawn and the one without.

Over 900 closed curves (eggs, superellipses of power 2.5 to 6, Cassini ovals, radii with Fourier coefficients that decay
as powers and as exponentials) with 12 to 64 nodes, in 400 cases one of them moved by 1e-2 to 1e-5, clamped and
supported, against the plate with the curve itself: 98 % of the intervals hold it, 96 % where a node is moved (the
constants were chosen on these curves).

A line of few straight edges that turns much at its vertices may as well be a polygon with one element on a side, and
one that turns at every other vertex alone a polygon with two: then the whole area between it and its chords is in
doubt, of which deflections and eigenvalues change by 1 to 4 times as much (polygons of 4 to 8 sides, clamped and
supported).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.error.outlying import outlying
from kshell.plate.chains import BLUNT_CORNER, FLAT, GENTLEST_CORNER, KINK
from kshell.plate.curves import EdgeCurves
from kshell.plate.domain import Domain
from kshell.plate.smooth import settled_degree
from kshell.plate.splines import spline_at

Floats = NDArray[np.float64]

SMOOTH = 1.0 - 1e-9  # cosine between tangents of one smooth line
ENOUGH = 5  # nodes, of which every other one is left out
CUBIC = 1.0 / 384.0
RELIED = 4.0
FEW = 10  # nodes of a smooth line that a polygon may have by chance
ROUGH = 0.2  # doubt over the distance from the chord, from which at most edges more nodes are no smooth line, either
SIDES = 0.5  # share of its edges that turn at one end alone, from which a line may be a polygon
OF_AREA = 5.0
IN_EDGE = np.linspace(0.05, 0.95, 10)


def curve_doubt(domain: Domain) -> Floats:
    """(edge,) distance that the true shape of each edge of `Domain.curves` may have from the one taken; 0: straight.

    An edge with a node in its middle is a polynomial with the derivatives of the spline at its ends: it misses that
    node by as much as it is off. Arcs of circles and ellipses are known to rounding.
    """
    curves, mesh = domain.curves, domain.mesh
    out = np.zeros(len(curves.edges))
    for edges, ahead, closed in _chains(domain):
        if not curves.arcs[edges].all():
            out[edges] = _missed(domain, edges, ahead, closed)
    out[curves.arcs] = 0.0
    if mesh.midpoints is not None:
        bent = np.flatnonzero(curves.curved)
        chord = domain.points[mesh.edges[curves.edges[bent]]].mean(axis=1)
        off = chord + curves.deviation(bent, np.array([0.5]))[:, 0] - mesh.midpoints[curves.edges[bent], :2]
        # where along the edge the node lies says nothing of its shape
        along = domain.edge_motion(curves.edges[bent].astype(np.int64), np.array([0.5]))[1][:, 0]
        across = off[:, 0] * along[:, 1] - off[:, 1] * along[:, 0]
        out[bent] += np.abs(across) / np.linalg.norm(along, axis=1)
    return out


def polygon_share(domain: Domain) -> float:
    """Relative change of deflections where lines that are taken as smooth are polygons, of meshes of straight edges.

    Arcs of circles and ellipses are no chance.
    """
    curves, mesh = domain.curves, domain.mesh
    if mesh.midpoints is not None or curves.sharpest < KINK:
        return 0.0
    gentle, turn = _smooth_turns(domain)
    divided = (gentle < FLAT) & (turn > KINK)
    if curves.sharpest < GENTLEST_CORNER and not divided.any():
        return 0.0
    doubt, between = curve_doubt(domain), 0.0
    depth = np.linalg.norm(curves.deviation(np.arange(len(curves.edges)), IN_EDGE), axis=2)
    for edges, _, closed in _chains(domain):
        if curves.arcs[edges].all():
            continue
        count = len(edges) + (not closed)
        rough = np.median(doubt[edges] - ROUGH * depth[edges].max(axis=1)) > 0.0  # a node moved is no polygon
        least = GENTLEST_CORNER if count < ENOUGH else BLUNT_CORNER
        if (turn[edges].max() > least and (count < FEW or rough)) or np.mean(divided[edges]) > SIDES:
            between += float((mesh.edge_lengths[curves.edges[edges]] * depth[edges].mean(axis=1)).sum())
    return OF_AREA * between / float(mesh.areas.sum())


def _smooth_turns(domain: Domain) -> tuple[Floats, Floats]:
    """(edge,) the least and most that chords of `Domain.curves` turn by at the ends of each where tangents do not."""
    curves = domain.curves
    ends = domain.mesh.edges[curves.edges]
    order = np.argsort(ends.ravel(), kind="stable")
    vertex = ends.ravel()[order]
    first = np.flatnonzero((vertex[1:] == vertex[:-1]) & (np.bincount(vertex)[vertex[1:]] == 2))
    (a, i), (b, j) = (np.divmod(order[first + k], 2) for k in (0, 1))
    chord = domain.points[ends[:, 1]] - domain.points[ends[:, 0]]
    chord /= np.linalg.norm(chord, axis=1)[:, None]
    smooth = np.abs((curves.tangent[a, i] * curves.tangent[b, j]).sum(axis=1)) > SMOOTH
    outward = np.where(i == j, -1.0, 1.0)  # both lead away from the vertex, or both to it
    angle = np.arccos(np.clip(outward * (chord[a] * chord[b]).sum(axis=1), -1.0, 1.0))
    angle = np.where(smooth, angle, 0.0)
    least, most = np.full(len(ends), np.inf), np.zeros(len(ends))
    for edge in (a, b):
        np.minimum.at(least, edge, angle)
        np.maximum.at(most, edge, angle)
    return least, most


def turns(curves: EdgeCurves) -> Floats:
    """(edge,) angle that each edge turns by."""
    cosine = (curves.tangent[:, 0] * curves.tangent[:, 1]).sum(axis=1)
    return np.asarray(np.arccos(np.clip(cosine, -1.0, 1.0)))


def _chains(domain: Domain) -> list[tuple[list[int], list[bool], bool]]:
    """Curved edges, by their places in the curves, in smooth lines; whether each is walked ahead, and lines closed.

    None where all are arcs of circles and ellipses, which are known.
    """
    curves = domain.curves
    if curves.arcs[curves.curved].all():
        return []
    ends = domain.mesh.edges[curves.edges]
    at: dict[int, list[tuple[int, int]]] = {}
    for k in np.flatnonzero(curves.curved).tolist():
        for end in range(2):
            at.setdefault(int(ends[k, end]), []).append((k, end))
    after: dict[tuple[int, int], tuple[int, int]] = {}
    for both in at.values():
        if len(both) == 2:
            (a, i), (b, j) = both
            if a != b and abs(float(curves.tangent[a, i] @ curves.tangent[b, j])) > SMOOTH:
                after[a, i], after[b, j] = (b, j), (a, i)
    used: set[int] = set()

    def walk(k: int, start: int) -> tuple[list[int], list[bool], bool]:
        line: list[int] = []
        ahead: list[bool] = []
        while k not in used:
            used.add(k)
            line.append(k)
            ahead.append(start == 0)
            following = after.get((k, 1 - start))
            if following is None:
                return line, ahead, False
            k, start = following
        return line, ahead, True

    places = sorted({k for both in at.values() for k, _ in both})
    open_ends = [(k, end) for k in places for end in range(2) if (k, end) not in after]
    out = [walk(k, end) for k, end in open_ends if k not in used]
    return out + [walk(k, 0) for k in places if k not in used]


def _missed(domain: Domain, edges: list[int], ahead: list[bool], closed: bool) -> Floats:
    """(edge,) of one smooth line."""
    mesh, curves = domain.mesh, domain.curves
    place = np.array(edges)
    ends = domain.points[mesh.edges[curves.edges[place]]]
    forward = np.array(ahead)
    first = np.where(forward[:, None], ends[:, 0], ends[:, 1])
    last = np.where(forward[-1], ends[-1, 1], ends[-1, 0])
    step = 1 if mesh.midpoints is None else 2
    nodes = np.empty((step * len(edges) + 1, 2))
    nodes[:-1:step], nodes[-1] = first, last
    if step == 2:
        assert mesh.midpoints is not None
        nodes[1::2] = mesh.midpoints[curves.edges[place], :2]
    if len(nodes) < ENOUGH:
        return np.asarray(CUBIC * mesh.edge_lengths[curves.edges[place]] * turns(curves)[place] ** 3)
    parameter = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(nodes, axis=0), axis=1))])
    missed = outlying(parameter, nodes, closed)
    kept = np.unique(np.append(np.arange(0, len(nodes), 2), len(nodes) - 1))
    left = np.setdiff1d(np.arange(len(nodes)), kept)
    degree = min(settled_degree(parameter[of], nodes[of], closed) for of in (kept, np.arange(len(nodes))))
    periodic = closed and len(kept) > degree + 1
    through, along = spline_at(parameter[kept], nodes[kept], degree, parameter[left], periodic)
    off = through - nodes[left]
    across = np.abs(off[:, 0] * along[:, 1] - off[:, 1] * along[:, 0]) / np.linalg.norm(along, axis=1)
    missed[left] = np.maximum(missed[left], across * RELIED / 2.0 ** (degree + 1))
    near = [np.roll(missed[:-1], shift) for shift in (-1, 0, 1)]  # beside each edge, around where it closes
    at_nodes = np.max(near, axis=0)
    return np.asarray(np.maximum(at_nodes[::step], np.roll(at_nodes, -1)[::step]))
