"""SU2 meshes: elements, points and markers as groups.

Source: SU2 documentation, "Mesh File" (elements are numbered as in VTK, their nodes from 0).
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from kshell.errors import InputError
from kshell.mesh.formats.found import Found
from kshell.mesh.formats.text import real, text_of, whole
from kshell.mesh.raw import RawMesh

# number of VTK: kind, nodes
KINDS = {
    1: ("point", 1),
    3: ("line", 2),
    5: ("triangle", 3),
    9: ("quadrilateral", 4),
    10: ("solid cells", 4),
    12: ("solid cells", 8),
    13: ("solid cells", 6),
    14: ("solid cells", 5),
}
_KEY = re.compile(r"^\s*([A-Z_]+)\s*=\s*(.*?)\s*$", re.IGNORECASE)


def read_su2(path: Path) -> RawMesh:
    """Mesh and markers of an .su2 file.

    Raises
    ------
    InputError
        If it holds other numbers of elements or points than it announces.
    """
    lines = [
        (f"{path.name}, line {number}", line.partition("%")[0].strip())
        for number, line in enumerate(text_of(path).splitlines(), 1)
    ]
    lines = [(where, line) for where, line in lines if line]
    dimension, points, found = 3, np.empty((0, 3)), Found(np.empty((0, 3)), path.name)
    marker, at = "", 0
    announced = markers = 0
    while at < len(lines):
        where, line = lines[at]
        match = _KEY.match(line)
        if match is None:
            raise InputError(
                f"{where}: {line[:40]!r} stands where a key such as NELEM= should: a count is too small"
            )
        key, value = match[1].upper(), match[2]
        at += 1
        if key == "NDIME":
            dimension = whole(value, where)
        elif key == "MARKER_TAG":
            marker, markers = value, markers + 1
        elif key == "NMARK":
            announced = whole(value, where)
        elif key in ("NELEM", "MARKER_ELEMS", "NPOIN"):
            n = whole(value.split()[0] if value else "", where)
            rows = lines[at : at + n]
            at += n
            if len(rows) < n or any("=" in row for _, row in rows):
                raise InputError(f"{where}: announces {n} lines, but fewer follow. The file is cut off")
            if key == "NPOIN":
                short = [place for place, row in rows if len(row.split()) < dimension]
                if short or dimension not in (2, 3):
                    raise InputError(
                        f"{(short or [where])[0]}: a point has fewer than {dimension} coordinates"
                    )
                points = np.array(
                    [[real(word, place) for word in row.split()[:dimension]] for place, row in rows]
                )
            else:
                _cells(found, rows, marker if key == "MARKER_ELEMS" else "")
        elif key in ("NZONE", "NCHUNK", "FFD_NBOX") and value not in ("1", "0"):
            raise InputError(f"{where}: {key} = {value}: only one zone is read")
    if announced > markers:
        raise InputError(
            f"{path.name}: announces {announced} markers but holds {markers}. The file is cut off"
        )
    if points.ndim != 2 or points.shape[1:] not in ((2,), (3,)):
        raise InputError(f"{path.name}: has no points in {dimension} dimensions")
    found.points = np.column_stack([points, np.zeros((len(points), 3 - points.shape[1]))])
    _require_points(found)
    return found.raw()


def _cells(found: Found, rows: list[tuple[str, str]], marker: str) -> None:
    by_kind: dict[tuple[str, int], list[list[int]]] = {}
    for where, row in rows:
        words = [whole(word, where) for word in row.split()]
        kind = KINDS.get(words[0])
        if kind is None or len(words) < 1 + kind[1]:
            raise InputError(f"{where}: {row[:40]!r} is no element")
        by_kind.setdefault(kind, []).append(words[1 : 1 + kind[1]])
    for (kind_name, _), nodes in by_kind.items():
        cells = found.add(kind_name, nodes)
        if marker:
            found.put(marker, cells)


def _require_points(found: Found) -> None:
    for _, nodes in found.blocks:
        if nodes.size and (nodes.min() < 0 or nodes.max() >= len(found.points)):
            bad = nodes.min() if nodes.min() < 0 else nodes.max()
            raise InputError(
                f"{found.source}: an element names point {bad}, but there are {len(found.points)}"
            )
