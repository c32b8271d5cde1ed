"""The command line: `kshell solve`, `modes`, `buckling`, `trace`, `simulate`, `check`, `sweep`, `diff`, `report`,
`verify`.

Exit codes: 0 answered, 1 no answer, 2 bad input, 130 interrupted. Errors are one message on stderr; a
traceback only with --debug. Heavy imports happen inside the commands: help is immediate.
"""

from __future__ import annotations

import sys
import time
import traceback
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Annotated, Any

import typer

from kshell.cli.scene_options import flag, is_scene, no_overrides, number, scene_of
from kshell.errors import InputError, Interrupted, KshellError, KshellWarning, SolveError

if TYPE_CHECKING:
    from kshell.result.result import Result
    from kshell.scene.scene import Scene

ClickException: Any = next(c for c in typer.BadParameter.__mro__ if c.__name__ == "ClickException")
COMMANDS = (
    "solve",
    "modes",
    "buckling",
    "trace",
    "simulate",
    "converge",
    "check",
    "sweep",
    "diff",
    "report",
    "verify",
)
INTERRUPTED = 130

app = typer.Typer(
    name="kshell",
    help="Finite elements for thin plates and shells: a gmsh mesh goes in, a checked answer comes out.",
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)

Source = Annotated[
    Path, typer.Argument(metavar="SCENE.toml|MESH", help="A scene file, or a mesh or geometry file.")
]
SceneOnly = Annotated[Path, typer.Argument(metavar="SCENE.toml", help="A scene file.")]
Output = Annotated[
    Path | None,
    typer.Option("-o", "--output", metavar="DIR", help="Write result.json, result.vtu and modes.pvd here."),
]
JsonFile = Annotated[
    str | None,
    typer.Option(
        "--json", metavar="FILE|-", help="Write result.json to FILE; - is stdout, and nothing else there."
    ),
]
Pictures = Annotated[
    bool,
    typer.Option("--plot", help="Write pictures too; without -o into a folder named after the scene."),
]
Report = Annotated[
    bool, typer.Option("--report", help="Write report.html, a report that needs no other file; with -o.")
]
Overrides = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help="Replace a value of the scene file, e.g. load.0.value=2000. Repeatable.",
    ),
]
AllowSystem = Annotated[
    bool,
    typer.Option(
        "--allow-system", help="Let geometry files run programs and write files, as gmsh's language can."
    ),
]
Log = Annotated[
    Path | None, typer.Option("--log", metavar="FILE", help="Append what is done, with times, to FILE.")
]
Tolerance = Annotated[
    str | None,
    typer.Option(metavar="0.01|1%", help="Refine until what is asked for is known that well, relative."),
]
Debug = Annotated[bool, typer.Option("--debug", help="Show the traceback of errors.")]


def _print_version(wanted: bool) -> None:
    if wanted:
        from kshell.version import __version__

        typer.echo(f"kshell {__version__}")
        raise typer.Exit


@app.callback()
def _common(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    pass


@app.command()
def solve(
    source: Source,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="DIR", help="Write result.json and result.vtu here."),
    ] = None,
    json: JsonFile = None,
    plot: Pictures = False,
    report: Report = False,
    set_: Overrides = None,
    thickness: Annotated[
        str | None, typer.Option(help="Of a mesh file: number or expression in x, y, z.", show_default=False)
    ] = None,
    E: Annotated[float | None, typer.Option("--E", help="Young's modulus.")] = None,
    nu: Annotated[float | None, typer.Option("--nu", help="Poisson's ratio, -1 < nu < 1/2.")] = None,
    density: Annotated[float | None, typer.Option(help="Mass per volume.")] = None,
    clamped: Annotated[
        list[str] | None, typer.Option(metavar="GROUP", help="Clamped group. Repeatable.")
    ] = None,
    supported: Annotated[
        list[str] | None, typer.Option(metavar="GROUP", help="Simply supported group. Repeatable.")
    ] = None,
    symmetry: Annotated[
        list[str] | None, typer.Option(metavar="GROUP", help="Group on a plane of symmetry. Repeatable.")
    ] = None,
    pressure: Annotated[
        str | None,
        typer.Option(
            help="Force per area along the normal (+z on a plate): number or expression in x, y, z."
        ),
    ] = None,
    mesh_size: Annotated[float | None, typer.Option(help="Triangle size, for geometry files only.")] = None,
    mesh_order: Annotated[
        str | None, typer.Option(metavar="auto|1|2", help="For geometry files only; auto: 2 where curved.")
    ] = None,
    facets: Annotated[
        str | None, typer.Option(metavar="auto|flat|curved", help="Flat triangles of a curved shell.")
    ] = None,
    crease: Annotated[
        float | None, typer.Option(help="Angle in degrees from which neighbours meet in a fold.")
    ] = None,
    geometry: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Of a flat-sided mesh: .geo, .step, .brep to curve it onto."),
    ] = None,
    model: Annotated[str | None, typer.Option(metavar="auto|plate|shell", help="Which model.")] = None,
    element: Annotated[
        str | None, typer.Option(metavar="auto|morley|argyris|koiter", help="Which element.")
    ] = None,
    order: Annotated[str | None, typer.Option(metavar="auto|1..8", help="Of koiter and hhj.")] = None,
    solver: Annotated[
        str | None, typer.Option(metavar="auto|direct|multigrid", help="How the linear system is solved.")
    ] = None,
    large_deflection: Annotated[
        str | None, typer.Option(metavar="auto|true|false", help="Whether deflections are large.")
    ] = None,
    steps: Annotated[
        str | None, typer.Option(metavar="auto|N", help="First guess of the load steps.")
    ] = None,
    tolerance: Tolerance = None,
    quantity: Annotated[
        str | None, typer.Option(metavar="PROBE|probes|energy", help="What the tolerance is for.")
    ] = None,
    limit: Annotated[
        str | None, typer.Option(metavar="'60 s'|'4 GB'", help="Where refining ends at the latest.")
    ] = None,
    tables: Annotated[bool, typer.Option("--tables", help="Write all tables as CSV too; needs -o.")] = False,
    allow_system: AllowSystem = False,
    log: Log = None,
    debug: Debug = False,
) -> None:
    """Solve a scene file, or a mesh file described by options."""
    plate = {
        "thickness": thickness,
        "E": E,
        "nu": nu,
        "density": density,
        "clamped": clamped,
        "supported": supported,
        "symmetry": symmetry,
        "pressure": pressure,
        "mesh_size": mesh_size,
        "mesh_order": number(mesh_order),
        "facets": facets,
        "crease": crease,
        "geometry": geometry,
    }
    if tables and output is None and not plot:
        raise InputError("--tables needs -o DIR, the folder to write into")
    begin = time.perf_counter()
    _needs_folder(report, output)
    scene = scene_of(source, plate, set_ or [])
    given = {"model": model, "element": element, "order": number(order), "solver": solver}
    given |= {"large_deflection": flag(large_deflection), "steps": number(steps)}
    given |= {"tolerance": tolerance, "quantity": quantity, "limit": limit}
    options = {key: value for key, value in given.items() if value is not None}
    folder = output or (Path(f"{source.stem}-result") if plot else None)
    try:
        result = _solve(scene, options, allow_system, log)
    except (SolveError, Interrupted) as error:
        _save_last(error.state, folder, plot, report, json)
        raise
    written: list[str] = []
    if folder is not None:
        written += result.save(folder, plots=plot, report=report, tables=tables)
    written += _write_json(result, json)
    if json != "-":
        from kshell.cli.terminal import print_result

        print_result(result, written, time.perf_counter() - begin)


@app.command()
def trace(
    source: Annotated[Path, typer.Argument(metavar="SCENE.toml", help="A scene file.")],
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="DIR",
            help="Write the result, a .vtu per step (path.pvd), the load-deflection picture, and the steps themselves "
            "as they converge (steps/).",
        ),
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Go on after the last step in DIR.")] = False,
    json: JsonFile = None,
    plot: Pictures = False,
    report: Report = False,
    set_: Overrides = None,
    allow_system: AllowSystem = False,
    log: Log = None,
    debug: Debug = False,
) -> None:
    """Follow large deflections while the loads grow from zero to their full size."""
    _in_steps("trace", source, output, resume, json, plot, report, set_, allow_system, log)


@app.command()
def simulate(
    source: SceneOnly,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="DIR",
            help="Write the result, history.csv, a .vtu per state (series.pvd), the picture of the history, and the "
            "states themselves as they come (steps/).",
        ),
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Go on after the last state in DIR.")] = False,
    json: JsonFile = None,
    plot: Pictures = False,
    report: Report = False,
    set_: Overrides = None,
    allow_system: AllowSystem = False,
    log: Log = None,
    debug: Debug = False,
) -> None:
    """Motion in time, under loads and prescribed motions that may depend on t."""
    _in_steps("simulate", source, output, resume, json, plot, report, set_, allow_system, log)


def _in_steps(
    command: str,
    source: Path,
    output: Path | None,
    resume: bool,
    json: str | None,
    plot: bool,
    report: bool,
    set_: list[str] | None,
    allow_system: bool,
    log: Path | None,
) -> None:
    if not is_scene(source):
        raise InputError(f"{source}: {command} needs a scene file, .toml")
    begin = time.perf_counter()
    _needs_folder(report, output)
    scene = scene_of(source, {}, set_ or [])
    folder = output or (Path(f"{source.stem}-result") if plot else None)
    if resume and folder is None:
        raise InputError("--resume needs -o DIR, the folder of what is to go on")
    try:
        result = _stepped(
            command, scene, None if folder is None else folder / "steps", resume, allow_system, log
        )
    except (SolveError, Interrupted) as error:
        _save_last(error.state, folder, plot, report, json)
        raise
    written = [] if folder is None else result.save(folder, plots=plot, report=report)
    written += _write_json(result, json)
    if json != "-":
        from kshell.cli.terminal import print_result

        print_result(result, written, time.perf_counter() - begin)


Count = Annotated[int | None, typer.Option("--count", metavar="N", help="How many.")]


@app.command()
def modes(
    source: SceneOnly,
    output: Output = None,
    json: JsonFile = None,
    plot: Pictures = False,
    report: Report = False,
    set_: Overrides = None,
    allow_system: AllowSystem = False,
    log: Log = None,
    count: Count = None,
    range_: Annotated[
        str | None, typer.Option("--range", metavar="F1,F2", help="All between two frequencies instead.")
    ] = None,
    prestress: Annotated[
        bool, typer.Option("--prestress", help="Let the loads act before the structure vibrates.")
    ] = False,
    tolerance: Tolerance = None,
    debug: Debug = False,
) -> None:
    """Natural frequencies and modes, of plates between guaranteed bounds."""
    options: dict[str, Any] = {"count": count, "tolerance": tolerance, "prestress": prestress or None}
    if range_ is not None:
        options["range"] = _frequencies(range_)
    _eigen(source, "modes", options, output, json, plot, report, set_, allow_system, log)


@app.command()
def buckling(
    source: SceneOnly,
    output: Output = None,
    json: JsonFile = None,
    plot: Pictures = False,
    report: Report = False,
    set_: Overrides = None,
    allow_system: AllowSystem = False,
    log: Log = None,
    count: Count = None,
    debug: Debug = False,
) -> None:
    """Factors by which the loads may grow before the structure buckles, by linear theory."""
    _eigen(source, "buckling", {"count": count}, output, json, plot, report, set_, allow_system, log)


def _needs_folder(report: bool, output: Path | None) -> None:
    if report and output is None:
        raise InputError("--report needs -o DIR, the folder of report.html")


def _frequencies(text: str) -> tuple[float, ...]:
    try:
        return tuple(float(part) for part in text.split(","))
    except ValueError:
        raise InputError(f'--range "{text}": must be two frequencies, such as 0,100') from None


def _eigen(
    source: Path,
    analysis: str,
    options: dict[str, Any],
    output: Path | None,
    json: str | None,
    plot: bool,
    report: bool,
    set_: list[str] | None,
    allow_system: bool,
    log: Path | None,
) -> None:
    if not is_scene(source):
        raise InputError(f"{source}: {analysis} needs a scene file, .toml")
    begin = time.perf_counter()
    _needs_folder(report, output)
    scene = scene_of(source, {}, set_ or [])
    given = {key: value for key, value in options.items() if value is not None}
    result = _solve(scene, {**given, "analysis": analysis}, allow_system, log)
    folder = output or (Path(f"{source.stem}-result") if plot else None)
    written = [] if folder is None else result.save(folder, plots=plot, report=report)
    written += _write_json(result, json)
    if json != "-":
        from kshell.cli.terminal import print_result

        print_result(result, written, time.perf_counter() - begin)


@app.command()
def converge(
    source: SceneOnly,
    levels: Annotated[int, typer.Option(help="How many meshes, at least 3.")] = 4,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="DIR", help="Write convergence.json and convergence.png here."
        ),
    ] = None,
    set_: Overrides = None,
    allow_system: AllowSystem = False,
    debug: Debug = False,
) -> None:
    """Solve a scene on meshes that are halved: observed rates, and what the values tend to by Richardson."""
    from kshell.cli.study import save_study, study_lines, study_of

    if not is_scene(source):
        raise InputError(f"{source}: converge needs a scene file, .toml")
    found = study_of(scene_of(source, {}, set_ or []), levels, allow_system)
    for line in study_lines(found):
        typer.echo(line)
    if output is not None:
        for path in save_study(found, output):
            typer.echo(f"written: {path}")


@app.command()
def check(
    source: Source, set_: Overrides = None, allow_system: AllowSystem = False, debug: Debug = False
) -> None:
    """Say what is in a scene or mesh, what would be modelled and what is wrong; solves nothing."""
    from kshell.analysis.check import check_mesh, check_scene
    from kshell.cli.terminal import print_findings

    if is_scene(source):
        from kshell.scene.scene import Scene

        scene = Scene.load(source, set_ or [])
        found = check_scene(scene, scene.read_mesh(allow_system))
    else:
        from kshell.mesh import read_mesh

        no_overrides(source, set_ or [])
        found = check_mesh(read_mesh(source, allow_system=allow_system))
    print_findings(found)
    for words in found.problems:
        typer.echo(f"error: {words}", err=True)
    if found.problems:
        raise typer.Exit(2)


@app.command()
def sweep(
    source: SceneOnly,
    set_: Annotated[
        list[str],
        typer.Option(
            "--set",
            metavar="KEY=A..B:N|A,B",
            help="Values of a key of the scene file: N from A to B, or a list. Repeatable: all combinations.",
        ),
    ],
    csv: Annotated[Path | None, typer.Option("--csv", metavar="FILE", help="Write the rows here.")] = None,
    workers: Annotated[
        int | None, typer.Option("--workers", metavar="N", help="Processes; one per core if absent.")
    ] = None,
    allow_system: AllowSystem = False,
    log: Log = None,
    debug: Debug = False,
) -> None:
    """Solve a scene for all combinations of values of its parameters."""
    from kshell.analysis.sweep import sweep as sweep_scene
    from kshell.cli.progress import Progress
    from kshell.cli.scene_options import parameters_of
    from kshell.cli.terminal import print_sweep

    if not is_scene(source):
        raise InputError(f"{source}: sweep needs a scene file, .toml")
    scene = scene_of(source, {}, [])
    with Progress(log).shown() as progress:
        rows = sweep_scene(
            scene, parameters_of(set_), workers=workers, progress=progress, allow_system=allow_system
        )
    print_sweep(rows, [] if csv is None else [rows.save(csv)])
    if all(row["error"] for row in rows):
        raise SolveError("no point of the sweep has an answer: the reasons stand in its rows")


@app.command()
def diff(
    first: Annotated[Path, typer.Argument(metavar="DIR", help="A folder with a result.")],
    second: Annotated[Path, typer.Argument(metavar="DIR", help="Another.")],
    tolerance: Annotated[
        float | None, typer.Option(help="Exit with 1 if a relative difference is larger.")
    ] = None,
    debug: Debug = False,
) -> None:
    """Say what differs between two results."""
    from kshell.cli.terminal import print_differences
    from kshell.result.compare import differences
    from kshell.result.result import Result

    if tolerance is not None and not tolerance >= 0.0:
        raise InputError(f"--tolerance {tolerance:g}: must not be negative")
    found = differences(Result.load(first), Result.load(second))
    print_differences(found, str(first), str(second))
    if tolerance is not None and found and found[0].relative > tolerance:
        raise typer.Exit(1)


@app.command("report")
def report_(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A folder with a result.")],
    debug: Debug = False,
) -> None:
    """Write DIR/report.html, one file that needs no other: what was asked, and what was found."""
    from kshell.result.result import Result

    result = Result.load(folder)
    for path in result.report((folder if folder.is_dir() else folder.parent) / "report.html"):
        print(f"written: {path}")


@app.command()
def verify(
    quick: Annotated[bool, typer.Option("--quick", help="Each case once with each element.")] = False,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Write charts, table and an HTML page here.")
    ] = None,
    debug: Debug = False,
) -> None:
    """Run the verification cases on this machine: value, reference, error and what is allowed of each."""
    from kshell.verify import verify as run_all

    if run_all(quick, out).failed:
        raise typer.Exit(1)


def _solve(scene: Scene, options: dict[str, Any], allow_system: bool, log: Path | None = None) -> Result:
    import warnings

    from kshell.analysis.solve import solve as solve_scene
    from kshell.cli.progress import Progress

    with warnings.catch_warnings(), Progress(log).shown() as progress:
        warnings.simplefilter("ignore", KshellWarning)  # they stand in the result and are printed from it
        warnings.simplefilter("ignore", RuntimeWarning)  # overflow: what is not finite ends as a SolveError
        return solve_scene(scene, progress=progress, allow_system=allow_system, **options)


def _stepped(
    command: str,
    scene: Scene,
    folder: Path | None,
    resume: bool,
    allow_system: bool,
    log: Path | None = None,
) -> Result:
    import warnings

    from kshell.analysis import solve
    from kshell.cli.progress import Progress

    follow = {"trace": solve.trace, "simulate": solve.simulate}[command]
    with warnings.catch_warnings(), Progress(log).shown() as progress:
        warnings.simplefilter("ignore", KshellWarning)  # they stand in the result and are printed from it
        warnings.simplefilter("ignore", RuntimeWarning)  # overflow: what is not finite ends as a SolveError
        return follow(scene, folder=folder, resume=resume, progress=progress, allow_system=allow_system)


def _save_last(state: Any, folder: Path | None, plot: bool, report: bool, json: str | None) -> None:
    """The last good state of a path that was not completed, and where it is."""
    from kshell.result.result import Result

    if not isinstance(state, Result):
        return
    written = [] if folder is None else state.save(folder, plots=plot, report=report)
    for path in written + _write_json(state, json):
        print(f"written, up to the last good step: {path}", file=sys.stderr)


def _write_json(result: Result, target: str | None) -> list[str]:
    from kshell.result.saving import as_json, write_text

    if target is None:
        return []
    text = as_json(result)
    if target == "-":
        sys.stdout.write(text)
        return []
    return write_text(text, target)


def _say(message: str, debug: bool = False) -> None:
    if debug and sys.exc_info()[0] is not None:
        traceback.print_exc()
    print(f"error: {message}", file=sys.stderr)


def _short_report(kind: type[BaseException], error: BaseException, _: TracebackType | None) -> None:
    """For an error nobody foresaw: still one message, and how to see more. Python exits with code 1."""
    _say(
        f"{kind.__name__}: {error}. This is a fault of kshell: --debug shows the traceback, please report it"
    )


def run(arguments: Sequence[str]) -> int:
    """Run the command line and return its exit code."""
    debug = "--debug" in arguments
    if not debug:
        sys.excepthook = _short_report
    command = typer.main.get_command(app)
    try:
        code = command.main(list(arguments) or ["--help"], prog_name="kshell", standalone_mode=False) or 0
    except ClickException as error:
        words = error.format_message().rstrip().rstrip(".")
        if words.startswith("No such command"):
            words += f"; the commands are {', '.join(COMMANDS)}"
        _say(f"{words}. See kshell --help", debug)
        return 2
    except KshellError as error:
        _say(str(error), debug)
        return 1 if isinstance(error, SolveError) else 2
    except MemoryError:
        _say("out of memory: take a coarser mesh, element morley, or solver multigrid", debug)
        return 1
    except Interrupted as error:
        _say(f"{error}: files are written whole or not at all, --resume goes on with a path", debug)
        return INTERRUPTED
    except (KeyboardInterrupt, typer.Abort):
        code = INTERRUPTED  # depending on its version typer raises or returns
    if code == INTERRUPTED:
        _say("interrupted: files are written whole or not at all", debug)
    return int(code)


def main() -> None:
    """Entry point of the `kshell` command."""
    sys.exit(run(sys.argv[1:]))
