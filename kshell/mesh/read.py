"""One door for every source of a mesh."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import Any

from kshell.errors import InputError, clipped
from kshell.mesh.build import build, reversed_triangles
from kshell.mesh.mesh import Mesh
from kshell.mesh.order import in_spatial_order
from kshell.mesh.orient import to_reverse
from kshell.mesh.raw import RawMesh
from kshell.mesh.words import count, is_file, is_folder, nearest_name

GEOMETRY_SUFFIXES = (".geo", ".geo_unrolled", ".step", ".stp", ".brep", ".iges", ".igs")

STRAIGHT_INSTEAD = "straight triangles"  # note of a mesh whose mid-edge nodes would turn some inside out
LARGE = 50_000  # vertices of a file from which on they are put in spatial order


def read_mesh(
    source: Any,
    mesh_size: float | None = None,
    mesh_order: int | str | None = None,
    geometry: str | os.PathLike[str] | None = None,
    allow_system: bool = False,
) -> Mesh:
    """A checked mesh from a file or an object.

    Parameters
    ----------
    source : path, Mesh, skfem.MeshTri, skfem.MeshTri2 or meshio.Mesh
        Files: .msh of gmsh; .geo, .step, .brep, .iges, which gmsh meshes; those of `kshell.mesh.formats` (.inp, .bdf,
        .med, .unv, .obj, .stl and others) and of meshio that `kshell.mesh.foreign` names.
    mesh_size : float, optional
        Edge length wanted everywhere, for geometry files only; absent: the sizes the file itself gives.
    mesh_order : 1, 2 or "auto", optional
        For geometry files only; absent: what the file itself gives; auto: at least 2 where a surface or curve is
        curved.
    geometry : path, optional
        .geo, .step, .brep or .iges from which a mesh of order 1 was made: it becomes one of order 2 with its
        mid-edge nodes on the curves and surfaces there.
    allow_system : bool
        Whether geometry files may run programs and write files, as the language of gmsh allows; otherwise they are
        refused when they would.

    Notes
    -----
    Vertices keep the order of the source, except that files of more than 50,000 are put in spatial order.

    Raises
    ------
    InputError
        If the source cannot be read, or the mesh is not one of usable triangles, or not one of `geometry`.
    """
    if geometry is not None:
        return _on_geometry(source, Path(geometry), mesh_size, mesh_order, allow_system)
    is_path = isinstance(source, (str, os.PathLike))
    path = Path(source) if is_path else None
    is_geometry = path is not None and path.suffix.lower() in GEOMETRY_SUFFIXES
    if not is_geometry and mesh_order == "auto":
        mesh_order = None
    if not is_geometry and (mesh_size is not None or mesh_order is not None):
        option = "mesh_size" if mesh_size is not None else "mesh_order"
        name = path.name if path else f"a {type(source).__name__} object"
        raise InputError(
            f"{option} is for geometry files ({', '.join(GEOMETRY_SUFFIXES)}) only: {name} is meshed "
            f"already. Leave {option} out, or give the geometry"
        )
    if isinstance(source, Mesh):
        return facing_up(source)
    if path is None:
        from kshell.mesh.foreign import raw_from_object

        return build(raw_from_object(source), Mesh)
    _require_file(path)
    if is_geometry:
        from kshell.mesh.geometry_file import read_geometry

        raw = read_geometry(path, mesh_size, mesh_order, allow_system)
        return _quick_to_walk(_build_or_straight(raw) if mesh_order == "auto" else build(raw, Mesh))
    if path.suffix.lower() == ".msh" or _begins_like_gmsh(path):
        from kshell.mesh.gmsh_file import read_gmsh

        return _quick_to_walk(build(read_gmsh(path), Mesh))
    from kshell.mesh.formats import reader_of

    read = reader_of(path)
    if read is not None:
        return _quick_to_walk(build(read(path), Mesh))
    from kshell.mesh.foreign import read_foreign

    return _quick_to_walk(build(read_foreign(path), Mesh))


def _on_geometry(
    source: Any, path: Path, mesh_size: float | None, mesh_order: int | str | None, allow_system: bool
) -> Mesh:
    from kshell.mesh.on_geometry import put_on_geometry

    if path.suffix.lower() not in GEOMETRY_SUFFIXES:
        raise InputError(
            f'geometry = "{path.name}" is no geometry file: give the {", ".join(GEOMETRY_SUFFIXES)} from which the '
            "mesh was made"
        )
    if isinstance(source, str | os.PathLike) and Path(source).suffix.lower() in GEOMETRY_SUFFIXES:
        raise InputError(
            f"geometry is for meshes: {Path(source).name} is a geometry file itself. Leave geometry out and write "
            "mesh_order = 2"
        )
    mesh = read_mesh(source, mesh_size, mesh_order)
    _require_file(path, "geometry")
    return put_on_geometry(mesh, path, allow_system)


def _build_or_straight(raw: RawMesh) -> Mesh:
    """The mesh, or that of its straight triangles where mid-edge nodes nobody asked for turn some inside out."""
    try:
        return build(raw, Mesh)
    except InputError as error:
        if raw.triangles.shape[1] == 3:
            raise
        raw.triangles = raw.triangles[:, :3]
        raw.notes.append(f"{STRAIGHT_INSTEAD}, because of order 2 {error}")
        return build(raw, Mesh)


def _quick_to_walk(mesh: Mesh) -> Mesh:
    """Large meshes from files in spatial order, which makes all that follows faster; others as they are."""
    return in_spatial_order(mesh)[0] if len(mesh.points) > LARGE else mesh


def facing_up(mesh: Mesh) -> Mesh:
    """A mesh in a plane z = const with its normals along +z; any other mesh as it is."""
    if "_faces_up" in mesh.__dict__ or not mesh.is_flat:  # found when it was built, or asked before
        return mesh
    reverse = to_reverse(mesh, True)
    if not reverse.any():
        mesh.__dict__["_faces_up"] = True
        return mesh
    note = f"{reverse.sum()} of {count(len(reverse), 'triangle')} reversed so that normals point along +z"
    return replace(reversed_triangles(mesh, reverse), notes=(*mesh.notes, note))


def _require_file(path: Path, what: str = "mesh") -> None:
    if is_folder(path):
        raise InputError(f"{clipped(path)} is a folder, not a {what} file")
    if is_file(path):
        return
    near = ""
    if is_folder(path.parent):
        close = nearest_name(path.name, [file.name for file in path.parent.iterdir() if file.is_file()])
        near = f" Did you mean '{close}'?" if close else ""
    raise InputError(
        f"{what} file {clipped(path)} not found.{near} Relative paths start from the folder of the scene, or the "
        "present one"
    )


def _begins_like_gmsh(path: Path) -> bool:
    with path.open("rb") as file:
        return file.read(11).startswith((b"$MeshFormat", b"$NOD"))
