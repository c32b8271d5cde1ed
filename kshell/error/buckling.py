"""Bounds and estimates of buckling factors of plates, from Morley elements and from moments in equilibrium.

Rough lower bounds. Under uniform membrane forces N that are nowhere tensile, the exact factor is at least

    f >= f_M / (1 + eps^2 f_M),

f_M the factor of the Morley element on straight triangles T, and

    eps^2 = max_T (kappa H_T)^2 n / c_T,

n the largest principal compression and |grad (v - I v)| <= kappa H_T |D^2 (v - I v)| on T: grad (v - I v) has no mean
on the edges, so that kappa is the constant of Crouzeix and Raviart's interpolation.

Moments in equilibrium. With a(u, v) = int kappa(u) . C kappa(v), b(u, v) = - int grad u . N grad v and a(u, v) =
f b(u, v), the Hellan-Herrmann-Johnson moments sigma_i under the load b(u_i, .) fulfil (sigma_i, kappa(v)) = b(u_i, v)
for all v, not only for those of the element, where div(N grad u_i) is of degree p - 3 at most and its flux through
edges of degree p - 2: p = 6 for the quintics of Argyris and constant N, p = 8 for quadratic N. What is left,

    m_i = |sigma_i - C kappa(u_i) / f_i|^2 f_i^2 / a(u_i, u_i),        in the energy of moments, (s, C^-1 s),

is the squared relative size of the residual, and so about the relative error of f_i, over the gap to the next factor
(Kato; Temple). Where b is not negative the method of Lehmann and Goerisch (`kshell.error.goerisch`) makes it a bound.

Source: C. Carstensen and D. Gallistl, Numer. Math. 126 (2014) 33-51; kappa: C. Carstensen and J. Gedicke, Math. Comp.
83 (2014) 2605-2629, theorem 2.1: kappa^2 = 1/48 + 1/j^2, j = 3.8317 the first zero of the Bessel function J_1.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kshell.elements.hierarchic import orthonormal
from kshell.elements.quadrature import triangle_rule
from kshell.error.frequencies import EPS, OPERATIONS, softest
from kshell.plate.hhj.system import HHJSystem
from kshell.plate.problem import PlateProblem
from kshell.solvers.pencil import Spectrum

Floats = NDArray[np.float64]

KAPPA = float(np.sqrt(1 / 48 + 1 / 3.8317059702**2))
# relative rounding of factors from matrices of this size: entries cancel as h^-2
AMPLIFIED = 1e2
TRIAL_DEGREE = 5
# degree of membrane forces in each triangle
FORCE_DEGREE = 2
# factors closer than this, relative, belong to one cluster, whose members share their error
CLUSTER = 1e-2


class Pressed(NamedTuple):
    """Buckling shapes as trial functions.

    Attributes
    ----------
    values : (m,) array
        Ritz values of either sign, ascending in size.
    energy, work : (m, m) arrays
        a(u_i, u_j) and b(u_i, u_j).
    flux : callable
        (triangle, point, 2) places to -N grad u (m, triangle, point, 2).
    curvature : callable
        (triangle, point, 2) places to kappa(u) (m, triangle, point, 3).
    """

    values: Floats
    energy: Floats
    work: Floats
    flux: Callable[[Floats], Floats]
    curvature: Callable[[Floats], Floats]


class Moments(NamedTuple):
    """Moments in equilibrium with the shapes.

    Attributes
    ----------
    energies : (m, m) array
        (sigma_i, C^-1 sigma_j).
    misfit : (m, triangle) array
        m_i, triangle by triangle.
    slack : float
        Relative energy error of the equilibrium.
    """

    energies: Floats
    misfit: Floats
    slack: float


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


def from_moments(system: HHJSystem, pressed: Pressed) -> Moments:
    """Moments under the loads b(u_i, .).

    Parameters
    ----------
    system : HHJSystem
        Of the same plate, on straight triangles, with the same supports.
    """
    triangles, p = system.triangles, system.order
    xi, weight = triangle_rule(p - 1 + TRIAL_DEGREE - 1 + FORCE_DEGREE)
    flux = pressed.flux(triangles.xy(xi))  # (m, triangle, point, 2)
    reference = np.einsum("tax,mtqx->mtqa", triangles.inverse, flux) * (
        weight[:, None] * triangles.area[:, None, None]
    )
    gradients = system.tables.gradients(xi)  # (point, 2, local)
    strains, slack = [], 0.0
    for load in reference:
        f = system.no_load()
        f.local += np.tensordot(load, gradients, axes=([1, 2], [0, 1]))
        solution = system.solve(f)
        strains.append(solution.strains.ravel())
        slack = max(slack, solution.corrections[-1])
    rows = np.array(strains)
    return Moments(rows @ rows.T, _misfit(system, pressed, rows), slack)


def _misfit(system: HHJSystem, pressed: Pressed, strains: Floats) -> Floats:
    triangles, degree = system.triangles, system.order - 1
    xi, weight = triangle_rule(TRIAL_DEGREE - 2 + degree)
    kappa = pressed.curvature(triangles.xy(xi))  # (m, triangle, point, 3)
    polynomials = weight[:, None] * orthonormal(degree, xi)
    scaled = system.root[:, None, None] * (system.factor @ (np.swapaxes(kappa, -1, -2) @ polynomials))
    own = strains.reshape(scaled.shape)
    values = pressed.values[:, None, None, None]
    squares = ((own - scaled / values) ** 2).sum(axis=(2, 3))
    return np.asarray(squares * (pressed.values**2 / np.diag(pressed.energy))[:, None])


def estimated(values: Floats, moments: Moments) -> Floats:
    """(m,) relative half widths: the misfit over the gap, in 1 / f, to the next factor of another cluster."""
    share, nu = moments.misfit.sum(axis=1), 1.0 / values
    out = np.empty(len(values))
    for k in range(len(values)):
        gap = np.abs(nu - nu[k]) / abs(nu[k])
        alike = gap <= CLUSTER
        # beyond the last one there may be another close by: the gap in front of it is all that is known
        out[k] = share[alike].max() / min(gap[~alike].min(initial=1.0), 1.0)
    return out


def sharp_bounds(pressed: Pressed, moments: Moments, count: int, rho: float) -> Floats:
    """(count,) lower bounds of the first factors, b not negative.

    Parameters
    ----------
    rho : float
        Lower bound of the factor behind them, above the last Ritz value.
    """
    from scipy.linalg import LinAlgError, eigh

    chosen = np.ix_(np.arange(count), np.arange(count))
    a0, a1, a2 = pressed.energy[chosen], pressed.work[chosen], moments.energies[chosen]
    a2 = a2 + (2 * moments.slack + moments.slack**2) * np.diag(np.diag(a2)) * count
    left, right = a0 - rho * a1, a0 - 2 * rho * a1 + rho**2 * a2
    try:
        nu = eigh(0.5 * (left + left.T), 0.5 * (right + right.T), eigvals_only=True)
    except LinAlgError:  # rounding: the trial functions say nothing
        return np.full(count, -np.inf)
    below = np.where(nu < 0, rho - rho / (1 - np.minimum(nu, 0.0)), -np.inf)
    return np.asarray(below[::-1])
