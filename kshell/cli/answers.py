"""`kshell solve`, `modes`, `buckling`, `trace`, `simulate`: a scene goes in, a result comes out."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated, Any

import typer

from kshell.cli.app import command
from kshell.cli.options import (
    Count,
    Files,
    MeshFile,
    ModeFiles,
    MotionFiles,
    PathFiles,
    Resume,
    Running,
    SceneOnly,
    Solving,
    Source,
    Tolerance,
    require_scene,
)
from kshell.cli.scene_options import scene_of
from kshell.errors import InputError, Interrupted, SolveError


@command()
def solve(source: Source, files: Files, mesh: MeshFile, solving: Solving, running: Running) -> None:
    """Solve a scene file, or a mesh file described by options."""
    _answer("solve", source, files, running, solving.given(), mesh.given())


@command()
def modes(
    source: SceneOnly,
    files: ModeFiles,
    *,
    count: Count = None,
    range_: Annotated[
        str | None, typer.Option("--range", metavar="F1,F2", help="All between two frequencies instead.")
    ] = None,
    prestress: Annotated[
        bool, typer.Option("--prestress", help="Let the loads act before the structure vibrates.")
    ] = False,
    tolerance: Tolerance = None,
    running: Running,
) -> None:
    """Natural frequencies and modes, of plates between guaranteed bounds."""
    require_scene(source, "modes")
    options = {
        "count": count,
        "tolerance": tolerance,
        "prestress": prestress or None,
        "range": None if range_ is None else _frequencies(range_),
    }
    _answer("modes", source, files, running, {key: o for key, o in options.items() if o is not None})


@command()
def buckling(
    source: SceneOnly,
    files: ModeFiles,
    *,
    count: Count = None,
    tolerance: Tolerance = None,
    running: Running,
) -> None:
    """Factors by which the loads may grow before the structure buckles, by linear theory."""
    options = {"count": count, "tolerance": tolerance}
    _answer("buckling", source, files, running, {key: o for key, o in options.items() if o is not None})


@command()
def trace(source: SceneOnly, files: PathFiles, *, resume: Resume = False, running: Running) -> None:
    """Follow large deflections while the loads grow from zero to their full size."""
    _answer("trace", source, files, running, {"resume": resume})


@command()
def simulate(source: SceneOnly, files: MotionFiles, *, resume: Resume = False, running: Running) -> None:
    """Motion in time, under loads and prescribed motions that may depend on t."""
    _answer("simulate", source, files, running, {"resume": resume})


def _frequencies(text: str) -> tuple[float, ...]:
    try:
        return tuple(float(part) for part in text.split(","))
    except ValueError:
        raise InputError(f'--range "{text}": must be two frequencies, such as 0,100') from None


def _answer(
    name: str,
    source: Path,
    files: Files,
    running: Running,
    options: dict[str, Any],
    mesh: dict[str, Any] | None = None,
) -> None:
    """Solve, write and print.

    Parameters
    ----------
    name : str
        Of the command.
    options : dict
        Of the function that answers.
    mesh : dict, optional
        What describes a mesh file, where one may be given.
    """
    begin = time.perf_counter()
    if mesh is None:
        require_scene(source, name)
    files.require_folder()
    scene = scene_of(source, mesh or {}, running.set_ or [])
    if "resume" in options:
        folder = files.folder(source)
        if options["resume"] and folder is None:
            raise InputError("--resume needs -o DIR, the folder of what is to go on")
        options["folder"] = None if folder is None else folder / "steps"
    elif name != "solve":
        options["analysis"] = name
    from kshell.analysis import solve

    function = {"trace": solve.trace, "simulate": solve.simulate}.get(name, solve.solve)
    try:
        result = running.watched(
            lambda progress: function(scene, progress=progress, allow_system=running.allow_system, **options)
        )
    except (SolveError, Interrupted) as error:
        files.save_last(error.state, source)
        raise
    solved = time.perf_counter()
    written = files.save(result, source)
    done = time.perf_counter()
    if files.json != "-":
        from kshell.cli.terminal import print_result

        print_result(result, written, done - begin, done - solved if written else 0.0)
