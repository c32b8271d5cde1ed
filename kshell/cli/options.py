"""The options that commands share, each declared once: what is read, how it is solved, what is written."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

import typer

from kshell.cli.scene_options import flag, is_scene, number, scene_of
from kshell.distributed.launch import launched
from kshell.errors import InputError, KshellWarning

if TYPE_CHECKING:
    from kshell.cli.progress import Progress
    from kshell.result.result import Result
    from kshell.scene.scene import Scene

T = TypeVar("T")

Source = Annotated[
    Path, typer.Argument(metavar="SCENE.toml|MESH", help="A scene file, or a mesh or geometry file.")
]
SceneOnly = Annotated[Path, typer.Argument(metavar="SCENE.toml", help="A scene file.")]
ResultFolder = Annotated[Path, typer.Argument(metavar="DIR", help="A folder with a result.")]
Tolerance = Annotated[
    str | None,
    typer.Option(metavar="0.01|1%", help="Refine until what is asked for is known that well, relative."),
]
Count = Annotated[int | None, typer.Option("--count", metavar="N", help="How many.")]
Resume = Annotated[bool, typer.Option("--resume", help="Go on after the last step in DIR.")]
Levels = Annotated[int, typer.Option(help="How many meshes, at least 3.")]
Log = Annotated[
    Path | None, typer.Option("--log", metavar="FILE", help="Append what is done, with times, to FILE.")
]


def into(words: str) -> Any:
    """The type of an option -o with words for what is written into that folder."""
    return Annotated[Path | None, typer.Option("-o", "--output", metavar="DIR", help=words)]


@dataclass(eq=False, repr=False, match_args=False)  # help waits for what is generated
class Debugging:
    """What every command has."""

    debug: Annotated[bool, typer.Option("--debug", help="Show the traceback of errors.")] = False


@dataclass(eq=False, repr=False, match_args=False)  # help waits for what is generated
class Trust(Debugging):
    """Of commands that read geometry."""

    allow_system: Annotated[
        bool,
        typer.Option(
            "--allow-system",
            help="Let geometry files run programs and write files, as gmsh's language can.",
        ),
    ] = False


@dataclass(eq=False, repr=False, match_args=False)  # help waits for what is generated
class Reading(Trust):
    """Of commands that read a scene file."""

    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="Replace a value of the scene file, e.g. load.0.value=2000. Repeatable.",
        ),
    ] = None

    def scene(self, source: Path, command: str) -> Scene:
        """The scene of a file, which must be a scene file."""
        require_scene(source, command)
        return scene_of(source, {}, self.set_ or [])


@dataclass(eq=False, repr=False, match_args=False)  # help waits for what is generated
class Running(Reading):
    """Of commands that solve."""

    log: Log = None

    def watched(self, solve: Callable[[Progress], T]) -> T:
        """What a function gives, while its progress is shown."""
        return watched(solve, self.log)


def watched(solve: Callable[[Progress], T], log: Path | None = None) -> T:
    """What a function gives, while its progress is shown and warnings wait to be printed from the result."""
    import warnings

    from kshell.cli.progress import Progress

    with warnings.catch_warnings(), Progress(log if _speaks() else None).shown() as progress:
        warnings.simplefilter("ignore", KshellWarning)  # they stand in the result and are printed from it
        warnings.simplefilter("ignore", RuntimeWarning)  # overflow: what is not finite ends as a SolveError
        return solve(progress)


def require_scene(source: Path, command: str) -> None:
    """Raise InputError if it is not a scene file."""
    if not is_scene(source):
        raise InputError(f"{source}: {command} needs a scene file, .toml")


@dataclass(eq=False, repr=False, match_args=False)  # help waits for what is generated
class Files:
    """What is written, and where."""

    output: into("Write result.json and result.vtu here.") = None  # type: ignore[valid-type]
    json: Annotated[
        str | None,
        typer.Option(
            "--json", metavar="FILE|-", help="Write result.json to FILE; - is stdout, and nothing else there."
        ),
    ] = None
    plot: Annotated[
        bool,
        typer.Option("--plot", help="Write pictures too; without -o into a folder named after the scene."),
    ] = False
    report: Annotated[
        bool, typer.Option("--report", help="Write report.html, a report that needs no other file; with -o.")
    ] = False
    tables: Annotated[bool, typer.Option("--tables", help="Write all tables as CSV too; needs -o.")] = False

    def require_folder(self) -> None:
        """Raise InputError if something is to be written that needs a folder, and there is none."""
        if self.tables and self.output is None and not self.plot:
            raise InputError("--tables needs -o DIR, the folder to write into")
        if self.report and self.output is None:
            raise InputError("--report needs -o DIR, the folder of report.html")

    def folder(self, source: Path) -> Path | None:
        """Where the files go, None if nowhere."""
        return self.output or (Path(f"{source.stem}-result") if self.plot else None)

    def save(self, result: Result, source: Path) -> list[str]:
        """Write all that was asked for; the paths."""
        folder, written = self.folder(source), []
        if folder is not None:
            more = {"xdmf": True} if getattr(self, "xdmf", False) else {}
            written += result.save(folder, plots=self.plot, report=self.report, tables=self.tables, **more)
        return written + _write_json(result, self.json)

    def save_last(self, state: Any, source: Path) -> None:
        """Write the last good state of what was not completed, and say where it is."""
        from kshell.result.result import Result

        if isinstance(state, Result):
            for path in self.save(state, source):
                print(f"written, up to the last good step: {path}", file=sys.stderr)


@dataclass(eq=False, repr=False, match_args=False)  # help waits for what is generated
class ModeFiles(Files):
    """Of modes and buckling."""

    output: into("Write result.json, result.vtu and modes.pvd here.") = None  # type: ignore[valid-type]


@dataclass(eq=False, repr=False, match_args=False)  # help waits for what is generated
class PathFiles(Files):
    """Of a path."""

    output: into(  # type: ignore[valid-type]
        "Write the result, a .vtu per step (path.pvd), the load-deflection picture, and the steps themselves "
        "as they converge (steps/)."
    ) = None
    xdmf: Annotated[
        bool, typer.Option("--xdmf", help="Write all states into series.xdmf and series.h5, not a .vtu each.")
    ] = False


@dataclass(eq=False, repr=False, match_args=False)  # help waits for what is generated
class MotionFiles(Files):
    """Of a motion."""

    output: into(  # type: ignore[valid-type]
        "Write the result, history.csv, a .vtu per state (series.pvd), the picture of the history, and the "
        "states themselves as they come (steps/)."
    ) = None
    xdmf: Annotated[
        bool, typer.Option("--xdmf", help="Write all states into series.xdmf and series.h5, not a .vtu each.")
    ] = False


def _speaks() -> bool:
    """Whether this process prints and writes: of several the first one."""
    start = launched()
    return start is None or start.rank == 0


def _write_json(result: Result, target: str | None) -> list[str]:
    from kshell.result.saving import as_json, write_text

    if target is None or not _speaks():
        return []
    text = as_json(result)
    if target == "-":
        sys.stdout.write(text)
        return []
    return write_text(text, target)


def _groups(words: str) -> Any:
    return Annotated[list[str] | None, typer.Option(metavar="GROUP", help=f"{words} Repeatable.")]


@dataclass(eq=False, repr=False, match_args=False)  # help waits for what is generated
class MeshFile:
    """What makes a scene of a mesh file."""

    thickness: Annotated[
        str | None, typer.Option(help="Of a mesh file: number or expression in x, y, z.", show_default=False)
    ] = None
    E: Annotated[float | None, typer.Option("--E", help="Young's modulus.")] = None
    nu: Annotated[float | None, typer.Option("--nu", help="Poisson's ratio, -1 < nu < 1/2.")] = None
    density: Annotated[float | None, typer.Option(help="Mass per volume.")] = None
    clamped: _groups("Clamped group.") = None  # type: ignore[valid-type]
    supported: _groups("Simply supported group.") = None  # type: ignore[valid-type]
    symmetry: _groups("Group on a plane of symmetry.") = None  # type: ignore[valid-type]
    pressure: Annotated[
        str | None,
        typer.Option(
            help="Force per area along the normal (+z on a plate): number or expression in x, y, z."
        ),
    ] = None
    mesh_size: Annotated[float | None, typer.Option(help="Triangle size, for geometry files only.")] = None
    mesh_order: Annotated[
        str | None, typer.Option(metavar="auto|1|2", help="For geometry files only; auto: 2 where curved.")
    ] = None
    facets: Annotated[
        str | None, typer.Option(metavar="auto|flat|curved", help="Flat triangles of a curved shell.")
    ] = None
    crease: Annotated[
        float | None, typer.Option(help="Angle in degrees from which neighbours meet in a fold.")
    ] = None
    geometry: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Of a flat-sided mesh: .geo, .step, .brep to curve it onto."),
    ] = None

    def given(self) -> dict[str, Any]:
        """By name, whole numbers as such."""
        return vars(self) | {"mesh_order": number(self.mesh_order)}


@dataclass(eq=False, repr=False, match_args=False)  # help waits for what is generated
class Solving:
    """Keys of [solve] that stand before those of the scene file."""

    model: Annotated[str | None, typer.Option(metavar="auto|plate|shell", help="Which model.")] = None
    element: Annotated[
        str | None, typer.Option(metavar="auto|morley|argyris|koiter", help="Which element.")
    ] = None
    order: Annotated[str | None, typer.Option(metavar="auto|1..12", help="Of koiter and hhj.")] = None
    solver: Annotated[
        str | None,
        typer.Option(metavar="auto|direct|multigrid|petsc", help="How the linear system is solved."),
    ] = None
    large_deflection: Annotated[
        str | None, typer.Option(metavar="auto|true|false", help="Whether deflections are large.")
    ] = None
    steps: Annotated[str | None, typer.Option(metavar="auto|N", help="First guess of the load steps.")] = None
    tolerance: Tolerance = None
    quantity: Annotated[
        str | None, typer.Option(metavar="PROBE|probes|energy", help="What the tolerance is for.")
    ] = None
    limit: Annotated[
        str | None, typer.Option(metavar="'60 s'|'4 GB'", help="Where refining ends at the latest.")
    ] = None

    def given(self) -> dict[str, Any]:
        """Those that are there."""
        read = {"order": number, "steps": number, "large_deflection": flag}
        values = {key: read.get(key, str)(value) for key, value in vars(self).items() if value is not None}
        return values
