"""Nodes, cells and groups of MSH 4.1: blocks of cells per entity, physical groups listed at the entities."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.gmsh_cells import NODES_OF_TYPE, CellBlock
from kshell.mesh.numbers import Numbers, Section

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
TagsOfEntity = dict[tuple[int, int], tuple[int, ...]]


def read_entities(section: Section, binary: bool, byte_order: str) -> TagsOfEntity:
    """Physical tags of each entity (dimension, tag)."""
    numbers = Numbers(section, binary, byte_order)
    counts = numbers.integers("size", 4).tolist()
    return _entities(numbers, counts, partitioned=False)


def read_partitioned_entities(section: Section, binary: bool, byte_order: str) -> TagsOfEntity:
    """Physical tags of the pieces into which a partitioned mesh divides its entities."""
    numbers = Numbers(section, binary, byte_order)
    numbers.integer("size")  # number of partitions
    numbers.integers("int", 2 * numbers.integer("size"))  # ghost entities
    counts = numbers.integers("size", 4).tolist()
    return _entities(numbers, counts, partitioned=True)


def _entities(numbers: Numbers, counts: list[int], partitioned: bool) -> TagsOfEntity:
    tags: TagsOfEntity = {}
    for dimension, number in enumerate(counts):
        for _ in range(number):
            entity = numbers.integer()
            if partitioned:
                numbers.integers("int", 2)  # parent
                numbers.integers("int", numbers.integer("size"))  # partitions
            numbers.doubles(3 if dimension == 0 else 6)  # where it lies
            tags[dimension, entity] = tuple(numbers.integers("int", numbers.integer("size")).tolist())
            if dimension > 0:
                numbers.integers("int", numbers.integer("size"))  # what bounds it
    numbers.end()
    return tags


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


def read_cells(section: Section, binary: bool, byte_order: str, tags: TagsOfEntity) -> list[CellBlock]:
    """Cells by entity, with the physical tags of the entity."""
    numbers = Numbers(section, binary, byte_order, whole=True)
    n_blocks, n_cells = numbers.integers("size", 4)[:2].tolist()
    blocks = []
    for _ in range(n_blocks):
        dimension, entity, cell_type = numbers.integers("int", 3).tolist()
        n = numbers.integer("size")
        if cell_type not in NODES_OF_TYPE:
            raise section.fail(f"holds cells of the unknown type {cell_type}")
        width = 1 + NODES_OF_TYPE[cell_type]
        nodes = numbers.integers("size", n * width).reshape(n, width)[:, 1:]
        number = (entity,) if dimension > 0 and (dimension, entity) in tags else ()
        blocks.append(CellBlock(cell_type, nodes, tags.get((dimension, entity), ()), number))
    numbers.end()
    if sum(len(block.nodes) for block in blocks) != n_cells:
        raise section.fail(f"announces {n_cells} cells but holds {sum(len(block.nodes) for block in blocks)}")
    return blocks
