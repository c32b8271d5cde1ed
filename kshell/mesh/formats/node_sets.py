"""What part of a mesh a set of nodes stands for: programs that hold single nodes keep lines and regions as such sets.

- One node is a point.
- Nodes that the border of the mesh joins, all of them, are curves along the border.
- Nodes that are the corners of at least two cells, or of one quadrilateral, all of them, are a surface.
- Otherwise cells around a node inside the mesh that have all corners in the set, and those beside them, are a surface,
  edges of cells between the remaining nodes are curves, as along a fold or a stiffener, and nodes on neither are
  points. Of a triangle with all corners in the set, as at the corner of a line, the longest edge is a chord and left
  out.

Diagonals of quadrilaterals are no edges of cells.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.raw import RawGroup
from kshell.mesh.words import quoted

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


@dataclass
class Surface:
    """The cells of a surface before quadrilaterals are split.

    Attributes
    ----------
    points : (node, 3) float array
    corners : (cell, 4) int array
        Nodes; -1 in the last column of triangles.
    rows : (cell, 2) int array
        The first row of the triangles of each cell and the row after the last one.
    middles : (node,) bool array
        Mid-side nodes and centres, which say nothing about a set.
    """

    points: Floats
    corners: Ints
    rows: Ints
    middles: Bools
    edges: Ints = field(init=False)
    cell_edges: Ints = field(init=False)
    on_border: Bools = field(init=False)

    def __post_init__(self) -> None:
        n, is_triangle = len(self.points), self.corners[:, 3] < 0
        following = np.roll(self.corners, -1, axis=1)
        following[is_triangle, 2] = self.corners[is_triangle, 0]
        ends = np.sort(np.stack([self.corners, following], axis=2), axis=2)  # (cell, side, end)
        real = np.ones(self.corners.shape, dtype=bool)
        real[is_triangle, 3] = False
        key, inverse = np.unique(ends[real][:, 0] * n + ends[real][:, 1], return_inverse=True)
        self.edges = np.stack([key // n, key % n], axis=1)
        self.cell_edges = np.full(self.corners.shape, -1)
        self.cell_edges[real] = inverse
        self.on_border = np.bincount(inverse, minlength=len(key)) == 1

    def groups(self, sets: Mapping[str, Ints], lost: Mapping[str, int]) -> tuple[list[RawGroup], list[str]]:
        """Groups of the sets of nodes, and notes about what they were taken as.

        Parameters
        ----------
        sets : dict of str to (n,) int array
        lost : dict of str to int
            How many nodes more each set names than the file holds.
        """
        groups: list[RawGroup] = []
        taken: dict[str, list[str]] = {}
        is_corner = np.zeros(len(self.points), dtype=bool)
        is_corner[self.corners[self.corners >= 0]] = True
        for name, nodes in sets.items():
            member = np.zeros(len(self.points), dtype=bool)
            member[nodes] = True
            strange = int(np.count_nonzero(member & ~is_corner & ~self.middles))
            parts = self._parts(member & is_corner)
            if not parts:
                parts = [RawGroup(name, 0, np.flatnonzero(member))]
                strange = 0
            strange += lost.get(name, 0)
            kinds = " and ".join(("points", "curves", "surfaces")[part.dimension] for part in parts)
            taken.setdefault(kinds, []).append(name)
            for part in parts:
                part.name, part.lost = name, strange
            groups += parts
        taken.pop("points", None)
        return groups, [
            f"sets of nodes taken as {kinds} of the mesh: {quoted(names)}" for kinds, names in taken.items()
        ]

    def _parts(self, member: Bools) -> list[RawGroup]:
        """The surface, curves and points of the nodes that are members; nameless."""
        number = int(member.sum())
        inside: Bools = np.all(member[self.edges], axis=1)  # (edge,)
        if number == 0 or not inside.any():
            return [RawGroup("", 0, np.flatnonzero(member))] if number else []
        border = inside & self.on_border
        if self._covered(border).sum() == number:
            return [RawGroup("", 1, self.edges[border])]
        full: Bools = np.all(member[self.corners] | (self.corners < 0), axis=1)  # (cell,)
        is_quad = self.corners[:, 3] >= 0
        in_full = np.zeros(len(member), dtype=bool)
        in_full[self.corners[full][self.corners[full] >= 0]] = True
        whole = (in_full == member).all() and (full.sum() > 1 or (full & is_quad).any())
        region = full if whole else self._around_inner_nodes(member, full, inside)
        parts: list[RawGroup] = []
        rest = member.copy()
        lines = inside.copy()
        if region.any():
            rows = [np.arange(a, b) for a, b in self.rows[region].tolist()]
            parts.append(RawGroup("", 2, np.concatenate(rows)))
            rest[self.corners[region][self.corners[region] >= 0]] = False
            lines[self.cell_edges[region][self.cell_edges[region] >= 0]] = False
            lines &= rest[self.edges].any(axis=1)
        lines[self._chords(full & ~region & ~is_quad)] = False
        if lines.any():
            parts.append(RawGroup("", 1, self.edges[lines]))
            rest &= ~self._covered(lines)
        if rest.any():
            parts.append(RawGroup("", 0, np.flatnonzero(rest)))
        return parts

    def _covered(self, edges: Bools) -> Bools:
        ends = np.zeros(len(self.points), dtype=bool)
        ends[self.edges[edges]] = True
        return ends

    def _around_inner_nodes(self, member: Bools, full: Bools, inside: Bools) -> Bools:
        """Full cells with a corner off the border around which all cells are full, and full ones that join them."""
        inner = member & ~self._covered(self.on_border)
        used = self.corners[~full]
        inner[used[used >= 0]] = False
        found: Bools = full & (inner[self.corners] & (self.corners >= 0)).any(axis=1)
        line = inside.copy()  # edges of the set on no full cell: where one begins, the region ends
        line[self.cell_edges[full][self.cell_edges[full] >= 0]] = False
        beside = full & ~(self._covered(line)[self.corners] & (self.corners >= 0)).any(axis=1)
        grown = -1
        while found.sum() != grown:
            grown = int(found.sum())
            edges = np.zeros(len(self.edges), dtype=bool)
            edges[self.cell_edges[found][self.cell_edges[found] >= 0]] = True
            found |= beside & (edges[self.cell_edges] & (self.cell_edges >= 0)).any(axis=1)
        return found

    def _chords(self, triangles: Bools) -> Ints:
        """The longest edge of each of these triangles, those of the border apart."""
        edges = self.cell_edges[triangles, :3]
        x = self.points[self.edges[edges]]
        longest = edges[
            np.arange(len(edges)), np.argmax(np.linalg.norm(x[:, :, 1] - x[:, :, 0], axis=2), axis=1)
        ]
        return longest[~self.on_border[longest]]
