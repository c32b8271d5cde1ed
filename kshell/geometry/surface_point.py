"""The differential geometry of a chart at points: every quantity computed when it is first asked for.

Symbols
-------
x_i      tangent vectors, i = u, v             N      unit normal, x_u x x_v normalised
g_ij     first form, x_i . x_j                 b_ij   second form, x_ij . N
W        Weingarten matrix of the differential of the Gauss map: N_j = sum_i W_ij x_i, W = -g^-1 b
S        shape operator, S = -dN; in the basis (x_u, x_v) its matrix is -W
k1 k2    principal curvatures, k1 >= k2, positive where the surface bends toward N
H K      mean curvature (k1 + k2)/2, Gaussian curvature k1 k2

Formulas: do Carmo, Differential Geometry of Curves and Surfaces, chapters 2 to 4, with S = -dN.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kshell.errors import InputError
from kshell.geometry import components as vec
from kshell.geometry import principal_axes as axes
from kshell.geometry.components import Component, Floats
from kshell.geometry.places import refuse_where
from kshell.geometry.smooth import Partials, SmoothMap

# sqrt(det g) below this part of max(|x_u|, |x_v|)^2 is a singular parametrisation
SINGULAR = 1e-13
# a principal curvature below this part of the curvature of the parameter lines counts as zero
FLAT = 1e-10

PARAMETERS = ("u", "v")


class SurfacePoint:
    """A chart at points (u, v); all attributes have the shape of u and v in front.

    Made by `Chart.at`, which raises InputError where the parametrisation is singular.
    """

    def __init__(self, surface: SmoothMap, name: str, u: Floats, v: Floats) -> None:
        self._map, self._name = surface, name
        self.u, self.v = u, v
        self.shape = u.shape
        self._known: Partials = surface.partials((u, v), min(2, surface.highest))
        with np.errstate(invalid="ignore", over="ignore"):
            self._check()

    def _check(self) -> None:
        where = (self.u, self.v)
        lost = [~np.isfinite(c) for vector in self._known.values() for c in vector if np.ndim(c)]
        lost += [
            np.asarray(not np.isfinite(c))
            for vector in self._known.values()
            for c in vector
            if np.ndim(c) == 0
        ]
        refuse_where(
            np.logical_or.reduce([np.broadcast_to(b, self.shape) for b in lost]), PARAMETERS, where,
            f"{self._name} or one of its derivatives is not finite", "stay inside the domain of the chart",
        )  # fmt: skip
        E, _, G = self._g
        refuse_where(
            ~(self._area > SINGULAR * np.maximum(E, G)), PARAMETERS, where,
            f"{self._name} has a singular parametrisation, |x_u x x_v| = 0,",
            "tangent plane and curvature are not defined by this chart there (a tip, a pole or a fold); "
            "use another chart around the point or stay away from it",
        )  # fmt: skip

    def _partial(self, i: int, j: int) -> list[Component]:
        if i + j > 2 or (i, j) not in self._known:
            self._map.require(i + j, f"{self._name}: this quantity")
            if (i, j) not in self._known:
                self._known = self._map.partials((self.u, self.v), i + j)
        return self._known[i, j]

    def _array(self, vector: vec.Vector) -> Floats:
        return vec.stacked(vector, self.shape)

    def _full(self, component: Component) -> Floats:
        return vec.full(component, self.shape)

    # --- first order -------------------------------------------------------------------------------

    @cached_property
    def point(self) -> Floats:
        """(..., 3) the points x(u, v)."""
        return self._array(self._partial(0, 0))

    @cached_property
    def tangents(self) -> Floats:
        """(..., 2, 3) the tangent vectors x_u, x_v."""
        return np.stack([self._array(self._partial(1, 0)), self._array(self._partial(0, 1))], axis=-2)

    @cached_property
    def _g(self) -> list[Component]:
        x_u, x_v = self._partial(1, 0), self._partial(0, 1)
        return [vec.dot(x_u, x_u), vec.dot(x_u, x_v), vec.dot(x_v, x_v)]

    @cached_property
    def _cross(self) -> list[Component]:
        return vec.cross(self._partial(1, 0), self._partial(0, 1))

    @cached_property
    def _area(self) -> Component:
        return vec.norm(self._cross)

    @cached_property
    def _normal(self) -> list[Component]:
        return vec.scaled(self._cross, 1.0 / self._area)

    @cached_property
    def normal(self) -> Floats:
        """(..., 3) the unit normal x_u x x_v / |x_u x x_v|, which is also the Gauss map."""
        return self._array(self._normal)

    @cached_property
    def first_form(self) -> Floats:
        """(..., 2, 2) the metric g_ij = x_i . x_j."""
        return vec.symmetric(self._g, self.shape)

    @cached_property
    def area_element(self) -> Floats:
        """(...) sqrt(det g) = |x_u x x_v|: area per parameter area."""
        return self._full(self._area)

    @cached_property
    def angle(self) -> Floats:
        """(...) angle between the parameter lines, in (0, pi)."""
        return self._full(np.arctan2(self._area, self._g[1]))

    def parameters_of(self, direction: ArrayLike) -> Floats:
        """Tangent directions as parameter components (..., 2).

        Parameters
        ----------
        direction : (..., 2) or (..., 3) array
            Parameter components (du, dv), returned as they are, or tangent vectors in space.

        Raises
        ------
        InputError
            If a direction is zero, or a vector in space is not tangent (to 1e-6 of its length).
        """
        d = np.asarray(direction, dtype=np.float64)
        if d.ndim == 0 or d.shape[-1] not in (2, 3) or not np.isfinite(d).all():
            raise InputError(
                f"a direction is (du, dv) or a tangent vector of 3 finite numbers, not {direction!r}"
            )
        d = np.broadcast_to(d, (*np.broadcast_shapes(d.shape[:-1], self.shape), d.shape[-1]))
        size = np.linalg.norm(d, axis=-1)
        if not size.all():
            raise InputError("a direction is the zero vector: give one with a length")
        if d.shape[-1] == 2:
            return d
        off = np.abs(np.sum(d * self.normal, axis=-1)) / size
        if off.max() > 1e-6:
            raise InputError(
                f"a direction leaves the tangent plane by {np.degrees(np.arcsin(min(off.max(), 1.0))):.3g} "
                "degrees: project it, or give it as (du, dv)"
            )
        along = np.einsum("...ic,...c->...i", self.tangents, d)
        return np.linalg.solve(self.first_form, along[..., None])[..., 0]

    def length(self, direction: ArrayLike) -> Floats:
        """(...) length of a direction, by the first form."""
        d = self.parameters_of(direction)
        return np.sqrt(np.einsum("...i,...ij,...j->...", d, self.first_form, d))

    def angle_between(self, first: ArrayLike, second: ArrayLike) -> Floats:
        """(...) angle from one direction to another, in (-pi, pi], positive about the normal."""
        a, b = self.parameters_of(first), self.parameters_of(second)
        along = np.einsum("...i,...ij,...j->...", a, self.first_form, b)
        turn = self.area_element * (a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
        return np.arctan2(turn, along)

    # --- second order ------------------------------------------------------------------------------

    @cached_property
    def _b(self) -> list[Component]:
        return [vec.dot(self._partial(i, j), self._normal) for i, j in ((2, 0), (1, 1), (0, 2))]

    @cached_property
    def second_form(self) -> Floats:
        """(..., 2, 2) b_ij = x_ij . N."""
        return vec.symmetric(self._b, self.shape)

    @cached_property
    def second_derivatives(self) -> Floats:
        """(..., 2, 2, 3) x_ij."""
        arrays = [self._array(self._partial(2 - n, n)) for n in range(3)]
        return np.stack([np.stack(arrays[:2], axis=-2), np.stack(arrays[1:], axis=-2)], axis=-3)

    @cached_property
    def third_form(self) -> Floats:
        """(..., 2, 2) N_i . N_j, the metric of the Gauss map."""
        return np.einsum("...ic,...jc->...ij", self.normal_derivatives, self.normal_derivatives)

    @cached_property
    def shape_operator(self) -> Floats:
        """(..., 2, 2) matrix of S = -dN in the basis (x_u, x_v): solves g S = b."""
        E, F, G = self._g
        L, M, P = self._b
        det = self._area**2
        out = np.empty((*self.shape, 2, 2))
        out[..., 0, 0] = (G * L - F * M) / det
        out[..., 0, 1] = (G * M - F * P) / det
        out[..., 1, 0] = (E * M - F * L) / det
        out[..., 1, 1] = (E * P - F * M) / det
        return out

    @cached_property
    def weingarten(self) -> Floats:
        """(..., 2, 2) matrix W of the differential of the Gauss map: N_j = sum_i W_ij x_i."""
        return -self.shape_operator

    @cached_property
    def normal_derivatives(self) -> Floats:
        """(..., 2, 3) N_u and N_v, by the equations of Weingarten."""
        return np.einsum("...ij,...ic->...jc", self.weingarten, self.tangents)

    @cached_property
    def gaussian_curvature(self) -> Floats:
        """(...) K = det b / det g."""
        L, M, P = self._b
        return self._full((L * P - M * M) / self._area**2)

    @cached_property
    def _orthonormal_form(self) -> list[Component]:
        return axes.in_orthonormal_basis(self._g, self._b, self._area)

    @cached_property
    def mean_curvature(self) -> Floats:
        """(...) H = (k1 + k2) / 2."""
        p, _, r = self._orthonormal_form
        return self._full(0.5 * (p + r))

    @cached_property
    def principal_curvatures(self) -> Floats:
        """(..., 2) k1 >= k2."""
        return axes.principal_curvatures(self._orthonormal_form, self.shape)

    @cached_property
    def principal_directions(self) -> Floats:
        """(..., 2, 3) unit vectors d1, d2 of k1, k2 with d1 x d2 = N; any such pair at an umbilic."""
        e1 = self.tangents[..., 0, :] / np.sqrt(self._full(self._g[0]))[..., None]
        return axes.principal_directions(self._orthonormal_form, e1, self.normal)

    def classify(self, tolerance: float = FLAT) -> Any:
        """(...) "elliptic", "hyperbolic", "parabolic" or "planar" (dN = 0, not only det dN = 0).

        A principal curvature counts as zero below `tolerance` times the larger of the two, or times the
        curvature |x_ij| / (|x_i| |x_j|) of the parameter lines, from whose cancellation it was computed.
        """
        k1, k2 = np.moveaxis(self.principal_curvatures, -1, 0)
        size = np.maximum(np.abs(k1), np.abs(k2))
        lines = [np.sqrt(self._full(self._g[0])), np.sqrt(self._full(self._g[2]))]
        noise = np.zeros(self.shape)
        for i, j, scale in ((2, 0, lines[0] ** 2), (1, 1, lines[0] * lines[1]), (0, 2, lines[1] ** 2)):
            noise = np.maximum(
                noise, np.maximum.reduce([np.abs(c) + noise * 0 for c in self._partial(i, j)]) / scale
            )
        zero = np.stack([np.abs(k) <= tolerance * np.maximum(size, noise) for k in (k1, k2)])
        kind = np.where(k1 * k2 > 0, "elliptic", "hyperbolic")
        kind = np.where(zero.any(axis=0), "parabolic", kind)
        return np.where(zero.all(axis=0), "planar", kind)[()]

    @cached_property
    def kind(self) -> Any:
        """(...) of str: what `classify` says with its default tolerance."""
        return self.classify()

    def normal_curvature(self, direction: ArrayLike) -> Floats:
        """(...) curvature b(d, d) / g(d, d) of the normal section along (du, dv) or a tangent vector."""
        d = self.parameters_of(direction)
        return np.einsum("...i,...ij,...j->...", d, self.second_form, d) / self.length(d) ** 2

    def euler(self, angle: ArrayLike) -> Floats:
        """(...) Euler: k1 cos^2 + k2 sin^2, the normal curvature at an angle from the first direction."""
        k1, k2 = np.moveaxis(self.principal_curvatures, -1, 0)
        angle = np.asarray(angle, dtype=np.float64)
        return k1 * np.cos(angle) ** 2 + k2 * np.sin(angle) ** 2

    def section_curvature(self, direction: ArrayLike, tilt: ArrayLike) -> Floats:
        """(...) Meusnier: curvature of the section along a direction by a plane tilted from the normal.

        Parameters
        ----------
        direction : (..., 2) or (..., 3) array
        tilt : (...) array
            Angle between the cutting plane and the normal, within (-pi/2, pi/2).
        """
        tilt = np.asarray(tilt, dtype=np.float64)
        if not (np.abs(tilt) < 0.5 * np.pi).all():
            raise InputError("the cutting plane of a section must not be the tangent plane: |tilt| < pi/2")
        return self.normal_curvature(direction) / np.cos(tilt)

    @cached_property
    def christoffel(self) -> Floats:
        """(..., 2, 2, 2) Christoffel symbols Gamma^k_ij as [k, i, j]: x_ij = Gamma^k_ij x_k + b_ij N."""
        x_i = (self._partial(1, 0), self._partial(0, 1))
        E, F, G = self._g
        det = self._area**2
        out = np.empty((*self.shape, 2, 2, 2))
        for i, j in ((0, 0), (0, 1), (1, 1)):
            second = self._partial(2 - i - j, i + j)
            first_kind = [vec.dot(second, x) for x in x_i]  # x_ij . x_k
            out[..., 0, i, j] = out[..., 0, j, i] = (G * first_kind[0] - F * first_kind[1]) / det
            out[..., 1, i, j] = out[..., 1, j, i] = (E * first_kind[1] - F * first_kind[0]) / det
        return out

    # --- third order -------------------------------------------------------------------------------

    def metric_derivatives(self) -> tuple[Floats, Floats]:
        """First and second derivatives of the first form.

        Returns
        -------
        (..., 2, 2, 2) array, g_ij,k as [k, i, j], and (..., 2, 2, 2, 2) array, g_ij,kl as [k, l, i, j].
        """
        index = {0: (1, 0), 1: (0, 1)}

        def x(*axes: int) -> list[Component]:
            return self._partial(sum(index[a][0] for a in axes), sum(index[a][1] for a in axes))

        self._partial(3, 0)
        first = np.empty((*self.shape, 2, 2, 2))
        second = np.empty((*self.shape, 2, 2, 2, 2))
        for i in range(2):
            for j in range(2):
                for k in range(2):
                    first[..., k, i, j] = vec.dot(x(i, k), x(j)) + vec.dot(x(i), x(j, k))
                    for m in range(2):
                        second[..., k, m, i, j] = (
                            vec.dot(x(i, k, m), x(j)) + vec.dot(x(i, k), x(j, m))
                            + vec.dot(x(i, m), x(j, k)) + vec.dot(x(i), x(j, k, m))
                        )  # fmt: skip
        return first, second
