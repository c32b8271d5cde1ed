"""The cell types of gmsh, and blocks of cells as both versions of its format deliver them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

# number of nodes of each type of cell in the MSH format (gmsh reference manual, "MSH file format")
_NODES = """
1:2 2:3 3:4 4:4 5:8 6:6 7:5 8:3 9:6 10:9 11:10 12:27 13:18 14:14 15:1 16:8 17:20 18:15 19:13 20:9 21:10 22:12
23:15 24:15 25:21 26:4 27:5 28:6 29:20 30:35 31:56 36:16 37:25 38:36 42:28 43:36 44:45 45:55 46:66 62:7 63:8
64:9 65:10 66:11 92:64 93:125
"""
NODES_OF_TYPE = {int(pair.split(":")[0]): int(pair.split(":")[1]) for pair in _NODES.split()}

# types kshell uses: dimension
POINT, LINES, TRIANGLES, QUADRILATERALS = (15,), (1, 8), (2, 9), (3, 10, 16)

_HIGHER_LINES = (28, 62, 63, 64, 65, 66)
_HIGHER_TRIANGLES = (24, 25, 42, 43, 44, 45, 46)
_HIGHER_QUADRILATERALS = (36, 37, 38)


def kind_of_other(cell_type: int) -> str:
    """What a cell that is no point, line, triangle or quadrilateral that is read is called in messages."""
    if cell_type in _HIGHER_QUADRILATERALS:
        return "quadrilaterals of order 3 or higher"
    if cell_type in _HIGHER_TRIANGLES + _HIGHER_LINES:
        return "triangles of order 5 or higher"
    return "solid cells"


@dataclass(frozen=True)
class CellBlock:
    """Cells of one type in the same groups.

    Attributes
    ----------
    cell_type : int
    nodes : (n, nodes of the type) int array
        Node tags.
    tags : tuple of int
        Physical tags; negative where the group takes the cells the other way round.
    entity : tuple of int
        The number of the curve or surface the cells lie on, where the format tells; empty for points, and for lines
        between the parts of a divided mesh.
    part : int
        Of a divided mesh, from 1; 0 where it is not.
    """

    cell_type: int
    nodes: NDArray[np.int64]
    tags: tuple[int, ...]
    entity: tuple[int, ...] = ()
    part: int = 0
