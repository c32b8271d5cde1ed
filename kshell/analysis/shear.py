"""The shear entry of the error budget, and the warning that a plate is too thick for a theory without shear."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.model import Model, Solved
from kshell.error.modal_shear import modal_shares
from kshell.error.shear import shear_share
from kshell.result.result import Result
from kshell.scene.options import SolveOptions

Floats = NDArray[np.float64]

# fall of a frequency or of a factor from which it is told
TOLD = 0.01


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


def account_for_shear_of_modes(result: Result, model: Model, vectors: Floats, options: SolveOptions) -> None:
    """The same for frequencies, with rotary inertia, or for buckling factors: of the first and of the last of them.

    Parameters
    ----------
    vectors : (free, mode)
        Those of the result, rigid motions not among them.
    """
    if options.error == "off" or not vectors.shape[1]:
        return
    vibrates = options.analysis == "modes"
    ends = vectors[:, [0, -1]] if vectors.shape[1] > 1 else vectors
    found = modal_shares(model, ends, vibrates)
    if found[0].why_not:
        result.error["shear_why_not"] = found[0].why_not
    if found[0].share is None:
        return
    first, last = (
        None if one.share is None else one.share / (1.0 + one.share) for one in (found[0], found[-1])
    )
    result.error["budget"]["shear"] = first
    falls = [0.0 if x is None else 1.0 - (1.0 - x) ** (0.5 if vibrates else 1.0) for x in (first, last)]
    limit = TOLD if options.tolerance is None else min(TOLD, options.tolerance)
    if max(falls) <= limit:
        return
    left_out = "transverse shear and rotary inertia" if vibrates else "transverse shear"
    what = "frequency" if vibrates else "factor"
    behind = f", the last by {falls[1]:.1%}" if len(found) > 1 and falls[1] > 0.0 else ""
    thick = "too thick for this theory" if falls[0] > TOLD else "short waves"
    result.warnings.append(
        f"{thick}: {left_out}, left out, would lower the first {what} by about {falls[0]:.1%}{behind}"
    )
