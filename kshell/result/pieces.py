"""A result in pieces, result.pvtu for ParaView: each a .vtu of some triangles, written by the process that has them.

In a piece `node` and `triangle` are the numbers in the whole, by which the pieces are put together again.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.result.vtu_file import Unstructured

NODE, TRIANGLE = "node", "triangle"
INDEX = "result.pvtu"
PATTERN = "result-[0-9][0-9][0-9]*.vtu"


def piece_name(number: int) -> str:
    """Name of the file of a piece."""
    return f"result-{number:03d}.vtu"


def old_pieces(folder: Path, names: Iterable[str]) -> list[Path]:
    """Files of an earlier result that a new one of these pieces does not replace."""
    return [path for path in [folder / "result.vtu", *folder.glob(PATTERN)] if path.name not in set(names)]


def piece_of(whole: Unstructured, mine: NDArray[np.bool_]) -> Unstructured:
    """Some triangles of what a result has."""
    chosen = np.flatnonzero(mine)
    nodes, cells = np.unique(whole.cells[chosen], return_inverse=True)
    point_data = {name: values[nodes] for name, values in whole.point_data.items()}
    cell_data = {name: values[chosen] for name, values in whole.cell_data.items()}
    point_data[NODE], cell_data[TRIANGLE] = nodes.astype(np.int64), chosen.astype(np.int64)
    shape = (len(chosen), whole.cells.shape[1])
    return Unstructured(whole.points[nodes], cells.reshape(shape), point_data, cell_data, whole.components)


def pieces_index(whole: Unstructured, names: Sequence[str]) -> str:
    """The text of result.pvtu: what the pieces have, and where they are."""
    from xml.sax.saxutils import quoteattr

    none = piece_of(whole, np.zeros(len(whole.cells), dtype=bool))

    def array(name: str, values: NDArray[Any]) -> str:
        kind = {"f": "Float", "i": "Int", "u": "UInt"}[values.dtype.kind] + str(8 * values.dtype.itemsize)
        width = 1 if values.ndim == 1 else values.shape[1]
        columns = whole.components.get(name, ())
        named = enumerate(columns if len(columns) == width else ())
        names = "".join(f" ComponentName{k}={quoteattr(column)}" for k, column in named)
        return f'      <PDataArray type="{kind}" Name={quoteattr(name)} NumberOfComponents="{width}"{names}/>'

    return "\n".join(
        [
            '<?xml version="1.0"?>',
            '<VTKFile type="PUnstructuredGrid" version="0.1" byte_order="LittleEndian">',
            '  <PUnstructuredGrid GhostLevel="0">',
            "    <PPoints>",
            '      <PDataArray type="Float64" NumberOfComponents="3"/>',
            "    </PPoints>",
            "    <PPointData>",
            *(array(name, values) for name, values in none.point_data.items()),
            "    </PPointData>",
            "    <PCellData>",
            *(array(name, values) for name, values in none.cell_data.items()),
            "    </PCellData>",
            *(f'    <Piece Source="{name}"/>' for name in names),
            "  </PUnstructuredGrid>",
            "</VTKFile>",
            "",
        ]
    )


def read_pieces(index: Path) -> Any:
    """The whole from its pieces, as meshio has meshes.

    Raises
    ------
    InputError
        If a piece is missing or damaged.
    """
    from xml.etree import ElementTree

    import meshio

    try:
        tree = ElementTree.parse(index)
        read = [meshio.vtu.read(str(index.parent / p.attrib["Source"])) for p in tree.iter("Piece")]
        node = np.concatenate([piece.point_data.pop(NODE) for piece in read]).astype(np.int64)
        number = np.concatenate([piece.cell_data.pop(TRIANGLE)[0] for piece in read]).astype(np.int64)
        first = np.cumsum([0, *(len(piece.points) for piece in read)])
        cells = np.concatenate([node[b + p.cells[0].data] for b, p in zip(first, read, strict=False)])
        kind = read[0].cells[0].type
        names = list(read[0].point_data)
        points = _placed(node, np.concatenate([piece.points for piece in read]))
        point_data = {n: _placed(node, np.concatenate([p.point_data[n] for p in read])) for n in names}
        cell_data = {
            n: [_placed(number, np.concatenate([p.cell_data[n][0] for p in read]))] for n in read[0].cell_data
        }
        return meshio.Mesh(points, [(kind, _placed(number, cells))], point_data, cell_data)
    except (OSError, ValueError, KeyError, IndexError, ElementTree.ParseError, meshio.ReadError) as error:
        raise InputError(f"{index}: cannot be read ({error})") from None


def _placed(number: NDArray[np.int64], values: NDArray[Any]) -> NDArray[Any]:
    out = np.zeros((int(number.max(initial=-1)) + 1, *values.shape[1:]), dtype=values.dtype)
    out[number] = values
    return out
