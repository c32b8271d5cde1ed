"""Files of a result that a team has: result.json as of one process, result.pvtu with a piece by each.

All of the files or none: they are written into a new folder beside their places, and moved when all are complete.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from kshell.distributed.partition import partition
from kshell.distributed.team import Team
from kshell.errors import InputError
from kshell.result.pieces import old_pieces, piece_name, piece_of, pieces_index
from kshell.result.result import Result
from kshell.result.saving import Writer, cannot_be_written, unfinished, writers_with
from kshell.result.vtu import facts, unstructured
from kshell.result.vtu_file import write_triangles


def save_pieces(
    team: Team, result: Result, folder: str | os.PathLike[str], files: Callable[[], Mapping[str, Writer]]
) -> list[str]:
    """Write result.json, result.pvtu and its pieces, and what `files` gives on the first, with all.

    Raises
    ------
    InputError
        If a file cannot be written; says which and why.
    """
    place = Path(folder)
    names = [piece_name(rank) for rank in range(team.size)]

    def parts() -> tuple[Any, Any, list[str]]:
        if team.rank:
            return None, None, []
        return unstructured(result), partition(result.mesh, team.size), facts(result)

    whole, part, words = team.together(parts)
    piece, words = team.deal(lambda rank: (piece_of(whole, part == rank), words))
    writers: dict[str, Writer] = {
        names[team.rank]: lambda path: write_triangles(path, piece, "; ".join(words), words)
    }

    def more() -> dict[str, Writer]:
        if team.rank:
            return {}
        found = writers_with(result, files())
        del found["result.vtu"]
        return {
            **found,
            "result.pvtu": lambda path: path.write_text(pieces_index(whole, names), encoding="utf-8"),
        }

    writers |= team.together(more)
    # a NaN is found before anything is touched
    listed = team.once(lambda: sorted({*writers, *names}))
    room = team.once(lambda: _opened(place, listed))

    def write() -> None:
        try:
            for name, writer in writers.items():
                writer(room / name)
        except OSError as error:
            raise cannot_be_written(error, place) from None

    def move() -> None:
        try:
            for name in listed:
                os.replace(room / name, place / name)
            for stale in old_pieces(place, names):
                stale.unlink(missing_ok=True)
        except OSError as error:
            raise cannot_be_written(error, place) from None

    try:
        team.together(write)
        team.once(move)
    finally:
        if team.rank == 0:
            shutil.rmtree(room, ignore_errors=True)
    return [str(place / name) for name in listed]


def _opened(place: Path, names: list[str]) -> Path:
    """A new folder for unfinished files."""
    try:
        place.mkdir(parents=True, exist_ok=True)
        for name in names:
            if (place / name).is_dir():
                raise InputError(f"{place / name}: is a folder: remove it or give another output folder")
        return unfinished(place)
    except OSError as error:
        raise cannot_be_written(error, place) from None
