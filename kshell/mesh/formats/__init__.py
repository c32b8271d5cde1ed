"""Readers of the mesh formats of other programs: text and binary in, `kshell.mesh.raw.RawMesh` out."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path

from kshell.mesh.raw import RawMesh

# the module and function here that reads files of each suffix
READERS = {
    ".inp": ("abaqus", "read_abaqus"),
    ".bdf": ("nastran", "read_nastran"),
    ".nas": ("nastran", "read_nastran"),
    ".fem": ("nastran", "read_nastran"),
    ".dat": ("nastran", "read_nastran"),
    ".med": ("med", "read_med"),
    ".mdpa": ("mdpa", "read_mdpa"),
    ".off": ("off", "read_off"),
    ".obj": ("obj", "read_obj"),
    ".stl": ("stl", "read_stl"),
    ".su2": ("su2", "read_su2"),
    ".unv": ("unv", "read_unv"),
}


def reader_of(path: Path) -> Callable[[Path], RawMesh] | None:
    """The reader of a file by its suffix; None where there is none here."""
    suffix = path.suffix.lower()
    if suffix not in READERS:
        return None
    module, function = READERS[suffix]
    reader: Callable[[Path], RawMesh] = getattr(import_module(f"kshell.mesh.formats.{module}"), function)
    return reader
