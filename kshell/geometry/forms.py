"""Differential forms on the parameters of a chart: d, wedge, closed, exact, and the theorem of Stokes.

Symbols
-------
f               a function of (u, v), a 0-form               df = f_u du + f_v dv
P du + Q dv     a one-form                                   d(P du + Q dv) = (Q_u - P_v) du ^ dv
R du ^ dv       a two-form                                   (a ^ b) = (a_1 b_2 - a_2 b_1) du ^ dv
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from kshell.errors import InputError
from kshell.geometry.chart import Chart
from kshell.geometry.components import Floats
from kshell.geometry.curve import Curve
from kshell.geometry.exact import SymbolicMap, traced
from kshell.geometry.maps import ProductMap, PullBackMap, SlopeMap
from kshell.geometry.places import interval, parameter_arrays, refuse_where
from kshell.geometry.quadrature import over_interval, over_rectangle, panel_points
from kshell.geometry.smooth import Partials, SmoothMap
from kshell.geometry.surface_point import PARAMETERS

# a form counts as closed when |Q_u - P_v| is below this part of |Q_u| + |P_v|
CLOSED = 1e-9


def _map_of(given: SmoothMap | Callable[..., object] | Sequence[str], components: int) -> SmoothMap:
    if isinstance(given, SmoothMap):
        found = given
    elif callable(given):
        found = traced(given, PARAMETERS, components)
    else:
        found = SymbolicMap.from_texts(given, PARAMETERS)
    if (found.parameters, found.components) != (2, components):
        raise InputError(f"this form has {components} components that are functions of (u, v)")
    return found


def _evaluated(form: SmoothMap, u: ArrayLike, v: ArrayLike, order: int) -> tuple[Partials, tuple[int, ...]]:
    where = parameter_arrays(PARAMETERS, (u, v))
    partials = form.partials(where, order)
    for vector in partials.values():
        for c in vector:
            refuse_where(
                ~np.isfinite(c), PARAMETERS, where, "the form is not finite", "stay inside its domain"
            )
    return partials, where[0].shape


class ScalarField:
    """A function f(u, v), given by a formula, a function made of numpy functions, or a SmoothMap."""

    def __init__(self, f: str | SmoothMap | Callable[..., object]) -> None:
        self.map = _map_of([f] if isinstance(f, str) else f, 1)

    def __call__(self, u: ArrayLike, v: ArrayLike) -> Floats:
        """(...) values."""
        partials, shape = _evaluated(self.map, u, v, 0)
        return np.array(np.broadcast_to(partials[0, 0][0], shape), dtype=np.float64)[()]

    def d(self) -> OneForm:
        """df = f_u du + f_v dv."""
        return OneForm(SlopeMap(self.map))


class OneForm:
    """P du + Q dv.

    Parameters
    ----------
    components : two formulas, a callable returning (P, Q), or a SmoothMap
    """

    def __init__(self, components: Sequence[str] | SmoothMap | Callable[..., object]) -> None:
        self.map = _map_of(components, 2)

    def __call__(self, u: ArrayLike, v: ArrayLike) -> Floats:
        """(..., 2) P and Q."""
        partials, shape = _evaluated(self.map, u, v, 0)
        return np.stack([np.broadcast_to(c, shape) for c in partials[0, 0]], axis=-1).astype(np.float64)

    def d(self) -> TwoForm:
        """Exterior derivative (Q_u - P_v) du ^ dv."""

        def density(u: Floats, v: Floats) -> Floats:
            partials, shape = _evaluated(self.map, u, v, 1)
            return np.broadcast_to(partials[1, 0][1] - partials[0, 1][0], shape)

        return TwoForm(density)

    def wedge(self, other: OneForm) -> TwoForm:
        """self ^ other."""

        def density(u: Floats, v: Floats) -> Floats:
            a, b = self(u, v), other(u, v)
            return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]

        return TwoForm(density)

    def times(self, f: ScalarField) -> OneForm:
        """f (P du + Q dv)."""
        return OneForm(ProductMap(self.map, f.map))

    def pulled_back(self, phi: Chart) -> OneForm:
        """The form in parameters (s, t) where (u, v) = phi(s, t), the x and y of a chart of the plane."""
        return OneForm(PullBackMap(self.map, phi.map))

    def along(self, path: Curve, a: float, b: float) -> float:
        """Integral over the path (u, v) = (x, y)(t), t from a to b."""

        def integrand(t: Floats) -> Floats:
            point, slope = path.derivatives(t, order=1)
            form = self(point[..., 0], point[..., 1])
            return form[..., 0] * slope[..., 0] + form[..., 1] * slope[..., 1]

        return over_interval(
            integrand, *interval("the range of t", (a, b)), "the integral of the form", scale=1e-3
        )

    def is_closed(self, u_range: Sequence[float], v_range: Sequence[float]) -> bool:
        """Whether d of the form vanishes, to 1e-9 of its terms, on 48 x 48 points of the rectangle."""
        u = panel_points(*interval("the range of u", u_range), 4)[0]
        v = panel_points(*interval("the range of v", v_range), 4)[0]
        partials, _ = _evaluated(self.map, *np.meshgrid(u, v, indexing="ij"), 1)
        q_u, p_v = partials[1, 0][1], partials[0, 1][0]
        return bool(np.all(np.abs(q_u - p_v) <= CLOSED * np.max(np.abs(q_u) + np.abs(p_v))))

    def is_exact(
        self,
        u_range: Sequence[float],
        v_range: Sequence[float],
        loops: Sequence[tuple[Curve, float, float]] = (),
    ) -> bool:
        """Whether the form is df on the rectangle.

        On a rectangle closed forms are exact (lemma of Poincare). If the form is not defined somewhere
        inside, give closed paths (path, a, b) around each hole: a form is exact if in addition its integral
        over each vanishes.

        Raises
        ------
        InputError
            If a path does not close.
        """
        if not self.is_closed(u_range, v_range):
            return False
        for path, a, b in loops:
            ends = path([a, b])
            if np.abs(ends[1] - ends[0]).max() > 1e-9 * (np.abs(ends).max() + 1e-300):
                raise InputError(
                    f"the path from {ends[0, :2]} to {ends[1, :2]} does not close: it is no loop"
                )
            if abs(self.along(path, a, b)) > CLOSED * path.length(a, b):
                return False
        return True

    def potential(self, u: ArrayLike, v: ArrayLike, start: Sequence[float]) -> Floats:
        """(...) the f with df = the form and f(start) = 0, integrated along straight lines from `start`.

        Only meaningful for an exact form on a region that has those lines.
        """
        u, v = parameter_arrays(PARAMETERS, (u, v))
        u0, v0 = (float(c) for c in start)
        t, w = panel_points(0.0, 1.0, 8)
        along_u, along_v = u0 + np.multiply.outer(u - u0, t), v0 + np.multiply.outer(v - v0, t)
        form = self(along_u, along_v)
        return (u - u0) * (form[..., 0] @ w) + (v - v0) * (form[..., 1] @ w)


class TwoForm:
    """R du ^ dv, given by the function R(u, v)."""

    def __init__(self, density: Callable[[Floats, Floats], ArrayLike]) -> None:
        self.density = density

    @classmethod
    def area(cls, chart: Chart) -> TwoForm:
        """The area form of a chart, |x_u x x_v| du ^ dv."""
        return cls(lambda u, v: chart.at(u, v).area_element)

    def __call__(self, u: ArrayLike, v: ArrayLike) -> Floats:
        """(...) R."""
        u, v = parameter_arrays(PARAMETERS, (u, v))
        return np.array(np.broadcast_to(np.asarray(self.density(u, v), float), u.shape))[()]

    def integrate(self, u_range: Sequence[float], v_range: Sequence[float]) -> float:
        """Integral over a rectangle."""
        u, v = interval("the range of u", u_range), interval("the range of v", v_range)
        return over_rectangle(self, u, v, "the integral of the form", scale=1e-3)


def stokes(form: OneForm, u_range: Sequence[float], v_range: Sequence[float]) -> tuple[float, float]:
    """Both sides of the theorem of Stokes on a rectangle: integral of d form, integral over the boundary.

    For another region pull the form back by a map of the rectangle onto it.
    """
    (a, b), (c, d) = interval("the range of u", u_range), interval("the range of v", v_range)

    def along_u(v: float) -> float:
        return over_interval(lambda t: form(t, v)[..., 0], a, b, "the boundary integral", scale=1e-3)

    def along_v(u: float) -> float:
        return over_interval(lambda t: form(u, t)[..., 1], c, d, "the boundary integral", scale=1e-3)

    return form.d().integrate((a, b), (c, d)), along_u(c) + along_v(b) - along_u(d) - along_v(a)
