"""Closest points of single triangles, flat ones and those of order 2, many pairs of a point and a triangle at a time.

Vectors are listed by component, (3, pair), and reference coordinates too, (2, pair): numpy adds whole rows fastest.

Symbols
-------
p          the point, (3, pair)
x_k        nodes of a triangle, (node, 3, pair): three corners, then the nodes on the edges 01, 12, 02
r, s       reference coordinates: x = x_0 + r (x_1 - x_0) + s (x_2 - x_0) on a flat triangle
f          |p - x(r, s)|^2 / 2, whose least value is sought
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

EDGES = ((0, 1, 3), (1, 2, 4), (0, 2, 5))  # first corner, second corner, node between
CORNERS = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])  # (r and s, corner)
STEPS = 20  # of Newton's method; on well-shaped triangles it takes three to five
SMALL = 1e-14  # step in reference coordinates that is rounding
INSIDE = -1e-12  # barycentric coordinate from which a point lies in the triangle


def dot(a: Floats, b: Floats) -> Floats:
    """Scalar products of vectors (3, ...)."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def flat_feet(p: Floats, corners: Floats) -> Floats:
    """Reference coordinates (2, pair) of the closest points of flat triangles with corners (3, 3, pair)."""
    u, v, d = corners[1] - corners[0], corners[2] - corners[0], p - corners[0]
    uu, uv, vv, du, dv = dot(u, u), dot(u, v), dot(v, v), dot(d, u), dot(d, v)
    area = uu * vv - uv * uv
    r, s = (vv * du - uv * dv) / area, (uu * dv - uv * du) / area
    out = np.stack([r, s])
    beside = np.flatnonzero(~((r >= 0) & (s >= 0) & (r + s <= 1)))
    if len(beside):
        out[:, beside] = _flat_edges(p[:, beside], corners[:, :, beside])
    return out


def _flat_edges(p: Floats, corners: Floats) -> Floats:
    """Of the closest points of the three straight edges the closest one."""
    best, out = np.full(p.shape[1], np.inf), np.empty((2, p.shape[1]))
    for a, b, _ in EDGES:
        along, d = corners[b] - corners[a], p - corners[a]
        t = np.clip(dot(d, along) / dot(along, along), 0.0, 1.0)
        off = d - t * along
        distance = dot(off, off)
        nearer = distance < best
        best[nearer] = distance[nearer]
        foot = CORNERS[:, a, None] + t * (CORNERS[:, b] - CORNERS[:, a])[:, None]
        out[:, nearer] = foot[:, nearer]
    return out


def place(nodes: Floats, rs: Floats) -> Floats:
    """Points (3, pair) of triangles with three nodes or six at reference coordinates (2, pair)."""
    r, s = rs
    q = 1 - r - s
    if len(nodes) == 3:
        return q * nodes[0] + r * nodes[1] + s * nodes[2]
    shape = (q * (2 * q - 1), r * (2 * r - 1), s * (2 * s - 1), 4 * q * r, 4 * r * s, 4 * q * s)
    out = shape[0] * nodes[0]
    for value, node in zip(shape[1:], nodes[1:], strict=True):
        out += value * node
    return out


def second_derivatives(nodes: Floats) -> Floats:
    """x_rr, x_ss, x_rs (3, 3, pair) of triangles of order 2, constant in each."""
    x0, x1, x2, m01, m12, m02 = nodes
    return np.stack([4 * (x0 + x1 - 2 * m01), 4 * (x0 + x2 - 2 * m02), 4 * (x0 + m12 - m01 - m02)])


def curved_feet(p: Floats, nodes: Floats, start: Floats) -> Floats:
    """Reference coordinates (2, pair) of least distance on triangles of order 2, found from starts by descent.

    Where f is convex on the triangle this is the closest point; elsewhere it is the best of the local ones that
    Newton's method finds inside and on the edges.
    """
    inside, rs = _interior(p, nodes, start)
    rest = np.flatnonzero(~inside)
    if len(rest):
        rs[:, rest] = _curved_edges(p[:, rest], nodes[:, :, rest])
        off = p[:, rest] - place(nodes[:, :, rest], rs[:, rest])
        before = p[:, rest] - place(nodes[:, :, rest], start[:, rest])
        worse = rest[dot(before, before) < dot(off, off)]
        rs[:, worse] = start[:, worse]
    return rs


def _interior(p: Floats, nodes: Floats, start: Floats) -> tuple[Bools, Floats]:
    """Whether a stationary minimum of f lies in each triangle, and where; Newton's method.

    f_a = -(p - x) . x_a,  f_ab = x_a . x_b - (p - x) . x_ab
    """
    rr, ss, rs_ = second_derivatives(nodes)
    xr0 = -3 * nodes[0] - nodes[1] + 4 * nodes[3]  # x_r at the first corner
    xs0 = -3 * nodes[0] - nodes[2] + 4 * nodes[5]
    out = start.copy()
    done = np.zeros(p.shape[1], dtype=bool)
    found = np.zeros(p.shape[1], dtype=bool)
    todo = np.arange(p.shape[1])
    for _ in range(STEPS):
        r, s = out[:, todo]
        a, b, c = rr[:, todo], ss[:, todo], rs_[:, todo]
        xr, xs = xr0[:, todo] + r * a + s * c, xs0[:, todo] + r * c + s * b
        off = p[:, todo] - nodes[0][:, todo] - r * xr0[:, todo] - s * xs0[:, todo]
        off -= 0.5 * r * r * a + 0.5 * s * s * b + r * s * c
        h11, h22, h12 = dot(xr, xr) - dot(off, a), dot(xs, xs) - dot(off, b), dot(xr, xs) - dot(off, c)
        g1, g2 = dot(off, xr), dot(off, xs)
        determinant = h11 * h22 - h12 * h12
        bowl = (determinant > 0) & (h11 > 0)
        determinant = np.where(bowl, determinant, 1.0)
        step = np.stack([h22 * g1 - h12 * g2, h11 * g2 - h12 * g1]) / determinant
        out[:, todo] += np.where(bowl, step, 0.0)
        small = np.abs(step).max(axis=0) <= SMALL * 100
        r, s = out[:, todo]
        beyond = (np.minimum(np.minimum(r, s), 1 - r - s) < -1.0) | ~bowl
        done[todo] = small | beyond
        found[todo] = small & bowl
        todo = todo[~done[todo]]
        if not len(todo):
            break
    least = np.minimum(np.minimum(out[0], out[1]), 1 - out[0] - out[1])
    found &= least >= INSIDE
    return found, _onto_triangle(out)


def _onto_triangle(rs: Floats) -> Floats:
    """Coordinates that rounding took out of the triangle put back."""
    r, s = np.maximum(rs, 0.0)
    total = np.maximum(r + s, 1.0)
    return np.stack([r / total, s / total])


def _curved_edges(p: Floats, nodes: Floats) -> Floats:
    """Of the closest points of the three curved edges the closest one.

    With x(t) = x_a + t v + t^2 w the derivative of f along an edge is the cubic
    2 w.w t^3 + 3 v.w t^2 + (v.v - 2 d.w) t - d.v, d = p - x_a; its roots and the ends are compared.
    """
    best, out = np.full(p.shape[1], np.inf), np.empty((2, p.shape[1]))
    for a, b, m in EDGES:
        d = p - nodes[a]
        w = 2 * (nodes[a] + nodes[b] - 2 * nodes[m])
        v = nodes[b] - nodes[a] - w
        cubic = (2 * dot(w, w), 3 * dot(v, w), dot(v, v) - 2 * dot(d, w), -dot(d, v))
        for t in _candidates(*cubic):
            off = d - t * v - t * t * w
            distance = dot(off, off)
            nearer = distance < best
            best[nearer] = distance[nearer]
            foot = CORNERS[:, a, None] + t * (CORNERS[:, b] - CORNERS[:, a])[:, None]
            out[:, nearer] = foot[:, nearer]
    return out


def _candidates(c3: Floats, c2: Floats, c1: Floats, c0: Floats) -> list[Floats]:
    """Places in [0, 1] among which f is least: both ends, and the roots at which its derivative rises through zero.

    Between its turning points the cubic is monotone, so each part holds one root at most.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        half = np.sqrt(np.maximum(c2 * c2 - 3 * c3 * c1, 0.0))
        q = -(c2 + np.copysign(half, c2))
        turns = np.sort(np.stack([q / (3 * c3), c1 / q]), axis=0)
    turns = np.clip(np.where(np.isfinite(turns), turns, 0.0), 0.0, 1.0)
    zero, one = np.zeros_like(c0), np.ones_like(c0)
    out = [zero, one]
    for low, high in ((zero, turns[0]), (turns[0], turns[1]), (turns[1], one)):
        g_low, g_high = (((c3 * t + c2) * t + c1) * t + c0 for t in (low, high))
        here = (g_low < 0) & (g_high > 0)
        if here.any():
            out.append(_root(c3, c2, c1, c0, low, high, here))
    return out


def _root(c3: Floats, c2: Floats, c1: Floats, c0: Floats, low: Floats, high: Floats, here: Bools) -> Floats:
    """Root of rising cubics between brackets; elsewhere the lower end."""
    t = 0.5 * (low + high)
    for _ in range(2 * STEPS):
        g = ((c3 * t + c2) * t + c1) * t + c0
        slope = (3 * c3 * t + 2 * c2) * t + c1
        low, high = np.where(g < 0, t, low), np.where(g < 0, high, t)
        with np.errstate(divide="ignore", invalid="ignore"):
            new = t - g / slope
        new = np.where((new > low) & (new < high), new, 0.5 * (low + high))
        if np.abs(new - t)[here].max() <= SMALL:
            t = new
            break
        t = new
    return np.where(here, t, 0.0)
