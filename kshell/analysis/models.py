"""From a resolved scene to the model that is chosen for it: the one place that knows all models."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from kshell.analysis.model_choice import ModelChoice, choose_model
from kshell.analysis.sense import BENDING, at_rest_first, shaking
from kshell.distributed.refuse import refuse_model
from kshell.distributed.team import Team, team_of
from kshell.equilibrium.model import Model
from kshell.scene.options import SolveOptions
from kshell.scene.scene import Scene
from kshell.scene.structure import Structure, resolve

# analyses of elastic materials, whatever they remember of their past
ELASTIC = ("modes", "buckling", "response")
# analyses of what no support holds: it may move as a rigid body
MOVABLE = ("modes", "dynamic")


def build_model(structure: Structure, options: SolveOptions) -> Model:
    """The model that options ask for, with the imperfection of the structure.

    Raises
    ------
    InputError
        If options contradict each other or the structure, or the structure does not fit or is not held.
    SolveError
        If there is no such buckling mode for the imperfection.
    """
    if options.analysis == "dynamic":
        structure = structure.at_time(0.0)
    choice = choose_model(structure, options)
    choice = replace(choice, reasons=(*choice.reasons, *structure.notes))
    team = team_of(options.solver)
    analysed = as_analysed(structure, choice, options)
    model = model_as(analysed, choice) if team is None else model_of_team(team, analysed, choice)
    if structure.imperfection is None:
        return model
    from kshell.shell.koiter.imperfection import imperfect

    return imperfect(model)


def as_analysed(structure: Structure, choice: ModelChoice, options: SolveOptions) -> Structure:
    """The structure with the supports and loads that the analysis takes of it.

    Raises
    ------
    InputError
        If loads in its plane push a flat shell away.
    """
    if options.analysis in ELASTIC:
        structure = replace(structure, elastic=True)
    if options.analysis in MOVABLE and not options.prestress:
        structure = replace(structure, movable=True)
    if choice.kind == "plate" and options.analysis in BENDING:
        return bending_only(structure)
    if choice.kind == "plate" and at_rest_first(options):
        return shaking(structure)
    if flat_under_load(structure, options):
        from kshell.analysis.membrane import held_in_plane

        return held_in_plane(structure)
    return structure


def flat_under_load(structure: Structure, options: SolveOptions) -> bool:
    """Whether a flat shell is to be stressed in its plane before it buckles or vibrates."""
    prestressed = (options.analysis in BENDING and options.prestress) or at_rest_first(options)
    loaded = options.analysis == "buckling" or prestressed
    return loaded and structure.chart is None and structure.space.is_flat


def bending_only(structure: Structure) -> Structure:
    """The structure without its loads: what they do in the plane is found beside it, see `kshell.analysis.membrane`."""
    return replace(structure, loads=())


def model_as(structure: Structure, choice: ModelChoice) -> Model:
    """The model of a choice, of the shape as drawn; solves nothing."""
    if choice.kind == "plate":
        if choice.element == "hhj":
            from kshell.plate.hhj.model import HHJModel

            return HHJModel(structure, choice.order, choice.reasons)
        from kshell.plate.model import PlateModel

        return PlateModel(structure, choice.element, choice.reasons)
    if choice.element == "argyris":
        from kshell.shell.chart.model import ChartModel

        return ChartModel(structure, choice.reasons)
    from kshell.shell.koiter.model import KoiterModel

    return KoiterModel(structure, choice.order, choice.reasons)


def model_of_team(team: Team, structure: Structure, choice: ModelChoice) -> Model:
    """The same on several processes.

    Raises
    ------
    InputError
        If the model is not for several processes.
    """
    if choice.kind == "shell" and choice.element == "koiter":
        from kshell.distributed.linear import PartedKoiterModel

        return PartedKoiterModel(team, structure, choice.order, choice.reasons)
    if choice.kind == "plate" and choice.element != "hhj":
        from kshell.distributed.plate import PartedPlateModel

        return PartedPlateModel(team, structure, choice.element, choice.reasons)
    raise refuse_model(choice.kind, choice.element)


def model_of(scene: Scene, **options: Any) -> Model:
    """The model of a scene, with some of its options changed, for those who want matrices rather than results."""
    return build_model(resolve(scene, scene.read_mesh()), scene.solve.updated(**options))
