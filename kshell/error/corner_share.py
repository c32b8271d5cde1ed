"""What estimates of plates miss beside corners where moments grow without bound.

There the deflection goes like r^lambda, 1 < lambda < 2, and triangles of size h at the corner miss the energy of all
scales below theirs: h^(2 s) of the first, s = lambda - 1, and 1 / (1 - 4^-s) times that of all. Averages of moments,
and residuals, see what changes over h. Measured on parallelograms of 4 to 288 triangles, with each pair of supports at
corners of 93 to 166 degrees and where supports change along an edge:

- Averages, orders 3 and 4: errors in energy are .2 half widths from lambda = 1.9 to 1.7, .3 at 1.5, .6 at 1.33, 1.8 at
  1.16, 4 at 1.09 and 15 at 1.03 (supported beside symmetry at 93 degrees), .17 / s and more; with 0.7 / s all are held.
- Residuals overestimate by 36 to 76 times where supports change along an edge, beside 42 to 156 elsewhere, and by 24 to
  29 where clamped arcs end; half of `SCALE` holds there.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.plate.corner_exponents import corner_exponents
from kshell.plate.domain import Domain
from kshell.plate.problem import PlateProblem

Floats = NDArray[np.float64]

AVERAGES = 0.7  # over s
RESIDUALS = 3.0  # added to 1 where s is GENTLE or less; in proportion above
GENTLE = 0.5


def of_averages(problem: PlateProblem) -> Floats:
    """(T,) factors of the squares of differences from averages."""
    return np.maximum(1.0, AVERAGES / (_exponents(problem) - 1.0))


def of_residuals(problem: PlateProblem) -> Floats:
    """(T,) factors of the squares of residuals."""
    s = _exponents(problem) - 1.0
    return np.asarray(1.0 + RESIDUALS * np.clip((1.0 - s) / GENTLE, 0.0, 1.0))


def _exponents(problem: PlateProblem) -> Floats:
    """(T,) the least lambda at the corners of each triangle; 2 where moments are finite."""
    if "least exponents" not in problem.shared:
        mesh = problem.mesh
        domain = problem.domain
        if problem.element.maxdeg < 5:  # of chords
            domain = Domain(mesh, True, domain.bent)
        at_vertex = np.full(len(mesh.points), 2.0)
        for vertex, exponent in corner_exponents(problem, domain).items():
            at_vertex[vertex] = exponent
        problem.shared["least exponents"] = at_vertex[mesh.triangles].min(axis=1)
    found: Floats = problem.shared["least exponents"]
    return found
