"""From a scene to its result: read the mesh, choose the model, solve."""

from __future__ import annotations

import os
import time
import warnings
from collections.abc import Callable
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

from kshell.analysis.cases import answer_cases
from kshell.analysis.clock import Clock
from kshell.analysis.run import Run
from kshell.distributed.refuse import require_parted
from kshell.distributed.team import team_of
from kshell.errors import InputError, Interrupted, KshellWarning, SolveError
from kshell.mesh.mesh import Mesh
from kshell.mesh.words import shown
from kshell.result.result import Result
from kshell.scene.options import SolveOptions
from kshell.scene.scene import Scene
from kshell.scene.structure import resolve


def trace(
    scene: Scene,
    *,
    folder: str | os.PathLike[str] | None = None,
    resume: bool = False,
    progress: Callable[[str], None] | None = None,
    allow_system: bool = False,
    **options: Any,
) -> Result:
    """Large deflections under loads that grow from zero to their full size, through limit points.

    Parameters
    ----------
    scene : Scene
    folder : path, optional
        Each converged step is written there, whole; see `resume`.
    resume : bool
        Go on after the last step in the folder, with the path that would have come without the interruption.
    progress, allow_system, **options :
        As for `solve`; words after each step, too.

    Returns
    -------
    Result
        Of the last state, with its `path` and the `critical` points on it.

    Raises
    ------
    InputError
        As `solve`, and if the steps in the folder belong to another problem.
    SolveError
        If the load cannot grow to its full size; its `state` is the Result of the last good step.
    """
    if resume and folder is None:
        raise InputError("resume = True needs the folder with the steps to go on from")
    return answer(scene, {**options, "analysis": "path"}, progress, folder, resume, allow_system)


def simulate(
    scene: Scene,
    *,
    folder: str | os.PathLike[str] | None = None,
    resume: bool = False,
    progress: Callable[[str], None] | None = None,
    allow_system: bool = False,
    **options: Any,
) -> Result:
    """Motion in time, from rest or an initial velocity, under loads and prescribed motions that may depend on t.

    Parameters
    ----------
    scene : Scene
        Its material has a density.
    folder : path, optional
        Each state kept is written there, whole; see `resume`.
    resume : bool
        Go on after the last state in the folder, with the motion that would have come without the interruption.
    progress, allow_system, **options :
        As for `solve`; time, step, scheme, output and ramp belong here.

    Returns
    -------
    Result
        Of the end, with its `history`, and the states before in `series`.

    Raises
    ------
    InputError
        As `solve`, and if the states in the folder belong to another motion.
    SolveError
        If the motion cannot go on; its `state` is the Result of the last good step.
    """
    if resume and folder is None:
        raise InputError("resume = True needs the folder with the states to go on from")
    return answer(scene, {**options, "analysis": "dynamic"}, progress, folder, resume, allow_system)


def modes(
    scene: Scene,
    *,
    progress: Callable[[str], None] | None = None,
    allow_system: bool = False,
    **options: Any,
) -> Result:
    """Natural frequencies and modes.

    Parameters
    ----------
    scene : Scene
        Its material has a density; its loads act with prestress = True only.
    progress, allow_system, **options :
        As for `solve`; count, range, prestress and tolerance belong here.

    Returns
    -------
    Result
        With `eigen`, ascending, and the fields mode_1, mode_2, ...

    Raises
    ------
    InputError
        If the scene or an option is wrong, or there are fewer modes than asked for.
    SolveError
        If no answer was reached.
    """
    return answer(scene, {**options, "analysis": "modes"}, progress, allow_system=allow_system)


def buckling(
    scene: Scene,
    *,
    progress: Callable[[str], None] | None = None,
    allow_system: bool = False,
    **options: Any,
) -> Result:
    """Factors by which the loads may grow before the structure buckles, by linear theory.

    Parameters
    ----------
    scene : Scene
        Loads with `fixed` do not grow.
    progress, allow_system, **options :
        As for `solve`; count belongs here.

    Returns
    -------
    Result
        With `eigen`, ascending in size, and the fields mode_1, mode_2, ...; negative factors belong to reversed loads.

    Raises
    ------
    InputError
        If the scene or an option is wrong.
    SolveError
        If nothing buckles.
    """
    return answer(scene, {**options, "analysis": "buckling"}, progress, allow_system=allow_system)


def solve(
    scene: Scene,
    *,
    progress: Callable[[str], None] | None = None,
    allow_system: bool = False,
    **options: Any,
) -> Result:
    """Deflection, moments and reactions of a plate or shell under static loads.

    Parameters
    ----------
    scene : Scene
    progress : function, optional
        Called with the name of each stage as it begins: read, assemble, solve, recover.
    allow_system : bool
        Whether geometry files may run programs and write files, which gmsh's language can; they are refused otherwise.
    **options
        The keys of [solve] in a scene file: analysis, model, element, order, large_deflection, solver,
        steps. They take precedence over those of the scene.

    Returns
    -------
    Result
        Its warnings are issued as Python warnings of class KshellWarning, too.

    Raises
    ------
    InputError
        If the scene, its mesh or an option is wrong; nothing was solved.
    SolveError
        If no answer was reached; of large deflections its `state` is the Result of the last good load step.
    """
    return answer(scene, options, progress, allow_system=allow_system)


def answer(
    scene: Scene,
    options: dict[str, Any],
    progress: Callable[[str], None] | None = None,
    folder: str | os.PathLike[str] | None = None,
    resume: bool = False,
    allow_system: bool = False,
) -> Result:
    """The result of the analysis that the options of a scene name: what `solve`, `trace` and their kind stand on.

    The module of the analysis is found by its name in kshell.analysis, and has `analyse(model, run) -> Result`.

    Parameters
    ----------
    options : dict
        Keys of [solve], which take precedence over those of the scene.
    progress, folder, resume, allow_system :
        As for `trace`.

    Raises
    ------
    InputError, SolveError, Interrupted
        As `solve` and `trace`.
    """
    if not isinstance(scene, Scene):
        raise InputError(f"{shown(scene)} is not a scene: make one with ks.Scene(...) or ks.Scene.load(path)")
    chosen = scene.solve.updated(**options)
    team = team_of(chosen.solver)

    def read() -> Mesh:
        return scene.read_mesh(allow_system)

    if team is None:
        result = _analysed(scene, chosen, progress, read, folder, resume, allow_system)
    else:
        from kshell.distributed.leading import answered

        require_parted(scene, chosen, resume)
        # states are not kept on the way
        result = answered(team, lambda: _analysed(scene, chosen, progress, read, allow_system=allow_system))
    for words in result.warnings:
        warnings.warn(words, KshellWarning, stacklevel=3)  # at the call of `solve` or `trace`
    return result


def _analysed(
    scene: Scene,
    options: SolveOptions,
    progress: Callable[[str], None] | None,
    read: Callable[[], Mesh],
    folder: str | os.PathLike[str] | None = None,
    resume: bool = False,
    allow_system: bool = False,
) -> Result:
    """The result of an analysis; `read` gives the mesh."""
    if progress is not None:
        progress("read")
    begin = time.perf_counter()
    structure = resolve(scene, read(), options.analysis == "dynamic", options.looks, options.without_errors)
    clock = Clock(progress, time.perf_counter() - begin)
    kept = None if folder is None else Path(folder)
    run = Run(scene, structure, options, clock, progress, kept, resume, allow_system=allow_system)
    analyse = import_module(f"kshell.analysis.{_module(scene, options)}").analyse
    try:
        result: Result = answer_cases(run, analyse) if scene.cases else analyse(run.model(), run)
    except (SolveError, Interrupted) as error:
        if isinstance(error.state, Result):
            _of_scene(error.state, scene)
        raise
    return _of_scene(result, scene)


def _module(scene: Scene, options: SolveOptions) -> str:
    """The module of an analysis; static ones are three."""
    if options.analysis != "static":
        return options.analysis
    if scene.contact is not None:
        return "touching"
    return "static" if options.tolerance is None else "refined"


def _of_scene(result: Result, scene: Scene) -> Result:
    """The result and those of its path, with what was solved."""
    result.scene = scene
    result.series = [(factor, partial(_made, make, scene)) for factor, make in result.series]
    return result


def _made(make: Callable[[], Result], scene: Scene) -> Result:
    return _of_scene(make(), scene)
