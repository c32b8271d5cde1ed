"""Sharp guaranteed lower bounds of the eigenvalues of plates, after Lehmann and Goerisch.

For  a(u, v) = lambda (mu u, v),  a(u, v) = int kappa(u) . C kappa(v),  trial functions u_1 ... u_m (Argyris), and
a rough lower bound rho of lambda_{m+1} above the m-th Ritz value. The form is shifted by gamma > 0,

    A(u, v) = a(u, v) + gamma (mu u, v),        r = rho + gamma,

and Goerisch's space is that of pairs (s, g) of moments and functions with the product
(s, C^-1 s') + gamma (mu g, g'), T v = (C kappa(v), v). Pairs w_i with
(s_i, kappa(v)) + gamma (mu g_i, v) = (mu u_i, v) for all v are made from moments
sigma_i of the Hellan-Herrmann-Johnson element of order p under the load P mu u_i:

    s_i = theta_i sigma_i,    gamma mu g_i = mu u_i - theta_i P mu u_i,    theta_i = lambda_i / (lambda_i + gamma),

P the projection to polynomials of degree p - 3 in each triangle, for which div div sigma_i = P mu u_i holds exactly,
in the weak sense, on straight triangles. With

    A0 = A(u_i, u_j),  A1 = (mu u_i, u_j),
    A2 = theta_i theta_j (sigma_i, C^-1 sigma_j) + int e_i e_j / (gamma mu),    e_i = mu u_i - theta_i P mu u_i,

the negative eigenvalues nu_1 <= nu_2 <= ... of  (A0 - r A1) x = nu (A0 - 2 r A1 + r^2 A2) x  bound

    lambda_{m+1-k} >= r - r / (1 - nu_k) - gamma.

Every gamma gives a bound; the largest counts. theta takes the moments to where they belong for the shifted form.

Source: F. Goerisch and Z. He, "The determination of guaranteed bounds to eigenvalues with the use of variational
methods I", Computer Arithmetic and Self-Validating Numerical Methods, Academic Press (1990) 137-153.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kshell.elements.hierarchic import orthonormal
from kshell.elements.quadrature import triangle_rule
from kshell.plate.hhj.system import HHJSystem

Floats = NDArray[np.float64]

TRIAL_DEGREE = 5
# shifts gamma, in units of rho
SHIFTS = (1e-3, 1e-2, 0.1, 0.3, 1.0)
# gap, relative, that a rough bound must leave above the last Ritz value
GAP = 1.01


class Trial(NamedTuple):
    """Trial functions.

    Attributes
    ----------
    values : (m,) array
        Their Ritz values, ascending; zero for rigid motions.
    energy, inertia : (m, m) arrays
        a(u_i, u_j) and (mu u_i, u_j).
    at : callable
        (triangle, point, 2) places to u (m, triangle, point).
    mass : (triangle,) array
        mu, constant in each triangle.
    curvature : callable
        (triangle, point, 2) places to kappa(u) (m, triangle, point, 3).
    """

    values: Floats
    energy: Floats
    inertia: Floats
    at: Callable[[Floats], Floats]
    mass: Floats
    curvature: Callable[[Floats], Floats]


class Lower(NamedTuple):
    """Lower bounds, and where they come from.

    Attributes
    ----------
    values : (m,) array
    misfit : (m, triangle) array
        |sigma_i - C kappa(u_i) / lambda_i|^2 in the energy of each triangle, times lambda_i: its sum is about the
        relative width of the interval.
    """

    values: Floats
    misfit: Floats


def trial_count(ritz: Floats, rough: Floats, count: int) -> int | None:
    """How many trial functions to take: the most, from `count` on, below which a rough bound leaves a gap.

    Parameters
    ----------
    ritz : (n,) array
        Ritz values.
    rough : (n,) array
        Lower bounds of as many eigenvalues.
    """
    fitting = [m for m in range(count, min(len(ritz), len(rough))) if rough[m] > GAP * ritz[m - 1]]
    return max(fitting, default=None)


def lower_bounds(system: HHJSystem, trial: Trial, rho: float) -> Lower:
    """Lower bounds of the first m eigenvalues.

    Parameters
    ----------
    system : HHJSystem
        Of the same plate, on straight triangles, with the same supports.
    rho : float
        Lower bound of the eigenvalue m + 1, above the last Ritz value.
    """
    p, triangles = system.order, system.triangles
    degree = max(2 * TRIAL_DEGREE, 2 * p - 3)
    xi, weight = triangle_rule(degree)
    u = trial.at(triangles.xy(xi)) * trial.mass[:, None]  # mu u
    polynomials, basis = orthonormal(p - 3, xi), system.tables.inside(xi)
    projected = ((u * weight) @ polynomials) @ polynomials.T
    strains, slack = [], 0.0
    for load, value in zip(projected, trial.values, strict=True):
        if value == 0.0:  # a rigid motion: no moments at all
            strains.append(np.zeros(3 * system.tables.moments * len(triangles)))
            continue
        f = system.no_load()
        f.local += (load * weight * triangles.area[:, None]) @ basis
        solution = system.solve(f)
        strains.append(solution.strains.ravel())
        slack = max(slack, solution.corrections[-1])
    energies = np.array(strains) @ np.array(strains).T
    area = weight * (triangles.area / trial.mass)[:, None]
    every = [_bounds(trial, rho, shift * rho, energies, slack, u, projected, area) for shift in SHIFTS]
    misfit = _misfit(system, trial, np.array(strains).reshape(len(strains), len(triangles), 3, -1))
    return Lower(np.asarray(np.max(every, axis=0)), misfit)


def _misfit(system: HHJSystem, trial: Trial, strains: Floats) -> Floats:
    """(m, triangle) distance of moments from those of the trial functions; see `Lower`."""
    triangles, degree = system.triangles, system.order - 1
    xi, weight = triangle_rule(TRIAL_DEGREE - 2 + degree)
    kappa = trial.curvature(triangles.xy(xi))  # (m, triangle, point, 3)
    polynomials = weight[:, None] * orthonormal(degree, xi)
    scaled = system.root[:, None, None] * (system.factor @ (np.swapaxes(kappa, -1, -2) @ polynomials))
    safe = np.where(trial.values > 0, trial.values, np.inf)
    apart = strains - scaled / safe[:, None, None, None]
    return np.asarray((apart**2).sum(axis=(2, 3)) * trial.values[:, None])


def _bounds(
    trial: Trial,
    rho: float,
    gamma: float,
    energies: Floats,
    slack: float,
    u: Floats,
    projected: Floats,
    area: Floats,
) -> Floats:
    """With one shift. `slack`: relative energy error of the moments' equilibrium."""
    from scipy.linalg import LinAlgError, eigh

    theta = trial.values / (trial.values + gamma)
    rest = (u - theta[:, None, None] * projected).reshape(len(u), -1)
    a2 = theta[:, None] * energies * theta + (rest * area.ravel()) @ rest.T / gamma
    a2 = a2 + (2 * slack + slack**2) * np.diag(np.diag(a2)) * len(a2)
    r, a1 = rho + gamma, trial.inertia
    a0 = trial.energy + gamma * a1
    left, right = a0 - r * a1, a0 - 2 * r * a1 + r * r * a2
    try:
        nu = eigh(0.5 * (left + left.T), 0.5 * (right + right.T), eigvals_only=True)
    except LinAlgError:  # rounding: the trial functions say nothing with this shift
        return np.full(len(a1), -np.inf)
    below = np.where(nu < 0, r - r / (1 - np.minimum(nu, 0.0)) - gamma, -np.inf)
    return np.asarray(below[::-1])
