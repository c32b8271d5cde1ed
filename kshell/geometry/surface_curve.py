"""Curves on surfaces: geodesic and normal curvature, geodesic torsion.

Symbols
-------
T N U    Darboux frame: tangent of the curve, normal of the surface, U = N x T to the left of the curve
k_g      geodesic curvature x'' . U / |x'|^2        k_n   normal curvature x'' . N / |x'|^2
t_g      geodesic torsion -N' . U / |x'|
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from kshell.geometry.components import Floats
from kshell.geometry.curve import Curve
from kshell.geometry.curve_point import CurvePoint
from kshell.geometry.places import parameter_arrays
from kshell.geometry.smooth import ComposedMap, SmoothMap
from kshell.geometry.surface_point import PARAMETERS, SurfacePoint


class SurfaceCurve:
    """The curve x(u(t), v(t)) on a surface. Made by `Chart.along`.

    Parameters
    ----------
    surface : SmoothMap
        The map x(u, v).
    name : str
        Of the surface, for messages.
    path : Curve
        Its x and y are u(t) and v(t).
    """

    def __init__(self, surface: SmoothMap, name: str, path: Curve) -> None:
        self.surface, self.name, self.path = surface, name, path
        self.curve = Curve(ComposedMap(surface, path.map), domain=path.domain, name=f"curve on the {name}")

    def at(self, t: ArrayLike) -> DarbouxPoint:
        """The curve at parameters t. Raises InputError where curve or chart are singular."""
        return DarbouxPoint(self, np.asarray(t, dtype=np.float64))

    def length(self, a: float, b: float) -> float:
        """Arc length from t = a to t = b."""
        return self.curve.length(a, b)


class DarbouxPoint:
    """A curve on a surface at parameters t; attributes have the shape of t in front."""

    def __init__(self, owner: SurfaceCurve, t: Floats) -> None:
        path = owner.path.derivatives(t, order=1)
        self._direction = path[1][..., :2]
        self.space: CurvePoint = owner.curve.at(t)
        u, v = parameter_arrays(PARAMETERS, (path[0][..., 0], path[0][..., 1]))
        self.surface = SurfacePoint(owner.surface, owner.name, u, v)

    @cached_property
    def tangent(self) -> Floats:
        """(..., 3) T."""
        return self.space.tangent

    @cached_property
    def normal(self) -> Floats:
        """(..., 3) N of the surface."""
        return self.surface.normal

    @cached_property
    def left(self) -> Floats:
        """(..., 3) U = N x T, in the tangent plane to the left of the curve."""
        return np.cross(self.normal, self.tangent)

    @cached_property
    def geodesic_curvature(self) -> Floats:
        """(...) k_g, positive where the curve turns left as seen from the side of the normal."""
        return np.sum(self.space.acceleration * self.left, axis=-1) / self.space.speed**2

    @cached_property
    def normal_curvature(self) -> Floats:
        """(...) k_n."""
        return np.sum(self.space.acceleration * self.normal, axis=-1) / self.space.speed**2

    @cached_property
    def geodesic_torsion(self) -> Floats:
        """(...) t_g."""
        turn = np.einsum("...i,...ic->...c", self._direction, self.surface.normal_derivatives)  # N'
        return -np.sum(turn * self.left, axis=-1) / self.space.speed
