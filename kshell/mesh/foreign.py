"""Meshes of other libraries: formats read through meshio, and objects of meshio and scikit-fem.

Objects are recognised by the name of their class, so that neither library is imported for a .msh file.
"""

from __future__ import annotations

import contextlib
import io
import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh.formats import READERS
from kshell.mesh.formats.found import DIMENSIONS, HIGHER, SOLID, Found
from kshell.mesh.mesh import EDGE_VERTICES
from kshell.mesh.pieces import require_no_copies, require_whole_vtk
from kshell.mesh.raw import RawGroup, RawMesh
from kshell.mesh.words import count

Ints = NDArray[np.int64]

# what the readers of meshio let through when a file is damaged (SyntaxError: of XML)
READER_ERRORS = (
    ValueError, KeyError, IndexError, TypeError, AttributeError, AssertionError, EOFError, OSError,
    SyntaxError, ImportError, RuntimeError, MemoryError, OverflowError, struct.error, zlib.error,
    SystemExit,
)  # fmt: skip

# formats read through meshio: VTK, PLY, Medit, XDMF, Exodus, DOLFIN, Netgen, Tecplot, AVS
SUFFIXES = (
    ".vtk", ".vtu", ".ply", ".mesh", ".meshb", ".xdmf", ".xmf", ".e", ".ex2", ".exo", ".xml", ".vol", ".tec",
    ".avs",
)  # fmt: skip

# the cell types of meshio that are taken
KINDS = {
    "point": ("vertex",),
    "line": ("line", "line3"),
    "triangle": ("triangle", "triangle6", "triangle7"),
    "quadrilateral": ("quad", "quad8", "quad9"),
}
# cell data in which file formats number their groups: gmsh, Medit, gmsh's .vtk and .vtu, Netgen, AVS
NUMBERED_GROUPS = ("gmsh:physical", "medit:ref", "CellEntityIds", "netgen:index", "avsucd:material")
MOST_NUMBERS = 1000  # different whole numbers in cell data that may stand for groups


def read_foreign(path: Path) -> RawMesh:
    """A mesh from a file that meshio reads.

    Raises
    ------
    InputError
        If meshio does not know the format or cannot read the file.
    """
    import meshio

    if path.stat().st_size == 0:
        raise InputError(f"{path.name}: the file is empty")
    require_whole_vtk(path)
    if path.suffix.lower() not in SUFFIXES:
        raise InputError(
            f"{path.name}: the format '{path.suffix}' is not known. Readable are .msh of gmsh, .geo, .step, "
            f".brep, .iges, {' '.join(sorted({*READERS, *SUFFIXES}))}"
        )
    said = io.StringIO()  # meshio prints its reasons
    try:
        # its test whether an .stl file is binary overflows
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said), np.errstate(over="ignore"):
            found = meshio.read(path)
    except (meshio.ReadError, *READER_ERRORS) as error:
        reason = " ".join(said.getvalue().split()) if isinstance(error, SystemExit) else f"{error}"
        raise InputError(
            f"{path.name}: meshio cannot read it: {reason or type(error).__name__}. Is the file damaged, or "
            "of another format than its name says?"
        ) from error
    return _from_meshio(found, path.name)


def raw_from_object(source: Any) -> RawMesh:
    """A mesh from an object of meshio or scikit-fem.

    Raises
    ------
    InputError
        If the object is of another class.
    """
    ancestors = [(cls.__module__.partition(".")[0], cls.__name__) for cls in type(source).__mro__]
    name = type(source).__name__
    if any(library == "skfem" and cls.startswith("MeshTri1") for library, cls in ancestors):
        return _from_skfem(source, f"scikit-fem {name}")
    if any(library == "skfem" for library, _ in ancestors):
        raise InputError(
            f"scikit-fem {name}: kshell takes triangles only, MeshTri or MeshTri2. A MeshQuad becomes one by "
            "`.to_meshtri()`"
        )
    if any(library == "meshio" for library, _ in ancestors):
        return _from_meshio(source, "meshio mesh")
    raise InputError(
        f"a mesh cannot be made from an object of class {name}: give a path, a kshell.Mesh, a skfem.MeshTri "
        "or a meshio.Mesh"
    )


def _from_skfem(mesh: Any, source: str) -> RawMesh:
    points = _in_space(mesh.doflocs.T)
    # scikit-fem keeps the node of each edge in its table of degrees of freedom
    is_order_2 = mesh.elem.__name__ == "ElementTriP2"
    if not is_order_2 and mesh.elem.__name__ != "ElementTriP1":
        raise InputError(
            f"{source}: its geometry is {mesh.elem.__name__}, but only order 1 and 2 are supported"
        )
    nodes = (mesh.dofs.element_dofs[[0, 1, 2, 3, 4, 5]] if is_order_2 else mesh.t).T.astype(np.int64)
    ends = np.stack([mesh.t[EDGE_VERTICES[k]].T for k in range(3)], axis=1)  # (triangle, edge, end)
    facet_ends = np.empty((mesh.facets.shape[1], 2), dtype=np.int64)
    facet_ends[mesh.t2f.T] = ends
    groups = [
        RawGroup(name, 1, facet_ends[np.asarray(facets, dtype=np.int64)])
        for name, facets in (mesh.boundaries or {}).items()
    ]
    groups += [
        RawGroup(name, 2, np.asarray(elements, dtype=np.int64))
        for name, elements in (mesh.subdomains or {}).items()
    ]
    return RawMesh(points, nodes, groups, source)


def _from_meshio(mesh: Any, source: str) -> RawMesh:
    require_no_copies(mesh.cell_data, source)
    found = Found(_in_space(np.asarray(mesh.points, dtype=float)), source)
    cells_of = []  # of each block
    for block in mesh.cells:
        kind = _kind(block.type, np.shape(block.data))
        cells = found.add(kind, np.asarray(block.data))
        cells_of.append(cells)
        if block.type == "triangle7":
            found.notes.append(
                f"{count(len(cells), 'triangle')} of 7 nodes taken by their first 6, without the centre"
            )
    for name, by_block in mesh.cell_sets.items():
        if name.startswith("gmsh:"):  # not a group: meshio keeps the topology of entities there
            continue
        for cells, chosen in zip(cells_of, by_block, strict=True):
            if chosen is not None:
                found.put(name, cells[np.asarray(chosen, dtype=np.int64)])
        if name in mesh.field_data:
            found.tags[name] = int(mesh.field_data[name][0])
    for name, nodes in mesh.point_sets.items():
        found.put_nodes(name, np.asarray(nodes, dtype=np.int64).ravel())
    raw = found.raw()
    raw.groups += _numbered(mesh, found, cells_of)
    return raw


def _numbered(mesh: Any, found: Found, cells_of: list[Ints]) -> list[RawGroup]:
    """Groups that are numbers in the cell data, named through the field data where it knows them."""
    names = {(int(dimension), int(tag)): name for name, (tag, dimension) in _named_tags(mesh)}
    dimensions = [DIMENSIONS.get(kind, -1) for kind, _ in found.blocks]
    numbered = Found(found.points, found.source, found.blocks)
    keys: list[tuple[str, tuple[int, int]]] = []
    for array in _group_arrays(mesh):
        for dimension, cells, numbers in zip(dimensions, cells_of, mesh.cell_data[array], strict=False):
            for tag in np.unique(numbers).tolist() if dimension >= 0 else ():
                key = (dimension, int(tag))
                # 0, of arrays of others numbers below it, stand for "no group"; a named set has been taken already
                if (tag if array in NUMBERED_GROUPS else tag >= 0) and names.get(key) not in mesh.cell_sets:
                    label = f"{key[0]}:{key[1]}" if array in NUMBERED_GROUPS else f"{array} {key[1]}"
                    keys.append((label, key))
                    numbered.put(label, cells[np.asarray(numbers).ravel() == tag])
    groups = numbered.raw().groups
    for group in groups:
        for label, key in keys:
            if group.name == label == f"{key[0]}:{key[1]}":
                group.name, group.tag = names.get(key, ""), key[1]
                break
    return sorted(groups, key=lambda group: (group.dimension, group.tag or 0))


def _group_arrays(mesh: Any) -> list[str]:
    """Arrays of cell data that number groups: the known ones, else whole numbers that take few values."""
    known = [name for name in NUMBERED_GROUPS if name in mesh.cell_data]
    if known:
        return known
    arrays = []
    for name, blocks in mesh.cell_data.items():
        values = [np.asarray(values) for values in blocks]
        number = sum(v.size for v in values)
        if number and all(v.ndim == 1 and np.issubdtype(v.dtype, np.integer) for v in values):
            different = len(np.unique(np.concatenate(values)))
            if 1 < different <= min(MOST_NUMBERS, number // 2) and not name.startswith("gmsh:"):
                arrays.append(name)
    return arrays


def _named_tags(mesh: Any) -> list[tuple[str, tuple[int, int]]]:
    return [(name, tuple(data)) for name, data in mesh.field_data.items() if np.shape(data) == (2,)]


def _kind(name: str, shape: tuple[int, ...]) -> str:
    """What a cell type of meshio is here."""
    if name in ("polygon", "polygon3", "polygon4"):
        name = {3: "triangle", 4: "quad"}.get(shape[1] if len(shape) == 2 else 0, name)
    for kind, types in KINDS.items():
        if name in types:
            return kind
    if name.startswith(("quad", "VTK_LAGRANGE_QUAD", "polygon")):
        return "polygons" if name.startswith("polygon") else "quadrilaterals of order 3 or higher"
    if name.startswith(("triangle", "line", "VTK_LAGRANGE_TRIANGLE", "VTK_LAGRANGE_CURVE")):
        return HIGHER
    return SOLID


def _in_space(points: NDArray[np.float64]) -> NDArray[np.float64]:
    if points.shape[1] < 3:
        points = np.column_stack([points, np.zeros((len(points), 3 - points.shape[1]))])
    return np.ascontiguousarray(points, dtype=float)
