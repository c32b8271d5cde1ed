"""States of a path or a motion in one file: XDMF, whose arrays lie in an HDF5 file beside it.

The mesh stands there once, fields once for every state, compressed; ParaView and VisIt read it, meshio and h5py, too.

Source of the format: XDMF 3, www.xdmf.org (Grid of type Collection, CollectionType Temporal).
"""

from __future__ import annotations

import html
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.result.vtu import unstructured

if TYPE_CHECKING:
    from kshell.result.result import Result

TOPOLOGY = {3: "Triangle", 6: "Tri_6"}  # by nodes of a triangle
KINDS = {1: "Scalar", 3: "Vector", 9: "Tensor"}  # by columns
LEVEL = 4  # of gzip


def require_hdf5() -> None:
    """Raise InputError if h5py is not installed."""
    try:
        import h5py  # noqa: F401
    except ImportError:
        raise InputError(
            'XDMF files have their arrays in HDF5, which h5py writes: pip install "kshell[series]", or leave xdmf out'
        ) from None


def write_series(path: Path, states: Sequence[tuple[float, Callable[[], Result]]], title: str = "") -> None:
    """Write states (time or load factor, function that gives the result) as path and, beside it, path with .h5.

    Raises
    ------
    SolveError
        If a field has a value that is NaN or infinite.
    """
    import h5py

    arrays = path.with_suffix(".h5")
    grids = []
    with h5py.File(arrays, "w") as file:

        def put(name: str, values: NDArray[Any]) -> str:
            """An array, and the item of XDMF that says where it is."""
            compressed = {"compression": "gzip", "compression_opts": LEVEL} if values.size else {}
            file.create_dataset(name, data=values, **compressed)
            kind, size = ("Float", values.itemsize) if values.dtype.kind == "f" else ("Int", values.itemsize)
            shape = " ".join(map(str, values.shape))
            return (
                f'<DataItem DataType="{kind}" Precision="{size}" Dimensions="{shape}" Format="HDF">'
                f"{html.escape(arrays.name)}:/{name}</DataItem>"
            )

        mesh = ""
        for number, (time, make) in enumerate(states):
            content = unstructured(make())
            if not mesh:
                count, nodes = content.cells.shape
                mesh = (
                    f'<Geometry GeometryType="XYZ">{put("points", content.points)}</Geometry>'
                    f'<Topology TopologyType="{TOPOLOGY[nodes]}" NumberOfElements="{count}">'
                    f"{put('cells', content.cells.astype(np.int64))}</Topology>"
                )
            fields = []
            for centre, data in (("Node", content.point_data), ("Cell", content.cell_data)):
                for field, values in data.items():
                    if field.startswith(("group ", "edges of group ")):
                        continue  # which do not change: result.vtu has them
                    columns = values.shape[1] if values.ndim == 2 else 1
                    item = put(f"state-{number:05d}/{centre.lower()}/{_safe(field)}", values)
                    fields.append(
                        f'<Attribute Name="{html.escape(field)}" AttributeType="{KINDS.get(columns, "Matrix")}" '
                        f'Center="{centre}">{item}</Attribute>'
                    )
            grids.append(
                f'<Grid Name="state {number}" GridType="Uniform"><Time Value="{time:.17g}"/>{mesh}'
                f"{''.join(fields)}</Grid>"
            )
    name = html.escape(title or "states")
    text = "\n".join(
        [
            '<?xml version="1.0" encoding="UTF-8"?>',
            '<Xdmf Version="3.0"><Domain>',
            f'<Grid Name="{name}" GridType="Collection" CollectionType="Temporal">',
            *grids,
            "</Grid>",
            "</Domain></Xdmf>",
            "",
        ]
    )
    path.write_text(text, encoding="utf-8")


def _safe(name: str) -> str:
    """A name as part of a path in HDF5."""
    return name.replace("/", "-")
