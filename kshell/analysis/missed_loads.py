"""What missed parts of loads can change: each counts by what its load does alone, however much others take of that."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.analysis.models import build_model
from kshell.analysis.run import Run
from kshell.equilibrium.model import Model
from kshell.error.assessment import Missed
from kshell.mesh.mesh import Mesh
from kshell.result.result import Result
from kshell.scene.jump_rules import rules
from kshell.scene.load import Load
from kshell.scene.placed import Placed

Floats = NDArray[np.float64]


def largest_displacement(result: Result) -> float:
    """Over all vertices."""
    return abs(float(result.extremes["deflection"]["value"]))


def missed_loads(model: Model, run: Run, size: float, energy: float) -> list[Missed]:
    """The loads and springs that change faster than they are integrated, with what each does alone.

    Two loads that nearly cancel move little, and the part that is missed of one moves as if it were alone; so do waves
    of one load. Where several act the structure is solved under each of these by itself, with small deflections, and
    with the absolute values of loads that have both signs.

    Parameters
    ----------
    size, energy : float
        The largest displacement, and the strain energy, under all loads.
    """
    structure = model.structure
    factors = np.ones(len(structure.loads)) if run.factors is None else np.array(run.factors, dtype=float)
    springs = sum(placed.missed for placed in structure.supports)
    out = [Missed(springs, size, energy)] if springs else []
    acting = np.flatnonzero(factors)
    only = len(acting) == 1 and not np.any(model.motion_vector())
    for k in acting.tolist():
        placed = structure.loads[k]
        if not placed.missed:
            continue
        one_sided = _absolute(placed, structure.space)
        if only and one_sided is None:
            out.append(Missed(placed.missed, size, energy))
            continue
        alone = model
        if one_sided is not None:
            loads = tuple(one_sided if k == j else other for j, other in enumerate(structure.loads))
            alone = build_model(replace(structure, loads=loads), run.options)
        alone = alone.under(np.where(np.arange(len(factors)) == k, factors, 0.0).tolist(), 0.0)
        result = alone.recover(alone.solve(run.options.solver))
        most = max(size, largest_displacement(result)), max(energy, result.strain_energy)
        out.append(Missed(placed.missed, *most))
    return out


def _absolute(placed: Placed[Load], space: Mesh) -> Placed[Load] | None:
    """A load with the absolute values of its components, where one has both signs; else None."""
    load: Any = placed.item
    if load.needs_normal or load.scaling != ("value",):
        return None
    members = placed.members(space)
    cells = space.triangles if placed.place is None or placed.place.dimension == 2 else space.edges
    at = space.points[cells[members]]
    rule = rules(at.shape[1])[1][0]
    values = load.at(np.einsum("qb,nbi->nqi", rule, at).reshape(-1, 3))
    values = values.reshape(len(values), -1)
    if not ((values > 0.0).any(axis=0) & (values < 0.0).any(axis=0)).any():
        return None

    def value(x: Floats, y: Floats, z: Floats) -> Floats:
        return np.abs(load.at(np.stack([x, y, z], axis=-1))).T

    return replace(placed, item=replace(load, value=value))
