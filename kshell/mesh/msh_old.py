"""Nodes, cells and groups of MSH 1 and MSH 4.0, which gmsh wrote before 2.2 and 4.1, as text.

MSH 1 has no names of groups and stores a cell once per group, as MSH 2.2 does. MSH 4.0 differs from 4.1 in the order of
the numbers.

Source: gmsh reference manual, "MSH file format version 1 (Legacy)"; of gmsh 4.0, "MSH file format version 4.0".
"""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh.gmsh_cells import NODES_OF_TYPE, CellBlock
from kshell.mesh.msh4 import Entities
from kshell.mesh.numbers import Numbers, Section

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]

PLACE = 6  # numbers that tell where a point lies in version 4.0


def read_version_1(data: bytes, source: str) -> tuple[Ints, Floats, list[CellBlock]]:
    """Node tags (n,), coordinates (n, 3) and cells of a file of version 1.

    Raises
    ------
    InputError
        If it is cut off, or holds other numbers than it announces.
    """
    nodes, cells = (_section(name, data, source) for name in ("NOD", "ELM"))
    n = nodes.integer()
    rows = nodes.doubles(4 * n).reshape(n, 4)
    nodes.end()
    by_kind: dict[tuple[int, int], list[Ints]] = {}
    for _ in range(cells.integer()):
        # number, type, group, entity, number of nodes
        _, kind, group, _, number = cells.integers("int", 5).tolist()
        if NODES_OF_TYPE.get(kind) != number:
            raise cells.fail(f"holds a cell of the unknown type {kind} with {number} nodes")
        by_kind.setdefault((kind, group), []).append(cells.integers("int", number))
    cells.end()
    blocks = [
        CellBlock(kind, np.array(found), (group,) if group else ())
        for (kind, group), found in by_kind.items()
    ]
    return rows[:, 0].astype(np.int64), np.ascontiguousarray(rows[:, 1:]), blocks


def _section(name: str, data: bytes, source: str) -> Numbers:
    found = re.findall(rb"\$" + name.encode() + rb"\b(.*?)\$END" + name.encode(), data, re.DOTALL)
    if len(found) != 1:
        what = f"has no ${name}" if not found else f"has ${name} twice"
        raise InputError(
            f"{source}: {what}, or does not end it. The file is damaged or cut off: write it again"
        )
    return Numbers(Section(name, found[0], source), False, "=")


def read_nodes(section: Section) -> tuple[Ints, Floats]:
    """Node tags (n,) and coordinates (n, 3) of version 4.0."""
    numbers = Numbers(section, False, "=")
    n_blocks, n_nodes = numbers.integers("size", 2).tolist()
    rows = [np.empty((0, 4))]
    for _ in range(n_blocks):
        _, dimension, parametric = numbers.integers("int", 3).tolist()
        n = numbers.integer("size")
        width = 4 + (dimension if parametric else 0)
        rows.append(numbers.doubles(n * width).reshape(n, width)[:, :4])
    numbers.end()
    nodes = np.concatenate(rows)
    if len(nodes) != n_nodes:
        raise section.fail(f"announces {n_nodes} nodes but holds {len(nodes)}")
    return nodes[:, 0].astype(np.int64), np.ascontiguousarray(nodes[:, 1:])


def read_cells(section: Section, entities: Entities) -> list[CellBlock]:
    """Cells of version 4.0 as `kshell.mesh.msh4.read_cells` reads those of 4.1."""
    numbers = Numbers(section, False, "=", whole=True)
    n_blocks, n_cells = numbers.integers("size", 2).tolist()
    blocks, found = [], 0
    for _ in range(n_blocks):
        entity, dimension, kind = numbers.integers("int", 3).tolist()
        n = numbers.integer("size")
        if kind not in NODES_OF_TYPE:
            raise section.fail(f"holds cells of the unknown type {kind}")
        width = 1 + NODES_OF_TYPE[kind]
        nodes = numbers.integers("size", n * width).reshape(n, width)[:, 1:]
        key, found = (dimension, entity), found + n
        if dimension == 2 and entity in entities.ghosts:
            continue
        tags, part = entities.tags.get(key, ()), entities.part.get(key, 0)
        blocks.append(CellBlock(kind, nodes, tags, entities.numbered(key), part))
    numbers.end()
    if found != n_cells:
        raise section.fail(f"announces {n_cells} cells but holds {found}")
    return blocks
