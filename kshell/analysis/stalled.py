"""Why finer meshes gain nothing any more, in words."""

from __future__ import annotations

import numpy as np

from kshell.analysis.levels import Level, Refinement
from kshell.error.assessment import ENERGY
from kshell.mesh.words import place
from kshell.result.peaks import peaks

NOTHING = "further levels gain nothing: "
ROUNDING = 0.1  # of the half width, from which that of the algebra is its reason
SHAPE = 0.3  # of the half width, from which that of the shape is
STILL = 1e-9  # of the largest displacement, that is rounding
MOST = 0.5  # of what is left, that a place where stresses grow without bound has to have


def why_stalled(loop: Refinement, level: Level) -> str:
    """Rounding where that is a good part of what is left; else where most of it is left, and what grows there."""
    found, model = level.assessment, level.model
    worst = max(loop.names or [ENERGY], key=found.relative)
    budget = level.answered.result.error["budget"] if level.answered is not None else {}
    algebra = float(budget.get("algebra") or 0.0)
    if found.kind(worst) == "guaranteed" or worst not in found.parts or algebra > ROUNDING * level.half_width:
        return f"{NOTHING}rounding sets the limit"
    if worst != ENERGY and np.linalg.norm(found.probes[worst].value) <= STILL * found.size:
        return f"{NOTHING}{worst} does not move, but by rounding"
    if level.shape > SHAPE * level.half_width:
        shape = max(loop.frozen, loop.cut)
        return f"{NOTHING}the shape of the mesh is known to {shape:.1e} only: give its geometry, or a chart"
    parts, mesh = found.parts[worst], model.structure.space
    total, grows = float(parts.sum()), peaks(model.structure, model.singular())
    if grows and total > 0.0:
        vertices = np.array(list(grows))
        at_them = np.isin(mesh.triangles, vertices)
        if parts[at_them.any(axis=1)].sum() > MOST * total:
            most = max(grows, key=lambda vertex: float(parts[(mesh.triangles == vertex).any(axis=1)].sum()))
            return (
                f"{NOTHING}most of what is left is at {grows[most]} at {place(mesh.points[most])}, where stresses grow "
                "without bound"
            )
    centre = mesh.points[mesh.triangles[int(np.argmax(parts))]].mean(axis=0)
    return f"{NOTHING}what is left is largest near {place(centre)}"
