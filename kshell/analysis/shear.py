"""The shear entry of the error budget, and the warning that a plate is too thick for a theory without shear."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.model import Model, Solved
from kshell.error.shear import shear_share
from kshell.result.result import Result
from kshell.scene.options import SolveOptions

Floats = NDArray[np.float64]


def account_for_shear(
    result: Result, model: Model, solved: Solved, options: SolveOptions, duals: Mapping[str, Floats]
) -> None:
    """Fill in how much transverse shear would change a linear answer, and warn where that matters.

    ``duals`` of probes are those at hand. It matters beyond the tolerance, where there is one, and for plates as thick
    as one of 1/20 of its size.
    """
    probe = next(iter(result.probes), None)
    if options.quantity is not None and options.quantity != "probes":
        probe = options.quantity if options.quantity in result.probes else None
    found = shear_share(model, solved, result, probe, duals.get(probe) if probe else None)
    result.error["budget"]["shear"] = found.share
    guessed = model.structure.section.guessed_shear
    if found.share is not None and guessed:
        result.model["reasons"].append(guessed)
    if found.why_not:
        result.error["shear_why_not"] = found.why_not
    named = "the strain energy" if probe is None or found.share is None else f'the deflection of "{probe}"'
    tolerance = options.tolerance
    beyond = tolerance is not None and found.share is not None and found.share > tolerance
    if found.thick or beyond:
        result.warnings.append(found.words(named))
    if found.thick and options.model == "auto":
        result.model["reasons"].append(f"kind {model.kind}: {found.words(named)}")
