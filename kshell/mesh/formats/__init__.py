"""Readers of the mesh formats of other programs: text and binary in, `kshell.mesh.raw.RawMesh` out."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path

from kshell.mesh.raw import RawMesh

# the module and function here that reads files of each suffix
READERS = {
    ".inp": ("abaqus", "read_abaqus"),
}


def reader_of(suffix: str) -> Callable[[Path], RawMesh] | None:
    """The reader of files with this suffix; None where there is none here."""
    if suffix.lower() not in READERS:
        return None
    module, function = READERS[suffix.lower()]
    reader: Callable[[Path], RawMesh] = getattr(import_module(f"kshell.mesh.formats.{module}"), function)
    return reader
