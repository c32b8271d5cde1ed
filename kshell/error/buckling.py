"""Guaranteed lower bounds of buckling factors of plates under uniform compression, from Morley elements.

As `kshell.error.frequencies`, with gradients in place of the deflection: for membrane forces -N that are positive
semidefinite and uniform, the j-th factor f_M of the Morley element on straight triangles T gives

    f >= f_M / (1 + eps^2 f_M),      eps^2 = max_T (kappa H_T)^2 n / c_T,

n the largest principal compression and |grad (v - I v)| <= kappa H_T |D^2 (v - I v)| on T: grad (v - I v) has no mean
on the edges, so that kappa is the constant of Crouzeix and Raviart's interpolation.

Source: C. Carstensen and D. Gallistl, Numer. Math. 126 (2014) 33-51; kappa: C. Carstensen and J. Gedicke, Math. Comp.
83 (2014) 2605-2629, theorem 2.1: kappa^2 = 1/48 + 1/j^2, j = 3.8317 the first zero of the Bessel function J_1.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.error.frequencies import EPS, OPERATIONS, softest
from kshell.plate.problem import PlateProblem
from kshell.solvers.pencil import Spectrum

Floats = NDArray[np.float64]

KAPPA = float(np.sqrt(1 / 48 + 1 / 3.8317059702**2))
# relative rounding of factors from matrices of this size: entries cancel as h^-2
AMPLIFIED = 1e2


def lower_bounds(problem: PlateProblem, found: Spectrum, compression: Floats) -> Floats:
    """Of the factors of a Morley plate under uniform compression -N (2, 2)."""
    mesh = problem.mesh
    longest = mesh.edge_lengths[mesh.triangle_edges].max(axis=1)
    largest = float(np.linalg.eigvalsh(compression)[-1])
    stiffness = softest(problem.section.bending_per_triangle())
    constant = float(np.max((KAPPA * longest) ** 2 * largest / stiffness))
    rounding = OPERATIONS * EPS * AMPLIFIED * problem.reduction.count
    safe = found.values * (1.0 - rounding)
    return safe / (1.0 + constant * safe)
