"""A level: vertices with (w, w_x, w_y), what the supports leave of that, and triangles between them.

Which vertices are coarsened away must not hang on the last digit of a coordinate: regular meshes are full of equal
lengths, and of thresholds that are met exactly. So whatever is compared is compared up to `TIE`, and among equals
a fixed random order of the vertices decides (`Cloud.turn`), that knows nothing of coordinates. A plate that is
moved, turned or made larger has the same levels, on any machine.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.solvers.system import Floats, Ints, PlateSpace

Bools = NDArray[np.bool_]
Turns = NDArray[np.uint64]

STIFFNESS_JUMP = 3.0  # neighbours whose stiffness differs by this factor have an interface between them
TIE = 1e-6  # what differs by less, relative, is equal
LONG = 3.0  # an edge that many times longer than the shortest at both of its ends couples weakly


@dataclass(frozen=True, eq=False)
class Cloud:
    """Vertices of one level.

    Attributes
    ----------
    points : (vertex, 2) float array
    triangles : (triangle, 3) int array
        On the finest level the mesh; below, what is left of it when regions of vertices are contracted. They
        may overlap a little: they only serve to find three neighbours for interpolation.
    basis, mask : (vertex, 3, 3) float and (vertex, 3) bool arrays
        As in `PlateSpace`.
    stiffness : (triangle,) float array or None
    turn : (vertex,) uint64 array
        When it is the turn of each vertex to be chosen, and which of two equals is taken: the lower.
    """

    points: Floats
    triangles: Ints
    basis: Floats
    mask: Bools
    stiffness: Floats | None
    turn: Turns

    @classmethod
    def of_space(cls, space: PlateSpace) -> Cloud:
        """The finest level."""
        return cls(
            np.asarray(space.points, dtype=float),
            np.asarray(space.triangles),
            space.vertex_basis,
            space.vertex_mask,
            space.stiffness,
            shuffled(np.arange(len(space.points), dtype=np.uint64)),
        )

    @cached_property
    def active(self) -> Bools:
        """(vertex,) whether the supports leave anything of (w, w_x, w_y)."""
        return np.asarray(self.mask.any(axis=1))

    @cached_property
    def number(self) -> Ints:
        """(vertex,) position among the active vertices, -1 for the others."""
        return np.where(self.active, np.cumsum(self.active) - 1, -1)

    @cached_property
    def plain(self) -> Bools:
        """(vertex,) whether nothing is constrained, so that the basis is of no importance."""
        return np.asarray(self.mask.all(axis=1))

    @cached_property
    def columns(self) -> Floats:
        """(vertex, 3, 3) admissible columns of the basis, zero where the supports forbid them."""
        return np.where(self.mask[:, None, :], self.basis, 0.0)

    @cached_property
    def edges(self) -> tuple[Ints, Bools]:
        """Edges (edge, 2), and which of them are lines: boundaries, interfaces, supported lines."""
        n = len(self.points)
        one, other = (self.triangles[:, ends].astype(np.int64) for ends in ([0, 1, 0], [1, 2, 2]))
        keys = (np.minimum(one, other) * n + np.maximum(one, other)).ravel()
        if self.stiffness is None or len(keys) == 0:
            key, count = np.unique(keys, return_counts=True)
            line = count != 2
        else:
            key, inverse, count = np.unique(keys, return_inverse=True, return_counts=True)
            low, high = np.full(len(key), np.inf), np.zeros(len(key))
            np.minimum.at(low, inverse, np.repeat(self.stiffness, 3))
            np.maximum.at(high, inverse, np.repeat(self.stiffness, 3))
            line = (count != 2) | (high > STIFFNESS_JUMP * (1 + TIE) * low)
        edges = np.empty((len(key), 2), dtype=np.int32)
        edges[:, 0] = low = key // n
        edges[:, 1] = key - low * n
        constrained = ~self.plain
        line |= constrained[edges[:, 0]] & constrained[edges[:, 1]]
        return edges, line

    @cached_property
    def squared_lengths(self) -> Floats:
        """(edge,)"""
        edges = self.edges[0]
        return np.sum((self.points[edges[:, 0]] - self.points[edges[:, 1]]) ** 2, axis=1)

    @cached_property
    def strong(self) -> Bools:
        """(edge,) edges across which vertices are merged: not those along the long side of thin triangles."""
        edges = self.edges[0]
        shortest = np.full(len(self.points), np.inf)
        np.minimum.at(shortest, edges[:, 0], self.squared_lengths)
        np.minimum.at(shortest, edges[:, 1], self.squared_lengths)
        return self.squared_lengths <= LONG**2 * (1 + TIE) * shortest[edges].max(axis=1)

    @cached_property
    def vertex_stiffness(self) -> Floats | None:
        """(vertex,) the largest stiffness of the triangles at each vertex."""
        if self.stiffness is None:
            return None
        largest = np.zeros(len(self.points))
        np.maximum.at(largest, self.triangles.ravel(), np.repeat(self.stiffness, 3))
        return largest


def shuffled(numbers: Turns) -> Turns:
    """Other numbers in place of numbers, without visible order and always the same ones.

    The last step of the generator splitmix64 (Steele, Lea & Flood 2014): unlike a permutation, the number of
    one vertex does not change when vertices elsewhere come or go.
    """
    z = (numbers + np.uint64(1)) * np.uint64(0x9E3779B97F4A7C15)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return np.asarray(z ^ (z >> np.uint64(31)))


def neighbours(matrix_size: int, edges: Ints) -> Any:
    """Adjacency matrix of a graph, CSR."""
    import scipy.sparse as sp

    ends = edges.astype(np.int32)
    row, column = np.concatenate([ends, ends[:, ::-1]]).T
    data = np.ones(len(row), dtype=np.int8)
    return sp.csr_matrix((data, (row, column)), shape=(matrix_size, matrix_size))
