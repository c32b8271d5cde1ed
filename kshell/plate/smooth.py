"""Splines through the nodes of a smooth curve, of the degree that the nodes tell: 5, 7 or 9.

Through nodes h apart a spline of degree k is off by h^(k + 1), if the curve is that smooth and the nodes are close
enough. Both is seen from splines of rising degree: a higher one is taken as long as each changes the curve by a
quarter at most of what the one before it did.

Symbols
-------
s          place along an edge or an interval between nodes, in [0, 1]
delta(s)   curve minus chord = s (1 - s) phi(s); with k derivatives at both ends phi has 2 k coefficients
"""

from __future__ import annotations

from functools import lru_cache
from math import perm

import numpy as np
from numpy.typing import NDArray

from kshell.elements.quadrature import interval_rule
from kshell.plate.splines import spline_derivatives

Floats = NDArray[np.float64]

LOWEST, HIGHEST = 5, 9  # degrees
COEFFICIENTS = HIGHEST - 1  # of phi
UNEVEN = 1e-3  # relative difference of the lengths of neighbouring edges
REFITS = 2
SETTLING = 0.25  # by which each degree must change less than the one before
ALONG = 6  # points of an interval for its length


def smooth_shapes(nodes: Floats, step: int, periodic: bool) -> tuple[Floats, Floats]:
    """Derivatives by s at both ends of each edge of a smooth run of nodes, and phi: in walking direction.

    Parameters
    ----------
    nodes : (n, 2) array
        Of a closed curve the first one again at the end.
    step : int
        Nodes per edge.
    periodic : bool
        Of a closed curve without a break.

    Returns
    -------
    (edge, end, 2, 2) array
        First and second derivatives.
    (edge, coefficient, 2) array
    """
    chord = np.linalg.norm(np.diff(nodes, axis=0), axis=1)
    lowest, _, closed = _degrees(nodes, periodic)
    parameter = np.concatenate([[0.0], np.cumsum(chord)])
    uneven = len(chord) > 1 and bool((np.abs(np.diff(np.log(chord))) > UNEVEN).any())
    if uneven:
        # chords are too short by a share that grows with their length, which between long and short ones bends the
        # curve (a circle with edges of 15 degrees beside some of 1/4 by 1e-4): lengths of arcs do not
        for _ in range(REFITS):
            parameter = _lengths(parameter, nodes, lowest, closed)
    degree = settled_degree(parameter, nodes, periodic)
    if uneven and degree > lowest:
        parameter = _lengths(parameter, nodes, degree, closed)
    jets = _jets(parameter[::step], _derivatives(parameter, nodes, degree, closed)[:, ::step])
    return jets[:, :, :2], hermite(np.diff(nodes[::step], axis=0), jets)


def _degrees(nodes: Floats, periodic: bool) -> tuple[int, int, bool]:
    """The lowest and the highest degree there are nodes for, and whether the spline is periodic."""
    closed = periodic and len(nodes) > LOWEST + 1
    most = len(nodes) - 2 if closed else len(nodes) - 1
    return min(LOWEST, most - (most > 1 and most % 2 == 0)), min(most, HIGHEST), closed


def settled_degree(parameter: Floats, nodes: Floats, periodic: bool) -> int:
    """The degree up to which splines through the nodes change less and less."""
    lowest, highest, closed = _degrees(nodes, periodic)
    if highest < LOWEST + 2:
        return lowest
    chord = np.diff(nodes, axis=0)
    before, change = None, np.inf
    for degree in range(LOWEST - 2, highest + 1, 2):
        phi = hermite(chord, _jets(parameter, _derivatives(parameter, nodes, degree, closed)))
        middle = (phi * 0.5 ** np.arange(phi.shape[1])[:, None]).sum(axis=1)
        if before is not None:
            now = float(np.abs(middle - before).max())
            if now > SETTLING * change:
                return degree - 2
            change = now
        before = middle
    return degree


def _derivatives(parameter: Floats, nodes: Floats, degree: int, closed: bool) -> Floats:
    """(k, node, 2) derivatives by the parameter, k enough for polynomials of the degree between nodes."""
    return np.stack(spline_derivatives(parameter, nodes, degree, closed, max(2, (degree - 1) // 2)))


def _jets(parameter: Floats, derivatives: Floats) -> Floats:
    """(interval, end, k, 2) derivatives by s of intervals of the parameter."""
    width = np.diff(parameter)[:, None] ** np.arange(1, len(derivatives) + 1)
    at = derivatives.swapaxes(0, 1)
    return np.stack([at[:-1], at[1:]], axis=1) * width[:, None, :, None]


def _lengths(parameter: Floats, nodes: Floats, degree: int, closed: bool) -> Floats:
    """Lengths from the first node on, along the spline over a parameter."""
    chord = np.diff(nodes, axis=0)
    jets = _jets(parameter, _derivatives(parameter, nodes, degree, closed))
    phi = hermite(chord, jets)
    s, weights = interval_rule(ALONG)
    n = phi.shape[1]
    power = np.arange(n)
    # (s phi - s^2 phi)'
    by_s = (power + 1) * s[:, None] ** power - (power + 2) * s[:, None] ** (power + 1)
    speed = chord[:, None] + by_s @ phi
    return np.concatenate([[0.0], np.cumsum(np.hypot(speed[..., 0], speed[..., 1]) @ weights)])


def hermite(chord: Floats, jets: Floats) -> Floats:
    """phi (interval, 2 k, 2) of the polynomials with given derivatives (interval, end, k, 2) at both ends."""
    k = jets.shape[2]
    delta = jets.copy()
    delta[:, :, 0] -= chord[:, None]
    return np.asarray(_inverse(k) @ delta.reshape(len(chord), 2 * k, 2))


@lru_cache(maxsize=8)
def _inverse(k: int) -> Floats:
    """(2 k, 2 k) from derivatives 1 to k of delta at 0, and at 1, to coefficients of phi."""
    rows = np.zeros((2, k, 2 * k))
    for j in range(2 * k):
        for order in range(1, k + 1):
            for power, sign in ((j + 1, 1.0), (j + 2, -1.0)):
                if power == order:
                    rows[0, order - 1, j] += sign * perm(power, order)
                if power >= order:
                    rows[1, order - 1, j] += sign * perm(power, order)
    found: Floats = np.linalg.inv(rows.reshape(2 * k, 2 * k)).astype(np.float64)
    return found
