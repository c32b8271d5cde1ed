"""What is infinite, or grows with finer meshes: under moments at points, and forces at points in the plane of a shell.

Under a moment at a point plates and shells bend like 1 / r, under a force in the plane shells stretch like 1 / r: no
mesh tells the energy, nor the displacement of the force itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from kshell.equilibrium.model import Model, Solved
from kshell.error.assessment import Assessment
from kshell.mesh.words import place
from kshell.scene.loads import PointMoment
from kshell.scene.structure import Structure

if TYPE_CHECKING:  # plates need none of it
    from kshell.equilibrium.problem import State
    from kshell.error.in_plane import Pushed

LITTLE = (
    0.01  # of a value, that may be added to it by the smallest triangles that can be, and known all the same
)
SAME_PLACE = 1e-9  # of the size of the mesh


def without_infinite(
    found: Assessment, model: Model, answer: Solved | State, factors: Sequence[float] | None
) -> None:
    """Take away the intervals of what is infinite, and widen those of what grows by less than a hundredth.

    Parameters
    ----------
    found : Assessment
    model : Model
    answer : Solved or State
    factors : sequence of float, optional
        Of the loads.
    """
    found.without_energy(infinite_energy(model.structure, factors))
    if model.kind != "shell":
        return
    from kshell.error.in_plane import pushed

    places = pushed(model, answer, factors)
    if places:
        _with_growth(found, model, places)


def _with_growth(found: Assessment, model: Model, places: list[Pushed]) -> None:
    mesh = model.structure.space
    worst = max(places, key=lambda each: each.endless)
    whose, moved = ("the reaction of a support", "all") if worst.support else ("a force", "its")
    why = (
        f"{whose} at a point in the plane of the shell, {place(mesh.points[worst.vertex])}, has an infinite strain "
        f"energy, and {moved} displacements are: what a mesh gives is a number of the mesh; spread it along an edge"
    )
    if found.energy is not None:
        value = abs(found.energy.value)
        if sum(each.energy for each in places if each.endless) > LITTLE * value:
            found.without_energy(why)
        else:
            found.with_more_energy(sum(each.energy for each in places))
    for name, given in model.structure.probes.items():
        if name not in found.probes:
            continue
        at = np.asarray(given, dtype=float)
        here = [
            each
            for each in places
            if each.support or np.linalg.norm(mesh.points[each.vertex] - at) <= SAME_PLACE * mesh.size
        ]
        grows, endless = (
            float(sum(getattr(each, key) for each in here)) for key in ("displacement", "endless")
        )
        if endless > LITTLE * float(np.linalg.norm(found.probes[name].value)):
            found.without_probe(name, why)
        elif grows:
            found.with_more(name, grows)


def infinite_energy(structure: Structure, factors: Sequence[float] | None) -> str:
    """Why the strain energy under the loads, (load,) times factors, is infinite, in words; empty if it is not.

    With moments like 1 / r around the point, its density is like 1 / r^2 and the energy within r like log r. A moment
    on the point of a rigid link acts along all of what this ties.
    """
    for k, load in enumerate(structure.loads):
        acts = factors is None or factors[k] != 0.0
        if not acts or not isinstance(load.item, PointMoment) or load.place is None or load.link:
            continue
        at = load.places(structure.space)
        if load.depends_on_time or np.any(load.item.at(at)):
            return (
                f"the strain energy under a moment at a point, {place(at[0])}, is infinite: what a mesh gives is a "
                "number of the mesh; take a probe, or spread the moment along an edge or by a rigid link"
            )
    return ""
