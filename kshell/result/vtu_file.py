"""The .vtu format: one mesh of triangles with arrays at its points and cells, compressed.

Source of the format: VTK file formats, docs.vtk.org (XML, inline binary, zlib blocks).
"""

from __future__ import annotations

import base64
import html
import re
import sys
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import BinaryIO, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kshell.version import __version__

TRIANGLE = {3: 5, 6: 22}  # VTK's numbers of cells, by nodes: corners, then the middles of edges 01, 12, 20
BLOCK = 1 << 18  # bytes compressed at a time
LEVEL = 1  # of zlib: digits of results hardly compress further
NOT_IN_XML = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")

Array = NDArray[np.generic]


class Unstructured(NamedTuple):
    """What a file holds.

    Attributes
    ----------
    points : (point, 3) array
    cells : (cell, 3 or 6) array
        Numbers of points.
    point_data, cell_data : name to array (point or cell, ...)
        Of numbers.
    components : name to sequence of str
        Names of the columns of arrays, which ParaView shows.
    """

    points: Array
    cells: Array
    point_data: dict[str, Array]
    cell_data: dict[str, Array]
    components: Mapping[str, Sequence[str]] = MappingProxyType({})


def write_triangles(
    path: Path,
    mesh: Unstructured,
    comment: str = "",
    facts: Sequence[str] = (),
    time: float | None = None,
) -> None:
    """Write a mesh, with words after the first line.

    Parameters
    ----------
    facts : sequence of str
        Names of field data, which ParaView lists: an array of one zero each, as readers such as meshio stumble over
        arrays of text.
    time : float, optional
        Of the state, for ParaView.
    """
    points, cells, point_data, cell_data, components = mesh
    order = "LittleEndian" if sys.byteorder == "little" else "BigEndian"
    count, nodes = cells.shape
    with path.open("wb") as file:

        def say(line: str) -> None:
            file.write(line.encode() + b"\n")

        say('<?xml version="1.0" encoding="UTF-8"?>')
        if comment:
            say(f"<!-- {_words(comment)} -->")
        say(
            f'<VTKFile type="UnstructuredGrid" version="0.1" byte_order="{order}" header_type="UInt32" '
            'compressor="vtkZLibDataCompressor">'
        )
        say(f"<!-- kshell {__version__} -->")
        say("<UnstructuredGrid>")
        if facts or time is not None:
            say("<FieldData>")
            for fact in dict.fromkeys(facts):
                _array(file, fact, np.zeros(1, dtype=np.uint8), single=True)
            if time is not None:
                _array(file, "TimeValue", np.array([time]), single=True)
            say("</FieldData>")
        say(f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{count}">')
        parts: list[tuple[str, Mapping[str, Array]]] = [
            ("Points", {"Points": points}),
            (
                "Cells",
                {
                    "connectivity": cells.ravel(),
                    "offsets": np.arange(1, count + 1, dtype=cells.dtype) * nodes,
                    "types": np.full(count, TRIANGLE[nodes], dtype=np.uint8),
                },
            ),
            ("PointData", point_data),
            ("CellData", cell_data),
        ]
        for part, arrays in parts:
            say(f"<{part}>")
            for name, values in arrays.items():
                _array(file, name, values, components.get(name, ()))
            say(f"</{part}>")
        say("</Piece>\n</UnstructuredGrid>\n</VTKFile>")


def _array(
    file: BinaryIO, name: str, values: Array, columns: Sequence[str] = (), single: bool = False
) -> None:
    """One array: its kind, then sizes and blocks in base64; of field data its length, too."""
    kind = {"f": "Float", "i": "Int", "u": "UInt"}[values.dtype.kind] + str(8 * values.dtype.itemsize)
    components = f' NumberOfComponents="{values.shape[1]}"' if values.ndim == 2 else ""
    if values.ndim == 2 and len(columns) == values.shape[1]:
        components += "".join(f' ComponentName{k}="{_attribute(column)}"' for k, column in enumerate(columns))
    if single:
        components += f' NumberOfTuples="{len(values)}"'
    label = _attribute(name)
    file.write(f'<DataArray type="{kind}" Name="{label}"{components} format="binary">\n'.encode())
    data = values.tobytes()
    blocks = [zlib.compress(data[at : at + BLOCK], LEVEL) for at in range(0, len(data), BLOCK)]
    rest = len(data) - (len(blocks) - 1) * BLOCK if blocks else 0
    sizes = np.array([len(blocks), BLOCK, rest, *map(len, blocks)], dtype=np.uint32)
    file.write(base64.b64encode(sizes.tobytes()) + base64.b64encode(b"".join(blocks)))
    file.write(b"\n</DataArray>\n")


def _attribute(name: str) -> str:
    """A name between quotation marks of XML; characters that XML cannot have become U+FFFD."""
    text = html.escape(NOT_IN_XML.sub("\ufffd", name))
    for space in "\t\n\r":
        text = text.replace(space, f"&#{ord(space)};")
    return text


def _words(text: str) -> str:
    """Words of a comment, which may not have two hyphens in a row."""
    return NOT_IN_XML.sub("\ufffd", text).replace("--", "- -").replace("--", "- -")
