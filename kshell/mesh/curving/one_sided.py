"""Nodes beside jumps of curvature, where a sphere goes over into a cylinder: fits that do not reach over them.

For each edge the surfaces at all vertices near are compared by how well they pass through the edge and through the
third corner of one of its triangles; those that do best give the bow of the edge over its own chord.

Symbols
-------
a, b, m    ends and middle of the chord; n the unit normal of the edge, at right angles to it
g(x)       distance along n from x to the surface of a vertex
rho        how badly the surface fits: the largest of its residual, |g(a)|, |g(b)| and the smaller |g| of the corners
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.curving.fits import Fits

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

AS_GOOD = 2.0  # times the least rho
STEPS = 3  # of Newton's method
FIRST = 6  # surfaces of least residual, which bound the least rho before the others are looked at
FLOOR = 1e-8  # of the length of the edge, below which all misses are alike


class Edges(NamedTuple):
    """Edges inside sheets.

    Attributes
    ----------
    ends : (edge, 2) vertices of the cut mesh
    corners : (edge, 2) opposite vertices of both triangles
    normal : (edge, 3)
    """

    ends: Ints
    corners: Ints
    normal: Floats

    def some(self, which: Ints) -> Edges:
        """The edges at positions (n,)."""
        return Edges(self.ends[which], self.corners[which], self.normal[which])


def candidates(edges: Edges, step: Any) -> tuple[Ints, Ints]:
    """Pairs of an edge and a vertex within two rings of its ends: (pair,) each, sorted by edge."""
    wide = step @ step
    both = (wide[edges.ends[:, 0]] + wide[edges.ends[:, 1]]).tocsr()
    row = np.repeat(np.arange(len(edges.ends)), np.diff(both.indptr))
    return row, both.indices.astype(np.int64)


def one_sided(edges: Edges, fits: Fits, row: Ints, vertex: Ints) -> tuple[Floats, Floats]:
    """Bows (edge,) over the chords, along the normals, and estimates of their errors, from pairs of `candidates`."""
    residual = np.where(fits.determined[vertex], fits.residual[vertex], np.inf)
    usable = np.isfinite(residual)
    row, vertex, residual = row[usable], vertex[usable], residual[usable]
    order = np.lexsort((residual, row))
    row, vertex, residual = row[order], vertex[order], residual[order]
    number = len(edges.ends)
    rank = np.arange(len(row)) - np.searchsorted(row, row)
    bow, rho = np.zeros(len(row)), np.full(len(row), np.inf)

    def look(which: Ints) -> None:
        bow[which], miss = _bows(edges, fits, row[which], vertex[which])
        rho[which] = np.maximum(miss, residual[which])

    look(np.flatnonzero(rank < FIRST))
    best = _least(rho, row, number)
    look(np.flatnonzero((rank >= FIRST) & (residual <= AS_GOOD * best[row])))
    best = _least(rho, row, number)
    points = fits.near.points
    floor = FLOOR * np.linalg.norm(points[edges.ends[:, 1]] - points[edges.ends[:, 0]], axis=1)
    good = rho <= AS_GOOD * best[row] + floor[row]
    weight = np.zeros(len(row))
    weight[good] = 1 / (rho[good] + floor[row[good]]) ** 2
    total = np.bincount(row, weight, number)
    some = total > 0
    total[~some] = 1.0
    mean = np.bincount(row[good], (weight * bow)[good], number) / total
    spread = np.bincount(row[good], (weight * (bow - mean[row]) ** 2)[good], number) / total
    return mean, np.where(some, np.sqrt(spread) + best, np.inf)


def _least(values: Floats, row: Ints, number: int) -> Floats:
    out = np.full(number, np.inf)
    np.minimum.at(out, row, values)
    return out


def _bows(edges: Edges, fits: Fits, row: Ints, vertex: Ints) -> tuple[Floats, Floats]:
    """g(m) less its mean at the ends, and how far the surfaces miss the ends and the nearer corner."""
    points, n = fits.near.points, edges.normal[row]
    a, b = (points[edges.ends[row, k]] for k in range(2))
    g = [fits.heights(vertex, x, n, STEPS) for x in (a, b, 0.5 * (a + b))]
    corner = [np.abs(fits.heights(vertex, points[edges.corners[row, k]], n, STEPS)) for k in range(2)]
    miss = np.maximum(np.maximum(np.abs(g[0]), np.abs(g[1])), np.minimum(*corner))
    bow = g[2] - 0.5 * (g[0] + g[1])
    lost = ~(np.isfinite(miss) & np.isfinite(bow))
    return np.where(lost, 0.0, bow), np.where(lost, np.inf, miss)
