"""Strain energies that are infinite: of moments at points, under which thin plates and shells bend like 1 / r."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kshell.mesh.words import place
from kshell.scene.loads import PointMoment
from kshell.scene.structure import Structure


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
