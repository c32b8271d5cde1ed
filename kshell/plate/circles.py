"""Pieces of a plate's edge that are arcs of circles, told by their nodes.

An ellipse has at most four points in common with a circle, so five nodes within rounding of one circle are on an arc.
Its edges are then known to rounding, where a spline through few nodes is not (1e-5 of the radius with six nodes).

Symbols
-------
theta      angle that an edge subtends, positive to the left of the way
delta(s)   arc minus chord = s (1 - s) phi(s); with the chord c a complex number
           delta = c [(exp(i theta s) - 1) / (exp(i theta) - 1) - s]
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

FEWEST = 5  # nodes that tell a circle from other conics
OFF = 1e-12  # of the radius: how far nodes may lie off the circle
COEFFICIENTS = 8  # of phi: 1e-12 of the chord for edges of 70 degrees
LARGEST_ANGLE = np.radians(100.0)


def angles_of_arc(nodes: Floats, step: int, rounding: float) -> Floats | None:
    """Angle (edge,) that each edge of a run of nodes (n, 2) subtends on its circle; None where it is no circle.

    Parameters
    ----------
    step : int
        Nodes per edge.
    rounding : float
        Of the nodes' coordinates.
    """
    closed = bool(np.abs(nodes[-1] - nodes[0]).max() <= rounding)
    different = nodes[:-1] if closed else nodes
    if len(different) < FEWEST:
        return None
    shift, size = different.mean(axis=0), np.ptp(different, axis=0).max()
    x = (different - shift) / size
    # |x|^2 = 2 c . x + r^2 - |c|^2
    system = np.concatenate([2 * x, np.ones((len(x), 1))], axis=1)
    found = np.linalg.lstsq(system, (x * x).sum(axis=1), rcond=None)[0]
    radius = np.sqrt(max(found[2] + found[:2] @ found[:2], 0.0))
    off = np.abs(np.linalg.norm(x - found[:2], axis=1) - radius).max()
    if not off <= OFF * radius + rounding / size:
        return None
    spoke = (nodes - shift) / size - found[:2]
    a, b = spoke[:-1], spoke[1:]
    between = np.arctan2(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], (a * b).sum(axis=1))
    theta: Floats = between.reshape(-1, step).sum(axis=1)
    same_way = (between > 0).all() or (between < 0).all()
    return theta if same_way and np.abs(theta).max() < LARGEST_ANGLE else None


def arc_derivatives(chord: Floats, theta: Floats) -> Floats:
    """(edge, end, first or second by s, 2) derivatives of arcs by s in [0, 1], of chords (edge, 2)."""
    c = (chord[:, 0] + 1j * chord[:, 1]) / np.expm1(1j * theta)
    turn = np.exp(1j * np.stack([np.zeros_like(theta), theta], axis=1))
    step = 1j * theta[:, None]
    found = c[:, None, None] * np.stack([step * turn, step**2 * turn], axis=2)
    return np.stack([found.real, found.imag], axis=-1)


def arc_shapes(chord: Floats, theta: Floats) -> Floats:
    """(edge, coefficient, 2) of phi, interpolated at Chebyshev points."""
    n = COEFFICIENTS
    s = 0.5 + 0.5 * np.cos(np.pi * (np.arange(n) + 0.5) / n)
    along = np.expm1(1j * theta[:, None] * s) / np.expm1(1j * theta)[:, None]
    phi = (along - s) / (s * (1 - s))
    coefficients = (
        np.linalg.solve(s[:, None] ** np.arange(n), phi.T).T * (chord[:, 0] + 1j * chord[:, 1])[:, None]
    )
    return np.stack([coefficients.real, coefficients.imag], axis=-1)
