"""What is in a scene and what is wrong with it, without solving: the work of `kshell check`."""

from __future__ import annotations

from dataclasses import dataclass, field

from kshell.analysis.cost import cost_lines
from kshell.analysis.model_choice import choose_model
from kshell.analysis.models import as_analysed, model_as
from kshell.analysis.sense import BENDING
from kshell.errors import InputError
from kshell.mesh import Mesh, check
from kshell.mesh.check import Quality, Summary
from kshell.mesh.words import place
from kshell.scene.scene import Scene
from kshell.scene.structure import problems, resolve

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
    cost : list of str
        What a solve would take, where that is asked for.
    warnings : list of str
        Worth knowing; does not stop a solve.
    problems : list of str
        Each would stop a solve.
    """

    summary: Summary
    quality: Quality
    model: list[str] = field(default_factory=list)
    cost: list[str] = field(default_factory=list)
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


def check_scene(scene: Scene, mesh: Mesh, cost: bool = False) -> Findings:
    """What would be modelled, and everything that would stop a solve; with `cost` what a solve would take."""
    found = check_mesh(mesh)
    moving = scene.solve.analysis == "dynamic"
    found.problems += problems(scene, mesh, moving)
    if found.problems:
        return found
    try:
        structure = resolve(scene, mesh, moving, scene.solve.looks)
        if moving:
            structure = structure.at_time(0.0)
        choice = choose_model(structure, scene.solve)
        model = model_as(as_analysed(structure, choice, scene.solve), choice)
    except InputError as error:
        found.problems.append(str(error))
        return found
    found.model = [*model.reasons, f"{model.unknowns} unknowns, {_regime(scene, model.kind)}"]
    still = "there is no load"  # its own affair where loads do not act
    if cost:
        found.cost = cost_lines(model)
    found.warnings.extend(
        words
        for words in model.warnings()
        if scene.solve.analysis not in BENDING or not words.startswith(still)
    )
    return found


def _regime(scene: Scene, kind: str) -> str:
    options = scene.solve
    if options.analysis in ("modes", "buckling", "response"):
        return {"modes": "natural frequencies", "buckling": "linear buckling", "response": "harmonic loads"}[
            options.analysis
        ]
    moving = options.analysis == "dynamic" and options.large_deflection is not False and kind == "shell"
    if options.large_asked or moving or scene.contact is not None:
        return "large deflections"
    if options.analysis == "dynamic":
        return "small deflections"
    return "small deflections" + (
        "" if options.large_deflection is False else ", large ones where they matter"
    )
