"""The arc length of a curve, and its parameter as a function of it.

Symbols
-------
s(t)     arc length from the start; s' = |x'|
t(s)     its inverse; t' = 1 / |x'|
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence

import numpy as np

from kshell.errors import InputError, KshellWarning, SolveError
from kshell.geometry.components import Floats
from kshell.geometry.curve_point import CurvePoint, derivatives
from kshell.geometry.places import parameter_arrays
from kshell.geometry.quadrature import POINTS
from kshell.geometry.smooth import Partials, SmoothMap

MOST_PANELS = 16384


def arc_length(curve: SmoothMap, name: str, a: float, b: float) -> float:
    """Arc length of x(t) from t = a to t = b > a. See `Curve.length`."""
    from scipy.integrate import quad

    def speed(t: float) -> float:
        return float(np.linalg.norm(derivatives(curve, name, t, 1)[1]))

    value, error, *_ = quad(speed, a, b, epsabs=0.0, epsrel=1e-12, limit=400, full_output=1)
    if value <= 1e-14 * np.abs(derivatives(curve, name, [a, b], 0)[0]).max():
        raise InputError(f"{name} has length zero from t = {a:g} to t = {b:g}: it is a single point")
    if error > 1e-8 * value:
        message = f"the length of {name} is only known to a relative {error / value:.1e}: it is not smooth"
        warnings.warn(KshellWarning(message), stacklevel=3)
    return float(value)


class ArcLengthMap(SmoothMap):
    """t(s) for s in [0, length], by Newton's method on Gauss panels, to rounding."""

    parameters, components = 1, 1

    def __init__(self, curve: SmoothMap, name: str, a: float, b: float) -> None:
        self.curve, self.name = curve, name
        self.highest = min(3, curve.highest)
        self.length = arc_length(curve, name, a, b)
        panels = 8
        while True:
            self.knots = np.linspace(a, b, panels + 1)
            self.sums = np.concatenate(
                [[0.0], np.cumsum(self._panel_length(self.knots[:-1], self.knots[1:]))]
            )
            if abs(self.sums[-1] - self.length) <= 1e-13 * self.length:
                break
            panels *= 2
            if panels > MOST_PANELS:
                raise InputError(
                    f"{name} has no smooth arc length from t = {a:g} to t = {b:g}: {panels // 2} "
                    f"panels give {self.sums[-1]:.12g}, quadrature {self.length:.12g}; cut it at its corners"
                )

    def _speed(self, t: Floats) -> Floats:
        return np.asarray(CurvePoint(self.curve, self.name, *parameter_arrays(("t",), (t,))).speed)

    def _panel_length(self, start: Floats, end: Floats) -> Floats:
        """Arc length from each `start` to each `end`, both (n,)."""
        x, w = np.polynomial.legendre.leggauss(POINTS)
        half = 0.5 * (end - start)
        t = 0.5 * (start + end)[:, None] + half[:, None] * x
        return half * (self._speed(t) @ w)

    def invert(self, s: Floats) -> Floats:
        """(n,) parameters t at arc lengths s.

        Raises
        ------
        InputError
            If an arc length is outside [0, length] by more than rounding.
        """
        slack = 1e-12 * self.length
        outside = (s < -slack) | (s > self.length + slack)
        if outside.any():
            raise InputError(
                f"arc length s = {s[outside][0]:.9g} is outside [0, {self.length:.9g}], the part of "
                f"{self.name} that was parametrised"
            )
        panel = np.clip(np.searchsorted(self.sums, s, side="right") - 1, 0, len(self.knots) - 2)
        low, high = self.knots[panel], self.knots[panel + 1]
        t = np.interp(s, self.sums, self.knots)
        for _ in range(50):
            gap = self.sums[panel] + self._panel_length(low, t) - s
            step = gap / self._speed(t)
            t = np.clip(t - step, low, high)
            if np.abs(step).max(initial=0.0) <= 4e-16 * max(abs(self.knots[0]), abs(self.knots[-1])) * len(
                self.sums
            ):
                return t
        raise SolveError(f"the arc length of {self.name} could not be inverted to rounding", t)

    def partials(self, where: Sequence[Floats], order: int) -> Partials:
        self.require(order, "a curve by arc length")
        s = where[0]
        t = self.invert(s.ravel()).reshape(s.shape)
        out: Partials = {(0,): [t]}
        if order == 0:
            return out
        # with p = x'.x': t' = p^(-1/2), t'' = -p'/(2 p^2), t''' = (-p''/(2 p^2) + p'^2/p^3) t'
        _, *d = derivatives(self.curve, self.name, t, order)
        p = np.sum(d[0] * d[0], axis=-1)
        out[1,] = [p**-0.5]
        if order >= 2:
            p1 = 2.0 * np.sum(d[0] * d[1], axis=-1)
            out[2,] = [-p1 / (2.0 * p**2)]
        if order >= 3:
            p2 = 2.0 * np.sum(d[1] * d[1] + d[0] * d[2], axis=-1)
            out[3,] = [(-p2 / (2.0 * p**2) + p1**2 / p**3) * p**-0.5]
        return out
