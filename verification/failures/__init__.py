"""Where methods fail, and what kshell does about it: numbers, pictures, words.

`python -m verification.failures` prints the numbers and draws the pictures anew.
"""

from functools import cache

from verification.failures import (
    averages,
    conditioning,
    corners,
    crease,
    curved_support,
    discrete_curvature,
    frozen_shape,
    hinges,
    known_bending,
    locking,
    newton,
    origin,
    point_supports,
    poisson,
    richardson,
    rounding,
    textbook,
    thin_triangles,
    time_steps,
)
from verification.failures.failure import Failure, Numbers

GALLERY: dict[str, Failure] = {
    module.FAILURE.id: module.FAILURE
    for module in (
        origin,
        curved_support,
        thin_triangles,
        corners,
        poisson,
        conditioning,
        point_supports,
        discrete_curvature,
        locking,
        newton,
        time_steps,
        textbook,
        hinges,
        known_bending,
        crease,
        averages,
        frozen_shape,
        richardson,
        rounding,
    )
}


@cache
def measured(id: str, quick: bool) -> Numbers:
    """The numbers of an entry, measured once."""
    return GALLERY[id].measure(quick)


__all__ = ["GALLERY", "Failure", "measured"]
