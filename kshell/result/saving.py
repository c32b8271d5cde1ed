"""Writing a result: all of its files or none, so that an earlier result is never damaged."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from kshell.errors import InputError
from kshell.result.vtu import write_vtu

if TYPE_CHECKING:
    from kshell.result.result import Result

Writer = Callable[[Path], object]  # writes one file at the path


def save(result: Result, folder: str | os.PathLike[str], pictures: Mapping[str, Writer]) -> list[str]:
    """Write result.json, result.vtu and the given pictures. See `Result.save`."""
    text = as_json(result)  # a NaN is found before anything is touched
    writers: dict[str, Writer] = {
        "result.json": lambda path: path.write_text(text, encoding="utf-8"),
        "result.vtu": lambda path: write_vtu(path, result),
    }
    if result.analysis == "path":
        writers |= _series(result)
    return write_together(Path(folder), writers | dict(pictures))


def _series(result: Result) -> dict[str, Writer]:
    """One .vtu per load step, and the .pvd that lists them by load factor."""
    names = [f"step-{number:04d}.vtu" for number in range(len(result.series))]
    lines = [
        f'    <DataSet timestep="{factor:.12g}" part="0" file="{name}"/>'
        for name, (factor, _) in zip(names, result.series, strict=True)
    ]
    text = "\n".join(
        ['<?xml version="1.0"?>', '<VTKFile type="Collection" version="0.1">', "  <Collection>"]
        + [*lines, "  </Collection>", "</VTKFile>", ""]
    )
    writers: dict[str, Writer] = {
        name: lambda path, make=make: write_vtu(path, make())  # type: ignore[misc]
        for name, (_, make) in zip(names, result.series, strict=True)
    }
    writers["path.pvd"] = lambda path: path.write_text(text, encoding="utf-8")
    return writers


def as_json(result: Result) -> str:
    """The text of result.json."""
    return json.dumps(result.to_dict(), indent=1, allow_nan=False, ensure_ascii=False) + "\n"


def write_together(folder: Path, writers: dict[str, Writer]) -> list[str]:
    """Write several files into a folder, all or none.

    Each is written into a new folder beside its place first; only when all are complete they are moved.

    Parameters
    ----------
    folder : Path
        Made if needed.
    writers : dict of file name to function of the path to write

    Raises
    ------
    InputError
        If a file cannot be written; says which and why.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name in writers:
            if (folder / name).is_dir():
                raise InputError(f"{folder / name}: is a folder: remove it or give another output folder")
        with tempfile.TemporaryDirectory(prefix=".unfinished-", dir=folder) as unfinished:
            for name, write in writers.items():
                write(Path(unfinished) / name)
            for name in writers:
                os.replace(Path(unfinished) / name, folder / name)
    except OSError as error:
        raise InputError(
            f"{error.filename or folder}: cannot be written ({error.strerror or error}): "
            "give another output folder; earlier results are untouched"
        ) from None
    return [str(folder / name) for name in writers]
