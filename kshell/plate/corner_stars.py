"""What meets at the corners of a plate: edges and lines with their supports, and the stiffnesses between them.

Triangles around a vertex form fans. Those between neighbouring lines, where neither a condition nor the stiffness
changes, are one sector. All corners of a plate are looked at together, and walked around number by number.

Symbols
-------
ray        an edge at a vertex
wing       a triangle with one of its corners at a vertex: from its first ray to its second, counter-clockwise
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from kshell.material.section import Section
from kshell.mesh.mesh import Mesh
from kshell.plate.domain import Domain
from kshell.plate.forms import Bending
from kshell.plate.held import Supports

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

STRAIGHT = 1e-6  # radians
DIGITS = 9  # of angles and stiffnesses that are told apart


@dataclass(frozen=True)
class Star:
    """What meets at a point.

    Attributes
    ----------
    angles : tuple of float
        Of the sectors, one after the other.
    held, turned : tuple of bool
        By ray, one more than sectors, or as many where the sectors close: whether the deflection, and whether its
        derivative across, is held.
    stiffness : tuple of tuples of 9 floats
        Of each sector, in the axes of the first ray, over the largest entry of all.
    closed : bool
        Whether the last ray is the first one.
    """

    angles: tuple[float, ...]
    held: tuple[bool, ...]
    turned: tuple[bool, ...]
    stiffness: tuple[tuple[float, ...], ...]
    closed: bool


class Plate(Protocol):
    """What is read of a `PlateProblem`, and where it keeps what depends on no loads."""

    domain: Domain
    supports: Supports
    section: Section
    bending: Bending
    shared: dict[Any, Any]

    @property
    def mesh(self) -> Mesh: ...


def stars(problem: Plate, domain: Domain) -> list[tuple[int, Star]]:
    """The vertices where lines end, branch, turn or change, in rising order, with each fan of triangles there."""
    lines = _Lines(problem, domain)
    corners = lines.corners()
    if not len(corners):
        return []
    wings = _Wings(lines, corners)
    fans = [(fan, closed) for own in wings.by_corner(corners) for fan, closed in wings.fans(own)]
    begun = [wings.sectors(fan, closed) for fan, closed in fans]
    stiffness = iter(_stiffness(problem, wings, [[fan[k] for k in cut[:-1]] for fan, cut in begun]))
    return [
        (wings.vertex[fan[0]], wings.star(fan, cut, closed, next(stiffness)))
        for (fan, cut), (_, closed) in zip(begun, fans, strict=True)
    ]


class _Lines:
    """Edges that carry a condition or part stiffnesses.

    Attributes
    ----------
    held, turned : (edge,) bool arrays
    kind : (triangle,) int array
        Stiffnesses, -1 where triangles are held whole.
    """

    def __init__(self, problem: Plate, domain: Domain) -> None:
        mesh = self.mesh = problem.mesh
        self.domain = domain
        self.held, self.turned = (np.zeros(len(mesh.edges), dtype=bool) for _ in range(2))
        self.kind = _kinds(problem)
        for group in problem.supports.held:
            self.held[group.line] = True
            self.turned[group.edges] = True
            self.kind[group.surface] = -1
            around = mesh.triangle_edges[group.surface].ravel()
            self.held[around] = self.turned[around] = True
        one, other = self.kind[mesh.edge_table.sides // 3]
        low, high = np.minimum(one, other), np.maximum(one, other)
        low[mesh.edge_counts == 1] = -1  # nothing and what is held whole are alike
        self._special = (self.held | self.turned | (low != high)) & (high >= 0)
        # a number that tells conditions and stiffnesses of both sides
        kinds = int(self.kind.max(initial=0)) + 2
        self._alike = (((low + 1) * kinds + high + 1) * 2 + self.held) * 2 + self.turned

    def corners(self) -> Ints:
        """Vertices where such edges end, branch, turn or change."""
        mesh, edges = self.mesh, np.flatnonzero(self._special)
        ends = mesh.edges[edges].T.ravel()
        along = self.domain.tangents(edges)
        along = np.concatenate([along[:, 0], -along[:, 1]])
        code = np.tile(self._alike[edges], 2)
        n = len(mesh.points)
        count = np.bincount(ends, minlength=n)
        x, y = (np.bincount(ends, weights=part, minlength=n) for part in along.T)
        low, high = np.full(n, np.iinfo(np.int64).max), np.full(n, -1)
        np.minimum.at(low, ends, code)
        np.maximum.at(high, ends, code)
        straight = (count == 2) & (np.hypot(x, y) < STRAIGHT) & (low == high)
        return np.flatnonzero((count > 0) & ~straight)


def _kinds(problem: Plate) -> Ints:
    """(T,) a number for each stiffness; one for all where it varies inside triangles."""
    count = len(problem.mesh.triangles)
    if problem.section.uniform or not problem.section.constant_per_triangle:
        return np.zeros(count, dtype=np.int64)
    stiffness = problem.section.bending_per_triangle().reshape(count, 9)
    rounded = np.round(stiffness / np.abs(stiffness).max(), DIGITS)
    return np.unique(rounded, axis=0, return_inverse=True)[1].ravel().astype(np.int64)


class _Wings:
    """Triangles with a corner at one of some vertices, by vertex and triangle.

    Attributes
    ----------
    vertex, first, second, triangle : lists of int
        Of each wing: its vertex, those at the other ends of its rays, and its triangle.
    """

    def __init__(self, lines: _Lines, corners: Ints) -> None:
        mesh = lines.mesh
        at = np.zeros(len(mesh.points), dtype=bool)
        at[corners] = True
        triangles, local = np.nonzero(at[mesh.triangles] & (lines.kind >= 0)[:, None])
        vertex = mesh.triangles[triangles, local]
        order = np.argsort(vertex, kind="stable")
        triangles, local, vertex = triangles[order], local[order], vertex[order]
        after, before = (local + 1) % 3, (local + 2) % 3
        # local edges (0, 1), (1, 2), (0, 2)
        edges = np.stack([mesh.triangle_edges[triangles, k] for k in (local, before)])
        away = lines.domain.tangents(edges.ravel().astype(np.int64))
        here = mesh.edges[edges.ravel(), 0] == np.tile(vertex, 2)
        away = np.where(here[:, None], away[:, 0], -away[:, 1])
        polar = np.arctan2(away[:, 1], away[:, 0]).reshape(2, -1)
        self.vertex: list[int] = vertex.tolist()
        self.first: list[int] = mesh.triangles[triangles, after].tolist()
        self.second: list[int] = mesh.triangles[triangles, before].tolist()
        self.triangle: list[int] = triangles.tolist()
        self.polar: list[float] = polar[0].tolist()  # of the first ray
        self._turn: list[float] = (np.unwrap(polar, axis=0)[1] - polar[0]).tolist()
        self._held: list[list[bool]] = lines.held[edges].T.tolist()
        self._turned: list[list[bool]] = lines.turned[edges].T.tolist()
        self._kind: list[int] = lines.kind[triangles].tolist()

    def by_corner(self, corners: Ints) -> list[range]:
        """The wings at each of the vertices."""
        ends = np.searchsorted(self.vertex, corners, side="right").tolist()
        return [range(a, b) for a, b in zip([0, *ends[:-1]], ends, strict=True)]

    def fans(self, own: range) -> list[tuple[list[int], bool]]:
        """The wings at a vertex one after the other, from the first of each fan, and whether the fan closes."""
        after = {self.first[w]: w for w in own}
        inner = {self.second[w] for w in after.values()}
        starts = [a for a in after if a not in inner]
        out = []
        while after:
            a = starts.pop() if starts else next(iter(after))
            first, walk = a, []
            while a in after:
                walk.append(after.pop(a))
                a = self.second[walk[-1]]
            out.append((walk, a == first))
        return out

    def sectors(self, fan: list[int], closed: bool) -> tuple[list[int], list[int]]:
        """A fan, which begins at a line, and where in it sectors begin, with its end."""
        kind, n = self._kind, len(fan)
        apart = [
            self._held[w][0] or self._turned[w][0] or kind[w] != kind[fan[k - 1]] for k, w in enumerate(fan)
        ]
        if closed:
            shift = apart.index(True) if True in apart else 0
            fan, apart = fan[shift:] + fan[:shift], apart[shift:] + apart[:shift]
        apart[0] = True
        return fan, [k for k in range(n) if apart[k]] + [n]

    def star(
        self, fan: list[int], cut: list[int], closed: bool, stiffness: tuple[tuple[float, ...], ...]
    ) -> Star:
        """What meets there; ``stiffness`` by sector."""
        begin = [fan[k] for k in cut[:-1]]
        last = fan[-1]
        return Star(
            tuple(round(sum(self._turn[w] for w in fan[a:b]), DIGITS) for a, b in pairwise(cut)),
            (*(self._held[w][0] for w in begin), self._held[last][1]),
            (*(self._turned[w][0] for w in begin), self._turned[last][1]),
            stiffness,
            closed,
        )


def _stiffness(problem: Plate, wings: _Wings, begin: list[list[int]]) -> list[tuple[tuple[float, ...], ...]]:
    """By fan and sector: in the axes of the first ray of the fan, over the largest entry of all; ``begin`` wings."""
    wing = [w for own in begin for w in own]
    polar = np.array([wings.polar[own[0]] for own in begin for _ in own])
    place = problem.mesh.points[[wings.vertex[w] for w in wing], None, :2]
    there = problem.bending.at(np.array([wings.triangle[w] for w in wing], dtype=np.int64), place)[:, 0]
    turned = in_polar_axes(there, polar).reshape(-1, 9)
    counts = np.array([len(own) for own in begin])
    starts = np.cumsum(counts) - counts
    largest = np.maximum.reduceat(np.abs(turned).max(axis=1), starts)
    rows = [tuple(c) for c in (np.round(turned / np.repeat(largest, counts)[:, None], DIGITS) + 0.0).tolist()]
    ends = zip(starts.tolist(), counts.tolist(), strict=True)
    return [tuple(rows[start : start + count]) for start, count in ends]


def in_polar_axes(stiffness: Floats, angle: Floats) -> Floats:
    """(n, 3, 3) C in axes turned by an angle (n,)."""
    c, s = np.cos(angle), np.sin(angle)
    back = np.empty((len(c), 3, 3))  # curvatures in x, y from those in the turned axes
    back[:, 0, 0] = back[:, 1, 1] = c * c
    back[:, 0, 1] = back[:, 1, 0] = s * s
    back[:, 1, 2] = c * s
    back[:, 0, 2] = -back[:, 1, 2]
    back[:, 2, 0] = 2.0 * back[:, 1, 2]
    back[:, 2, 1] = -back[:, 2, 0]
    back[:, 2, 2] = c * c - s * s
    return np.asarray(back.swapaxes(1, 2) @ stiffness @ back)
