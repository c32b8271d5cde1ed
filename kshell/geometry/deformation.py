"""The deformation of a chart: strain and change of curvature, exact and linearised.

Symbols
-------
X, x = X + u      the chart before and after, u the displacement
A, a; B, b        first and second form before and after; N, n the normals
E = (a - A)/2     Green strain of the surface        e   its part linear in u
K = b - B         change of curvature                k   its part linear in u

    e_ij = (X_i . u_j + X_j . u_i) / 2            k_ij = (u_ij - Gamma^c_ij u_c) . N

All are covariant components in the parameters (u, v). Source: Ciarlet, An Introduction to Differential
Geometry with Applications to Elasticity, 2005, theorems 4.2-1 and 4.2-2.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from kshell.errors import InputError
from kshell.geometry.chart import Chart
from kshell.geometry.components import Floats
from kshell.geometry.exact import SymbolicMap
from kshell.geometry.smooth import FieldSum, SmoothMap
from kshell.geometry.surface_point import PARAMETERS, SurfacePoint


class Deformation:
    """A chart displaced by a field.

    Parameters
    ----------
    chart : Chart
    displacement : Chart, SmoothMap or three formulas
        The displacement u(u, v) in space, in the parameters of the chart.
    """

    def __init__(self, chart: Chart, displacement: Chart | SmoothMap | tuple[str, str, str]) -> None:
        if isinstance(displacement, Chart):
            field = displacement.map
        elif isinstance(displacement, SmoothMap):
            field = displacement
        else:
            field = SymbolicMap.from_texts(displacement, PARAMETERS)
        if (field.parameters, field.components) != (2, 3):
            raise InputError("a displacement has 3 components that are functions of (u, v)")
        self.chart = chart
        self.displacement = Chart(field, domain=chart.domain, name=f"displacement of the {chart.name}")
        moved = FieldSum(chart.map, field)
        self.deformed = Chart(moved, domain=chart.domain, name=f"deformed {chart.name}")

    def at(self, u: ArrayLike, v: ArrayLike) -> DeformationPoint:
        """Strains at parameters u, v. Raises InputError where the chart is singular before or after."""
        return DeformationPoint(self, u, v)


class DeformationPoint:
    """A deformation at points; attributes have the shape of u and v in front."""

    def __init__(self, deformation: Deformation, u: ArrayLike, v: ArrayLike) -> None:
        self.before: SurfacePoint = deformation.chart.at(u, v)
        self.after: SurfacePoint = deformation.deformed.at(u, v)
        _, self._slope, self._second = deformation.displacement.derivatives(u, v, order=2)

    @cached_property
    def _mixed(self) -> Floats:
        """(..., 2, 2) X_i . u_j."""
        return np.einsum("...ic,...jc->...ij", self.before.tangents, self._slope)

    @cached_property
    def linear_strain(self) -> Floats:
        """(..., 2, 2) e, the linearised strain."""
        return 0.5 * (self._mixed + np.swapaxes(self._mixed, -1, -2))

    @cached_property
    def green_strain(self) -> Floats:
        """(..., 2, 2) E = (a - A) / 2, from the displacement, so that small strains keep their digits."""
        return self.linear_strain + 0.5 * np.einsum("...ic,...jc->...ij", self._slope, self._slope)

    @cached_property
    def _normal_change(self) -> Floats:
        """(..., 3) n - N without cancellation.

        With C = X_1 x X_2 and c = C + d:  n - N = (d - C (|c| - |C|) / |C|) / |c|,
        where |c| - |C| = d . (2 C + d) / (|c| + |C|).
        """
        X, u = self.before.tangents, self._slope
        d = (
            np.cross(u[..., 0, :], X[..., 1, :])
            + np.cross(X[..., 0, :], u[..., 1, :])
            + np.cross(u[..., 0, :], u[..., 1, :])
        )
        C = np.cross(X[..., 0, :], X[..., 1, :])
        size, new_size = (np.asarray(s.area_element)[..., None] for s in (self.before, self.after))
        growth = np.sum(d * (2.0 * C + d), axis=-1, keepdims=True) / (new_size + size)
        return (d - C * growth / size) / new_size

    @cached_property
    def curvature_change(self) -> Floats:
        """(..., 2, 2) K = b - B = u_ij . n + X_ij . (n - N), without cancellation."""
        X_second = np.asarray(self.before.second_derivatives)
        bent = np.einsum("...ijc,...c->...ij", self._second, self.after.normal)
        return bent + np.einsum("...ijc,...c->...ij", X_second, self._normal_change)

    @cached_property
    def linear_curvature_change(self) -> Floats:
        """(..., 2, 2) k, the linearised change of curvature."""
        # u_ij - sum_k Gamma^k_ij u_k, the covariant second derivative of each component of u
        hessian = self._second - np.einsum("...kij,...kc->...ijc", self.before.christoffel, self._slope)
        return np.einsum("...ijc,...c->...ij", hessian, self.before.normal)

    def in_frame(self, tensor: ArrayLike) -> Floats:
        """Covariant components (..., 2, 2) turned into those in the orthonormal frame X_u/|X_u|, N x that."""
        g = self.before.first_form
        length = np.sqrt(g[..., 0, 0])
        to_frame = np.zeros_like(g)  # column j: the frame vector e_j in the basis (X_u, X_v)
        to_frame[..., 0, 0] = 1.0 / length
        to_frame[..., 1, 1] = length / self.before.area_element
        to_frame[..., 0, 1] = -g[..., 0, 1] / (length * self.before.area_element)
        return np.swapaxes(to_frame, -1, -2) @ np.asarray(tensor, float) @ to_frame
