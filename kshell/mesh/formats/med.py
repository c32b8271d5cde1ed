"""MED files of Salome and Code_Aster, by h5py: nodes, elements and groups with their names.

A family is a set of elements or nodes that lie in the same groups; its groups are named in strings of 80 characters.

Source: MED-fichier documentation, "Le modele de donnees MED" 4.0.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh.formats.found import SOLID, Found
from kshell.mesh.pieces import require_no_joints
from kshell.mesh.raw import RawMesh
from kshell.mesh.words import count, quoted

# type of MED: kind, nodes, nodes that are taken
KINDS = {
    "PO1": ("point", 1, 1),
    "SE2": ("line", 2, 2),
    "SE3": ("line", 3, 3),
    "TR3": ("triangle", 3, 3),
    "TR6": ("triangle", 6, 6),
    "TR7": ("triangle", 7, 6),
    "QU4": ("quadrilateral", 4, 4),
    "QU8": ("quadrilateral", 8, 8),
    "QU9": ("quadrilateral", 9, 9),
}
POLYGONS = ("POG", "POE", "PG2")


def read_med(path: Path) -> RawMesh:
    """Mesh and groups of a MED file.

    Raises
    ------
    InputError
        If it is no MED file, damaged, or holds several meshes.
    """
    import h5py

    try:
        with h5py.File(path, "r") as file:
            return _found(file, path.name).raw()
    except (OSError, RuntimeError, KeyError, ValueError, TypeError, AttributeError, IndexError) as error:
        raise InputError(
            f"{path.name}: cannot be read as a MED file: {str(error).splitlines()[0]}. Is the file damaged, or of "
            "another format than its name says?"
        ) from error


def _found(file: Any, source: str) -> Found:
    names = list(file["ENS_MAA"])
    if len(names) != 1:
        raise InputError(
            f"{source}: holds {count(len(names), 'mesh', 'meshes')}, {quoted(names)}. Save one alone"
        )
    require_no_joints(file, source)
    mesh = file["ENS_MAA"][names[0]]
    if int(mesh.attrs.get("REP", 0)):
        raise InputError(f"{source}: its coordinates are cylindrical or spherical. Save it in Cartesian ones")
    steps = [step for step in mesh if "NOE" in mesh[step]] or ["."]
    at = mesh[steps[0]]
    dimension = int(mesh.attrs["ESP" if "ESP" in mesh.attrs else "DIM"])  # older versions know DIM only
    coordinates = (
        np.asarray(at["NOE/COO"], dtype=float).reshape(dimension, -1).T
    )  # all x, then all y, then all z
    found = Found(np.column_stack([coordinates, np.zeros((len(coordinates), 3 - dimension))]), source)
    if len(steps) > 1:
        found.notes.append(f"the first of {len(steps)} steps of the mesh is taken")
    families = _families(file, names[0])
    for key, block in at["MAI"].items() if "MAI" in at else ():
        kind, nodes, taken = KINDS.get(key, ("polygons" if key in POLYGONS else SOLID, 0, 0))
        stored = np.asarray(block["NOD"], dtype=np.int64)
        if nodes == 0:  # refused with their number
            found.add(kind, np.zeros((int(block["NOD"].attrs["NBR"]), 1)))
            continue
        cells = found.add(kind, stored.reshape(nodes, -1).T[:, :taken] - 1)
        if key == "TR7":
            found.notes.append(
                f"{count(len(cells), 'triangle')} of 7 nodes taken by their first 6, without the centre"
            )
        if "FAM" in block:
            _put(found, cells, np.asarray(block["FAM"]), families, of_nodes=False)
    if "FAM" in at["NOE"]:
        _put(found, np.arange(len(found.points)), np.asarray(at["NOE/FAM"]), families, of_nodes=True)
    for _, cells in found.blocks:
        if cells.size and (cells.min() < 0 or cells.max() >= len(found.points)):
            raise InputError(
                f"{source}: an element names a node that the file does not hold. The file is damaged"
            )
    return found


def _families(file: Any, mesh: str) -> dict[int, list[str]]:
    """Names of the groups of each family."""
    families: dict[int, list[str]] = {}
    if "FAS" not in file or mesh not in file["FAS"]:
        return families
    for kind in ("ELEME", "NOEUD"):
        for family in file["FAS"][mesh].get(kind, {}).values():
            if "GRO" in family:
                families[int(family.attrs["NUM"])] = _names(family["GRO/NOM"])
    return families


def _names(dataset: Any) -> list[str]:
    """Names stored as arrays of 80 characters, padded by zeros or blanks."""
    names = []
    for row in dataset[()]:
        data = (row if isinstance(row, bytes) else row.astype(np.uint8).tobytes()).partition(b"\0")[0]
        try:
            names.append(data.decode("utf-8").strip())
        except UnicodeDecodeError:
            names.append(data.decode("latin-1").strip())
    return names


def _put(
    found: Found,
    members: NDArray[np.int64],
    family: NDArray[np.int64],
    families: dict[int, list[str]],
    of_nodes: bool,
) -> None:
    for number in np.unique(family).tolist():
        for name in families.get(number, []):
            (found.put_nodes if of_nodes else found.put)(name, members[family == number])
