"""STL files, ASCII with one solid or several and binary: corners at the same place are one vertex.

Source: 3D Systems, "Stereolithography Interface Specification", 1988.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh.formats.found import Found
from kshell.mesh.raw import RawMesh

HEADER, RECORD = 84, 50  # bytes before the triangles, and of each
_VERTEX = re.compile(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)", re.IGNORECASE)
_SOLID = re.compile(rb"^[ \t]*solid\b(.*?)$(.*?)^[ \t]*endsolid\b", re.IGNORECASE | re.DOTALL | re.MULTILINE)
_BEGIN = re.compile(rb"^[ \t]*solid\b", re.IGNORECASE | re.MULTILINE)


def read_stl(path: Path) -> RawMesh:
    """Mesh of an .stl file; of several solids each is a group.

    Raises
    ------
    InputError
        If it is empty or cut off.
    """
    data = path.read_bytes()
    if not data.strip():
        raise InputError(f"{path.name}: the file is empty")
    number = int.from_bytes(data[80:HEADER], "little")
    if len(data) >= HEADER and len(data) == HEADER + RECORD * number:
        record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
        solids = [("", np.frombuffer(data, record, number, HEADER)["corners"].astype(float))]
    elif data.lstrip()[:5].lower() == b"solid":
        solids = _ascii(data, path.name)
    else:
        raise InputError(
            f"{path.name}: {len(data)} bytes, but {number} triangles of a binary .stl file take "
            f"{HEADER + RECORD * number}. The file is cut off or of another format: export it again"
        )
    corners = np.concatenate([of_solid for _, of_solid in solids]).reshape(-1, 3) + 0.0  # no -0
    points, row = np.unique(corners, axis=0, return_inverse=True)
    found = Found(points, path.name)
    cells = found.add("triangle", row.reshape(-1, 3))
    first = 0
    for name, of_solid in solids:
        if len(solids) > 1:
            found.put(name, cells[first : first + len(of_solid)])
        first += len(of_solid)
    return found.raw()


def _ascii(data: bytes, source: str) -> list[tuple[str, NDArray[np.float64]]]:
    """Name and corners (n, 3, 3) of each solid."""
    solids = []
    for number, match in enumerate(_SOLID.finditer(data), 1):
        name = match[1].decode("utf-8", errors="replace").strip()
        vertices = _VERTEX.findall(match[2])
        words = match[2].lower().split()
        facets = words.count(b"endfacet")
        if (
            len(vertices) != 3 * facets
            or words.count(b"vertex") != len(vertices)
            or words.count(b"facet") != facets
        ):
            raise InputError(
                f"{source}: solid {number} has {facets} facets and {words.count(b'vertex')} corners instead of "
                f"{3 * facets}. The file is damaged: export it again"
            )
        try:
            corners = np.array(vertices, dtype=float)
        except ValueError as error:
            raise InputError(
                f"{source}: solid {number}: {error}. The file is damaged: export it again"
            ) from None
        solids.append((name or f"solid {number}", corners.reshape(-1, 3, 3)))
    if not solids or len(solids) != len(_BEGIN.findall(data)):
        raise InputError(f"{source}: {len(solids)} of its solids are ended by endsolid. The file is cut off")
    return solids
