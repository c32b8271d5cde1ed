"""Where methods fail, and what kshell does about it: numbers, pictures, words.

`python -m verification.failures` prints the numbers and draws the pictures anew.
"""

from verification.failures import (
    conditioning,
    corners,
    curved_support,
    discrete_curvature,
    origin,
    point_supports,
    poisson,
    thin_triangles,
)
from verification.failures.failure import Failure

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
    )
}

__all__ = ["GALLERY", "Failure"]
