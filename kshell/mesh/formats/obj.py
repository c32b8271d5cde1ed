"""Wavefront .obj files: vertices and faces of any form (v, v/vt, v//vn, v/vt/vn, negative), groups (g) and objects (o).

Source: Wavefront "Object Files (.obj)", appendix B1 of the Advanced Visualizer manual.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np

from kshell.errors import InputError
from kshell.mesh.formats.found import Found
from kshell.mesh.formats.text import real, text_of, whole
from kshell.mesh.raw import RawMesh

FREE_FORM = ("curv", "curv2", "surf", "vp", "cstype", "bzp", "bsp", "cdc", "cdp", "res")
KINDS = {1: "point", 2: "line", 3: "triangle", 4: "quadrilateral"}


def read_obj(path: Path) -> RawMesh:
    """Mesh, groups and objects of an .obj file.

    Raises
    ------
    InputError
        If a line is none of the format, or free-form surfaces are in it.
    """
    points: list[tuple[float, ...]] = []
    cells: dict[str, tuple[list[list[int]], list[tuple[str, ...]]]] = {}
    groups: tuple[str, ...] = ()
    thing: tuple[str, ...] = ()
    for number, line in enumerate(text_of(path).replace("\\\n", " ").splitlines(), 1):
        word, *rest = line.partition("#")[0].split() or [""]
        where = f"{path.name}, line {number}"
        if word == "v":
            if len(rest) < 3:
                raise InputError(f"{where}: a vertex of {len(rest)} numbers instead of 3")
            points.append(tuple(real(value, where) for value in rest[:3]))
        elif word in ("f", "fo"):
            _add(cells, rest, len(points), (*groups, *thing), where)
        elif word == "l":
            for ends in pairwise(rest):
                _add(cells, ends, len(points), (*groups, *thing), where)
        elif word == "p":
            for corner in rest:
                _add(cells, [corner], len(points), (*groups, *thing), where)
        elif word == "g":
            groups = tuple(rest)
        elif word == "o":
            thing = (" ".join(rest),) if rest else ()
        elif word in FREE_FORM:
            raise InputError(f"{where}: free-form surfaces ({word}) are not read. Export a mesh of polygons")
    found = Found(np.array(points, dtype=float).reshape(-1, 3), path.name)
    for kind, (nodes, names) in cells.items():
        numbers = found.add(kind, nodes)
        for name in dict.fromkeys(name for of_cell in names for name in of_cell):
            found.put(name, numbers[[name in of_cell for of_cell in names]])
    return found.raw()


def _add(
    cells: dict[str, tuple[list[list[int]], list[tuple[str, ...]]]],
    corners: list[str] | tuple[str, ...],
    n_points: int,
    names: tuple[str, ...],
    where: str,
) -> None:
    nodes = []
    for corner in corners:
        index = whole(corner.partition("/")[0], where)
        row = index - 1 if index > 0 else n_points + index  # -1 is the last vertex so far
        if not 0 <= row < n_points or index == 0:
            raise InputError(f"{where}: names vertex {index}, but {n_points} vertices were given so far")
        nodes.append(row)
    kind = KINDS.get(len(nodes), "polygons of more than four sides")
    of_kind = cells.setdefault(kind, ([], []))
    of_kind[0].append(nodes if kind in KINDS.values() else nodes[:4])
    of_kind[1].append(tuple(dict.fromkeys(names)))
