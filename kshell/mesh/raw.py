"""What every reader delivers: nodes, triangles and group cells exactly as the source stores them.

`kshell.mesh.build` turns this into a `Mesh`; nothing is checked or repaired here.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.triangulation import EdgeTable, Higher


@dataclass
class RawGroup:
    """A group as stored.

    Attributes
    ----------
    name : str
        Empty for a group without a name.
    dimension : int
    cells : int array
        Dimension 0: (n,) nodes. Dimension 1: (n, 2) end nodes. Dimension 2: (n,) rows of `RawMesh.triangles`.
    tag : int or None
        The integer a gmsh file knows the group by.
    lost : int
        Cells or nodes of the group in the source for which there is no place here.
    """

    name: str
    dimension: int
    cells: NDArray[np.int64]
    tag: int | None = None
    lost: int = 0


@dataclass
class RawMesh:
    """A mesh as stored.

    Attributes
    ----------
    points : (node, 3) float array
    triangles : (triangle, 3 or 6) int array
        Corner nodes, then the nodes on edges (0, 1), (1, 2), (2, 0); -1 where an edge has no node of its own.
    groups : list of RawGroup
    source : str
        For messages.
    other_cells : dict of str to int
        Kinds of cells a surface mesh cannot hold, and how many of them there are.
    segments : int
        How many line cells there are, in or out of groups.
    notes : list of str
    higher : Higher or None
        Nodes of triangles of order 3 and 4.
    parts : (triangle,) int array or None
        Of a file that is divided: the part of each triangle, from 0.
    edge_table : EdgeTable or None
        Of the triangles by the numbers of their nodes, where it is known.
    """

    points: NDArray[np.float64]
    triangles: NDArray[np.int64]
    groups: list[RawGroup] = field(default_factory=list)
    source: str = "mesh"
    other_cells: dict[str, int] = field(default_factory=dict)
    segments: int = 0
    notes: list[str] = field(default_factory=list)
    higher: Higher | None = None
    parts: NDArray[np.int64] | None = None
    edge_table: EdgeTable | None = None
