"""Pieces of a plate's edge that are arcs of circles or ellipses, told by their nodes.

An ellipse has at most four points in common with a circle or another ellipse: five nodes within rounding of one circle
are on an arc of it, and seven within rounding of one ellipse on an arc of that. Its edges are then known to rounding,
where a spline through few nodes is not (1e-5 of the radius with six nodes on a circle, with 24 on an ellipse).

Symbols
-------
theta      angle that an edge subtends, positive to the left of the way; on an ellipse where it is a circle, below
A          linear map of the plane that makes a circle of the ellipse; of circles the identity
delta(s)   arc minus chord = s (1 - s) phi(s); with the chord c of the circle, a complex number,
           A delta = c [(exp(i theta s) - 1) / (exp(i theta) - 1) - s]
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

FEWEST_ALONE, FEWEST_OF_ELLIPSES = 5, 7  # nodes that tell a circle, and an ellipse, from other curves
FEWEST_AT_JOINTS = 3  # of a circle that is known to run into its tangent
OFF = 1e-12  # of the size: how far nodes may lie off the curve
COEFFICIENTS = 10  # of phi: 1e-15 of the chord for edges of 70 degrees
CHEBYSHEV = 0.5 + 0.5 * np.cos(np.pi * (np.arange(COEFFICIENTS) + 0.5) / COEFFICIENTS)
POWERS = CHEBYSHEV[:, None] ** np.arange(COEFFICIENTS)
LARGEST_ANGLE = np.radians(100.0)
ROUND = 0.05  # determinant over squared trace of second moments, 1/4 of a whole circle: their condition is 18
LONGEST = 1e3  # ratio of the axes of an ellipse


@dataclass(frozen=True)
class Arc:
    """Edges along an arc.

    Attributes
    ----------
    theta : (edge,) array
    map : (2, 2) array
        A.
    """

    theta: Floats
    map: Floats

    @cached_property
    def circular(self) -> bool:
        """Whether it is of a circle."""
        return bool((self.map == np.eye(2)).all())

    def derivatives(self, chord: Floats) -> Floats:
        """(edge, end, first or second by s, 2) derivatives of the arcs by s in [0, 1], of chords (edge, 2)."""
        theta = self.theta
        c = self._complex(chord) / np.expm1(1j * theta)
        turn = np.exp(1j * np.stack([np.zeros_like(theta), theta], axis=1))
        step = 1j * theta[:, None]
        return self._back(c[:, None, None] * np.stack([step * turn, step**2 * turn], axis=2))

    def shapes(self, chord: Floats) -> Floats:
        """(edge, coefficient, 2) of phi, interpolated at Chebyshev points."""
        turn = 1j * self.theta[:, None]
        along = np.expm1(turn * CHEBYSHEV) / np.expm1(turn)
        phi = (along - CHEBYSHEV) / (CHEBYSHEV * (1 - CHEBYSHEV))
        found = np.linalg.solve(POWERS, phi.T).T
        return self._back(found * self._complex(chord)[:, None])

    def _complex(self, vectors: Floats) -> NDArray[np.complex128]:
        x, y = vectors.T if self.circular else (vectors @ self.map.T).T
        return np.asarray(x + 1j * y)

    def _back(self, numbers: NDArray[np.complex128]) -> Floats:
        both = np.stack([numbers.real, numbers.imag], axis=-1)
        return both if self.circular else np.asarray(both @ np.linalg.inv(self.map).T)


def arc_of(nodes: Floats, step: int, rounding: float, fewest: int = FEWEST_ALONE) -> Arc | None:
    """The arc of a circle or an ellipse that a run of nodes (n, 2) lies on; None where it lies on none.

    Parameters
    ----------
    step : int
        Nodes per edge.
    rounding : float
        Of the nodes' coordinates.
    fewest : int
        Nodes that tell a circle.
    """
    closed = bool(np.abs(nodes[-1] - nodes[0]).max() <= rounding)
    different = nodes[:-1] if closed else nodes
    if len(different) < fewest:
        return None
    shift, size = different.mean(axis=0), np.ptp(different, axis=0).max()
    x, run, near = (different - shift) / size, (nodes - shift) / size, rounding / size
    centre = _circle(x, near)
    if centre is not None:
        return _along(run - centre, step, np.eye(2))
    found = _ellipse(x, near) if len(different) >= FEWEST_OF_ELLIPSES else None
    return None if found is None else _along(run - found[0], step, found[1])


def _circle(x: Floats, near: float) -> Floats | None:
    """The centre of the circle that points are on, given from their mean."""
    # |x|^2 = 2 c . x + r^2 - |c|^2; the mean of x is zero, and r^2 - |c|^2 that of |x|^2
    squares = (x * x).sum(axis=1)
    (a, b), (_, d) = (x.T @ x).tolist()
    p, q = (0.5 * (squares @ x)).tolist()
    spread = a * d - b * b
    if spread > ROUND * (a + d) ** 2:
        centre = np.array([(d * p - b * q) / spread, (a * q - b * p) / spread])
    else:  # a short arc, whose normal equations lose digits
        system = np.concatenate([2 * x, np.ones((len(x), 1))], axis=1)
        centre = np.linalg.lstsq(system, squares, rcond=None)[0][:2]
    radius = np.sqrt(squares.mean() + centre @ centre)
    away = x - centre
    off = np.abs(np.hypot(away[:, 0], away[:, 1]) - radius).max()
    return np.asarray(centre) if off <= OFF * radius + near else None


def _ellipse(x: Floats, near: float) -> tuple[Floats, Floats] | None:
    """Centre and A of the ellipse that points are on."""
    a, b = x.T
    terms = np.stack([a * a, a * b, b * b, a, b, np.ones(len(x))], axis=1)
    conic = np.linalg.svd(terms, full_matrices=False)[2][
        -1
    ]  # the conic that is the nearest to zero at all points
    form = np.array([[conic[0], conic[1] / 2], [conic[1] / 2, conic[2]]])
    form, conic = (form, conic) if form[0, 0] > 0 else (-form, -conic)
    axes = np.linalg.eigvalsh(form)
    if not axes[0] * LONGEST**2 > axes[1]:
        return None
    steepness = np.linalg.norm(2 * x @ form + conic[3:5], axis=1)
    if not (np.abs(terms @ conic) <= (OFF + near) * steepness).all():
        return None
    return -0.5 * np.linalg.solve(form, conic[3:5]), np.asarray(np.linalg.cholesky(form).T)


def _along(spokes: Floats, step: int, made_round: Floats) -> Arc | None:
    """The arc of nodes given from its centre, all walked the same way round."""
    x = spokes @ made_round.T
    a, b = x[:-1], x[1:]
    between = np.arctan2(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], (a * b).sum(axis=1))
    theta: Floats = between.reshape(-1, step).sum(axis=1)
    same_way = (between > 0).all() or (between < 0).all()
    return Arc(theta, made_round) if same_way and np.abs(theta).max() < LARGEST_ANGLE else None
