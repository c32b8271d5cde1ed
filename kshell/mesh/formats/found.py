"""What a reader of a foreign format has found, and the `RawMesh` of it: the same rules for all formats.

Cells are numbered through all blocks in the order they were found; sets hold these numbers.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.mesh import quads
from kshell.mesh.formats.node_sets import Surface
from kshell.mesh.raw import RawGroup, RawMesh

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# what a kind of cells that is none of a surface mesh is called in messages
SOLID, HIGHER = "solid cells", "triangles of order 3 or higher"
DIMENSIONS = {"point": 0, "line": 1, "triangle": 2, "quadrilateral": 2}


@dataclass
class Found:
    """Nodes, cells and sets of a file.

    Attributes
    ----------
    points : (node, 3) float array
    source : str
        For messages.
    blocks : list of (kind, (n, nodes of a cell) int array)
        kind: "point", "line", "triangle", "quadrilateral"; else words for what a surface mesh cannot hold. Corners
        first, then mid-side nodes from side (0, 1) on, then the centre; rows of `points`.
    cell_sets, node_sets : dict of str to (n,) int array
    tags : dict of str to int
        Numbers by which the file knows sets of cells.
    lost, lost_nodes : dict of str to int
        Members of sets of cells and of nodes that the file names but does not hold.
    notes : list of str
    """

    points: Floats
    source: str
    blocks: list[tuple[str, Ints]] = field(default_factory=list)
    cell_sets: dict[str, Ints] = field(default_factory=dict)
    node_sets: dict[str, Ints] = field(default_factory=dict)
    tags: dict[str, int] = field(default_factory=dict)
    lost: dict[str, int] = field(default_factory=dict)
    lost_nodes: dict[str, int] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    @property
    def n_cells(self) -> int:
        """Cells found so far: the number of the next one."""
        return sum(len(nodes) for _, nodes in self.blocks)

    def add(self, kind: str, nodes: ArrayLike) -> Ints:
        """Take in cells of one kind; returns their numbers."""
        array = np.asarray(nodes, dtype=np.int64)
        first = self.n_cells
        self.blocks.append((kind, array.reshape(len(array), array.shape[1] if array.ndim > 1 else 1)))
        return np.arange(first, first + len(array))

    def put(self, name: str, cells: Iterable[int] | Ints) -> None:
        """Add cells to a set, made at need."""
        array = np.asarray(cells if isinstance(cells, np.ndarray) else list(cells), dtype=np.int64)
        before = self.cell_sets.get(name, np.empty(0, dtype=np.int64))
        self.cell_sets[name] = np.concatenate([before, array])

    def put_nodes(self, name: str, nodes: Iterable[int] | Ints) -> None:
        """Add nodes to a set, made at need."""
        array = np.asarray(nodes if isinstance(nodes, np.ndarray) else list(nodes), dtype=np.int64)
        before = self.node_sets.get(name, np.empty(0, dtype=np.int64))
        self.node_sets[name] = np.concatenate([before, array])

    def raw(self) -> RawMesh:
        """Triangles, groups and notes.

        Raises
        ------
        InputError
            If a quadrilateral cannot be split.
        """
        n = self.n_cells
        dimension = np.full(n, -1)
        place = np.zeros((n, 2), dtype=np.int64)  # first and last row of what became of each cell
        points = [np.empty((0, 3)), self.points]
        triangles: list[Ints] = [np.empty((0, 3), dtype=np.int64)]
        lines: list[Ints] = [np.empty((0, 2), dtype=np.int64)]
        single: list[Ints] = [np.empty(0, dtype=np.int64)]
        other: dict[str, int] = {}
        n_quads = warped = first = 0
        worst = 0.0
        middles = np.zeros(len(self.points), dtype=bool)
        for kind, nodes in self.blocks:
            cells = slice(first, first + len(nodes))
            first += len(nodes)
            dimension[cells] = DIMENSIONS.get(kind, -1)
            one = np.arange(len(nodes))
            if kind == "point":
                place[cells] = (sum(map(len, single)) + one)[:, None] + [0, 1]
                single.append(nodes[:, 0])
            elif kind == "line":
                place[cells] = (sum(map(len, lines)) + one)[:, None] + [0, 1]
                lines.append(nodes[:, :2] if nodes.shape[1] == 2 else _ends(self.points, nodes))
            elif kind == "triangle":
                place[cells] = (sum(map(len, triangles)) + one)[:, None] + [0, 1]
                triangles.append(nodes[:, :6])
                middles[_there(nodes[:, 3:], len(middles))] = True
            elif kind == "quadrilateral":
                halves = quads.split(np.concatenate(points), nodes, self.source)
                counts = np.bincount(halves.origin, minlength=len(nodes))
                ends = sum(map(len, triangles)) + np.cumsum(counts)
                place[cells] = np.column_stack([ends - counts, ends])
                triangles.append(halves.triangles)
                points.append(halves.points)
                n_quads, warped = n_quads + len(nodes), warped + halves.warped
                worst = max(worst, halves.worst)
                middles[_there(nodes[:, 4:], len(middles))] = True
            else:
                other[kind] = other.get(kind, 0) + len(nodes)
        width = max(t.shape[1] for t in triangles)
        stacked = np.concatenate(
            [np.pad(t, ((0, 0), (0, width - t.shape[1])), constant_values=-1) for t in triangles]
        )
        parts = (np.concatenate(single), np.concatenate(lines), np.arange(len(stacked)))
        groups = self._cell_groups(dimension, place, parts)
        notes = list(self.notes)
        if n_quads:
            notes.append(quads.note(n_quads, warped, worst))
        known = stacked.size > 0 and stacked[:, :3].min() >= 0 and stacked.max() < sum(map(len, points))
        if self.node_sets and known:  # what names unknown nodes is refused when the mesh is built
            surface = Surface(self.points, self._corners(), place[dimension == 2], middles)
            node_groups, words = surface.groups(self.node_sets, self.lost_nodes)
            groups, notes = groups + node_groups, notes + words
        return RawMesh(
            np.concatenate(points), stacked, groups, self.source, other, len(np.concatenate(lines)), notes
        )

    def _cell_groups(self, dimension: Ints, place: Ints, parts: tuple[Ints, Ints, Ints]) -> list[RawGroup]:
        """A set with cells of several dimensions becomes several groups."""
        groups = []
        for name, cells in self.cell_sets.items():
            kinds = np.unique(dimension[cells])
            for kind in kinds[kinds >= 0].tolist():
                chosen = place[cells[dimension[cells] == kind]]
                rows = [np.arange(a, b) for a, b in chosen.tolist()]
                lost = self.lost.get(name, 0)
                groups.append(
                    RawGroup(name, kind, parts[kind][np.concatenate(rows)], self.tags.get(name), lost)
                )
            if not len(cells) and name in self.lost:
                groups.append(RawGroup(name, 2, cells, self.tags.get(name), self.lost[name]))
        return groups

    def _corners(self) -> Ints:
        """(cell, 4) corners of triangles and quadrilaterals; equal neighbouring corners once."""
        corners = [np.empty((0, 4), dtype=np.int64)]
        for kind, nodes in self.blocks:
            if kind == "triangle":
                corners.append(np.pad(nodes[:, :3], ((0, 0), (0, 1)), constant_values=-1))
            elif kind == "quadrilateral":
                four = nodes[:, :4].copy()
                same = np.equal(four, np.roll(four, -1, axis=1))
                bent = np.flatnonzero(same.any(axis=1))
                turn = (np.argmax(same[bent], axis=1)[:, None] + np.array([1, 2, 3])) % 4
                four[bent] = np.column_stack(
                    [np.take_along_axis(four[bent], turn, axis=1), np.full(len(bent), -1)]
                )
                corners.append(four)
        return np.concatenate(corners)


def _there(nodes: Ints, n: int) -> Ints:
    """The nodes among these that exist."""
    flat = nodes.ravel()
    return flat[(flat >= 0) & (flat < n)]


def _ends(points: Floats, nodes: Ints) -> Ints:
    """End nodes (n, 2) of lines of three nodes, wherever their format lists the middle: the two farthest apart."""
    x = points[nodes]
    pairs = np.array([[0, 1], [1, 2], [0, 2]])
    length = np.linalg.norm(x[:, pairs[:, 1]] - x[:, pairs[:, 0]], axis=2)
    return np.take_along_axis(nodes, pairs[np.argmax(length, axis=1)], axis=1)
