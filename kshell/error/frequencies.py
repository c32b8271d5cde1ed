"""Guaranteed lower bounds of the eigenvalues of plates, from Morley elements.

With the j-th eigenvalue lambda_M of the Morley element on straight triangles T, the exact one is

    lambda >= lambda_M / (1 + eps^2 lambda_M),      eps^2 = max_T (kappa H_T^2)^2 mu_T / c_T,

H_T the longest side, mu_T the largest mass per area, and c_T the smallest ratio of the bending energy density to the
square of the second derivatives, constant in each triangle. kappa is the constant of the Morley interpolation I,
|v - I v| <= kappa H_T^2 |D^2 (v - I v)| on T.

Source: C. Carstensen and D. Gallistl, "Guaranteed lower eigenvalue bounds for the biharmonic equation", Numer. Math.
126 (2014) 33-51, theorems 1 and 2; there mu = c = 1. The proof takes local weights as they stand: I is orthogonal in
the energy of every triangle where the bending stiffness is constant. It holds for clamped, supported, symmetric and
free edges.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.mesh import Mesh
from kshell.plate.problem import PlateProblem
from kshell.plate.vibration import energy_rounding
from kshell.solvers.pencil import Pencil, Spectrum

Floats = NDArray[np.float64]

KAPPA = 0.2574  # of Carstensen and Gallistl
EPS = float(np.finfo(float).eps)
# operations that meet in an entry of a matrix and in its products, in units of rounding
OPERATIONS = 16


def interpolation_constant(mesh: Mesh, bending: Floats, mass: Floats) -> float:
    """eps^2 of a straight plane mesh.

    Parameters
    ----------
    bending : (triangle, 3, 3)
        D on (w_xx, w_yy, 2 w_xy).
    mass : (triangle,)
        Largest mass per area.
    """
    longest = mesh.edge_lengths[mesh.triangle_edges].max(axis=1)
    return float(np.max((KAPPA * longest**2) ** 2 * mass / softest(bending)))


def softest(bending: Floats) -> Floats:
    """(triangle,) smallest kappa . D kappa / |D^2 w|^2, with |D^2 w|^2 = w_xx^2 + w_yy^2 + 2 w_xy^2."""
    # kappa = S (w_xx, w_yy, sqrt(2) w_xy), S = diag(1, 1, sqrt(2))
    s = np.diag([1.0, 1.0, np.sqrt(2.0)])
    return np.asarray(np.linalg.eigvalsh(s @ bending @ s)[..., 0], dtype=float)


def lower_bounds(values: Floats, rounding: Floats, constant: float) -> Floats:
    """Bounds from the values of the Morley element, their relative rounding taken off first."""
    safe = values * (1.0 - rounding)
    return safe / (1.0 + constant * safe)


def rounding(pencil: Pencil, found: Spectrum) -> Floats:
    """(mode,) relative distance of computed values from the eigenvalues of the matrices, and of these from exact ones.

    The residual r = lambda M x - K x bounds the distance to the next eigenvalue by (r . K^-1 r / x . K x)^(1/2)
    (with K + shift M in place of K for free structures); entries of matrices are sums of OPERATIONS rounded terms.
    """
    k, m, shift = pencil.stiffness, pencil.mass, found.shift
    x = found.vectors
    if shift:
        k = (k + shift * m).tocsr()
    values = found.values + shift
    energy = (x * (k @ x)).sum(axis=0)
    entries = (np.abs(x) * (abs(k) @ np.abs(x))).sum(axis=0) / energy
    entries += (np.abs(x) * (abs(m) @ np.abs(x))).sum(axis=0) / (x * (m @ x)).sum(axis=0)
    out = OPERATIONS * EPS * entries
    if found.solve is not None:
        r = (m @ x) * values - k @ x
        work = np.array([float(c @ found.solve(c)) for c in r.T])
        out = out + np.sqrt(np.abs(work) / energy)
    return out


def evaluation(problem: PlateProblem, weight: Any, vectors: Floats) -> Floats:
    """(mode,) relative rounding of Ritz values of quintics, whose energies are formed through curvatures.

    Parameters
    ----------
    weight : (free, free) matrix
        Of the other form: mass, or geometric stiffness.
    """
    x, unit = vectors, OPERATIONS * EPS
    terms = (np.abs(x) * (abs(weight) @ np.abs(x))).sum(axis=0) / np.abs((x * (weight @ x)).sum(axis=0))
    return np.asarray(energy_rounding(problem, x, unit) + unit * terms)
