"""What triangles remember of their past, beside the directors of their edges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kshell.shell.koiter.edges import Directors

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Remembered(Directors):
    """Directors, and strains that stay.

    Attributes
    ----------
    inelastic : (triangle, r)
        Strains at which the triangles are free of stress, beside initial ones: plastic ones, or what has crept.
    inner : (k, triangle, r)
        Of a material that yields the back stress (one); of one that relaxes the strains of its terms that have not
        relaxed yet, and the last elastic strain.
    size : (triangle,)
        Of the surface of yielding, 1 at the start.
    lost : (triangle,)
        Energy dissipated so far.
    """

    inelastic: Floats
    inner: Floats
    size: Floats
    lost: Floats


def remembering(directors: Directors, triangles: int, strains: int, inner: int) -> Remembered:
    """Of a rest state without a past."""
    return Remembered(
        directors.vectors,
        directors.base,
        directors.angle,
        np.zeros((triangles, strains)),
        np.zeros((inner, triangles, strains)),
        np.ones(triangles),
        np.zeros(triangles),
    )
