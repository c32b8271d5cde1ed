"""Nodes, cells and groups of MSH 4.1: blocks of cells per entity, physical groups listed at the entities."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.gmsh_cells import NODES_OF_TYPE, CellBlock
from kshell.mesh.numbers import Numbers, Section

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
PLACE = 3  # numbers that tell where a point lies
TagsOfEntity = dict[tuple[int, int], tuple[int, ...]]


@dataclass
class Entities:
    """The points, curves and surfaces that cells lie on, by (dimension, number).

    A divided mesh has pieces of them, with numbers of their own, and copies of neighbours ("ghosts") in surfaces that
    are no pieces.

    Attributes
    ----------
    tags : dict to tuple of int
        Physical tags.
    origin : dict to (dimension, number)
        What each is a piece of.
    part : dict to int
        The part that each belongs to, from 1.
    parts : int
        How many there are.
    ghosts : set of int
        Numbers of surfaces of copies.
    """

    tags: TagsOfEntity = field(default_factory=dict)
    origin: dict[tuple[int, int], tuple[int, int]] = field(default_factory=dict)
    part: dict[tuple[int, int], int] = field(default_factory=dict)
    parts: int = 0
    ghosts: set[int] = field(default_factory=set)

    def numbered(self, key: tuple[int, int]) -> tuple[int, ...]:
        """The number of the curve or surface of cells; none of a line between parts, which lies on a surface."""
        dimension, number = self.origin.get(key, key)
        return (number,) if 0 < dimension == key[0] and key in self.tags else ()


def read_entities(section: Section, binary: bool, byte_order: str, out: Entities, place: int = PLACE) -> None:
    """Add what a mesh lies on; a version before has other `place`s of points."""
    numbers = Numbers(section, binary, byte_order)
    counts = numbers.integers("size", 4).tolist()
    _entities(numbers, counts, out, place, divided=False)


def read_partitioned_entities(
    section: Section, binary: bool, byte_order: str, out: Entities, place: int = PLACE
) -> None:
    """Add the pieces into which a divided mesh cuts that."""
    numbers = Numbers(section, binary, byte_order)
    out.parts = numbers.integer("size")
    out.ghosts = set(numbers.integers("int", 2 * numbers.integer("size")).tolist()[::2])
    counts = numbers.integers("size", 4).tolist()
    _entities(numbers, counts, out, place, divided=True)


def _entities(numbers: Numbers, counts: list[int], out: Entities, place: int, divided: bool) -> None:
    for dimension, number in enumerate(counts):
        for _ in range(number):
            key = (dimension, numbers.integer())
            if divided:
                parent, origin = numbers.integers("int", 2).tolist()
                out.origin[key] = (parent, origin)
                out.part[key] = next(iter(numbers.integers("int", numbers.integer("size")).tolist()), 0)
            numbers.doubles(place if dimension == 0 else 6)  # where it lies
            out.tags[key] = tuple(numbers.integers("int", numbers.integer("size")).tolist())
            if dimension > 0:
                numbers.integers("int", numbers.integer("size"))  # what bounds it
    numbers.end()


def read_nodes(section: Section, binary: bool, byte_order: str) -> tuple[Ints, Floats]:
    """Node tags (n,) and coordinates (n, 3)."""
    numbers = Numbers(section, binary, byte_order)
    n_blocks, n_nodes = numbers.integers("size", 4)[:2].tolist()
    tags, points = [np.empty(0, dtype=np.int64)], [np.empty((0, 3))]
    for _ in range(n_blocks):
        dimension, _, parametric = numbers.integers("int", 3).tolist()
        n = numbers.integer("size")
        tags.append(numbers.integers("size", n))
        width = 3 + (dimension if parametric else 0)
        points.append(numbers.doubles(n * width).reshape(n, width)[:, :3])
    numbers.end()
    all_tags, all_points = np.concatenate(tags), np.concatenate(points)
    if len(all_tags) != n_nodes:
        raise section.fail(f"announces {n_nodes} nodes but holds {len(all_tags)}")
    return all_tags, all_points


def read_cells(section: Section, binary: bool, byte_order: str, entities: Entities) -> list[CellBlock]:
    """Cells by entity, with the physical tags of the entity; without copies of those of other parts."""
    numbers = Numbers(section, binary, byte_order, whole=True)
    n_blocks, n_cells = numbers.integers("size", 4)[:2].tolist()
    blocks, found = [], 0
    for _ in range(n_blocks):
        dimension, entity, cell_type = numbers.integers("int", 3).tolist()
        n = numbers.integer("size")
        if cell_type not in NODES_OF_TYPE:
            raise section.fail(f"holds cells of the unknown type {cell_type}")
        width = 1 + NODES_OF_TYPE[cell_type]
        nodes = numbers.integers("size", n * width).reshape(n, width)[:, 1:]
        key, found = (dimension, entity), found + n
        if dimension == 2 and entity in entities.ghosts:
            continue
        tags, part = entities.tags.get(key, ()), entities.part.get(key, 0)
        blocks.append(CellBlock(cell_type, nodes, tags, entities.numbered(key), part))
    numbers.end()
    if found != n_cells:
        raise section.fail(f"announces {n_cells} cells but holds {found}")
    return blocks
