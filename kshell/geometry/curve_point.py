"""The differential geometry of a curve at points: every quantity computed when it is first asked for.

Symbols
-------
x' x'' x'''   derivatives with respect to the parameter t, which need not be the arc length
T N B         tangent, principal normal, binormal = T x N: the Frenet frame, undefined where x' x x'' = 0
kappa tau     curvature |x' x x''| / |x'|^3, torsion (x' x x'') . x''' / |x' x x''|^2

Source: do Carmo, Differential Geometry of Curves and Surfaces, 1-5, with N' = -kappa T + tau B, so that the
torsion of a right-handed helix is positive (there it is negative).
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.errors import InputError
from kshell.geometry import components as vec
from kshell.geometry.components import Component, Floats
from kshell.geometry.places import parameter_arrays, refuse_where
from kshell.geometry.smooth import Partials, SmoothMap

# the sine of the angle between x' and x'' below which a point counts as an inflection
STRAIGHT = 1e-12


def derivatives(curve: SmoothMap, name: str, t: ArrayLike, order: int) -> tuple[Floats, ...]:
    """Point and derivatives of x(t) up to `order`, each (..., 3), without any check of regularity.

    Raises
    ------
    InputError
        If a parameter or a value is not finite, or the order is not known; `name` is that of the curve.
    """
    (t,) = parameter_arrays(("t",), (t,))
    curve.require(order, f"{name}: this")
    partials = curve.partials((t,), order)
    out = []
    for k in range(order + 1):
        out.append(np.stack([np.broadcast_to(c, t.shape) for c in partials[k,]], axis=-1).astype(np.float64))
        if not np.isfinite(out[-1]).all():
            bad = t[~np.isfinite(out[-1]).all(axis=-1)].flat[0]
            raise InputError(f"{name} or a derivative is not finite at t = {bad:.9g}: stay inside its domain")
    return tuple(out)


class CurvePoint:
    """A curve at parameters t; all attributes have the shape of t in front. Made by `Curve.at`."""

    def __init__(self, curve: SmoothMap, name: str, t: Floats) -> None:
        self._map, self._name = curve, name
        self.t = t
        self.shape = t.shape
        self._known: Partials = curve.partials((t,), min(2, curve.highest))
        size = sum(np.abs(c) for vector in self._known.values() for c in vector)
        self._refuse(~np.isfinite(size), f"{name} or a derivative is not finite", "stay inside its domain")
        length = sum(np.abs(c) for c in self._known[0,])
        self._refuse(
            self._speed <= 1e-14 * length, f"{name} stands still, x' = 0,",
            "it has no tangent there; use a regular parametrisation",
        )  # fmt: skip

    def _refuse(self, bad: Component, what: str, mend: str) -> None:
        refuse_where(bad, ("t",), (self.t,), what, mend)

    def _x(self, order: int) -> list[Component]:
        """The derivative of the given order."""
        if (order,) not in self._known:
            self._map.require(order, f"{self._name}: this quantity")
            self._known = self._map.partials((self.t,), order)
        return self._known[order,]

    @cached_property
    def _speed(self) -> Component:
        return vec.norm(self._x(1))

    @cached_property
    def _cross(self) -> list[Component]:
        return vec.cross(self._x(1), self._x(2))

    @cached_property
    def point(self) -> Floats:
        """(..., 3) the points x(t)."""
        return vec.stacked(self._x(0), self.shape)

    @cached_property
    def velocity(self) -> Floats:
        """(..., 3) x'."""
        return vec.stacked(self._x(1), self.shape)

    @cached_property
    def acceleration(self) -> Floats:
        """(..., 3) x''."""
        return vec.stacked(self._x(2), self.shape)

    @cached_property
    def speed(self) -> Floats:
        """(...) |x'|, arc length per parameter."""
        return vec.full(self._speed, self.shape)

    @cached_property
    def tangent(self) -> Floats:
        """(..., 3) unit tangent T."""
        return vec.stacked(vec.scaled(self._x(1), 1.0 / self._speed), self.shape)

    @cached_property
    def curvature(self) -> Floats:
        """(...) kappa >= 0, zero at an inflection."""
        return vec.full(vec.norm(self._cross) / self._speed**3, self.shape)

    @cached_property
    def curvature_vector(self) -> Floats:
        """(..., 3) kappa N, defined at inflections too."""
        return vec.stacked(vec.scaled(vec.cross(self._cross, self._x(1)), self._speed**-4.0), self.shape)

    @cached_property
    def inflection(self) -> NDArray[np.bool_]:
        """(...) where x' and x'' are parallel (to 1e-12), so that the Frenet frame is not defined."""
        parallel = vec.norm(self._cross) <= STRAIGHT * self._speed * vec.norm(self._x(2))
        return np.array(np.broadcast_to(parallel, self.shape))[()]

    def _require_frenet(self) -> None:
        self._refuse(
            self.inflection, f"{self._name} has an inflection, curvature 0,",
            "normal, binormal and torsion are not defined there; `curve.rotation_minimising(t)` gives a "
            "frame that passes through inflections",
        )  # fmt: skip

    @cached_property
    def normal(self) -> Floats:
        """(..., 3) principal normal N. Raises InputError at an inflection."""
        self._require_frenet()
        across = vec.cross(self._cross, self._x(1))
        return vec.stacked(vec.scaled(across, 1.0 / vec.norm(across)), self.shape)

    @cached_property
    def binormal(self) -> Floats:
        """(..., 3) binormal B = T x N. Raises InputError at an inflection."""
        self._require_frenet()
        return vec.stacked(vec.scaled(self._cross, 1.0 / vec.norm(self._cross)), self.shape)

    @cached_property
    def frame(self) -> Floats:
        """(..., 3, 3) rows T, N, B. Raises InputError at an inflection."""
        return np.stack([self.tangent, self.normal, self.binormal], axis=-2)

    @cached_property
    def torsion(self) -> Floats:
        """(...) tau, positive for a right-handed helix. Raises InputError at an inflection."""
        self._require_frenet()
        value = vec.dot(self._cross, self._x(3)) / vec.dot(self._cross, self._cross)
        return vec.full(value, self.shape)
