"""Curves in space: arc length, Frenet frames, rotation-minimising frames."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kshell.errors import InputError, SolveError
from kshell.geometry.arc_length import ArcLengthMap, arc_length
from kshell.geometry.components import Floats
from kshell.geometry.curve_point import CurvePoint, derivatives
from kshell.geometry.exact import SymbolicMap, traced
from kshell.geometry.places import interval, parameter_arrays
from kshell.geometry.smooth import AffineMap, ComposedMap, GivenMap, SmoothMap


class Curve:
    """A curve x(t) in space; a plane curve has z = 0.

    Parameters
    ----------
    x : callable or SmoothMap
        x(t) for an array t: a tuple of three arrays, or one array (..., 3).
    derivatives : sequence of callables, optional
        First, second, third derivative, each returning what `x` returns. Left out, `x` is traced and
        differentiated by sympy, which needs a function made of numpy functions.
    domain : pair of float
        Range of t, used to check derivatives and by pictures.
    name : str
        For messages.

    Raises
    ------
    InputError
        If the derivatives cannot be derived, or those given do not belong to `x`.
    """

    def __init__(
        self,
        x: Callable[..., Any] | SmoothMap,
        derivatives: Sequence[Callable[..., Any]] | None = None,
        domain: tuple[float, float] = (0.0, 1.0),
        name: str = "curve",
    ) -> None:
        self.domain = interval("the range of t", domain)
        self.name = name
        if isinstance(x, SmoothMap):
            self.map = x
        elif derivatives is None:
            self.map = traced(x, ("t",), 3)
        else:
            self.map = given = GivenMap(x, derivatives, 1, 3)
            given.check([self.domain])
        if (self.map.parameters, self.map.components) != (1, 3):
            raise InputError(f"{name}: a curve has 1 parameter and 3 components")

    @classmethod
    def from_expressions(
        cls,
        x: str,
        y: str,
        z: str = "0",
        parameter: str = "t",
        constants: Mapping[str, float] | None = None,
        domain: tuple[float, float] = (0.0, 1.0),
        name: str = "curve",
    ) -> Curve:
        """A curve from formulas such as "cos(t)", "sin(t)", "t/2"; its derivatives are exact."""
        return Curve(SymbolicMap.from_texts([x, y, z], [parameter], constants), domain=domain, name=name)

    def __repr__(self) -> str:
        return f"<{self.name}>"

    def __call__(self, t: ArrayLike) -> Floats:
        """(..., 3) the points x(t)."""
        return self.derivatives(t, order=0)[0]

    def derivatives(self, t: ArrayLike, order: int = 1) -> tuple[Floats, ...]:
        """Point and derivatives up to `order`, each (..., 3), without any check of regularity."""
        return derivatives(self.map, self.name, t, order)

    def at(self, t: ArrayLike) -> CurvePoint:
        """The differential geometry at parameters t.

        Raises
        ------
        InputError
            Where the curve stands still (x' = 0) or is not finite; the message has the parameter.
        """
        (t,) = parameter_arrays(("t",), (t,))
        return CurvePoint(self.map, self.name, t)

    def length(self, a: float, b: float) -> float:
        """Arc length from t = a to t = b, by adaptive quadrature (scipy) to a relative 1e-12.

        Raises
        ------
        InputError
            If a >= b, the curve is not finite somewhere, or its length is zero.
        """
        return arc_length(self.map, self.name, *interval("the range of t", (a, b)))

    def by_arc_length(self, a: float, b: float) -> Curve:
        """The part from t = a to t = b as a curve of its arc length s in [0, length].

        Raises
        ------
        InputError
            If the part has length zero or stands still somewhere.
        """
        s = ArcLengthMap(self.map, self.name, *interval("the range of t", (a, b)))
        inner = ComposedMap(self.map, s)
        return Curve(inner, domain=(0.0, s.length), name=f"{self.name} by arc length")

    def rotation_minimising(self, t: ArrayLike, start: ArrayLike | None = None) -> Floats:
        """A frame that turns about the tangent nowhere, defined at inflections and on straight parts.

        Parameters
        ----------
        t : (n,) increasing array
        start : (3,) array, optional
            Direction of the second vector at t[0], made normal to the tangent. The default is the axis
            of space farthest from the tangent.

        Returns
        -------
        (n, 3, 3) array
            Rows T, U, V = T x U with U' parallel to T; solved as U' = -(U . T') T to a relative 1e-11.
            Source: Bishop, There is more than one way to frame a curve, 1975.

        Raises
        ------
        InputError
            If t does not increase, or `start` is along the tangent.
        """
        from scipy.integrate import solve_ivp

        t = np.atleast_1d(np.asarray(t, dtype=np.float64))
        points = self.at(t)
        if t.ndim != 1 or (np.diff(t) <= 0).any():
            raise InputError("a rotation-minimising frame needs increasing parameters t in one row")
        first = points.tangent[0]
        wish = np.eye(3)[np.argmin(np.abs(first))] if start is None else np.asarray(start, dtype=np.float64)
        u = wish - (wish @ first) * first
        if np.linalg.norm(u) < 1e-8 * np.linalg.norm(wish) or not np.isfinite(u).all():
            raise InputError(f"start = {wish} is along the tangent {first}: give another direction")
        u /= np.linalg.norm(u)

        def slope(time: float, vector: Floats) -> Floats:
            p = self.at(time)
            return -(vector @ p.curvature_vector) * p.speed * p.tangent

        if len(t) > 1:
            answer = solve_ivp(slope, (t[0], t[-1]), u, "DOP853", t_eval=t, rtol=1e-11, atol=1e-12)
            if not answer.success:
                raise SolveError(f"the frame of {self.name} could not be followed: {answer.message}", answer)
            across = answer.y.T
        else:
            across = u[None]
        across = across - np.sum(across * points.tangent, axis=1, keepdims=True) * points.tangent
        across /= np.linalg.norm(across, axis=1, keepdims=True)
        return np.stack([points.tangent, across, np.cross(points.tangent, across)], axis=1)

    def moved(self, rotation: ArrayLike, shift: ArrayLike = (0.0, 0.0, 0.0)) -> Curve:
        """The curve rotation @ x + shift."""
        return Curve(AffineMap(self.map, rotation, shift), domain=self.domain, name=f"moved {self.name}")

    def reparametrised(self, parameter: Curve, domain: tuple[float, float] = (0.0, 1.0)) -> Curve:
        """x(phi(s)), where phi is the x component of `parameter`."""
        return Curve(ComposedMap(self.map, parameter.map), domain=domain, name=self.name)
