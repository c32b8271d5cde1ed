"""Writing a result: all of its files or none, so that an earlier result is never damaged."""

from __future__ import annotations

import csv
import json
import os
import platform
import re
import shutil
import stat
import tempfile
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from kshell.errors import InputError, clipped
from kshell.mesh.write import write_msh
from kshell.result.vtu import write_motion, write_vtu
from kshell.result.xdmf import require_hdf5, write_series

if TYPE_CHECKING:
    from kshell.result.result import Result

FRAMES = 12  # of one period of a mode
UNFINISHED = ".unfinished-"  # begins the names of folders in which files are written before they are moved
STREAMS = ("/dev/", "/proc/")  # below them links lead to what is open already
Writer = Callable[[Path], object]  # writes one file at the path


def save(result: Result, folder: str | os.PathLike[str], pictures: Mapping[str, Writer]) -> list[str]:
    """Write result.json, result.vtu and the given pictures. See `Result.save`."""
    return write_together(Path(folder), writers_with(result, pictures))


def writers_with(result: Result, pictures: Mapping[str, Writer]) -> dict[str, Writer]:
    """What writes all files of a result and the given ones, which may have the states in one file."""
    states = not any(name.endswith(".xdmf") for name in pictures)
    return writers_of(result, states=states) | dict(pictures)


def writers_of(result: Result, states: bool = True) -> dict[str, Writer]:
    """What writes the files of a result, by their names; states of a path or motion one by one, or not at all."""
    text = as_json(result)  # a NaN is found before anything is touched
    writers: dict[str, Writer] = {
        "result.json": lambda path: path.write_text(text, encoding="utf-8"),
        "result.vtu": lambda path: write_vtu(path, result),
    }
    if result.last_mesh is not None:
        last = result.last_mesh
        writers["mesh.msh"] = lambda path: write_msh(last, path)
    if result.analysis == "path" and states:
        writers |= _series(result, "path.pvd")
    for name, case in result.cases.items():
        writers[f"{case_stem(name)}.vtu"] = partial(write_vtu, result=case, case=name)
        if case.analysis == "path" and name != result.case and states:
            writers |= _series(case, "path.pvd", f"{case_stem(name)}-")
    if result.cases:
        writers["envelope.vtu"] = partial(write_vtu, result=result.envelope.as_result(), case="envelope")
    if result.history:
        writers |= _series(result, "series.pvd") if states else {}
        writers["history.csv"] = lambda path: _write_history(path, result.history)
    if result.eigen:
        writers |= _animated(result)
    return writers


def case_stem(name: str) -> str:
    """How names of files of a load case begin."""
    return "case-" + safe(name)


def safe(name: str) -> str:
    """A name as part of the name of a file."""
    return re.sub(r"[^\w.+-]+", "-", name)


def _series(result: Result, collection: str, stem: str = "") -> dict[str, Writer]:
    """One .vtu per load step or time, and the .pvd that lists them by load factor or time."""
    names = [f"{stem}step-{number:04d}.vtu" for number in range(len(result.series))]
    text = _collection([(factor, name) for name, (factor, _) in zip(names, result.series, strict=True)])
    writers: dict[str, Writer] = {
        name: lambda path, make=make, time=time: write_vtu(path, make(), time, whole=result)  # type: ignore[misc]
        for name, (time, make) in zip(names, result.series, strict=True)
    }
    writers[f"{stem}{collection}"] = lambda path: path.write_text(text, encoding="utf-8")
    return writers


def in_one_file(result: Result) -> dict[str, Writer]:
    """The states of a result, and of each of its cases, as XDMF with HDF5: two files each.

    Raises
    ------
    InputError
        If h5py is not installed, or there are no states.
    """
    require_hdf5()
    out: dict[str, Writer] = {}
    for name, one in (result.cases or {"": result}).items():
        if one.series:
            stem = f"{case_stem(name)}-series" if name else "series"
            out[f"{stem}.xdmf"] = partial(write_series, states=one.series, title=one.title)
            out[f"{stem}.h5"] = lambda path: None  # written with the file before it
    if not out:
        raise InputError("xdmf: this result has no states of a path or motion, which such a file is for")
    return out


def _write_history(path: Path, history: Mapping[str, Any]) -> None:
    """The history of a motion as a table, vectors in three columns."""
    columns: dict[str, Any] = {
        name: values for name, values in history.items() if not isinstance(values, dict)
    }
    columns |= {f"{name}.u": values["u"] for name, values in history.get("probes", {}).items()}
    columns |= {f"contact_force.{name}": force for name, force in history.get("contact_force", {}).items()}
    heads, table = [], []
    for name, values in columns.items():
        if values.ndim == 1:
            heads.append(name)
            table.append(values)
        else:
            heads += [f"{name}.{axis}" for axis in "xyz"]
            table += list(values.T)
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(heads)
        writer.writerows(np.column_stack(table).tolist())


def _collection(entries: Sequence[tuple[float, str]]) -> str:
    """A .pvd of (time, file)."""
    lines = [f'    <DataSet timestep="{time:.12g}" part="0" file="{name}"/>' for time, name in entries]
    return "\n".join(
        ['<?xml version="1.0"?>', '<VTKFile type="Collection" version="0.1">', "  <Collection>"]
        + [*lines, "  </Collection>", "</VTKFile>", ""]
    )


def _animated(result: Result) -> dict[str, Writer]:
    """Every mode over one period, cos(2 pi t), one after the other: modes.pvd and its .vtu files.

    The largest displacement is a tenth of the size of the structure.
    """
    names, lines = {}, []
    for number in range(1, len(result.eigen) + 1):
        shape = result.fields[f"mode_{number}"]
        largest = float(np.linalg.norm(shape, axis=1).max(initial=0.0)) or 1.0
        for frame in range(FRAMES):
            name = f"mode-{number:03d}-{frame:02d}.vtu"
            lines.append((number - 1 + frame / FRAMES, name))
            names[name] = 0.1 * result.mesh.size / largest * np.cos(2 * np.pi * frame / FRAMES) * shape
    writers: dict[str, Writer] = {
        name: lambda path, motion=motion: write_motion(path, result.mesh, motion)  # type: ignore[misc]
        for name, motion in names.items()
    }
    text = _collection(lines)
    writers["modes.pvd"] = lambda path: path.write_text(text, encoding="utf-8")
    return writers


def as_json(result: Result) -> str:
    """The text of result.json."""
    return json.dumps(result.to_dict(), indent=1, allow_nan=False, ensure_ascii=False) + "\n"


def write_text(text: str, target: str | os.PathLike[str]) -> list[str]:
    """Write one text: whole or not at all to a file, also through links; straight into devices and pipes.

    Raises
    ------
    InputError
        If it cannot be written; says why.
    """
    path = Path(target)
    if str(path).startswith(STREAMS) or _is_stream(path):
        try:
            with path.open("w", encoding="utf-8") as stream:
                stream.write(text)
        except BrokenPipeError:
            pass  # nobody reads any more
        except OSError as error:
            raise InputError(f"{clipped(path)}: cannot be written ({error.strerror or error})") from None
        return [str(path)]
    real = Path(os.path.realpath(path))
    write_together(real.parent, {real.name: lambda p: p.write_text(text, encoding="utf-8")})
    return [str(path)]


def _is_stream(path: Path) -> bool:
    """Whether something other than a file or a folder stands there."""
    try:
        mode = path.stat().st_mode
    except OSError:
        return False
    return not (stat.S_ISREG(mode) or stat.S_ISDIR(mode))


def _machine() -> str:
    """The name of this machine, made of letters that names of files may have."""
    return re.sub(r"[^A-Za-z0-9]", "_", platform.node()) or "machine"


def _remove_left_over(folder: Path) -> None:
    """Remove unfinished files of processes of this machine that were killed."""
    for path in folder.glob(f"{UNFINISHED}{_machine()}-*-*"):
        number = path.name.removeprefix(f"{UNFINISHED}{_machine()}-").partition("-")[0]
        if number.isdecimal() and not _runs(int(number)):
            shutil.rmtree(path, ignore_errors=True)


def _runs(process: int) -> bool:
    import psutil

    return bool(psutil.pid_exists(process))


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
        room = unfinished(folder)
        try:
            for name, write in writers.items():
                write(room / name)
            for name in writers:
                os.replace(room / name, folder / name)
        finally:
            shutil.rmtree(room, ignore_errors=True)
    except OSError as error:
        raise cannot_be_written(error, folder) from None
    return [str(folder / name) for name in writers]


def unfinished(folder: Path) -> Path:
    """A new folder in a folder, for files that are moved when all are complete; those left over are removed."""
    _remove_left_over(folder)
    return Path(tempfile.mkdtemp(prefix=f"{UNFINISHED}{_machine()}-{os.getpid()}-", dir=folder))


def cannot_be_written(error: OSError, folder: Path) -> InputError:
    """The error for a file that could not be written."""
    return InputError(
        f"{clipped(error.filename or folder)}: cannot be written ({error.strerror or error}): "
        "give another output folder; earlier results are untouched"
    )
