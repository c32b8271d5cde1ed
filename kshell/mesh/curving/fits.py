"""Smooth surfaces fitted to the vertices around each vertex of a sheet, by least squares.

In a frame at the vertex with z along its normal, all lengths over the radius of the neighbourhood:

    quadric    z = a x + b y + c x^2 + d x y + e y^2 + f x z + g y z + h z^2
    quartic    z = p(x, y), p of degree 4 with p(0) = 0 (a jet: Cazals & Pouget 2005)

The products with z make the quadric exact for spheres, cylinders, cones and all other surfaces of second degree.
Vertex normals are those of Max, which are exact on spheres (J. Graphics Tools 4 (1999) 1-6).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.curving.sheets import Sheets
from kshell.mesh.vectors import cross

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# exponents of x, y, z
QUADRIC = ((1, 0, 0), (0, 1, 0), (2, 0, 0), (1, 1, 0), (0, 2, 0), (1, 0, 1), (0, 1, 1), (0, 0, 2))
QUARTIC = tuple((total - j, j, 0) for total in range(1, 5) for j in range(total + 1))
RINGS = 2
MORE = 1.4  # vertices wanted, in the number of coefficients
GROWN = 2  # rings by which neighbourhoods that do not determine the surface grow
# smallest over largest singular value of the scaled columns below which they do not, as few columns of vertices at a
# border
DETERMINED = 1e-3
VANISHING = 1e-9  # columns that are left out, against the largest: powers of z in a flat neighbourhood
ROUNDING = 1e-7  # singular values that count as zero
# of few vertices those whose neighbours are as many up to this number are fitted together
FEW, TOGETHER = 100, 16
NEAR = 0.1  # weights are 1 / (NEAR + r), r from 0 to 1


class Neighbourhoods:
    """Vertices of the cut mesh with their frames and the vertices around them.

    Attributes
    ----------
    points : (vertex, 3)
    frame : (vertex, 3, 3) rows x, y, z
    step : sparse (vertex, vertex), neighbours and the vertex itself
    """

    def __init__(self, points: Floats, sheets: Sheets) -> None:
        self.points: Floats = points[sheets.vertex]
        normal = _max_normals(self.points, sheets.triangles)
        first = cross(normal, np.eye(3)[np.argmin(np.abs(normal), axis=1)])
        first /= np.linalg.norm(first, axis=1)[:, None]
        self.frame = np.stack([first, cross(normal, first), normal], axis=1)
        self.step = _adjacency(sheets.triangles, len(self.points))

    def around(self, which: Ints, least: int) -> Any:
        """Sparse rows of the vertices within RINGS of some, and within more where these are fewer than `least`."""
        reach = self.step[which]
        for _ in range(RINGS - 1):
            reach = _pattern(reach @ self.step)
        for _ in range(GROWN):
            few = np.flatnonzero(np.diff(reach.indptr) < least)
            if not len(few):
                break
            reach = _replaced(reach, few, _pattern(reach[few] @ self.step))
        return reach


class Fits:
    """Surfaces of one kind through vertices.

    Attributes
    ----------
    coefficients : (vertex, term)
    residual : (vertex,) root mean square, over the degrees of freedom that are left; infinite where not fitted yet
    length : (vertex,) radius of the neighbourhood
    determined : (vertex,) bool
    """

    def __init__(self, near: Neighbourhoods, terms: tuple[tuple[int, int, int], ...]) -> None:
        number = len(near.points)
        self.near, self.terms = near, np.array(terms)
        self.degree = int(self.terms.max())
        self.coefficients = np.zeros((number, len(terms)))
        self.residual = np.full(number, np.inf)
        self.length = np.ones(number)
        self.determined = np.zeros(number, dtype=bool)

    def fit(self, which: Ints) -> None:
        """Fit the surfaces at some vertices, those that are not there yet."""
        which = which[~np.isfinite(self.residual[which])]
        if not len(which):
            return
        reach = self.near.around(which, int(np.ceil(MORE * len(self.terms))) + 1)
        for grown in range(GROWN + 1):
            self._solve(which, reach)
            bad = np.flatnonzero(~self.determined[which])
            if not len(bad) or grown == GROWN:
                return
            which, reach = which[bad], _pattern(reach[bad] @ self.near.step)

    def _solve(self, which: Ints, reach: Any) -> None:
        count = np.diff(reach.indptr)
        step = TOGETHER if len(which) <= FEW else 1
        rounded = -(-count // step) * step
        for m in np.unique(rounded):
            mine = np.flatnonzero(rounded == m)
            place = reach.indptr[mine][:, None] + np.arange(m)
            near = np.arange(m) < count[mine, None]
            around = np.where(near, reach.indices[np.where(near, place, 0)], which[mine, None])
            self._least_squares(which[mine], around, count[mine])

    def _least_squares(self, rows: Ints, around: Ints, count: Ints) -> None:
        """Fit at vertices (n,) to count (n,) of the vertices (n, m) around them; the others are the vertex itself."""
        points = self.near.points
        d = points[around] - points[rows][:, None]
        x = d @ self.near.frame[rows].swapaxes(1, 2)
        r = np.sqrt((d * d).sum(axis=2))
        length = r.max(axis=1)
        x /= length[:, None, None]
        weight = 1 / (NEAR + r / length[:, None])
        weight[r == 0] = 0.0  # the vertex itself lies on the surface
        columns = np.concatenate([self._columns(x), x[..., 2:]], axis=2) * weight[..., None]
        # triangular factor of [A b]: the last column holds Q^T b, and below it the part of b out of reach
        n_terms = len(self.terms)
        factor: Floats = np.asarray(np.linalg.qr(columns, mode="r"))
        if factor.shape[1] < n_terms + 1:
            more = np.zeros((len(rows), n_terms + 1 - factor.shape[1], n_terms + 1))
            factor = np.concatenate([factor, more], axis=1)
        a, b = factor[:, :n_terms, :n_terms], factor[:, :n_terms, n_terms]
        scale = np.sqrt((a * a).sum(axis=1))
        out = scale < VANISHING * scale.max(axis=1, keepdims=True)
        a = np.where(out[:, None], 0.0, a)
        scale = np.where(out, 1.0, scale)
        u, s, vt = np.linalg.svd(a / scale[:, None])
        last = n_terms - 1 - out.sum(axis=1)
        self.determined[rows] = s[np.arange(len(s)), last] >= DETERMINED * s[:, 0]
        inverse = np.where(s > ROUNDING * s[:, :1], 1 / np.maximum(s, 1e-300), 0.0)
        c = (vt.swapaxes(1, 2) @ (inverse * (u.swapaxes(1, 2) @ b[..., None])[..., 0])[..., None])[..., 0]
        c /= scale
        rest = (a @ c[..., None])[..., 0] - b
        squares = (rest * rest).sum(axis=1) + factor[:, n_terms, n_terms] ** 2
        free = np.maximum(count - 1 - n_terms, 1)
        mean = squares / (weight * weight).sum(axis=1) * (count / free)
        self.residual[rows] = np.sqrt(mean) * length
        self.length[rows] = length
        self.coefficients[rows] = c

    def _columns(self, x: Floats) -> Floats:
        power = np.ones((*x.shape, self.degree + 1))
        for k in range(1, self.degree + 1):
            power[..., k] = power[..., k - 1] * x
        i, j, k = self.terms.T
        out: Floats = power[..., 0, i] * power[..., 1, j]
        return out if not k.any() else out * power[..., 2, k]

    def _implicit(self, c: Floats, x: Floats) -> tuple[Floats, Floats]:
        """z - p and its gradient (3, n) at local places (3, n) over the length; c (term, n) the coefficients."""
        power = [[np.ones_like(x[0]), x[axis]] for axis in range(3)]
        for k in range(2, self.degree + 1):
            for axis in range(3):
                power[axis].append(power[axis][k - 1] * x[axis])
        value, gradient = x[2].copy(), np.zeros_like(x)
        gradient[2] = 1.0
        for row, (i, j, k) in zip(c, self.terms.tolist(), strict=True):
            xy = power[0][i] * power[1][j]
            value -= row * (xy * power[2][k] if k else xy)
            if i:
                gradient[0] -= row * (i * power[0][i - 1] * power[1][j] * power[2][k])
            if j:
                gradient[1] -= row * (j * power[0][i] * power[1][j - 1] * power[2][k])
            if k:
                gradient[2] -= row * (k * xy * power[2][k - 1])
        return value, gradient

    def _local(self, v: Ints, vectors: Floats) -> Floats:
        """(3, n) components of vectors (n, 3) in the frames at vertices."""
        return np.ascontiguousarray((self.near.frame[v] @ vectors[..., None])[..., 0].T)

    def _in_space(self, v: Ints, components: Floats) -> Floats:
        """(n, 3) vectors with components (3, n) in the frames at vertices."""
        return (components.T[:, None] @ self.near.frame[v])[:, 0]

    def heights(self, v: Ints, place: Floats, direction: Floats, steps: int) -> Floats:
        """(n,) how far places (n, 3) lie from the surfaces at vertices v along unit directions (n, 3)."""
        x = self._local(v, place - self.near.points[v]) / self.length[v]
        d, c = self._local(v, direction), np.ascontiguousarray(self.coefficients[v].T)
        moved = np.zeros(len(v))
        with np.errstate(all="ignore"):  # far from its vertex a surface may have no point along the direction
            for _ in range(steps):
                value, gradient = self._implicit(c, x + moved * d)
                moved = moved - value / (gradient * d).sum(axis=0)
        return moved * self.length[v]

    def implicit(self, v: Ints, place: Floats) -> tuple[Floats, Floats]:
        """Distances (n,) of places from surfaces to first order, and the unit gradients (n, 3)."""
        x = self._local(v, place - self.near.points[v]) / self.length[v]
        value, gradient = self._implicit(self.coefficients[v].T, x)
        size = np.linalg.norm(gradient, axis=0)
        return value * self.length[v] / size, self._in_space(v, gradient / size)

    def normals(self, v: Ints) -> Floats:
        """(n, 3) unit normals at vertices."""
        _, gradient = self._implicit(self.coefficients[v].T, np.zeros((3, len(v))))
        return self._in_space(v, gradient / np.linalg.norm(gradient, axis=0))


def _max_normals(points: Floats, triangles: Ints) -> Floats:
    """Sum of the edge products a x b / (|a|^2 |b|^2) at each vertex, made unit."""
    out = np.zeros_like(points)
    for k in range(3):
        v, p, q = (triangles[:, (k + j) % 3] for j in range(3))
        a, b = points[p] - points[v], points[q] - points[v]
        part = cross(a, b) / ((a * a).sum(axis=1) * (b * b).sum(axis=1))[:, None]
        for axis in range(3):
            out[:, axis] += np.bincount(v, part[:, axis], len(points))
    return out / np.linalg.norm(out, axis=1)[:, None]


def _adjacency(triangles: Ints, number: int) -> Any:
    from scipy.sparse import coo_matrix

    i = np.concatenate([triangles.ravel(), np.arange(number)])
    j = np.concatenate([np.roll(triangles, 1, axis=1).ravel(), np.arange(number)])
    graph = coo_matrix((np.ones(len(i)), (i, j)), shape=(number, number)).tocsr()
    return _pattern(graph + graph.T)


def _pattern(matrix: Any) -> Any:
    """The matrix with ones for all its entries, sorted by column."""
    out = matrix.tocsr()
    out.sort_indices()
    out.data = np.ones(len(out.data))
    return out


def _replaced(matrix: Any, rows: Ints, new: Any) -> Any:
    """The matrix with some rows exchanged."""
    from scipy.sparse import vstack

    place = np.arange(matrix.shape[0])
    place[rows] = matrix.shape[0] + np.arange(len(rows))
    return vstack([matrix, new]).tocsr()[place]
