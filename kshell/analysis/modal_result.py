"""A result whose fields are motions, modes of vibration or buckling, with what is known about their values."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.analysis.interval import Known
from kshell.analysis.narrowing import Stage
from kshell.analysis.run import described
from kshell.equilibrium.model import Model
from kshell.result.deferred import Deferred
from kshell.result.result import Result
from kshell.scene.supports import Symmetry

Floats = NDArray[np.float64]


def modal_result(model: Model, vectors: Floats, largest_one: bool = False) -> Result:
    """A result with the fields mode_1, mode_2, ... of vectors (free, mode).

    Parameters
    ----------
    largest_one : bool
        Whether the largest displacement of each is made 1.
    """
    motions = model.expand(vectors)
    count = len(model.structure.space.points)  # the first rows; further ones of a vertex move alike
    shapes = [model.motion_fields(x)["displacement"][:count] for x in motions.T]
    if largest_one:
        shapes = [shape / (np.linalg.norm(shape, axis=1).max(initial=0.0) or 1.0) for shape in shapes]
    return Result(
        mesh=model.structure.space,
        fields={f"mode_{k}": shape for k, shape in enumerate(shapes, 1)},
        unknowns=model.unknowns,
        model={},
        title=model.structure.title,
        extremes=Deferred({}),
        warnings=[words for words in model.warnings() if not words.startswith("there is no load")],
    )


def finished(
    result: Result, stage: Stage, known: Known, reasons: list[str], warnings: list[str], why: str
) -> Result:
    """The result with notes, intervals, levels and the solver of its eigenvalues.

    Parameters
    ----------
    reasons, warnings : list of str
        Of the analysis, beside those of intervals.
    why : str
        How the values were found.
    """
    found = stage.found
    result.warnings += [*found.notes, *warnings, *known.warnings]
    if any(isinstance(placed.item, Symmetry) for placed in stage.run.structure.supports):
        result.warnings.append(
            "planes of symmetry hold the motion: modes that are not symmetric to them are left out"
        )
    if known.why_not:
        result.error["why_not"] = known.why_not
    result.error["budget"]["geometry"] = known.shape
    result.error |= {"kind": known.kind, "estimate": known.width, "levels": known.levels}
    solver = {"name": found.solver, "why": why, "iterations": found.solves}
    return described(result, stage.model, stage.run, [*reasons, *known.reasons], solver, large=False)


def entry(value: float, known: Any = None) -> dict[str, Any]:
    """One eigenvalue in a result; rigid motions have no interval."""
    out: dict[str, Any] = {"value": value, "frequency": None, "lower": None, "upper": None, "kind": "none"}
    return out if known is None else out | {"lower": known.lower, "upper": known.upper, "kind": known.kind}
