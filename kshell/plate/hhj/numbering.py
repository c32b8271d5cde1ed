"""Unknowns of a plate: w at vertices, then the bubbles of w edge by edge, then the slopes edge by edge."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from kshell.elements.jets import legendre
from kshell.elements.quadrature import interval_rule
from kshell.plate.hhj.geometry import Triangles

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
NONE = np.zeros(0, dtype=np.int64)


@dataclass
class Held:
    """What supports hold.

    Attributes
    ----------
    vertices, edges : int arrays
        Vertices and edges where w is held; an edge holds its ends.
    slopes : int array
        Edges whose slope is held.
    values : (vertex,), (edge, order - 1) and (edge, order) arrays, optional
        Prescribed w at vertices, coefficients of its bubbles (`edge_coefficients`), and of the slopes; None is zero.
    """

    vertices: Ints = field(default_factory=lambda: NONE)
    edges: Ints = field(default_factory=lambda: NONE)
    slopes: Ints = field(default_factory=lambda: NONE)
    values: tuple[Floats, Floats, Floats] | None = None

    def times(self, motion: float) -> Held:
        """The same with the prescribed values times a number."""
        if self.values is None:
            return self
        at_vertices, on_edges, slopes = self.values
        return replace(self, values=(motion * at_vertices, motion * on_edges, motion * slopes))


class Numbering:
    """Numbers of the unknowns of order p on a mesh, all of them and those that are free.

    Attributes
    ----------
    outer : (T, o) int array
        Unknowns of each triangle that it shares, in the order of `Tables`.
    free : (count,) bool array
    number : (count,) int array
        Number among the free unknowns; held ones have the number `free_count`.
    """

    def __init__(self, triangles: Triangles, order: int, held: Held) -> None:
        mesh = triangles.mesh
        self.order, self.vertices, self.edges = order, len(mesh.points), len(mesh.edges)
        self.slope_start = self.vertices + self.edges * (order - 1)
        self.count = self.slope_start + self.edges * order
        bubbles = self.vertices + triangles.edges[..., None] * (order - 1) + np.arange(order - 1)
        slopes = self.slope_start + triangles.edges[..., None] * order + np.arange(order)
        n = len(triangles)
        self.outer: Ints = np.concatenate(
            [triangles.corners, bubbles.reshape(n, -1), slopes.reshape(n, -1)], axis=1
        )
        self.free = np.ones(self.count, dtype=bool)
        self.free[held.vertices] = False
        self.free[mesh.edges[held.edges].ravel()] = False
        self.free[self.vertices : self.slope_start].reshape(self.edges, order - 1)[held.edges] = False
        self.free[self.slope_start :].reshape(self.edges, order)[held.slopes] = False
        self.free_count = int(self.free.sum())
        self.number: Ints = np.where(self.free, np.cumsum(self.free) - 1, self.free_count)
        self.local_number: Ints = self.number[self.outer]

    def given(self, held: Held) -> Floats | None:
        """(count,) prescribed values, zero where nothing is held; None if all are zero."""
        if held.values is None:
            return None
        out = np.zeros(self.count)
        out[: self.vertices] = held.values[0]
        out[self.vertices : self.slope_start] = held.values[1].ravel()
        out[self.slope_start :] = held.values[2].ravel()
        out[self.free] = 0.0
        return out

    def gather(self, local: Floats) -> Floats:
        """(free,) sum of local vectors (T, o); what belongs to held unknowns is left out."""
        out: Floats = np.bincount(self.local_number.ravel(), local.ravel(), self.free_count + 1).astype(
            np.float64
        )
        return out[:-1]

    def scatter(self, free: Floats) -> Floats:
        """(count,) or (count, n) all unknowns of free ones, zero where held."""
        return np.concatenate([free, np.zeros((1, *free.shape[1:]))])[self.number]


def edge_coefficients(values: Floats, ends: Floats, order: int) -> Floats:
    """Bubbles of the interpolant of a function along edges: (edge, order - 1).

    Parameters
    ----------
    values : (edge, order + 6) array
        At the Gauss points of as many points, from the lower to the higher vertex.
    ends : (edge, 2) array
        At the ends. The interpolant keeps them and the moments to degree order - 2; derivatives along the edge are
        projected: coefficient k is (2 k + 3) int g' P_{k+1}, by parts.
    """
    s, ws = interval_rule(values.shape[1])
    k = np.arange(order - 1)
    polynomials = legendre(order, s)
    # P_n' = sum of (2 j + 1) P_j for j = n - 1, n - 3, ..., times 2 on [0, 1]
    derivative = np.zeros((order + 1, order + 1))
    for n in range(order + 1):
        for j in range(n - 1, -1, -2):
            derivative[j, n] = 2.0 * (2 * j + 1)
    slopes = (polynomials @ derivative)[:, 1:order]
    jump = ends[:, 1:] - (-1.0) ** (k + 1) * ends[:, :1]
    return (2 * k + 3) * (jump - (values * ws) @ slopes)
