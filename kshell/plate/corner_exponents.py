"""Exponents of the deflection at corners of a plate, of any supports and stiffnesses around them.

Near a point the deflection is a smooth part and terms r^lambda f(theta) that fulfil the conditions of the edges and
lines which meet there. With lambda < 2 moments grow without bound; how fast a mesh is to be graded follows from the
least such lambda > 1. With the curvatures in polar axes

    kappa_lambda(f) = (lambda (lambda - 1) f, lambda f + f'', 2 (lambda - 1) f')

r^lambda f is in equilibrium if, for all g that fulfil what is held,

    int kappa_{2 - lambda}(g) : C(theta) kappa_lambda(f) dtheta = 0,

the condition of free edges and between stiffnesses included: a polynomial of degree 4 in s = lambda - 1, whose
eigenvalues are found with polynomials of theta in sectors of 90 degrees at most. For isotropic plates these are the
roots of Williams' equations, such as sin(s omega)^2 = s^2 sin(omega)^2 between clamped edges.

Symbols
-------
s          lambda - 1
C          bending stiffness in the axes of the polar angle
ray        an edge at the point; sectors lie between rays

Sources: M. L. Williams, Proc. 1st US Nat. Congr. Appl. Mech. (1952) 325-329; V. A. Kondratiev, Trans. Moscow Math. Soc.
16 (1967) 227-313.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kshell.elements.quadrature import interval_rule
from kshell.plate.corner_stars import Plate, Star, in_polar_axes, stars
from kshell.plate.domain import Domain

Floats = NDArray[np.float64]

BUBBLES = 7  # polynomials of a sector beside the cubics that tell value and slope at its ends
WIDEST = 0.5 * np.pi + 1e-6
RIGID = 1e-3  # of s: rotations are s = 0, found to the square root of rounding
BELOW = 1.0 - 1e-4  # of s: from here on moments are finite


def corner_exponents(
    problem: Plate, domain: Domain | None = None, among: Sequence[int] | None = None
) -> dict[int, float]:
    """Exponents lambda < 2 of the deflection by vertex: their real parts where they are complex.

    Edges that are curved in the domain, that of the problem if absent, leave along their tangents. `among`: of these
    corners alone, of all if absent. What was found is kept with what problems share that differ in loads alone.
    """
    domain = problem.domain if domain is None else domain
    known = problem.shared.get("corner exponents")
    if known is None or known[0] is not domain:
        out: dict[int, float] = {}
        for vertex, star in stars(problem, domain):
            exponent = least_exponent(star)
            if exponent < out.get(vertex, 2.0):
                out[vertex] = exponent
        known = problem.shared["corner exponents"] = domain, out
    found: dict[int, float] = known[1]
    return {v: e for v, e in found.items() if among is None or v in among}


@lru_cache(maxsize=256)
def least_exponent(star: Star) -> float:
    """The least real part of lambda in (1, 2); 2 where there is none."""
    parts: list[tuple[float, float, int]] = []  # begin, end, sector
    conditions: list[tuple[bool, bool]] = []
    begin = 0.0
    for k, angle in enumerate(star.angles):
        pieces = int(np.ceil(angle / WIDEST))
        ends = begin + angle * np.arange(pieces + 1) / pieces
        parts += [(a, b, k) for a, b in zip(ends[:-1].tolist(), ends[1:].tolist(), strict=True)]
        conditions += [(star.held[k], star.turned[k])] + [(False, False)] * (pieces - 1)
        begin += angle
    if not star.closed:
        conditions.append((star.held[-1], star.turned[-1]))
    rays, own = len(conditions), BUBBLES
    count = 2 * rays + own * len(parts)
    terms = np.zeros((5, count, count))
    for number, (a, b, k) in enumerate(parts):
        c = np.array(star.stiffness[k]).reshape(3, 3)
        last = (number + 1) % rays
        ends_of = np.array([2 * number, 2 * number + 1, 2 * last, 2 * last + 1])
        at = np.append(ends_of, 2 * rays + own * number + np.arange(own))
        terms[np.ix_(np.arange(5), at, at)] += _sector_terms(a, b, c)
    free = np.ones(count, dtype=bool)
    free[: 2 * rays] = ~np.array(conditions).ravel()
    terms = terms[:, free][:, :, free]
    n = int(free.sum())
    companion = np.zeros((4 * n, 4 * n))
    companion[: 3 * n, n:] = np.eye(3 * n)
    solved = np.linalg.solve(terms[4], terms[:4].transpose(1, 0, 2).reshape(n, 4 * n))
    companion[3 * n :] = -solved
    s = np.linalg.eigvals(companion).real
    return 1.0 + float(np.min(s, where=(s > RIGID) & (s < BELOW), initial=1.0))


def _sector_terms(begin: float, end: float, stiffness: Floats) -> Floats:
    """(5, n, n) coefficients of s^0 ... s^4 of the form on a sector, rows test functions."""
    x, w, f = _unit_functions()
    size = end - begin
    f = f / size ** np.arange(3)[:, None, None]  # (derivative, point, function)
    f[:, :, [1, 3]] *= size  # whose unknowns are slopes
    c = (
        in_polar_axes(np.broadcast_to(stiffness, (len(x), 3, 3)), begin + size * x)
        * (w * size)[:, None, None]
    )
    zero = np.zeros_like(f[0])
    trial = np.stack(  # powers of s: (power, component, point, function)
        [[zero, f[0] + f[2], zero], [f[0], f[0], 2.0 * f[1]], [f[0], zero, zero]]
    )
    test = trial * np.array([1.0, -1.0, 1.0])[:, None, None, None]
    out = np.zeros((5, f.shape[2], f.shape[2]))
    for i in range(3):
        for j in range(3):
            out[i + j] += np.einsum("apm,pab,bpn->mn", test[i], c, trial[j])
    return out


@lru_cache(maxsize=1)
def _unit_functions() -> tuple[Floats, Floats, Floats]:
    """Points and weights on [0, 1], and (3, point, 4 + BUBBLES) cubics and bubbles there with two derivatives."""
    from numpy.polynomial import Polynomial

    x, w = interval_rule(BUBBLES + 8)
    t = Polynomial([0.0, 1.0])
    cubics = [(1 - t) ** 2 * (1 + 2 * t), (1 - t) ** 2 * t, t**2 * (3 - 2 * t), t**2 * (t - 1)]
    bubbles = [16 * (t * (1 - t)) ** 2 * (2 * t - 1) ** k for k in range(BUBBLES)]
    table = [[f.deriv(m)(x) if m else f(x) for f in cubics + bubbles] for m in range(3)]
    return x, w, np.array(table).transpose(0, 2, 1)
