"""Reading .msh files of gmsh, versions 1 to 4.1, ASCII and binary, with every physical group.

gmsh itself is not needed. meshio is not used: of a cell in several groups it keeps one tag only, and it
never reads physical points.
"""

from __future__ import annotations

import re
from collections import defaultdict
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh import msh2, msh4, msh_old, quads
from kshell.mesh.gmsh_cells import LINES, POINT, QUADRILATERALS, TRIANGLES, CellBlock, kind_of_other
from kshell.mesh.gmsh_high import lowered
from kshell.mesh.numbers import Section, sections
from kshell.mesh.pieces import require_all_parts
from kshell.mesh.raw import RawGroup, RawMesh

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]

OTHER_VERSION = (
    "Save it as version 4.1, `gmsh {name} -save -format msh41 -o new.msh`, or set `Mesh.MshFileVersion = "
    "4.1;`"
)
_NAME_LINE = re.compile(r'^\s*(\d)\s+(-?\d+)\s+"(.*)"\s*$')


def read_gmsh(path: Path, source: str | None = None) -> RawMesh:
    """Nodes, triangles and physical groups of a .msh file.

    Raises
    ------
    InputError
        If the file is no MSH file of version 1, 2 or 4, or is damaged.
    """
    source = source or path.name
    data = path.read_bytes()
    if not data.strip():
        raise InputError(f"{source}: the file is empty. Mesh again, `gmsh -2 file.geo -o file.msh`")
    if not data.lstrip().startswith((b"$MeshFormat", b"$Comments", b"$NOD")):
        raise InputError(
            f"{source}: not a gmsh file: it does not begin with $MeshFormat. Is it of another format or cut "
            "off?"
        )
    if data.lstrip().startswith(b"$NOD"):
        tags, points, blocks = msh_old.read_version_1(data, source)
        return _raw_mesh(tags, points, blocks, {}, source)
    found = sections(data, source)
    if "MeshFormat" not in found:
        raise InputError(f"{source}: has no $MeshFormat. {OTHER_VERSION.format(name=source)}")
    version, binary, byte_order = _format(found["MeshFormat"])
    for name in ("Nodes", "Elements"):
        if name not in found:
            raise InputError(
                f"{source}: has no ${name}: the file was saved before meshing or cut off. Mesh again, `gmsh "
                "-2 file.geo`"
            )
    parts: int | None = None
    if version == "2.2":
        tags, points = msh2.read_nodes(found["Nodes"], binary, byte_order)
        blocks = msh2.read_cells(found["Elements"], binary, byte_order)
    elif version == "4.0":
        entities = _entities(found, False, "=", msh_old.PLACE)
        tags, points = msh_old.read_nodes(found["Nodes"])
        blocks, parts = msh_old.read_cells(found["Elements"], entities), entities.parts
    else:
        entities = _entities(found, binary, byte_order, msh4.PLACE)
        tags, points = msh4.read_nodes(found["Nodes"], binary, byte_order)
        blocks, parts = msh4.read_cells(found["Elements"], binary, byte_order, entities), entities.parts
    there = {block.part for block in blocks if block.cell_type in TRIANGLES + QUADRILATERALS}
    said = require_all_parts(there, parts, tags, source)
    names = _physical_names(found["PhysicalNames"]) if "PhysicalNames" in found else {}
    if not names and not any(block.tags for block in blocks):
        blocks = [replace(block, tags=block.entity) for block in blocks]
        raw = _raw_mesh(tags, points, blocks, names, source)
        raw.notes += said
        if raw.groups:
            raw.notes.append(
                "no physical groups: curves and surfaces are called by gmsh's own numbers, e.g. '1:2'"
            )
        return raw
    raw = _raw_mesh(tags, points, blocks, names, source)
    raw.notes += said
    return raw


def _entities(found: dict[str, Section], binary: bool, byte_order: str, place: int) -> msh4.Entities:
    """What the cells lie on, and the pieces of it in a divided mesh; `place` numbers tell where a point lies."""
    out = msh4.Entities()
    if "Entities" in found:
        msh4.read_entities(found["Entities"], binary, byte_order, out, place)
    if "PartitionedEntities" in found:
        msh4.read_partitioned_entities(found["PartitionedEntities"], binary, byte_order, out, place)
    return out


def _format(section: Section) -> tuple[str, bool, str]:
    """Version, whether binary, and the byte order."""
    line, _, rest = section.data.lstrip().partition(b"\n")
    words = line.decode("latin-1").split()
    if len(words) < 3 or words[1] not in ("0", "1"):
        raise section.fail(f"is {' '.join(words)[:40]!r} instead of version, kind and size of numbers")
    version = {"2": "2.2", "2.0": "2.2", "2.1": "2.2", "2.2": "2.2", "4.1": "4.1"}.get(words[0])
    if words[0] in ("4", "4.0") and words[1] == "0":  # gmsh writes it as text only
        version = "4.0"
    if version is None:
        raise InputError(
            f"{section.source}: MSH version {words[0]} is not read. "
            f"{OTHER_VERSION.format(name=section.source)}"
        )
    if words[1] == "0":
        return version, False, "="
    if words[2] != "8":
        raise InputError(
            f"{section.source}: binary with numbers of {words[2]} bytes instead of 8. "
            f"{OTHER_VERSION.format(name=section.source)}"
        )
    if rest[:4] == (1).to_bytes(4, "little"):
        return version, True, "<"
    if rest[:4] == (1).to_bytes(4, "big"):
        return version, True, ">"
    raise section.fail("lacks the number 1 that tells the order of bytes")


def _physical_names(section: Section) -> dict[tuple[int, int], str]:
    """Names by (dimension, tag)."""
    names = {}
    for line in section.data.decode("utf-8", errors="replace").splitlines()[1:]:
        match = _NAME_LINE.match(line)
        if match:
            names[int(match[1]), int(match[2])] = match[3]
        elif line.strip():
            raise section.fail(f'holds {line.strip()[:60]!r} instead of: dimension tag "name"')
    return names


def _raw_mesh(
    node_tags: Ints,
    points: Floats,
    blocks: list[CellBlock],
    names: dict[tuple[int, int], str],
    source: str,
) -> RawMesh:
    number = _NodeNumbers(node_tags, source)
    read = len(node_tags)
    node_tags, points, blocks, higher, high = lowered(node_tags, points, blocks, number.of)
    if len(node_tags) > read:
        number = _NodeNumbers(node_tags, source)
    triangles: list[Ints] = [np.empty((0, 3), dtype=np.int64)]
    parts: list[Ints] = []
    segments = n_triangles = 0
    other: dict[str, int] = defaultdict(int)
    cells: dict[tuple[int, int], list[Ints]] = {key: [] for key in names if key[0] <= 2}
    for block in blocks:
        if block.cell_type in TRIANGLES:
            dimension = 2
            triangles.append(_turned(number.of(block.nodes), block.tags))
            members = np.arange(n_triangles, n_triangles + len(block.nodes))
            parts.append(np.full(len(members), block.part))
            n_triangles += len(block.nodes)
        elif block.cell_type in LINES:
            dimension = 1
            segments += len(block.nodes)
            members = number.of(block.nodes[:, :2]) if block.tags else np.empty((0, 2), dtype=np.int64)
        elif block.cell_type in POINT:
            dimension = 0
            members = number.of(block.nodes[:, 0])
        elif block.cell_type in QUADRILATERALS:
            continue
        else:
            other[kind_of_other(block.cell_type)] += len(block.nodes)
            continue
        for tag in {abs(tag) for tag in block.tags}:
            cells.setdefault((dimension, tag), []).append(members)
    points, quad_triangles, members_of, notes = _quadrilaterals(blocks, number, points, source)
    for block, rows in members_of:
        for tag in {abs(tag) for tag in block.tags}:
            cells.setdefault((2, tag), []).append(n_triangles + rows)
    triangles += quad_triangles
    parts.append(np.zeros(sum(map(len, quad_triangles)), dtype=np.int64))
    for block, rows in members_of:
        parts[-1][rows] = block.part

    width = max(t.shape[1] for t in triangles)
    stacked = np.concatenate(
        [np.pad(t, ((0, 0), (0, width - t.shape[1])), constant_values=-1) for t in triangles]
    )
    empty = (np.empty(0, np.int64), np.empty((0, 2), np.int64), np.empty(0, np.int64))
    groups = [
        RawGroup(names.get((dimension, tag), ""), dimension, np.concatenate([*found, empty[dimension]]), tag)
        for (dimension, tag), found in sorted(cells.items())
    ]
    part = np.concatenate(parts)
    divided = part - 1 if part.max(initial=0) > 0 and part.min(initial=1) > 0 else None
    return RawMesh(points, stacked, groups, source, dict(other), segments, [*high, *notes], higher, divided)


def _quadrilaterals(
    blocks: list[CellBlock], number: _NodeNumbers, points: Floats, source: str
) -> tuple[Floats, list[Ints], list[tuple[CellBlock, Ints]], list[str]]:
    """Quadrilaterals as triangles.

    Returns
    -------
    points : (node, 3) float array, with centres that were made
    triangles : list of (n, 3 or 6) int array
    members : for each block of quadrilaterals its rows in all of `triangles`
    notes : list of str
    """
    triangles: list[Ints] = []
    members: list[tuple[CellBlock, Ints]] = []
    n_quads = n_triangles = warped = 0
    worst = 0.0
    for cell_type in QUADRILATERALS:
        of_type = [block for block in blocks if block.cell_type == cell_type and len(block.nodes)]
        if not of_type:
            continue
        stored = np.concatenate([_turned(number.of(block.nodes), block.tags) for block in of_type])
        # MSH 2.2 repeats a cell for each group
        unique, row_of = np.unique(stored, axis=0, return_inverse=True)
        halves = quads.split(points, unique, source)
        first = np.searchsorted(halves.origin, np.arange(len(unique) + 1))
        ends = np.cumsum([len(block.nodes) for block in of_type])
        for block, rows in zip(of_type, np.split(row_of.ravel(), ends[:-1]), strict=True):
            parts = [np.arange(first[row], first[row + 1]) for row in rows.tolist()]
            members.append((block, n_triangles + np.concatenate(parts)))
        points = np.concatenate([points, halves.points])
        triangles.append(halves.triangles)
        n_triangles += len(halves.triangles)
        n_quads, warped, worst = n_quads + len(unique), warped + halves.warped, max(worst, halves.worst)
    return points, triangles, members, [quads.note(n_quads, warped, worst)] if n_quads else []


def _turned(nodes: Ints, tags: tuple[int, ...]) -> Ints:
    """Cells the other way round if their group asks for it by a negative tag (gmsh: `Physical Surface(1) "
    "= {-5};`)."""
    if not tags or max(tags) > 0:
        return nodes
    return nodes[:, _BACKWARDS[nodes.shape[1]]]


# the order of the nodes of a cell of so many nodes seen from its other side
_BACKWARDS = {
    3: [0, 2, 1],
    6: [0, 2, 1, 5, 4, 3],
    4: [0, 3, 2, 1],
    8: [0, 3, 2, 1, 7, 6, 5, 4],
    9: [0, 3, 2, 1, 7, 6, 5, 4, 8],
}


class _NodeNumbers:
    """From node tags, any positive integers, to positions in the list of nodes."""

    def __init__(self, tags: Ints, source: str) -> None:
        self._order = np.argsort(tags, kind="stable")
        self._sorted = tags[self._order]
        self._source = source
        twice = np.flatnonzero(self._sorted[1:] == self._sorted[:-1])
        if len(twice):
            raise InputError(f"{source}: node {self._sorted[twice[0]]} is stored twice. Write the file again")
        # consecutive tags, as gmsh writes them, need no search
        self._first = int(tags.min()) if len(tags) else 0
        self._dense = len(tags) > 0 and int(tags.max()) - self._first == len(tags) - 1

    def of(self, tags: Ints) -> Ints:
        """Positions of the nodes with these tags."""
        place = tags - self._first if self._dense else np.searchsorted(self._sorted, tags)
        inside = (place >= 0) & (place < len(self._sorted))
        known = inside.copy()
        known[inside] = self._sorted[place[inside]] == tags[inside]
        if not known.all():
            raise InputError(
                f"{self._source}: a cell names node {tags[~known][0]}, which the file does not hold. The "
                "file is damaged: write it again"
            )
        numbers: Ints = self._order[place]
        return numbers
