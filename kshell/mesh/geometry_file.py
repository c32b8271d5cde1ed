"""Meshing geometry files (.geo, .step, .brep, .iges) through gmsh.

gmsh is imported here and nowhere else, when a geometry file must be opened: its library needs graphics
libraries of the system even without a screen.
"""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from kshell.errors import InputError
from kshell.mesh.gmsh_file import read_gmsh
from kshell.mesh.raw import RawMesh

# the Debian package for each system library that the gmsh library is linked to
PACKAGE_OF_LIBRARY = {
    "libGLU": "libglu1-mesa",
    "libGL": "libgl1",
    "libOpenGL": "libopengl0",
    "libX11": "libx11-6",
    "libXrender": "libxrender1",
    "libXcursor": "libxcursor1",
    "libXfixes": "libxfixes3",
    "libXft": "libxft2",
    "libXinerama": "libxinerama1",
    "libXext": "libxext6",
    "libXi": "libxi6",
    "libfontconfig": "libfontconfig1",
    "libfreetype": "libfreetype6",
    "libgomp": "libgomp1",
}
# OpenCASCADE converts these formats
IN_MILLIMETRES = (".step", ".stp", ".iges", ".igs")
ALL_PACKAGES = "libglu1-mesa libxcursor1 libxft2 libxinerama1 libxrender1"


def read_geometry(path: Path, mesh_size: float | None = None, mesh_order: int | None = None) -> RawMesh:
    """Mesh a geometry file in two dimensions.

    Parameters
    ----------
    path : Path
    mesh_size : float, optional
        Edge length everywhere, instead of the sizes in the file.
    mesh_order : 1 or 2, optional

    Raises
    ------
    InputError
        If gmsh cannot be loaded or cannot read or mesh the file; the message repeats gmsh's own.
    """
    if mesh_size is not None and not 0 < mesh_size < float("inf"):
        raise InputError(f"mesh_size must be a positive length, not {mesh_size}")
    if mesh_order not in (None, 1, 2):
        raise InputError(f"mesh_order must be 1 or 2, not {mesh_order}")
    with tempfile.TemporaryDirectory(prefix="kshell-") as folder, opened(path, Path(folder)) as gmsh:
        target = Path(folder) / "mesh.msh"
        _mesh(gmsh, path, target, mesh_size, mesh_order)
        raw = read_gmsh(target, path.name)
    if path.suffix.lower() in IN_MILLIMETRES:
        raw.notes.append(
            "lengths are in millimetres: gmsh converts files of this format to them, whatever their unit"
        )
    return raw


@contextmanager
def opened(path: Path, folder: Path, purpose: str = "mesh it") -> Iterator[Any]:
    """The module gmsh with a geometry file opened in it; ended whatever happens.

    Parameters
    ----------
    path : Path
    folder : Path
        For files needed meanwhile.
    purpose : str
        What gmsh is wanted for, in messages.

    Raises
    ------
    InputError
        If gmsh cannot be loaded, cannot read the file, or fails at anything done meanwhile; the message repeats
        gmsh's own.
    """
    gmsh = _import_gmsh()
    with _session(gmsh):
        try:
            gmsh.open(str(_with_line_end(path, folder)))
            if not gmsh.model.getEntities(2):
                raise InputError(
                    f"{path.name}: has no surface to mesh. A .geo file needs a `Curve Loop` and a `Plane Surface` "
                    "(or another surface)"
                )
            yield gmsh
        except Exception as error:
            # gmsh raises plain Exception for all that goes wrong in it; other classes are no errors of gmsh
            if type(error) is not Exception:
                raise
            said = "; ".join(_errors(gmsh)) or str(error) or "no reason given"
            for folder_part in (str(folder), str(path.resolve().parent)):  # gmsh names the file in full
                said = said.replace(folder_part + os.sep, "")
            raise InputError(
                f"{path.name}: gmsh cannot {purpose}: {said}. Open the file in gmsh to see where"
            ) from error


def _import_gmsh() -> Any:
    try:
        import gmsh
    except OSError as error:
        missing = str(error).partition(":")[0].strip()
        package = PACKAGE_OF_LIBRARY.get(missing.partition(".so")[0])
        packages = " ".join(dict.fromkeys(([package] if package else []) + ALL_PACKAGES.split()))
        raise InputError(
            f"gmsh, which reads geometry files, cannot be loaded: {error}. Install the system library, on "
            f"Debian or Ubuntu `apt-get install {packages}`, or mesh the file elsewhere and give the .msh"
        ) from error
    except ImportError as error:
        raise InputError(
            f"geometry files need gmsh: {error}. Install it, `pip install gmsh`, or give a .msh file"
        ) from error
    return gmsh


@contextmanager
def _session(gmsh: Any) -> Iterator[None]:
    """gmsh started with its defaults and silent; ended whatever happens."""
    if gmsh.isInitialized():
        raise InputError(
            "gmsh is in use already, and opening a geometry file would change its options and models. Call "
            "gmsh.finalize() first, or write the mesh with gmsh.write('mesh.msh') and give that file"
        )
    with _silent_output():
        gmsh.initialize(readConfigFiles=False, interruptible=False)
        try:
            gmsh.option.setNumber("General.Terminal", 0)
            gmsh.logger.start()
            yield
        finally:
            gmsh.logger.stop()
            gmsh.finalize()


@contextmanager
def _silent_output() -> Iterator[None]:
    """Standard output discarded, also what OpenCASCADE inside gmsh writes to it past Python."""
    sys.stdout.flush()
    kept = os.dup(1)
    try:
        with open(os.devnull, "wb") as nowhere:
            os.dup2(nowhere.fileno(), 1)
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)


def _mesh(gmsh: Any, path: Path, target: Path, mesh_size: float | None, mesh_order: int | None) -> None:
    number = gmsh.option.setNumber
    if mesh_size is not None:
        number("Mesh.MeshSizeMin", mesh_size)
        number("Mesh.MeshSizeMax", mesh_size)
    if mesh_order is not None:
        number("Mesh.ElementOrder", mesh_order)
    if mesh_size is not None:
        gmsh.model.mesh.clear()
    if not gmsh.model.mesh.getNodes()[0].size:  # a .geo file may have meshed itself
        gmsh.model.mesh.generate(2)
    if mesh_order is not None:
        gmsh.model.mesh.setOrder(mesh_order)
    if path.suffix.lower() in (".iges", ".igs"):  # faces of this format do not share their edges
        gmsh.model.mesh.removeDuplicateNodes()
    # without a physical surface gmsh would leave out the triangles of a file with physical curves
    number("Mesh.SaveAll", 0 if gmsh.model.getPhysicalGroups(2) else 1)
    number("Mesh.MshFileVersion", 4.1)
    number("Mesh.Binary", 1)
    gmsh.write(str(target))


def _with_line_end(path: Path, folder: Path) -> Path:
    """The file, or a copy ending in a newline: of a single line without one gmsh drops the groups."""
    if path.suffix.lower() not in (".geo", ".geo_unrolled"):
        return path.resolve()
    text = path.read_bytes()
    if b"\n" in text:
        return path.resolve()
    copy = folder / path.name
    copy.write_bytes(text + b"\n")
    return copy


def _errors(gmsh: Any) -> list[str]:
    return [line.partition(":")[2].strip() for line in gmsh.logger.get() if line.startswith("Error")]
