"""`kshell check`, `converge`, `sweep`, `diff`, `report`, `verify`: about scenes, results and kshell itself."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kshell.cli.app import command
from kshell.cli.options import (
    Debugging,
    Levels,
    Log,
    Reading,
    ResultFolder,
    Running,
    SceneOnly,
    Source,
    Trust,
    into,
    require_scene,
    watched,
)
from kshell.cli.scene_options import is_scene, no_overrides, parameters_of, scene_of
from kshell.errors import InputError, SolveError

if TYPE_CHECKING:
    from kshell.mesh import Mesh
    from kshell.scene.scene import Scene


@command()
def converge(
    source: SceneOnly,
    *,
    levels: Levels = 4,
    output: into("Write convergence.json and convergence.png here.") = None,  # type: ignore[valid-type]
    running: Running,
) -> None:
    """Solve a scene on meshes that are halved: observed rates, and what the values tend to by Richardson."""
    from kshell.analysis.converge import converge as study
    from kshell.cli.study import save_study, study_lines

    scene = running.scene(source, "converge")
    found = running.watched(
        lambda progress: study(scene, levels, progress=progress, allow_system=running.allow_system)
    )
    for line in study_lines(found):
        typer.echo(line)
    if output is not None:
        for path in save_study(found, output):
            typer.echo(f"written: {path}")


@command()
def check(
    source: Source,
    *,
    output: into("Write mesh.png here, with --plot.") = None,  # type: ignore[valid-type]
    plot: Annotated[
        bool, typer.Option("--plot", help="Draw the mesh with supports, loads, probes and names of groups.")
    ] = False,
    cost: Annotated[
        bool,
        typer.Option("--cost", help="Say what a solve takes: memory and seconds, on several processes too."),
    ] = False,
    reading: Reading,
) -> None:
    """Say what is in a scene or mesh, what would be modelled and what is wrong; solves nothing."""
    from kshell.analysis.check import check_mesh, check_scene
    from kshell.cli.findings import print_findings

    if output is not None and not plot:
        raise InputError("-o is for the picture: give --plot, too")
    if is_scene(source):
        scene = reading.scene(source, "check")
        mesh = scene.read_mesh(reading.allow_system)
        found = check_scene(scene, mesh, cost)
    else:
        from kshell.mesh import read_mesh

        no_overrides(source, reading.set_ or [])
        if cost:
            raise InputError(
                f"{source}: --cost is for scenes: a mesh alone does not say what would be solved"
            )
        scene, mesh = None, read_mesh(source, allow_system=reading.allow_system)
        found = check_mesh(mesh)
    print_findings(found)
    for words in found.problems:
        typer.echo(f"error: {words}", err=True)
    if plot:
        for path in _drawn(mesh, scene if not found.problems else None, source, output):
            typer.echo(f"written: {path}")
    if found.problems:
        raise typer.Exit(2)


def _drawn(mesh: Mesh, scene: Scene | None, source: Path, output: Path | None) -> list[str]:
    """Draw a mesh, with supports and loads where there is a scene that fits; the paths written."""
    from functools import partial

    from kshell.draw.groups import save_named
    from kshell.result.saving import write_together
    from kshell.scene.on_chart import mesh_in_space

    space = mesh if scene is None else mesh_in_space(scene.chart, mesh)
    title = source.name if scene is None or not scene.title else scene.title
    return write_together(
        output or Path(f"{source.stem}-check"), {"mesh.png": partial(save_named, space, scene, title)}
    )


@command()
def export(
    source: SceneOnly,
    file: Annotated[Path, typer.Argument(metavar="FILE.inp", help="What to write, for CalculiX.")],
    *,
    reading: Reading,
) -> None:
    """Write a scene as an input file of CalculiX, so that it can be checked there."""
    from kshell.export.inp import write_inp

    scene = reading.scene(source, "export")
    for path in write_inp(scene, file, model=scene.solve.model, allow_system=reading.allow_system):
        typer.echo(f"written: {path}")


@command()
def sweep(
    source: SceneOnly,
    *,
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
    log: Log = None,
    trust: Trust,
) -> None:
    """Solve a scene for all combinations of values of its parameters."""
    from kshell.analysis.sweep import sweep as sweep_scene
    from kshell.cli.compared import print_sweep

    require_scene(source, "sweep")
    scene, parameters = scene_of(source, {}, []), parameters_of(set_)
    rows = watched(
        lambda progress: sweep_scene(
            scene, parameters, workers=workers, progress=progress, allow_system=trust.allow_system
        ),
        log,
    )
    print_sweep(rows, [] if csv is None else [rows.save(csv)])
    if all(row["error"] for row in rows):
        raise SolveError("no point of the sweep has an answer: the reasons stand in its rows")


@command()
def diff(
    first: ResultFolder,
    second: Annotated[Path, typer.Argument(metavar="DIR", help="Another.")],
    *,
    tolerance: Annotated[
        float | None,
        typer.Option(
            help="Exit with 1 if a relative difference is larger; below 1e-9 it is taken for rounding."
        ),
    ] = None,
    debugging: Debugging,
) -> None:
    """Say what differs between two results."""
    from kshell.cli.compared import print_differences
    from kshell.result.compare import ROUNDING, differences
    from kshell.result.result import Result

    if tolerance is not None and not tolerance >= 0.0:
        raise InputError(f"--tolerance {tolerance:g}: must not be negative")
    rounding = ROUNDING if tolerance is None else min(ROUNDING, tolerance)
    found = differences(Result.load(first), Result.load(second), rounding)
    print_differences(found, str(first), str(second))
    if tolerance is not None and found and found[0].relative > tolerance:
        raise typer.Exit(1)


@command()
def report(folder: ResultFolder, debugging: Debugging) -> None:
    """Write DIR/report.html, one file that needs no other: what was asked, and what was found."""
    from kshell.result.result import Result

    result = Result.load(folder)
    for path in result.report((folder if folder.is_dir() else folder.parent) / "report.html"):
        print(f"written: {path}")


@command()
def verify(
    *,
    quick: Annotated[bool, typer.Option("--quick", help="Each case once with each element.")] = False,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Write charts, table and an HTML page here.")
    ] = None,
    debugging: Debugging,
) -> None:
    """Run the verification cases on this machine: value, reference, error and what is allowed of each."""
    from kshell.verify import verify as run_all

    if run_all(quick, out).failed:
        raise typer.Exit(1)
