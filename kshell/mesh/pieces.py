"""Files that hold one piece of a mesh: read as the whole they would give an answer for a structure that nobody has.

Where a file tells that it is a piece it is refused. What tells it: numbers of parts (gmsh), copies of neighbours (VTK),
an index beside that names it (VTK), data of communication between pieces (Kratos), joints (MED).
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.errors import InputError
from kshell.mesh.words import count

INDICES = (".pvtu", ".pvd", ".vtm", ".vtmb")  # files of VTK that name others, which hold the cells
# cells that are copies of those of another piece (bit 1) or left out of the mesh (bit 32); an older name, for copies
# Source: VTK, vtkDataSetAttributes.h, CellGhostTypes
GHOSTS = {"vtkGhostType": 1 | 32, "vtkGhostLevels": 255}
_SOURCE = re.compile(r"""Source\s*=\s*["']([^"']*)["']""")


def one_of_gmsh(source: str, part: int, parts: int) -> InputError:
    """For one of the files that hold the mesh of gmsh together.

    Parameters
    ----------
    parts : int
        How many there are; 0 where the file does not tell.
    """
    of = f" of {parts}" if parts else ""
    return InputError(
        f"{source}: holds part {part}{of} alone, which gmsh wrote into a file for each. Save "
        "the mesh in one file: without -part_split, or `Mesh.PartitionSplitMeshFiles = 0;`"
    )


def require_all_parts(
    parts_there: set[int], parts: int | None, node_tags: NDArray[np.int64], source: str
) -> list[str]:
    """Raise InputError for one of the files that hold a mesh together; notes on one that may be.

    MSH 2.2 does not say how many parts there are. A file of the first one alone may be that of a mesh with one part;
    the nodes of one with more are some of all, which have gaps in their numbers.

    Parameters
    ----------
    parts_there : set of int
        Those of the triangles and quadrilaterals, from 1; 0 of what belongs to none.
    parts : int or None
        How many there are; None where the format does not say.
    node_tags : (node,) int array
    """
    there = parts_there - {0}
    if len(there) != 1 or parts == 1:
        return []
    part = min(there)
    if parts:
        raise one_of_gmsh(source, part, parts)
    if part > 1 or len(node_tags) < 1 or int(node_tags.max()) - int(node_tags.min()) >= len(node_tags):
        raise one_of_gmsh(source, part, 0)
    return ["all triangles are in part 1 of a divided mesh: taken as the whole, as no node is missing"]


def require_no_copies(cell_data: Mapping[str, Sequence[ArrayLike]], source: str) -> None:
    """Raise InputError where cells of VTK are copies of those of other pieces, or hidden."""
    for name, bits in GHOSTS.items():
        blocks = [np.asarray(block).ravel().astype(np.int64) for block in cell_data.get(name, ())]
        copies = sum(int(np.count_nonzero(block & bits)) for block in blocks)
        if copies:
            raise InputError(
                f"{source}: holds {count(copies, 'cell')} that belong to another piece of the mesh or are hidden "
                f"({name}): it is one of several files. Save the mesh in one file, in ParaView by Merge Blocks and "
                "Clean to Grid"
            )


def require_whole_vtk(path: Path) -> None:
    """Raise InputError for an index of pieces, and for a file that an index of several names."""
    if path.suffix.lower() in INDICES:
        raise InputError(
            f"{path.name}: names files that hold a mesh in pieces. Save the mesh in one file, in ParaView by Merge "
            "Blocks and Save Data as .vtu"
        )
    if path.suffix.lower() != ".vtu":
        return
    for folder in (path.resolve().parent, path.resolve().parent.parent):
        for index in sorted(folder.glob("*.pvtu")):
            try:
                named = _SOURCE.findall(index.read_text(encoding="utf-8", errors="replace"))
            except OSError:
                continue
            files = [(folder / name).resolve() for name in named]
            if len(files) > 1 and path.resolve() in files:
                raise InputError(
                    f"{path.name}: is one of {len(files)} pieces of the mesh that {index.name} names. Save the "
                    "mesh in one file, in ParaView by Merge Blocks and Save Data as .vtu"
                )


def require_one_model_part(block: str, source: str) -> None:
    """Raise InputError at the block by which a file of Kratos tells that it is that of one of several processes."""
    if block == "CommunicatorData":
        raise InputError(
            f"{source}: holds the model part of one process (CommunicatorData), with copies of those of others. Take "
            "the file that was divided"
        )


def require_no_joints(file: Any, source: str) -> None:
    """Raise InputError for a MED file with joints to other files of the mesh."""
    joints = sum(len(of_mesh) for of_mesh in file["JNT"].values()) if "JNT" in file else 0
    if joints:
        raise InputError(
            f"{source}: is one of several files of a divided mesh ({count(joints, 'joint')} to others). Take the file "
            "that was divided"
        )
