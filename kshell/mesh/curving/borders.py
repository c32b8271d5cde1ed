"""Nodes of kept edges: on circles along the line of edges, then on the sheets that meet there.

The circle through a vertex before an edge and its two ends gives the middle of its arc; where the line goes on
smoothly at both ends, the mean of both. Then the node goes to the surfaces of the sheets beside it: at the border of
one sheet within the plane of the circle, where several meet to their intersection.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.curving.fits import Fits
from kshell.mesh.curving.sheets import Sheets
from kshell.mesh.triangulation import Triangulation
from kshell.mesh.vectors import cross

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

CORNER = np.radians(40.0)  # turn of the line that is a corner
LONG = 2.0  # a chord longer than so many times the one before is a straight part beside a bend
UNLIKE = 2.0  # of two bows that differ by more than this factor the flatter one is taken
STRAIGHT = 1e-12  # sine of an angle between chords that is rounding
GOOD = 0.01  # residual of a fit, in the bow of the edge, up to which its surface is trusted
FAR = 0.5  # way to the surfaces, in the bow, up to which it is gone
STEPS = 4
PARALLEL = 0.05  # sine of the angle between two sheets below which they have no line of intersection


class Arcs(NamedTuple):
    """Nodes of kept edges on circles.

    Attributes
    ----------
    edges : (n,)
    nodes : (n, 3)
    spread : (n,) half the distance between the answers of both sides
    across : (n, 3) unit normal of the plane of the circle, 0 where the edge is straight
    """

    edges: Ints
    nodes: Floats
    spread: Floats
    across: Floats


def arcs(mesh: Triangulation, kept: Bools) -> Arcs:
    """Middles of kept edges on the circles through their neighbours along the line."""
    edges = np.flatnonzero(kept)
    ends = mesh.edges[edges].astype(np.int64)
    x, number = mesh.points, len(mesh.points)
    degree = np.bincount(ends.ravel(), minlength=number)
    total = np.zeros(number, dtype=np.int64)
    np.add.at(total, ends.ravel(), np.repeat(np.arange(len(edges)), 2))
    chord = 0.5 * (x[ends[:, 0]] + x[ends[:, 1]])
    length = np.linalg.norm(x[ends[:, 1]] - x[ends[:, 0]], axis=1)
    bow = np.zeros((2, len(edges), 3))
    found = np.zeros((2, len(edges)), dtype=bool)
    for side in range(2):
        v, w = ends[:, side], ends[:, 1 - side]
        on = np.flatnonzero(degree[v] == 2)  # the line goes on
        other = total[v[on]] - on
        before = ends[other].sum(axis=1) - v[on]
        p, a, b = x[before], x[v[on]], x[w[on]]
        s, t = a - p, b - a
        cos = (s * t).sum(axis=1) / (length[other] * length[on])
        smooth = cos > np.cos(CORNER)
        found[side, on[smooth]] = True
        bent = smooth & (length[on] <= LONG * length[other])
        bow[side, on[bent]] = _arc_bow(p[bent], a[bent], b[bent])
    size = np.linalg.norm(bow, axis=2)
    both = found.all(axis=0)
    unlike = both & (size.max(axis=0) > UNLIKE * size.min(axis=0))
    flatter = size.argmin(axis=0)
    weight = found / np.maximum(found.sum(axis=0), 1)
    weight[:, unlike] = flatter[unlike] == np.arange(2)[:, None]
    mean = (weight[..., None] * bow).sum(axis=0)
    spread = np.where(both & ~unlike, 0.5 * np.linalg.norm(bow[0] - bow[1], axis=1), 0.0)
    across = cross(x[ends[:, 1]] - x[ends[:, 0]], mean)
    across /= np.maximum(np.linalg.norm(across, axis=1), 1e-300)[:, None]
    return Arcs(edges, chord + mean, spread, across)


def _arc_bow(p: Floats, a: Floats, b: Floats) -> Floats:
    """From the middle of the chord ab to that of its arc on the circle through p, a, b, with p before a.

    The angle at p over the chord is half the angle of the arc: bow = l / 2 tan(angle / 2).
    """
    u, v, d = a - p, b - p, b - a
    normal = cross(u, v)
    sine, cosine = np.linalg.norm(normal, axis=1), (u * v).sum(axis=1)
    straight = sine < STRAIGHT * np.linalg.norm(u, axis=1) * np.linalg.norm(v, axis=1)
    out = cross(d, normal)
    out /= np.maximum(np.linalg.norm(out, axis=1), 1e-300)[:, None]
    size = 0.5 * np.linalg.norm(d, axis=1) * np.tan(0.5 * np.arctan2(sine, cosine))
    return np.where(straight[:, None], 0.0, size[:, None] * out)


def onto_sheets(mesh: Triangulation, sheets: Sheets, fits: Fits, found: Arcs) -> Floats:
    """The nodes moved to the surfaces of the sheets beside them, where these fit well."""
    nodes = found.nodes.copy()
    row = np.full(len(mesh.edges), -1, dtype=np.int64)
    row[found.edges] = np.arange(len(found.edges))
    flat = mesh.triangle_edges.ravel()
    place = np.flatnonzero(row[flat] >= 0)
    of, triangle = row[flat[place]], place // 3
    order = np.argsort(of, kind="stable")
    of, triangle = of[order], triangle[order]
    turn = np.arange(len(of)) - np.searchsorted(of, of)
    count = np.bincount(of, minlength=len(nodes))
    beside = np.full((len(nodes), 2), -1, dtype=np.int64)
    usual = (turn < 2) & (count[of] <= 2)  # where more sheets meet the circle stays
    beside[of[usual], turn[usual]] = triangle[usual]

    ends = mesh.edges[found.edges].astype(np.int64)
    chord = mesh.points[ends].mean(axis=1)
    bow = np.linalg.norm(nodes - chord, axis=1)
    surfaces, trusted = [], (beside[:, 0] >= 0) & (bow > 0)
    for side in range(2):
        t = beside[:, side]
        here = t >= 0
        vertices = np.zeros_like(ends)
        for end in range(2):
            corner = np.argmax(mesh.triangles[t[here]] == ends[here, end, None], axis=1)
            vertices[here, end] = sheets.triangles[t[here], corner]
        plane = here & sheets.flat[t]
        curved = here & ~plane
        worst = np.where(fits.determined[vertices], fits.residual[vertices], np.inf).max(axis=1)
        trusted &= ~curved | (worst <= GOOD * bow)
        surfaces.append((vertices, curved, plane))
    which = np.flatnonzero(trusted & (surfaces[0][1] | surfaces[1][1]))
    x = nodes[which]
    for _ in range(STEPS):
        x = x + _step(
            mesh, fits, [tuple(part[which] for part in s) for s in surfaces], beside[which], found, which, x
        )
    near = np.linalg.norm(x - nodes[which], axis=1) <= FAR * bow[which]
    nodes[which[near]] = x[near]
    return nodes


def _step(
    mesh: Triangulation, fits: Fits, surfaces: list, beside: Ints, found: Arcs, which: Ints, x: Floats
) -> Floats:
    """One step of Newton's method to the surfaces on both sides."""
    value, gradient = np.zeros((2, len(x))), np.zeros((2, len(x), 3))
    for side, (vertices, curved, plane) in enumerate(surfaces):
        c = np.flatnonzero(curved)
        for end in range(2):
            f, g = fits.implicit(vertices[c, end], x[c])
            value[side, c] += 0.5 * f
            gradient[side, c] += 0.5 * g
        p = np.flatnonzero(plane)
        corners = mesh.points[mesh.triangles[beside[p, side]]]
        normal = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        value[side, p] = ((x[p] - corners[:, 0]) * normal).sum(axis=1)
        gradient[side, p] = normal
    single = beside[:, 1] < 0
    across = found.across[which]
    inside = gradient[0] - (gradient[0] * across).sum(axis=1)[:, None] * across
    gradient[0, single] = inside[single]
    # least motion: sum_i l_i g_i with sum_j (g_i . g_j) l_j = -f_i; parallel sheets are one
    g00, g11, g01 = ((gradient[i] * gradient[j]).sum(axis=1) for i, j in ((0, 0), (1, 1), (0, 1)))
    determinant = g00 * g11 - g01 * g01
    crossing = determinant > PARALLEL**2 * g00 * g11
    determinant = np.where(crossing, determinant, 1.0)
    l0 = np.where(crossing, -(g11 * value[0] - g01 * value[1]) / determinant, 0.0)
    l1 = np.where(crossing, -(g00 * value[1] - g01 * value[0]) / determinant, 0.0)
    first = ~crossing & (g00 > 0) & (single | surfaces[0][1])
    l0[first] = -value[0, first] / g00[first]
    second = ~crossing & ~first & (g11 > 0)
    l1[second] = -value[1, second] / g11[second]
    return l0[:, None] * gradient[0] + l1[:, None] * gradient[1]
