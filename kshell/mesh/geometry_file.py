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

import numpy as np

from kshell.errors import InputError
from kshell.mesh.geo_script import require_harmless
from kshell.mesh.gmsh_file import read_gmsh
from kshell.mesh.raw import RawMesh
from kshell.mesh.words import count, place

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
MOST_TRIANGLES = 10_000_000  # of a geometry file, foreseen from its area and mesh_size
# gmsh's types of curves and surfaces that triangles of order 1 follow exactly
STRAIGHT = ("Plane", "Line", "Discrete")
ALL_PACKAGES = "libglu1-mesa libxcursor1 libxft2 libxinerama1 libxrender1"


def read_geometry(
    path: Path,
    mesh_size: float | None = None,
    mesh_order: int | str | None = None,
    allow_system: bool = False,
) -> RawMesh:
    """Mesh a geometry file in two dimensions.

    Parameters
    ----------
    path : Path
    mesh_size : float, optional
        Edge length everywhere, instead of the sizes in the file.
    mesh_order : 1, 2 or "auto", optional
        auto: at least 2 where a surface or one of its curves is curved.
    allow_system : bool
        Whether the file may run programs and write files.

    Raises
    ------
    InputError
        If gmsh cannot be loaded or cannot read or mesh the file (the message repeats gmsh's own), if the file does
        what it may not, holds solids whose faces are not named, or would give more than `MOST_TRIANGLES`.
    """
    if mesh_size is not None and not 0 < mesh_size < float("inf"):
        raise InputError(f"mesh_size must be a positive length, not {mesh_size}")
    if mesh_order not in (None, "auto", 1, 2):
        raise InputError(f"mesh_order must be 1 or 2, not {mesh_order}")
    with (
        tempfile.TemporaryDirectory(prefix="kshell-") as folder,
        opened(path, Path(folder), allow_system) as gmsh,
    ):
        _require_surface(gmsh, path)
        target = Path(folder) / "mesh.msh"
        _mesh(gmsh, path, target, mesh_size, mesh_order)
        raw = read_gmsh(target, path.name)
    if path.suffix.lower() in IN_MILLIMETRES:
        raw.notes.append(
            "lengths are in millimetres: gmsh converts files of this format to them, whatever their unit"
        )
    return raw


@contextmanager
def opened(path: Path, folder: Path, allow_system: bool = False, purpose: str = "mesh it") -> Iterator[Any]:
    """The module gmsh with a geometry file opened in it; ended whatever happens.

    Parameters
    ----------
    path : Path
    folder : Path
        For files needed meanwhile.
    allow_system : bool
        Whether the file may run programs and write files.
    purpose : str
        What gmsh is wanted for, in messages.

    Raises
    ------
    InputError
        If gmsh cannot be loaded, cannot read the file or its name, or fails at anything done meanwhile (the message
        repeats gmsh's own), or if the file does what it may not.
    """
    if not allow_system:
        require_harmless(path)
    _require_utf8(path.resolve())
    _require_utf8(folder)
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


def _require_utf8(path: Path) -> None:
    """gmsh takes names in UTF-8; elsewhere Python keeps bytes that are no text in this locale as surrogates."""
    try:
        str(path).encode()
    except UnicodeEncodeError as error:
        encoding = sys.getfilesystemencoding()
        cure = (
            "Rename it"
            if encoding == "utf-8"
            else f"In this locale ({encoding}) it cannot be: LC_ALL=C.UTF-8"
        )
        raise InputError(
            f"{path}: gmsh reads names in UTF-8, folders too, and this is none. {cure}"
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


def _require_surface(gmsh: Any, path: Path) -> None:
    """Raise if the file holds solids and does not say which of their faces are meant."""
    solids = gmsh.model.getEntities(3)
    if not solids or gmsh.model.getPhysicalGroups(2):
        return
    is_cad = path.suffix.lower() not in (".geo", ".geo_unrolled")
    faces = gmsh.model.getEntities(2)
    sizes = [(_box_size(gmsh, tag), tag) for _, tag in faces]
    largest = ", ".join(
        f"{tag} around {place([0.5 * (a + b) for a, b in zip(*_box(gmsh, tag), strict=True)])}"
        for _, tag in sorted(sizes, key=lambda face: -face[0])[:4]
    )
    merge = f'in a .geo file beside it, `SetFactory("OpenCASCADE"); Merge "{path.name}"; ' if is_cad else "`"
    raise InputError(
        f"{path.name}: holds {count(len(solids), 'solid')}, whose skin of {len(faces)} faces is not the midsurface of "
        f'a shell. Name the faces that are meant, {merge}Physical Surface("plate") = {{{faces[0][1]}}};` (the largest '
        f"are {largest}; of a closed shell all, `= Surface{{:}};`), or make the midsurface in the CAD program"
    )


def _box(gmsh: Any, tag: int) -> tuple[list[float], list[float]]:
    x = gmsh.model.getBoundingBox(2, tag)
    return list(x[:3]), list(x[3:])


def _box_size(gmsh: Any, tag: int) -> float:
    """An area that the surface may have: the sum of three sides of its box."""
    low, high = _box(gmsh, tag)
    a, b, c = (v - u for u, v in zip(low, high, strict=True))
    return a * b + b * c + c * a


def _foresee(gmsh: Any, path: Path, mesh_size: float) -> None:
    """Raise before a mesh of far too many triangles is begun, 4 / sqrt(3) times area / mesh_size^2."""
    per_area = 4 / 3**0.5 / mesh_size**2
    area = sum(_box_size(gmsh, tag) for _, tag in gmsh.model.getEntities(2))
    if area * per_area <= MOST_TRIANGLES:
        return
    low, high = gmsh.model.getBoundingBox(-1, -1)[:3], gmsh.model.getBoundingBox(-1, -1)[3:]
    coarse = 0.05 * max(b - a for a, b in zip(low, high, strict=True))
    if coarse > mesh_size:  # the area by a coarse mesh
        gmsh.option.setNumber("Mesh.MeshSizeMin", coarse)
        gmsh.option.setNumber("Mesh.MeshSizeMax", coarse)
        gmsh.model.mesh.generate(2)
        area = _mesh_area(gmsh)
        gmsh.model.mesh.clear()
    if area * per_area > MOST_TRIANGLES:
        enough = (area * 4 / 3**0.5 / MOST_TRIANGLES) ** 0.5
        raise InputError(
            f"{path.name}: mesh_size = {mesh_size:g} would make about {area * per_area:.2g} triangles of the area "
            f"{area:.3g}. Is it in the unit of the geometry? {enough:.2g} or more is possible"
        )


def _mesh_area(gmsh: Any) -> float:
    """Area of all triangles and quadrilaterals of the mesh in gmsh."""
    tags, flat, _ = gmsh.model.mesh.getNodes()
    place_of = np.empty(int(tags.max()) + 1, dtype=np.int64)
    place_of[tags.astype(np.int64)] = np.arange(len(tags))
    x = flat.reshape(-1, 3)
    area = 0.0
    types, _, nodes = gmsh.model.mesh.getElements(2)
    for kind, of_kind in zip(types, nodes, strict=True):
        width, corners = (
            gmsh.model.mesh.getElementProperties(kind)[3],
            gmsh.model.mesh.getElementProperties(kind)[5],
        )
        cells = place_of[of_kind.astype(np.int64)].reshape(-1, width)[:, :corners]
        for k in range(1, corners - 1):
            u, v = x[cells[:, k]] - x[cells[:, 0]], x[cells[:, k + 1]] - x[cells[:, 0]]
            area += 0.5 * float(np.linalg.norm(np.cross(u, v), axis=1).sum())
    return area


def _mesh(gmsh: Any, path: Path, target: Path, mesh_size: float | None, mesh_order: int | str | None) -> None:
    number = gmsh.option.setNumber
    if mesh_order == "auto":
        raised = gmsh.option.getNumber("Mesh.ElementOrder") == 1 and _is_curved(gmsh.model)
        mesh_order = 2 if raised else None
    if mesh_size is not None:
        _foresee(gmsh, path, mesh_size)
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
    written(gmsh, path, target)


def written(gmsh: Any, path: Path, target: Path) -> None:
    """Write the mesh in gmsh to a file, with the groups of the geometry."""
    if path.suffix.lower() in (".iges", ".igs"):  # faces of this format do not share their edges
        gmsh.model.mesh.removeDuplicateNodes()
    # without a physical surface gmsh would leave out the triangles of a file with physical curves
    number = gmsh.option.setNumber
    number("Mesh.SaveAll", 0 if gmsh.model.getPhysicalGroups(2) else 1)
    number("Mesh.MshFileVersion", 4.1)
    number("Mesh.Binary", 1)
    gmsh.write(str(target))


def is_discrete(model: Any) -> bool:
    """Whether a geometry holds triangles, as of an .stl file, in the place of a smooth surface."""
    return any(model.getType(*entity).startswith("Discrete") for entity in model.getEntities(2))


def _is_curved(model: Any) -> bool:
    """Whether some surface is no plane, or one of the curves on surfaces is no line."""
    surfaces = model.getEntities(2)
    if any(_kind(model, entity) not in STRAIGHT for entity in surfaces):
        return True
    return any(_kind(model, curve) not in STRAIGHT for curve in model.getBoundary(surfaces, False, False))


def _kind(model: Any, entity: tuple[int, int]) -> str:
    """Type of an entity; discrete ones are made of straight cells."""
    kind = str(model.getType(entity[0], abs(entity[1])))
    return "Discrete" if kind.startswith("Discrete") else kind


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
