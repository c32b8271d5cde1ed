"""Meshes of other libraries: what meshio reads, and objects of meshio and scikit-fem.

Objects are recognised by the name of their class, so that neither library is imported for a .msh file.
"""

from __future__ import annotations

import contextlib
import io
import struct
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh.mesh import EDGE_VERTICES
from kshell.mesh.raw import RawGroup, RawMesh

Ints = NDArray[np.int64]

# what the readers of meshio let through when a file is damaged (SyntaxError: of XML)
READER_ERRORS = (
    ValueError, KeyError, IndexError, TypeError, AttributeError, AssertionError, EOFError, OSError,
    SyntaxError, ImportError, struct.error, SystemExit,
)  # fmt: skip

TRIANGLES = ("triangle", "triangle6")
LINES = ("line", "line3")
# cell data in which file formats number their groups: gmsh, Medit, Nastran
NUMBERED_GROUPS = ("gmsh:physical", "medit:ref", "nastran:ref")


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
    known = meshio.extension_to_filetypes
    if path.suffix.lower() not in known:
        raise InputError(
            f"{path.name}: the format '{path.suffix}' is not known. Readable are .msh of gmsh, .geo, .step, "
            f".brep and what meshio reads: {' '.join(sorted(known))}"
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
    points = _in_space(np.asarray(mesh.points, dtype=float))
    triangles: list[Ints] = [np.empty((0, 3), dtype=np.int64)]
    other: dict[str, int] = {}
    segments = n_triangles = 0
    cells_of: list[tuple[int, Ints] | None] = []  # of each block: dimension and cells as RawGroup wants them
    for block in mesh.cells:
        data = np.asarray(block.data)
        if block.type in TRIANGLES:
            triangles.append(data.astype(np.int64))
            cells_of.append((2, np.arange(n_triangles, n_triangles + len(data))))
            n_triangles += len(data)
        elif block.type in LINES:
            segments += len(data)
            cells_of.append((1, data[:, :2].astype(np.int64)))
        elif block.type == "vertex":
            cells_of.append((0, data.ravel().astype(np.int64)))
        else:
            kind = _kind_of_other(block.type)
            other[kind] = other.get(kind, 0) + len(data)
            cells_of.append(None)
    width = max(t.shape[1] for t in triangles)
    stacked = np.concatenate(
        [np.pad(t, ((0, 0), (0, width - t.shape[1])), constant_values=-1) for t in triangles]
    )
    groups = _cell_sets(mesh, cells_of) + _numbered(mesh, cells_of)
    raw = RawMesh(points, stacked, groups, source, other, segments)
    raw.groups += _point_sets(mesh, stacked, raw.notes)
    return raw


def _cell_sets(mesh: Any, cells_of: list[tuple[int, Ints] | None]) -> list[RawGroup]:
    """Named sets of cells; a set with cells of several dimensions becomes several groups."""
    groups = []
    for name, by_block in mesh.cell_sets.items():
        if name.startswith("gmsh:"):  # not a group: meshio keeps the topology of entities there
            continue
        parts: dict[int, list[Ints]] = {}
        for block, chosen in zip(cells_of, by_block, strict=True):
            if block is not None and chosen is not None and len(chosen):
                parts.setdefault(block[0], []).append(block[1][np.asarray(chosen, dtype=np.int64)])
        tag = mesh.field_data.get(name, [None])[0]
        groups += [
            RawGroup(name, dimension, np.concatenate(cells), None if tag is None else int(tag))
            for dimension, cells in parts.items()
        ]
    return groups


def _numbered(mesh: Any, cells_of: list[tuple[int, Ints] | None]) -> list[RawGroup]:
    """Groups that are numbers in the cell data, named through the field data where it knows them."""
    names = {(int(dimension), int(tag)): name for name, (tag, dimension) in _named_tags(mesh)}
    parts: dict[tuple[int, int], list[Ints]] = {}
    for key in NUMBERED_GROUPS:
        for block, numbers in zip(cells_of, mesh.cell_data.get(key, []), strict=False):
            if block is None:
                continue
            for tag in np.unique(numbers).tolist():
                # 0 stands for "no group"; a named set has been taken already
                if tag and names.get((block[0], int(tag))) not in mesh.cell_sets:
                    parts.setdefault((block[0], int(tag)), []).append(block[1][np.asarray(numbers) == tag])
    return [
        RawGroup(names.get(key, ""), key[0], np.concatenate(cells), key[1])
        for key, cells in sorted(parts.items())
    ]


def _named_tags(mesh: Any) -> list[tuple[str, tuple[int, int]]]:
    return [(name, tuple(data)) for name, data in mesh.field_data.items() if np.shape(data) == (2,)]


def _point_sets(mesh: Any, triangles: Ints, notes: list[str]) -> list[RawGroup]:
    """Sets of nodes; one that covers a run of edges of the boundary is the curve along them."""
    if not mesh.point_sets:
        return []
    ends = np.sort(triangles[:, EDGE_VERTICES].reshape(-1, 2), axis=1)
    edges, how_often = np.unique(ends, axis=0, return_counts=True)
    boundary = edges[how_often == 1]
    groups = []
    for name, nodes in mesh.point_sets.items():
        members = np.unique(np.asarray(nodes, dtype=np.int64).ravel())
        inside = boundary[np.isin(boundary, members).all(axis=1)]
        # mid-edge nodes may belong to the set as well, but are no ends of edges
        corners = members[np.isin(members, triangles[:, :3])]
        if len(inside) and np.isin(corners, inside).all():
            groups.append(RawGroup(name, 1, inside))
            notes.append(f"node set '{name}' covers edges of the boundary and is taken as a curve")
        else:
            groups.append(RawGroup(name, 0, corners))
    return groups


def _kind_of_other(name: str) -> str:
    if name.startswith("quad") or name == "polygon":
        return "quadrilaterals"
    if name.startswith(("triangle", "line", "VTK_LAGRANGE_TRIANGLE", "VTK_LAGRANGE_CURVE")):
        return "triangles of order 3 or higher"
    return "solid cells"


def _in_space(points: NDArray[np.float64]) -> NDArray[np.float64]:
    if points.shape[1] < 3:
        points = np.column_stack([points, np.zeros((len(points), 3 - points.shape[1]))])
    return np.ascontiguousarray(points, dtype=float)
