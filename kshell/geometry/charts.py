"""Ready charts with derivatives of any order in closed form.

| chart | x(u, v) | normal x_u x x_v |
|---|---|---|
| Plane | (u, v, 0) | up |
| Cylinder | (R cos u, R sin u, v) | outward: k = 0, -1/R |
| Cone | (R v cos u, R v sin u, height v) | outward; the tip v = 0 is singular |
| Sphere | (R cos u sin v, R sin u sin v, R cos v) | inward: k = 1/R; the poles v = 0, pi are singular |
| Torus | ((R + r cos v) cos u, (R + r cos v) sin u, -r sin v) | inward: k1 = 1/r |
| Ellipsoid | (a cos u sin v, b sin u sin v, c cos v) | inward; the poles v = 0, pi are singular |
| Hypar | (u, v, u^2/a^2 - v^2/b^2) | up |
| Hyperboloid | (a cosh v cos u, a cosh v sin u, c sinh v) | outward |
| Catenoid | (c cosh(v/c) cos u, c cosh(v/c) sin u, v) | outward |
| Helicoid | (u cos v, u sin v, c v) | along (c sin v, -c cos v, u) |
| MonkeySaddle | (u, v, (u^3 - 3 u v^2) / a^2) | up |

Every component is a sum of products f(u) g(v), so a partial derivative is a product of ordinary ones.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Sequence

import numpy as np

from kshell.errors import InputError, clipped
from kshell.geometry.chart import ReadyChart
from kshell.geometry.components import Component, Floats, total
from kshell.geometry.smooth import Index, Partials, SmoothMap, indices

# the derivatives of order 0, 1, 2, ... of a function of one parameter
Tower = list[Component]
# for each component the products (f of u, g of v) that it sums
Terms = Sequence[Sequence[tuple[Tower, Tower]]]

FULL_TURN = (0.0, 2.0 * math.pi)


class SeparableMap(SmoothMap):
    """A chart whose components are sums of products f(u) g(v)."""

    parameters, components = 2, 3

    def __init__(self, terms: Callable[[Floats, Floats, int], Terms]) -> None:
        self.terms = terms

    def partials(self, where: Sequence[Floats], order: int) -> Partials:
        terms = self.terms(where[0], where[1], order)

        def component(products: Sequence[tuple[Tower, Tower]], index: Index) -> Component:
            return total([(f[index[0]], g[index[1]]) for f, g in products])

        return {index: [component(products, index) for products in terms] for index in indices(2, order)}


def circle(t: Floats, order: int) -> tuple[Tower, Tower]:
    """cos t and sin t."""
    c, s = np.cos(t), np.sin(t)
    cycle = [c, -s, -c, s]
    return [cycle[k % 4] for k in range(order + 1)], [cycle[(k + 3) % 4] for k in range(order + 1)]


def hyperbola(t: Floats, order: int, scale: float = 1.0) -> tuple[Tower, Tower]:
    """cosh(t / scale) and sinh(t / scale)."""
    c, s = np.cosh(t / scale), np.sinh(t / scale)
    cosine = [(s if k % 2 else c) * scale**-k for k in range(order + 1)]
    sine = [(c if k % 2 else s) * scale**-k for k in range(order + 1)]
    return cosine, sine


def power(t: Floats, n: int, order: int) -> Tower:
    """t^n."""
    return [math.perm(n, k) * t ** (n - k) if k < n else float(math.perm(n, k)) for k in range(order + 1)]


def times(factor: float, tower: Tower) -> Tower:
    """factor * f."""
    return [factor * f for f in tower]


def plus(constant: float, tower: Tower) -> Tower:
    """constant + f."""
    return [constant + tower[0], *tower[1:]]


def turned(
    u: Floats, radius: Tower, height: Tower, order: int, stretch: tuple[float, float] = (1.0, 1.0)
) -> Terms:
    """The surface of revolution of (radius, height) about z, its cross-section possibly an ellipse."""
    c, s = circle(u, order)
    one = power(u, 0, order)
    return [[(times(stretch[0], c), radius)], [(times(stretch[1], s), radius)], [(one, height)]]


def graph(u: Floats, v: Floats, order: int, height: Sequence[tuple[Tower, Tower]]) -> Terms:
    """(u, v, height(u, v))."""
    one = power(u, 0, order)
    return [[(power(u, 1, order), one)], [(one, power(v, 1, order))], height]


class Plane(ReadyChart):
    """(u, v, 0)."""

    def __init__(self) -> None:
        super().__init__(SeparableMap(lambda u, v, n: graph(u, v, n, [])), ((0.0, 1.0), (0.0, 1.0)))


class Cylinder(ReadyChart):
    """(R cos u, R sin u, v): normal outward, curvatures 0 and -1/R."""

    def __init__(self, R: float = 1.0) -> None:
        def terms(u: Floats, v: Floats, n: int) -> Terms:
            return turned(u, times(R, power(v, 0, n)), power(v, 1, n), n)

        super().__init__(SeparableMap(terms), (FULL_TURN, (0.0, 1.0)), R=R)


class Cone(ReadyChart):
    """(R v cos u, R v sin u, height v): radius R at v = 1, singular at the tip v = 0, normal outward."""

    def __init__(self, R: float = 1.0, height: float = 1.0) -> None:
        def terms(u: Floats, v: Floats, n: int) -> Terms:
            return turned(u, times(R, power(v, 1, n)), times(height, power(v, 1, n)), n)

        super().__init__(SeparableMap(terms), (FULL_TURN, (0.0, 1.0)), R=R, height=height)


class Sphere(ReadyChart):
    """(R cos u sin v, R sin u sin v, R cos v): v from the north pole; normal inward, curvatures 1/R."""

    def __init__(self, R: float = 1.0) -> None:
        def terms(u: Floats, v: Floats, n: int) -> Terms:
            c, s = circle(v, n)
            return turned(u, times(R, s), times(R, c), n)

        super().__init__(SeparableMap(terms), (FULL_TURN, (0.0, math.pi)), R=R)


class Torus(ReadyChart):
    """((R + r cos v) cos u, (R + r cos v) sin u, -r sin v): outer equator v = 0, normal inward, k1 = 1/r."""

    def __init__(self, R: float = 2.0, r: float = 1.0) -> None:
        def terms(u: Floats, v: Floats, n: int) -> Terms:
            c, s = circle(v, n)
            return turned(u, plus(R, times(r, c)), times(-r, s), n)

        super().__init__(SeparableMap(terms), (FULL_TURN, FULL_TURN), R=R, r=r)
        if r >= R:
            raise InputError(f"torus: r = {r:g} must be less than R = {R:g}, or the surface cuts itself")


class Ellipsoid(ReadyChart):
    """(a cos u sin v, b sin u sin v, c cos v): v from the pole on z; normal inward."""

    def __init__(self, a: float = 3.0, b: float = 2.0, c: float = 1.0) -> None:
        def terms(u: Floats, v: Floats, n: int) -> Terms:
            cosine, sine = circle(v, n)
            return turned(u, sine, times(c, cosine), n, stretch=(a, b))

        super().__init__(SeparableMap(terms), (FULL_TURN, (0.0, math.pi)), a=a, b=b, c=c)


class Hypar(ReadyChart):
    """(u, v, u^2/a^2 - v^2/b^2), the hyperbolic paraboloid."""

    def __init__(self, a: float = 1.0, b: float = 1.0) -> None:
        def terms(u: Floats, v: Floats, n: int) -> Terms:
            one = power(u, 0, n)
            return graph(
                u, v, n, [(times(a**-2, power(u, 2, n)), one), (one, times(-(b**-2), power(v, 2, n)))]
            )

        super().__init__(SeparableMap(terms), ((-0.5, 0.5), (-0.5, 0.5)), a=a, b=b)


class Hyperboloid(ReadyChart):
    """(a cosh v cos u, a cosh v sin u, c sinh v), of one sheet; normal outward."""

    def __init__(self, a: float = 1.0, c: float = 1.0) -> None:
        def terms(u: Floats, v: Floats, n: int) -> Terms:
            cosine, sine = hyperbola(v, n)
            return turned(u, times(a, cosine), times(c, sine), n)

        super().__init__(SeparableMap(terms), (FULL_TURN, (-1.0, 1.0)), a=a, c=c)


class Catenoid(ReadyChart):
    """(c cosh(v/c) cos u, c cosh(v/c) sin u, v), a minimal surface; normal outward."""

    def __init__(self, c: float = 1.0) -> None:
        def terms(u: Floats, v: Floats, n: int) -> Terms:
            return turned(u, times(c, hyperbola(v, n, c)[0]), power(v, 1, n), n)

        super().__init__(SeparableMap(terms), (FULL_TURN, (-1.0, 1.0)), c=c)


class Helicoid(ReadyChart):
    """(u cos v, u sin v, c v), a minimal surface."""

    def __init__(self, c: float = 1.0) -> None:
        def terms(u: Floats, v: Floats, n: int) -> Terms:
            cosine, sine = circle(v, n)
            along, one = power(u, 1, n), power(u, 0, n)
            return [[(along, cosine)], [(along, sine)], [(one, times(c, power(v, 1, n)))]]

        super().__init__(SeparableMap(terms), ((-1.0, 1.0), FULL_TURN), c=c)


class MonkeySaddle(ReadyChart):
    """(u, v, (u^3 - 3 u v^2) / a^2), with a planar point at the origin."""

    def __init__(self, a: float = 1.0) -> None:
        def terms(u: Floats, v: Floats, n: int) -> Terms:
            f = a**-2
            saddle = [
                (times(f, power(u, 3, n)), power(v, 0, n)),
                (times(-3.0 * f, power(u, 1, n)), power(v, 2, n)),
            ]
            return graph(u, v, n, saddle)

        super().__init__(SeparableMap(terms), ((-1.0, 1.0), (-1.0, 1.0)), a=a)


READY: dict[str, Callable[..., ReadyChart]] = {
    c.__name__.lower(): c
    for c in (
        Plane,
        Cylinder,
        Cone,
        Sphere,
        Torus,
        Ellipsoid,
        Hypar,
        Hyperboloid,
        Catenoid,
        Helicoid,
        MonkeySaddle,
    )
}


def ready_chart(kind: str, **constants: float) -> ReadyChart:
    """The ready chart of a kind such as "cylinder", with its constants by name.

    Raises
    ------
    InputError
        If there is no such chart, it has no such constant, or a constant is not a positive number.
    """
    chart = READY.get(str(kind).lower())
    if chart is None:
        raise InputError(f'there is no ready chart "{clipped(kind)}"; there are {", ".join(READY)}')
    known = list(inspect.signature(chart).parameters)
    unknown = [key for key in constants if key not in known]
    if unknown:
        has = ", ".join(known) or "none"
        raise InputError(f'the chart "{kind}" has no constant "{unknown[0]}"; its constants are: {has}')
    return chart(**constants)
