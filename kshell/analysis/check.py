"""What is in a scene and what is wrong with it, without solving: the work of `kshell check`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

from kshell.analysis.model_choice import choose_model
from kshell.errors import InputError
from kshell.material.section import shell_section
from kshell.mesh import Mesh, check
from kshell.mesh.check import Quality, Summary
from kshell.mesh.words import place
from kshell.scene.checking import check_load, check_support
from kshell.scene.on_chart import mesh_in_space
from kshell.scene.options import SolveOptions
from kshell.scene.scene import Scene

# below this angle a triangle spoils the accuracy around it
SLIVER = 5.0


@dataclass
class Findings:
    """What a check found.

    Attributes
    ----------
    summary, quality : of the mesh
    model : list of str
        What would be modelled and why; empty for a mesh alone.
    warnings : list of str
        Worth knowing; does not stop a solve.
    problems : list of str
        Each would stop a solve.
    """

    summary: Summary
    quality: Quality
    model: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)


def check_mesh(mesh: Mesh) -> Findings:
    """Groups, sizes and quality of a mesh."""
    found = Findings(check.summary(mesh), check.quality(mesh))
    found.warnings.extend(mesh.notes)
    worst = found.quality
    if worst.min_angle < SLIVER:
        found.warnings.append(
            f"the thinnest triangle, at {place(worst.min_angle_at)}, has an angle of {worst.min_angle:.2g} degrees: "
            "accuracy suffers there; mesh with a more even size"
        )
    return found


def check_scene(scene: Scene, mesh: Mesh) -> Findings:
    """What would be modelled, and everything that would stop a solve."""
    found = check_mesh(mesh)
    space = mesh
    try:
        space = mesh_in_space(scene, mesh)
    except InputError as error:
        found.problems.append(str(error))
        return found
    _collect(found, lambda: _check_section(scene, space))
    for support in scene.supports:
        _collect(found, partial(check_support, space, support))
    for load in scene.loads:
        _collect(found, partial(check_load, space, load))
    if not found.problems:
        _collect(found, lambda: _check_model(scene, mesh, found))
    return found


def _collect(found: Findings, look: Callable[[], object]) -> None:
    """Note what is wrong and go on: a check names everything it finds."""
    try:
        look()
    except InputError as error:
        found.problems.append(str(error))


def _check_section(scene: Scene, mesh: Mesh) -> None:
    shell_section(mesh, scene.thickness, scene.material, scene.layers)


def _check_model(scene: Scene, mesh: Mesh, found: Findings) -> None:
    """Set up the model as a solve does, without assembling its matrix."""
    choice = choose_model(scene, mesh, scene.solve)
    if choice.kind == "plate":
        from kshell.plate.problem import PlateProblem, choose_element

        check.plate_problems(mesh)
        element = choose_element(scene.solve, mesh)
        plate = PlateProblem(scene, mesh, element.element)
        unknowns, words = plate.reduction.count, plate.warnings()
        found.model = [*choice.reasons, element.reason]
    else:
        from kshell.shell.problem import ShellProblem

        shell = ShellProblem(scene, mesh, choice)
        unknowns, words = shell.reduction.basis.shape[1], shell.warnings()
        found.model = list(choice.reasons)
    found.model.append(f"{unknowns} unknowns, " + _regime(scene.solve))
    found.warnings.extend(words)


def _regime(options: SolveOptions) -> str:
    if options.large_asked:
        return "large deflections"
    return "small deflections" + (
        "" if options.large_deflection is False else ", large ones where they matter"
    )
