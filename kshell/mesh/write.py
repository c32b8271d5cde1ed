"""Writing a mesh as a .msh file of gmsh, with every group; whole or not at all."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh.mesh import KIND_OF_DIMENSION, Mesh

Ints = NDArray[np.int64]

# gmsh's cell types by dimension, for order 1 and 2
CELL_TYPE = {1: (15, 1, 2), 2: (15, 8, 9)}


def write_msh(mesh: Mesh, path: str | os.PathLike[str], version: str = "4.1") -> None:
    """Write `mesh` as an ASCII .msh file.

    Parameters
    ----------
    mesh : Mesh
    path : path
    version : "4.1" or "2.2"
        2.2 repeats a cell for every group it belongs to; programs other than kshell may then count it more
        than once.

    Raises
    ------
    InputError
        If the version is neither, or the folder does not exist.
    """
    if version not in ("4.1", "2.2"):
        raise InputError(f"MSH version {version!r} cannot be written: choose '4.1' or '2.2'")
    path = Path(path)
    if not path.parent.is_dir():
        raise InputError(f"cannot write {path}: there is no folder {path.parent}")
    tags = _physical_tags(mesh)
    text = [f"$MeshFormat\n{version} 0 8\n$EndMeshFormat\n", _names(mesh, tags)]
    text.append(_version_4(mesh, tags) if version == "4.1" else _version_2(mesh, tags))
    beside = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        beside.write_text("".join(text), encoding="utf-8")
        os.replace(beside, path)
    finally:
        beside.unlink(missing_ok=True)


def _physical_tags(mesh: Mesh) -> dict[str, int]:
    """A tag for each group: its own if it has one that is free, else the next free one of its dimension."""
    taken: set[tuple[int, int]] = set()
    tags: dict[str, int] = {}
    for name, group in mesh.groups.items():
        if group.tag is not None and (group.dimension, group.tag) not in taken:
            tags[name] = group.tag
            taken.add((group.dimension, group.tag))
    for name, group in mesh.groups.items():
        if name not in tags:
            tag = 1 + max((t for d, t in taken if d == group.dimension), default=0)
            tags[name] = tag
            taken.add((group.dimension, tag))
    return tags


def _names(mesh: Mesh, tags: dict[str, int]) -> str:
    lines = []
    for name, group in mesh.groups.items():
        # a name shared by several kinds of groups is told apart by its kind in kshell only
        plain = name.removesuffix(f" ({KIND_OF_DIMENSION[group.dimension]})")
        if name != f"{group.dimension}:{group.tag}" or not len(group.members):
            lines.append(f'{group.dimension} {tags[name]} "{plain}"\n')
    return f"$PhysicalNames\n{len(lines)}\n{''.join(lines)}$EndPhysicalNames\n" if lines else ""


def _cells(mesh: Mesh, dimension: int) -> Ints:
    """(cell, node) node numbers from 1 of all vertices, edges or triangles; mid-edge nodes follow the "
    "vertices."""
    n = len(mesh.points)
    if dimension == 0:
        return 1 + np.arange(n)[:, None]
    corners = mesh.edges if dimension == 1 else mesh.triangles
    if mesh.order == 1:
        return 1 + corners.astype(np.int64)
    middles = np.arange(len(mesh.edges))[:, None] if dimension == 1 else mesh.triangle_edges
    return 1 + np.concatenate([corners, n + middles], axis=1).astype(np.int64)


def _rows(array: NDArray[np.generic]) -> str:
    return "".join(" ".join(map(repr, row)) + "\n" for row in array.tolist())


def _node_points(mesh: Mesh) -> NDArray[np.float64]:
    return mesh.points if mesh.midpoints is None else np.concatenate([mesh.points, mesh.midpoints])


def _version_2(mesh: Mesh, tags: dict[str, int]) -> str:
    points = _node_points(mesh)
    numbered = "".join(f"{k} {x!r} {y!r} {z!r}\n" for k, (x, y, z) in enumerate(points.tolist(), 1))
    lines: list[str] = []
    grouped = np.zeros(len(mesh.triangles), dtype=bool)
    for name, group in mesh.groups.items():
        if group.dimension == 2:
            grouped[group.members] = True
        lines += _records_2(mesh, group.dimension, group.members, tags[name], len(lines))
    lines += _records_2(mesh, 2, np.flatnonzero(~grouped), 0, len(lines))
    return (
        f"$Nodes\n{len(points)}\n{numbered}$EndNodes\n$Elements\n{len(lines)}\n{''.join(lines)}$EndElements\n"
    )


def _records_2(mesh: Mesh, dimension: int, members: NDArray[np.integer], tag: int, before: int) -> list[str]:
    cell_type = CELL_TYPE[mesh.order][dimension]
    rows = _cells(mesh, dimension)[members].tolist()
    return [
        f"{before + k} {cell_type} 2 {tag} {max(tag, 1)} {' '.join(map(str, row))}\n"
        for k, row in enumerate(rows, 1)
    ]


def _version_4(mesh: Mesh, tags: dict[str, int]) -> str:
    """Cells in the same groups make one entity; the entity lists the groups."""
    entities: list[str] = []
    counts = [0, 0, 0, 0]
    blocks: list[str] = []
    n_cells = 0
    box = " ".join(repr(float(c)) for c in (*mesh.points.min(axis=0), *mesh.points.max(axis=0)))
    for dimension in (0, 1, 2):
        for combination, members in _combinations(mesh, dimension, tags):
            counts[dimension] += 1
            entity = counts[dimension]
            where = " ".join(map(repr, mesh.points[members[0]].tolist())) if dimension == 0 else box
            bounds = "" if dimension == 0 else " 0"
            physical = " ".join(map(str, combination))
            entities.append(f"{entity} {where} {len(combination)} {physical}{bounds}\n")
            cells = _cells(mesh, dimension)[members]
            numbered = np.column_stack([n_cells + 1 + np.arange(len(cells)), cells])
            blocks.append(
                f"{dimension} {entity} {CELL_TYPE[mesh.order][dimension]} {len(cells)}\n{_rows(numbered)}"
            )
            n_cells += len(cells)
    points = _node_points(mesh)
    n = len(points)
    node_numbers = "".join(f"{k}\n" for k in range(1, n + 1))
    return (
        f"$Entities\n{' '.join(map(str, counts))}\n{''.join(entities)}$EndEntities\n$Nodes\n1 {n} 1 {n}\n2 1 "
        f"0 {n}\n{node_numbers}{_rows(points)}$EndNodes\n$Elements\n{len(blocks)} {n_cells} 1 "
        f"{n_cells}\n{''.join(blocks)}$EndElements\n"
    )


def _combinations(mesh: Mesh, dimension: int, tags: dict[str, int]) -> list[tuple[list[int], Ints]]:
    """Cells gathered by the set of groups they belong to; points one by one, as gmsh demands."""
    names = [name for name, group in mesh.groups.items() if group.dimension == dimension]
    n_cells = (len(mesh.points), len(mesh.edges), len(mesh.triangles))[dimension]
    belongs = np.zeros((n_cells, len(names)), dtype=bool)
    for column, name in enumerate(names):
        belongs[mesh.groups[name].members, column] = True
    # cells in no group are written if they are triangles
    written = np.arange(n_cells) if dimension == 2 else np.flatnonzero(belongs.any(axis=1))
    if dimension == 0:
        return [([tags[names[k]] for k in np.flatnonzero(belongs[i])], np.array([i])) for i in written]
    if not len(written):
        return []
    if not names:
        return [([], written)]
    patterns, pattern_of = np.unique(belongs[written], axis=0, return_inverse=True)
    pattern_of = pattern_of.ravel()
    return [
        ([tags[names[k]] for k in np.flatnonzero(pattern)], written[pattern_of == row])
        for row, pattern in enumerate(patterns)
    ]
