"""Nodes and cells of MSH 2.2: one record per cell, repeated for each physical group the cell belongs to."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.gmsh_cells import NODES_OF_TYPE, CellBlock
from kshell.mesh.numbers import Section

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]


def _first_line(section: Section) -> tuple[int, Section]:
    """The count on the first line, and what follows it."""
    line, _, rest = section.data.lstrip().partition(b"\n")
    try:
        number = int(line)
    except ValueError:
        raise section.fail(f"begins with {line[:40].decode('latin-1')!r} instead of a count") from None
    return number, Section(section.name, rest, section.source)


def read_nodes(section: Section, binary: bool, byte_order: str) -> tuple[Ints, Floats]:
    """Node tags (n,) and coordinates (n, 3)."""
    n, rest = _first_line(section)
    if binary:
        record = np.dtype([("tag", f"{byte_order}i4"), ("x", f"{byte_order}f8", 3)])
        if n < 0 or len(rest.data) < n * record.itemsize:
            raise section.fail(f"ends before its {n} nodes have come")
        if rest.data[n * record.itemsize :].strip():
            raise section.fail(f"announces {n} nodes but holds more")
        nodes = np.frombuffer(rest.data, record, n)
        return nodes["tag"].astype(np.int64), nodes["x"].astype(float)
    numbers = rest.text_floats()
    if len(numbers) != 4 * n:
        raise section.fail(f"announces {n} nodes but holds {len(numbers)} numbers instead of {4 * n}")
    rows = numbers.reshape(n, 4)
    return rows[:, 0].astype(np.int64), np.ascontiguousarray(rows[:, 1:])


def read_cells(section: Section, binary: bool, byte_order: str) -> list[CellBlock]:
    """Cells by type and physical tag (0: none)."""
    n, rest = _first_line(section)
    if binary:
        numbers = np.frombuffer(rest.data, f"{byte_order}i4", len(rest.data) // 4).astype(np.int64)
        return _from_binary(section, numbers, n)
    return _from_text(section, rest.text_integers(), n)


def _from_text(section: Section, numbers: Ints, n: int) -> list[CellBlock]:
    """Records "number type n_tags tags... nodes..."."""
    nodes_of = _node_table()
    # the length a record would have if it began at each position
    cell_type = np.clip(_shifted(numbers, 1), 0, len(nodes_of) - 1)
    length = 3 + np.clip(_shifted(numbers, 2), 0, len(numbers)) + nodes_of[cell_type]
    start = _record_starts(length, n)
    if n and (len(start) < n or start[-1] + length[start[-1]] > len(numbers)):
        raise section.fail(f"ends before its {n} cells have come")
    types, n_tags = numbers[start + 1], numbers[start + 2]
    _raise_on_unknown(section, types, n_tags)
    _raise_on_more(section, n, len(numbers) - (start[-1] + length[start[-1]] if n else 0))
    return _blocks(numbers, types, n_tags, start + 3)


def _from_binary(section: Section, numbers: Ints, n: int) -> list[CellBlock]:
    """Runs with a header "type n_cells n_tags" before records "number tags... nodes..."."""
    nodes_of = _node_table()
    kind = np.clip(_shifted(numbers, 0), 0, len(nodes_of) - 1)
    n_cells, n_tags = (np.clip(_shifted(numbers, k), 0, len(numbers)) for k in (1, 2))
    length = 3 + n_cells * (1 + n_tags + nodes_of[kind])
    header = _record_starts(length, n)
    header = header[np.cumsum(n_cells[header]) <= n]
    if n_cells[header].sum() < n or (n and header[-1] + length[header[-1]] > len(numbers)):
        raise section.fail(f"ends before its {n} cells have come")
    types, n_tags = numbers[header], numbers[header + 2]
    _raise_on_unknown(section, types, n_tags)
    _raise_on_more(section, n, len(numbers) - (header[-1] + length[header[-1]] if n else 0))
    # every cell of every run, as if it had a header of its own
    repeats = n_cells[header]
    rank = np.arange(repeats.sum()) - np.repeat(np.cumsum(repeats) - repeats, repeats)
    types, n_tags = np.repeat(types, repeats), np.repeat(n_tags, repeats)
    tags_at = np.repeat(header, repeats) + 4 + rank * (1 + n_tags + nodes_of[types])
    return _blocks(numbers, types, n_tags, tags_at)


def _blocks(numbers: Ints, types: Ints, n_tags: Ints, tags_at: Ints) -> list[CellBlock]:
    """Cells with their first tag at `tags_at`, gathered by type, number of tags, physical tag and part.

    The tags are: physical, curve or surface, then of a divided mesh the number of parts, the own one, and those that it
    is a neighbour of, negative.
    """
    if not len(types):
        return []
    physical = np.where(n_tags > 0, numbers[np.minimum(tags_at, len(numbers) - 1)], 0)
    part = np.where(n_tags > 3, numbers[np.minimum(tags_at + 3, len(numbers) - 1)], 0)
    base = int(physical.min())
    key = (types * (n_tags.max() + 1) + n_tags) * (int(physical.max()) - base + 1) + physical - base
    key = key * (int(part.max()) - int(part.min()) + 1) + part - int(part.min())
    _, first, group = np.unique(key, return_index=True, return_inverse=True)
    labels = np.stack([types, n_tags, physical, part], axis=1)[first]
    order = np.argsort(group, kind="stable")
    ends = np.cumsum(np.bincount(group, minlength=len(labels)))
    blocks = []
    for (cell_type, tags, tag, own), cells in zip(labels.tolist(), np.split(order, ends[:-1]), strict=True):
        nodes_at = tags_at[cells] + tags
        nodes = numbers[nodes_at[:, None] + np.arange(NODES_OF_TYPE[cell_type])]
        blocks.append(CellBlock(cell_type, nodes, (tag,) if tag else (), part=own))
    return blocks


def _record_starts(length: Ints, n: int) -> Ints:
    """Where the first `n` records begin, when a record at position p is followed by one at p + length[p].

    The chain is followed in doubling steps: with the first m starts known and "jump" leading m records
    ahead, jump of the starts are the next m.
    """
    end = len(length)
    jump = np.minimum(np.arange(end + 1) + np.append(length, 0), end)
    start = np.zeros(1, dtype=np.int64)
    while len(start) < n and start[-1] < end:
        start = np.concatenate([start, jump[start]])
        jump = jump[jump]
    return start[start < end][:n]


def _shifted(numbers: Ints, by: int) -> Ints:
    """numbers[p + by] at each p, 0 past the end."""
    return np.append(numbers[by:], np.zeros(min(by, len(numbers)), dtype=np.int64))


def _node_table() -> Ints:
    table = np.zeros(max(NODES_OF_TYPE) + 1, dtype=np.int64)
    table[list(NODES_OF_TYPE)] = list(NODES_OF_TYPE.values())
    return table


def _raise_on_unknown(section: Section, types: Ints, n_tags: Ints) -> None:
    known = np.isin(types, list(NODES_OF_TYPE))
    if not known.all():
        raise section.fail(f"holds a cell of the unknown type {types[~known][0]}")
    if (n_tags < 0).any():
        raise section.fail("holds a cell with a negative number of tags")


def _raise_on_more(section: Section, n: int, numbers: int) -> None:
    if numbers > 0:
        raise section.fail(
            f"announces {n} cells, after which {numbers} numbers more follow: a count is too small or a line too long"
        )
