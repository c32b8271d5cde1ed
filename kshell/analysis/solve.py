"""From a scene to its result: read the mesh, choose the model, solve."""

from __future__ import annotations

import math
import os
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

from kshell.analysis.model_choice import choose_model
from kshell.errors import InputError, Interrupted, KshellWarning, SolveError
from kshell.mesh.mesh import Mesh
from kshell.result.result import Result
from kshell.scene.checking import check_load, check_support
from kshell.scene.on_chart import mesh_in_space
from kshell.scene.options import TOLERANCE, SolveOptions
from kshell.scene.scene import Scene
from kshell.scene.supports import SimplySupported

# deflection over thickness up to which no plate stretches by as much as matters
SMALL = 0.07
# larger plates are not taken for shells without being asked
MOST_TRIANGLES = 20_000
# deflection over the size of the plate from which the scene is a matter of scale, not of large deflections
ABSURD = 10.0


def trace(
    scene: Scene,
    *,
    folder: str | os.PathLike[str] | None = None,
    resume: bool = False,
    progress: Callable[[str], None] | None = None,
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
    progress, **options :
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
    result = _solve(scene, progress, {**options, "analysis": "path"}, folder, resume)
    return _warned(result)


def solve(scene: Scene, *, progress: Callable[[str], None] | None = None, **options: Any) -> Result:
    """Deflection, moments and reactions of a plate or shell under static loads.

    Parameters
    ----------
    scene : Scene
    progress : function, optional
        Called with the name of each stage as it begins: read, assemble, solve, recover.
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
    return _warned(_solve(scene, progress, options))


def _warned(result: Result) -> Result:
    for words in result.warnings:
        warnings.warn(words, KshellWarning, stacklevel=3)
    return result


def _solve(
    scene: Scene,
    progress: Callable[[str], None] | None,
    options: dict[str, Any],
    folder: str | os.PathLike[str] | None = None,
    resume: bool = False,
) -> Result:
    if not isinstance(scene, Scene):
        raise InputError(f"{scene!r} is not a scene: make one with ks.Scene(...) or ks.Scene.load(path)")
    chosen = scene.solve.updated(**options)
    if progress is not None:
        progress("read")
    begin = time.perf_counter()
    mesh = scene.read_mesh()
    space = mesh_in_space(scene, mesh)
    for support in scene.supports:
        check_support(space, support)
    for load in scene.loads:
        check_load(space, load)
    choice = choose_model(scene, mesh, chosen)
    read_seconds = time.perf_counter() - begin
    try:
        if choice.kind == "plate":
            from kshell.plate import solve_plate

            result = solve_plate(scene, mesh, chosen, progress, read_seconds, choice.reasons)
            result = _large_where_it_matters(scene, mesh, chosen, result, progress)
        else:
            from kshell.shell.model import solve_shell

            where = None if folder is None else Path(folder)
            result = solve_shell(scene, mesh, chosen, progress, read_seconds, where, resume)
    except (SolveError, Interrupted) as error:
        if isinstance(error.state, Result):
            error.state.scene = scene
        raise
    if chosen.tolerance is not None:
        result.warnings.append(
            f"tolerance = {chosen.tolerance:g} decides about large deflections only: the mesh is solved as given"
        )
    result.scene = scene
    return result


def _large_where_it_matters(
    scene: Scene, mesh: Mesh, options: SolveOptions, plate: Result, progress: Callable[[str], None] | None
) -> Result:
    """The plate, or where its deflection is not small against the thickness what large deflections make of it.

    A clamped circular plate with an immovable edge deflects less by about 0.47 (w / t)^2 of w, a simply supported one
    by 1.85 (w / t)^2 (Timoshenko & Woinowsky-Krieger, chapter 13): below SMALL that is less than 1 percent. Plates
    free to move in their plane stretch less, which the shell tells.

    A simple support of a plate says nothing of motion in its plane, that of a shell forbids it: as this decides how
    much stiffer the plate gets, it is the user's to say, and the plate is warned of instead.
    """
    thickness = float(plate.cell_fields["thickness"].max())
    ratio = abs(plate.extremes["deflection"]["value"]) / thickness
    words = f"the largest deflection is {ratio:.2g} times the thickness"
    small = SMALL * math.sqrt(options.large_tolerance / TOLERANCE)  # the change grows with its square
    if ratio <= small or options.large_deflection is False:
        plate.model["reasons"].append(f"linear: {words}")
        return plate
    doubt = f"{words}: where the supports hinder it from moving in its plane it stretches and gets stiffer"
    asked = options.model == "plate" or options.element != "auto"
    ambiguous = any(isinstance(support, SimplySupported) for support in scene.supports)
    if ambiguous:
        doubt += f" (a disk so supported all around would deflect by {_held_in_plane(ratio):.0%} of that)"
    absurd = ratio * thickness > ABSURD * mesh.size
    if asked or ambiguous or absurd or len(mesh.triangles) > MOST_TRIANGLES:
        plate.model["reasons"].append(f"linear: {doubt}")
        plate.warnings.append(
            f'{doubt}; large_deflection = true computes that (with model and element "auto"), large_deflection = false '
            "keeps the linear plate without this warning"
        )
        return plate
    from kshell.shell.model import solve_shell

    shell = solve_shell(scene, mesh, options.updated(model="shell"), progress)
    if shell.model["large_deflection"]:
        shell.model["reasons"][0] = f"kind shell: {words}"
        return shell
    plate.model["reasons"] += [f"linear: {words}", *(r for r in shell.model["reasons"] if "linear" in r)]
    return plate


def _held_in_plane(ratio: float) -> float:
    """Share of the linear deflection of a simply supported disk whose edge cannot move in its plane.

    The real root s of s + 1.85 ratio^2 s^3 = 1, after Timoshenko & Woinowsky-Krieger, chapter 13.
    """
    k = 1.85 * ratio**2
    half = math.sqrt(0.25 / k**2 + 1 / (27 * k**3)) + 0.5 / k
    return math.cbrt(half) - 1 / (3 * k * math.cbrt(half))
