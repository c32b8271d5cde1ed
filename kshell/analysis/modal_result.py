"""A result whose fields are motions: modes of vibration or buckling."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.model import Model
from kshell.result.deferred import Deferred
from kshell.result.result import Result

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
