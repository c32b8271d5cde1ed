"""The parameter of a curve as a function of its arc length.

Symbols
-------
s(t)     arc length from the start; s' = |x'|
t(s)     its inverse; t' = 1 / |x'|
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from kshell.errors import InputError, SolveError
from kshell.geometry.components import Floats
from kshell.geometry.quadrature import POINTS
from kshell.geometry.smooth import Partials, SmoothMap

if TYPE_CHECKING:
    from kshell.geometry.curve import Curve

MOST_PANELS = 16384


class ArcLengthMap(SmoothMap):
    """t(s) for s in [0, length], by Newton's method on Gauss panels, to rounding."""

    parameters, components = 1, 1

    def __init__(self, curve: Curve, a: float, b: float) -> None:
        self.curve = curve
        self.highest = min(3, curve.map.highest)
        self.length = curve.length(a, b)
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
                    f"{curve.name} has no smooth arc length from t = {a:g} to t = {b:g}: {panels // 2} "
                    f"panels give {self.sums[-1]:.12g}, quadrature {self.length:.12g}; cut it at its corners"
                )

    def _speed(self, t: Floats) -> Floats:
        return np.asarray(self.curve.at(t).speed)

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
                f"{self.curve.name} that was parametrised"
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
        raise SolveError(f"the arc length of {self.curve.name} could not be inverted to rounding", t)

    def partials(self, where: Sequence[Floats], order: int) -> Partials:
        self.require(order, "a curve by arc length")
        s = where[0]
        t = self.invert(s.ravel()).reshape(s.shape)
        out: Partials = {(0,): [t]}
        if order == 0:
            return out
        # with p = x'.x': t' = p^(-1/2), t'' = -p'/(2 p^2), t''' = (-p''/(2 p^2) + p'^2/p^3) t'
        _, *d = self.curve.derivatives(t, order=order)
        p = np.sum(d[0] * d[0], axis=-1)
        out[1,] = [p**-0.5]
        if order >= 2:
            p1 = 2.0 * np.sum(d[0] * d[1], axis=-1)
            out[2,] = [-p1 / (2.0 * p**2)]
        if order >= 3:
            p2 = 2.0 * np.sum(d[1] * d[1] + d[0] * d[2], axis=-1)
            out[3,] = [(-p2 / (2.0 * p**2) + p1**2 / p**3) * p**-0.5]
        return out
