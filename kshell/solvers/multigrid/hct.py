"""Values and gradients of the reduced Hsieh-Clough-Tocher triangle, as weights of its nine freedoms.

The triangle is split at its centroid into three; the function is cubic in each, C1 across all edges, and its
normal derivative is linear along the outer edges (Clough & Tocher 1965; Ciarlet 1978, section 6.1). It
reproduces quadratics, which is what a coarse space for bending must do.

Symbols (the sub-triangle that holds the point has the vertices 0, 1 and the centroid S)
-------
f_i, g_i     value and gradient at vertex i = 0, 1, 2: the degrees of freedom
e_ij         Bezier ordinate next to vertex i on the outer edge to j       f_i + g_i.(x_j - x_i)/3
s_i          next to vertex i on the edge to the centroid                  f_i + g_i.(S - x_i)/3
m_k          inner ordinate at the outer edge i-j opposite vertex k; a linear normal derivative asks for
             m_k = (1 - b) e_ij + b e_ji + (s_i + s_j - (1 - b)(f_i + e_ji) - b (e_ij + f_j)) / 2
b            where the foot of S on the edge i-j lies, 0 at i, 1 at j
t_i          next to the centroid                                          (s_i + m_j + m_k)/3
c            at the centroid                                               (t_0 + t_1 + t_2)/3

Nothing is solved for: the Bernstein weights of the ten ordinates are handed back along these relations, from
c to t to m to s and e, and from there to f and g.
"""

from __future__ import annotations

import numpy as np

from kshell.solvers import kernels
from kshell.solvers.system import Floats

CHUNK = 4096  # points at a time: the temporaries stay in the cache


def interpolation_weights(points: Floats, corners: Floats) -> Floats:
    """Weights that give (w, w_x, w_y) at points from (w, w_x, w_y) at the corners of a triangle around each.

    Parameters
    ----------
    points : (n, 2) float array
        Points a little outside their triangle are extrapolated.
    corners : (n, 3, 2) float array

    Returns
    -------
    (n, 3, 3, 3) float array
        [point, corner, component of the result, component at the corner].
    """
    out = np.empty((len(points), 3, 3, 3))
    if kernels.cycles is not None:
        kernels.cycles.clough_tocher(np.ascontiguousarray(points), np.ascontiguousarray(corners), out)
        return out
    for start in range(0, len(points), CHUNK):
        part = slice(start, start + CHUNK)
        out[part] = _weights(points[part], corners[part])
    return out


def _weights(points: Floats, corners: Floats) -> Floats:
    n = len(points)
    gradient, coordinate = barycentric(points, corners)
    # turn each triangle so that the point lies in the sub-triangle of the vertices 0 and 1
    order = (coordinate.argmin(axis=1)[:, None] + np.array([1, 2, 0])) % 3
    rows = np.arange(n)[:, None]
    x = corners[rows, order].transpose(1, 2, 0)  # (vertex, xy, point)
    lam = coordinate[rows, order].T  # (vertex, point)
    grad = gradient[rows, order].transpose(1, 2, 0)  # (vertex, xy, point)

    bernstein = _bernstein(lam, grad)
    f = [bernstein["f0"], bernstein["f1"], np.zeros((3, n))]  # (result, point) weight of each ordinate
    s = [bernstein["s0"], bernstein["s1"], np.zeros((3, n))]
    e = {(0, 1): bernstein["e01"], (1, 0): bernstein["e10"]}
    e.update({pair: np.zeros((3, n)) for pair in ((1, 2), (2, 1), (0, 2), (2, 0))})

    t2 = bernstein["c"] / 3.0
    t = [bernstein["t0"] + t2, bernstein["t1"] + t2, t2]
    centroid = x.mean(axis=0)
    for i, j, k in ((0, 1, 2), (1, 2, 0), (0, 2, 1)):
        m = (t[i] + t[j]) / 3.0
        if k == 2:
            m = m + bernstein["m2"]
        edge = x[j] - x[i]
        b = np.sum((centroid - x[i]) * edge, axis=0) / np.sum(edge * edge, axis=0)
        e[i, j] = e[i, j] + (1.0 - 1.5 * b) * m
        e[j, i] = e[j, i] + (1.5 * b - 0.5) * m
        s[i] = s[i] + 0.5 * m
        s[j] = s[j] + 0.5 * m
        f[i] = f[i] - 0.5 * (1.0 - b) * m
        f[j] = f[j] - 0.5 * b * m

    out = np.empty((n, 3, 3, 3))
    for i in range(3):
        si = s[i] + t[i] / 3.0
        value = f[i] + si
        slope = si[:, None] * (centroid - x[i])  # (result, xy, point)
        for j in range(3):
            if j != i:
                value = value + e[i, j]
                slope = slope + e[i, j][:, None] * (x[j] - x[i])
        corner = order[:, i]
        out[rows[:, 0], corner, :, 0] = value.T
        out[rows[:, 0], corner, :, 1:] = slope.transpose(2, 0, 1) / 3.0
    return out


def _bernstein(lam: Floats, grad: Floats) -> dict[str, Floats]:
    """Weights (result, point) of the ten ordinates for value, x and y derivative at the point."""
    a, b, c = lam[0] - lam[2], lam[1] - lam[2], 3.0 * lam[2]
    da, db, dc = grad[0] - grad[2], grad[1] - grad[2], 3.0 * grad[2]  # (xy, point)

    pa, pb, pc = ([np.ones_like(u), u, u * u, u * u * u] for u in (a, b, c))

    def weight(i: int, j: int, k: int) -> Floats:
        factor = 6.0 / (_FACTORIAL[i] * _FACTORIAL[j] * _FACTORIAL[k])
        result = np.empty((3, lam.shape[1]))
        result[0] = factor * (pa[i] * pb[j] * pc[k])
        slope = result[1:]
        slope[:] = 0.0
        if i:
            slope += (factor * i) * (pa[i - 1] * pb[j] * pc[k]) * da
        if j:
            slope += (factor * j) * (pa[i] * pb[j - 1] * pc[k]) * db
        if k:
            slope += (factor * k) * (pa[i] * pb[j] * pc[k - 1]) * dc
        return result

    return {name: weight(*power) for name, power in _ORDINATES.items()}


_FACTORIAL = (1.0, 1.0, 2.0, 6.0)
_ORDINATES = {
    "f0": (3, 0, 0),
    "f1": (0, 3, 0),
    "c": (0, 0, 3),
    "e01": (2, 1, 0),
    "e10": (1, 2, 0),
    "s0": (2, 0, 1),
    "s1": (0, 2, 1),
    "t0": (1, 0, 2),
    "t1": (0, 1, 2),
    "m2": (1, 1, 1),
}


def barycentric(points: Floats, corners: Floats) -> tuple[Floats, Floats]:
    """Gradients (n, corner, xy) and values (n, corner) of the barycentric coordinates of points."""
    edge = corners[:, [2, 0, 1]] - corners[:, [1, 2, 0]]  # opposite to each corner
    rotated = np.stack([-edge[..., 1], edge[..., 0]], axis=-1)
    twice_area = edge[:, 2, 0] * edge[:, 0, 1] - edge[:, 2, 1] * edge[:, 0, 0]
    gradient = rotated / twice_area[:, None, None]
    second = np.sum(gradient[:, 1:] * (points - corners[:, 0])[:, None], axis=2)
    return gradient, np.concatenate([1.0 - second.sum(axis=1, keepdims=True), second], axis=1)
