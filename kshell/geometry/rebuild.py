"""The curve of given curvature and torsion: the fundamental theorem of the local theory of curves.

Symbols
-------
T N B    Frenet frame; T' = kappa N, N' = -kappa T + tau B, B' = -tau N, and x' = T
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kshell.errors import InputError, SolveError
from kshell.geometry.components import Floats
from kshell.geometry.curve import Curve
from kshell.geometry.exact import SymbolicMap, traced
from kshell.geometry.smooth import GivenMap, Partials, SmoothMap

# relative error per step of the Runge-Kutta pair of order 8; its interpolant keeps 1e-12 at this step bound
TOLERANCE = 1e-13
STEPS = 64

Law = float | str | Callable[[Any], Any] | tuple[Callable[[Any], Any], Callable[[Any], Any]]


def rebuild(
    curvature: Law,
    torsion: Law,
    length: float,
    start: ArrayLike = (0.0, 0.0, 0.0),
    frame: ArrayLike | None = None,
) -> Curve:
    """The curve with the given curvature and torsion, unique up to the rigid motion fixed by start and frame.

    Parameters
    ----------
    curvature, torsion : float, str, callable, or pair of callables
        Functions of the arc length s: a number, a formula in s, a function made of numpy functions, a
        function with a method `derivative` (a scipy spline), or a function with its derivative.
        Only the derivative of the curvature is used. The curvature must be positive.
    length : float
    start : (3,) array
        The point at s = 0.
    frame : (3, 3) array, optional
        Rows T, N, B at s = 0, a rotation; the axes of space by default.

    Returns
    -------
    Curve
        Parametrised by the arc length s in [0, length].

    Raises
    ------
    InputError
        If the length is not positive, the frame no rotation, or the curvature is not positive or not finite
        somewhere; the message has the arc length.
    SolveError
        If the equations of Frenet could not be solved.
    """
    if not np.isfinite(length) or length <= 0.0:
        raise InputError(f"length = {length!r} must be a positive number")
    axes = np.eye(3) if frame is None else np.asarray(frame, dtype=np.float64)
    origin = np.asarray(start, dtype=np.float64)
    if origin.shape != (3,) or not np.isfinite(origin).all():
        raise InputError(f"start must be three finite numbers, not {start!r}")
    if (
        axes.shape != (3, 3)
        or not np.allclose(axes @ axes.T, np.eye(3), atol=1e-9)
        or np.linalg.det(axes) < 0
    ):
        raise InputError("frame must be a rotation: rows T, N, B orthonormal and right-handed")
    kappa, tau = _law(curvature, "curvature", 1), _law(torsion, "torsion", 0)
    return Curve(
        FrenetMap(kappa, tau, float(length), origin, axes), domain=(0.0, float(length)), name="rebuilt curve"
    )


def _law(given: Law, name: str, order: int) -> SmoothMap:
    if isinstance(given, str):
        return SymbolicMap.from_texts([given], ["s"])
    if isinstance(given, tuple):
        return GivenMap(lambda s: [given[0](s)], [lambda s: [given[1](s)]], 1, 1)
    if callable(given):
        if hasattr(given, "derivative"):
            slope = given.derivative()
            return GivenMap(lambda s: [given(s)], [lambda s: [slope(s)]], 1, 1)
        if order == 0:
            return GivenMap(lambda s: [np.asarray(given(s), float) + 0.0 * s], [], 1, 1)
        return traced(given, ["s"], 1)
    if not isinstance(given, (int, float, np.floating, np.integer)):
        raise InputError(f"{name} must be a number, a formula in s or a function, not {given!r}")
    return SymbolicMap.from_texts([repr(float(given))], ["s"])


class FrenetMap(SmoothMap):
    """The solution of the equations of Frenet as a map of the arc length, with derivatives up to order 3."""

    parameters, components, highest = 1, 3, 3

    def __init__(self, kappa: SmoothMap, tau: SmoothMap, length: float, start: Floats, frame: Floats) -> None:
        from scipy.integrate import solve_ivp

        self.kappa, self.tau, self.length = kappa, tau, length
        self._laws(np.linspace(0.0, length, 1001), 0)  # finite and positive, before anything is solved

        def slope(s: float, state: Floats) -> Floats:
            x = state.reshape(4, 3)
            k, t = (float(law[0]) for law in self._laws(np.array([s]), 0))
            return np.concatenate([x[1], k * x[2], t * x[3] - k * x[1], -t * x[2]])

        # the origin is added afterwards, so that a far start costs no digits
        state = np.concatenate([np.zeros(3), frame.ravel()])
        self.start = start
        answer = solve_ivp(
            slope, (0.0, length), state, "DOP853", dense_output=True, rtol=TOLERANCE, atol=TOLERANCE * 1e-2,
            max_step=length / STEPS,
        )  # fmt: skip
        if not answer.success:
            raise SolveError(f"the equations of Frenet could not be solved: {answer.message}", answer)
        self.solution = answer.sol

    def _laws(self, s: Floats, order: int) -> list[Floats]:
        """Curvature, torsion and (order 1) the derivative of the curvature at s, checked."""
        k = self.kappa.partials((s,), order)
        values = [k[0,][0], self.tau.partials((s,), 0)[0,][0]] + ([k[1,][0]] if order else [])
        out = [np.array(np.broadcast_to(np.asarray(v, float), s.shape)) for v in values]
        for name, value in zip(("curvature", "torsion", "derivative of the curvature"), out, strict=False):
            if not np.isfinite(value).all():
                raise InputError(f"the {name} is not finite at s = {s[~np.isfinite(value)][0]:.9g}")
        if (out[0] <= 0.0).any():
            worst = np.argmin(out[0])
            raise InputError(
                f"the curvature is {out[0].flat[worst]:.6g} at s = {s.flat[worst]:.9g}: it must be positive, "
                "for past an inflection curvature and torsion do not determine the curve; rebuild its parts"
            )
        return out

    def partials(self, where: Sequence[Floats], order: int) -> Partials:
        self.require(order, "a rebuilt curve")
        s = where[0]
        slack = 1e-12 * self.length
        outside = (s < -slack) | (s > self.length + slack)
        if outside.any():
            raise InputError(
                f"s = {s[outside].flat[0]:.9g} is outside the rebuilt curve, 0 to {self.length:.9g}"
            )
        state = self.solution(np.clip(s, 0.0, self.length).ravel()).reshape(4, 3, *s.shape)
        # the frame is orthonormal but for the tolerance of the solver; make it so to rounding
        T = state[1] / np.linalg.norm(state[1], axis=0)
        N = state[2] - np.sum(state[2] * T, axis=0) * T
        N = N / np.linalg.norm(N, axis=0)
        B = np.cross(T, N, axis=0)
        out: Partials = {(0,): [x + a for x, a in zip(state[0], self.start, strict=True)], (1,): list(T)}
        if order >= 2:
            kappa, tau, slope = self._laws(s.ravel(), 1)
            kappa, tau, slope = (a.reshape(s.shape) for a in (kappa, tau, slope))
            out[2,] = list(kappa * N)
            out[3,] = list(-(kappa**2) * T + slope * N + kappa * tau * B)
        return {index: out[index] for index in out if index[0] <= order}
