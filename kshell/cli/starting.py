"""`kshell new`: a scene and its geometry to start from."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from shlex import quote
from typing import Annotated

import typer

from kshell.cli.app import command
from kshell.cli.options import Debugging, into
from kshell.errors import InputError, clipped

STARTS = ("plate", "roof", "tank", "box")
SCHEMA = "scene.schema.json"  # as the first line of the scene files names it


@command()
def new(
    kind: Annotated[
        str,
        typer.Argument(
            metavar="|".join(STARTS), help="What to start from.", autocompletion=lambda: list(STARTS)
        ),
    ],
    *,
    output: into("The folder, new or empty; named after what it is if absent.") = None,  # type: ignore[valid-type]
    debugging: Debugging,
) -> None:
    """Write a scene and its geometry to start from: a plate with a hole, a roof of free form, a tank, a box girder."""
    from kshell.values.naming import listing, suggestion

    if kind not in STARTS:
        raise InputError(
            f'nothing to start from is called "{clipped(kind)}": {suggestion(kind, STARTS)}there are {listing(STARTS)}'
        )
    folder = output or Path(kind)
    _require_empty(folder)
    from importlib.resources import files

    from kshell.scene.schema import schema_text

    texts = {name: files("kshell.cli").joinpath("start", name).read_text("utf-8") for name in _names(kind)}
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in {**texts, SCHEMA: schema_text()}.items():
            (folder / name).write_text(text, encoding="utf-8", newline="\n")
            typer.echo(f"written: {folder / name}")
    except OSError as error:
        raise InputError(f"{folder}: cannot be written ({error.strerror or error})") from None
    scene, out = (quote(str(path)) for path in (folder / f"{kind}.toml", folder / "out"))
    typer.echo(f"next: kshell check {scene}, then kshell solve {scene} -o {out} --plot")


def _names(kind: str) -> Iterator[str]:
    yield f"{kind}.toml"
    yield f"{kind}.geo"


def _require_empty(folder: Path) -> None:
    try:
        if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
            what = "is not empty" if folder.is_dir() else "is a file"
            raise InputError(f"{folder}: {what}: give a folder that is new or empty, with -o DIR")
    except OSError as error:
        raise InputError(f"{folder}: cannot be read ({error.strerror or error})") from None
