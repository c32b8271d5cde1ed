"""From a scene to its result: read the mesh, choose the model, solve."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable
from typing import Any

from kshell.checking import check_load, check_support
from kshell.errors import InputError, KshellWarning
from kshell.modelling import choose_model
from kshell.on_chart import mesh_in_space
from kshell.result import Result
from kshell.scene import Scene


def solve(scene: Scene, *, progress: Callable[[str], None] | None = None, **options: Any) -> Result:
    """Deflection, moments and reactions of a plate or shell under static loads.

    Parameters
    ----------
    scene : Scene
    progress : function, optional
        Called with the name of each stage as it begins: read, assemble, solve, recover.
    **options
        The keys of [solve] in a scene file: analysis, model, element, order, large_deflection, solver. They
        take precedence over those of the scene.

    Returns
    -------
    Result
        Its warnings are issued as Python warnings of class KshellWarning, too.

    Raises
    ------
    InputError
        If the scene, its mesh or an option is wrong; nothing was solved.
    SolveError
        If no answer was reached.
    """
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
    solve_model: Any
    if choice.kind == "plate":
        from kshell.plate import solve_plate as solve_model
    else:
        from kshell.shell.model import solve_shell as solve_model
    result: Result = solve_model(scene, mesh, chosen, progress, read_seconds=read_seconds)
    result.scene = scene
    for words in result.warnings:
        warnings.warn(words, KshellWarning, stacklevel=2)
    return result
