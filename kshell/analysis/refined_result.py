"""The result of meshes that were refined to a tolerance: that of the last one, with how it was reached."""

from __future__ import annotations

import time

import numpy as np

from kshell.analysis.levels import Level, Refinement
from kshell.analysis.shear import account_for_shear
from kshell.analysis.static import Answered, answer_once
from kshell.equilibrium.model import Solved
from kshell.error.assessment import ENERGY
from kshell.mesh.words import count
from kshell.result.result import Result

QUARTICS = "order 4: quartics follow a chart so closely that its shape takes no triangles of its own"
CHOICES = ("kind ", "element ", "order ", "top: ", "linear: the largest deflection")


def refined_result(loop: Refinement, first: Answered | None) -> Result:
    """The result of the last level, with how it was reached."""
    level = loop.levels[-1]
    run = level.run
    if level.answered is None:
        assert level.pair is not None
        solution, conforming = level.pair.conforming.solution, level.pair.conforming
        d = conforming.full(conforming.unknowns)
        solved = Solved(d, solution.name, solution.why, solution.iterations, solution)
        level.answered = answer_once(level.model, run, solved)
    result = level.answered.result
    found = level.assessment
    if loop.pair:
        for other in loop.levels[:-1]:
            found.intersect(other.assessment)
        wanted = loop.names or [ENERGY]
        level.half_width = max(found.relative(name) for name in wanted)
    found.document(result, run.options.quantity)
    if isinstance(level.answered.state, Solved):
        account_for_shear(result, level.answered.model, level.answered.state, run.options, found.duals)
    error = result.error
    error["levels"] = [
        {"unknowns": each.unknowns, "half_width": _finite(each.half_width), "seconds": each.seconds}
        for each in loop.levels
    ]
    tolerance = float(run.options.tolerance)
    reasons = result.model["reasons"]
    if first is not None:
        # what held this model to that of the first answer was not asked for, and the first answer has its size
        chosen_first = first.result.model["reasons"]
        reasons[:] = [
            *dict.fromkeys([*chosen_first, *(words for words in reasons if not words.startswith(CHOICES))])
        ]
        if (
            first.result.error["budget"]["large_deflection"] is not None
            and not first.result.model["large_deflection"]
        ):
            error["budget"]["large_deflection"] = first.result.error["budget"]["large_deflection"]
        result.warnings[:] = [
            *dict.fromkeys(
                [*(w for w in first.result.warnings if "times the thickness" in w), *result.warnings]
            )
        ]
    if loop.why:
        reasons[:] = [
            *(words for words in reasons if not words.startswith(("element ", "order "))),
            *loop.why,
        ]
    if loop.quartics:
        reasons[:] = [*(words for words in reasons if not words.startswith("order ")), QUARTICS]
    what = ", ".join(loop.names) if loop.names else "the energy"
    counts = (
        f"{count(len(loop.levels), 'mesh', 'meshes')}, {loop.levels[0].unknowns} to {level.unknowns} unknowns"
    )
    if loop.why_not:
        others = (loop.why_not, found.infinite, found.why_not)
        error["why_not"] = "; ".join(dict.fromkeys(part for part in others if part))
        known = f"{what} is known within {level.half_width:.1e} ({kind_of(loop, level)})"
        result.warnings.append(
            f"the tolerance of {tolerance:g} is not reached: "
            f"{known if np.isfinite(level.half_width) else what + ' has no interval'}; {loop.why_not}"
        )
    if loop.refiner.lost:
        result.warnings.append(loop.refiner.lost)
    reasons.append(f"tolerance {tolerance:g} of {what}: {counts}{_how(loop)}")
    result.cell_fields["error"] = np.sqrt(found.marks[(loop.names or [ENERGY])[0]])
    result.last_mesh = level.model.structure.parameters
    result.solver["seconds"]["refine"] = time.perf_counter() - loop.begin
    return result


def _how(loop: Refinement) -> str:
    anew = loop.refiner.remesher
    return f", {anew.path.name} meshed anew by sizes" if anew is not None and len(loop.levels) > 1 else ""


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def kind_of(loop: Refinement, level: Level) -> str:
    """What kind of interval the first quantity asked for has."""
    return level.assessment.kind((loop.names or [ENERGY])[0])
