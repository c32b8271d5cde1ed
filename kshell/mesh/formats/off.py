"""Object File Format (.off) of Geomview: vertices and faces.

Source: Geomview manual, "OFF Files".
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from kshell.errors import InputError
from kshell.mesh.formats.found import Found
from kshell.mesh.formats.text import real, text_of, whole
from kshell.mesh.raw import RawMesh

KINDS = {1: "point", 2: "line", 3: "triangle", 4: "quadrilateral"}


def read_off(path: Path) -> RawMesh:
    """Mesh of an .off file.

    Raises
    ------
    InputError
        If it holds other numbers of vertices or faces than it announces.
    """
    lines = [
        (f"{path.name}, line {number}", line.partition("#")[0].split())
        for number, line in enumerate(text_of(path).splitlines(), 1)
    ]
    lines = [(where, words) for where, words in lines if words]
    if lines[0][1][0].upper() in ("OFF", "COFF", "NOFF", "CNOFF", "STOFF", "[ST][C][N]OFF"):
        lines[0] = (lines[0][0], lines[0][1][1:])
        lines = lines if lines[0][1] else lines[1:]
    elif not lines[0][1][0].isdigit():
        raise InputError(f"{lines[0][0]}: {lines[0][1][0]!r} is no OFF file in space. Export it again")
    counts = [whole(word, lines[0][0]) for word in lines[0][1]] if lines else []
    if len(counts) < 2 or len(lines) != 1 + counts[0] + counts[1] or min(counts) < 0:
        raise InputError(
            f"{path.name}: announces {counts[:2]} vertices and faces, but holds {len(lines) - 1} lines of them. The "
            "file is damaged or cut off"
        )
    points, faces = lines[1 : 1 + counts[0]], lines[1 + counts[0] :]
    if any(len(words) < 3 for _, words in points):
        raise InputError(f"{path.name}: a vertex has fewer than 3 coordinates")
    found = Found(
        np.array([[real(word, where) for word in words[:3]] for where, words in points]).reshape(-1, 3),
        path.name,
    )
    by_number: dict[int, list[list[int]]] = {}
    for where, words in faces:
        number = whole(words[0], where)
        nodes = [whole(word, where) for word in words[1 : 1 + number]]
        if len(nodes) != number or number < 1 or min(nodes) < 0 or max(nodes) >= len(found.points):
            raise InputError(
                f"{where}: a face of {number} vertices names others than 0 to {len(found.points) - 1}"
            )
        by_number.setdefault(number, []).append(nodes)
    for number, cells in by_number.items():
        found.add(KINDS.get(number, "polygons of more than four sides"), cells)
    return found.raw()
