"""The theorem of Gauss and Bonnet on a rectangle of parameters, with boundary and corners.

    int K dA + int k_g ds + sum of exterior angles = 2 pi (Euler characteristic)

A side that is a pole or glued to its opposite is no boundary; the region is then a disc, an annulus, a
sphere or a torus. A region with any other boundary is the image of a rectangle or disc: reparametrise.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from kshell.errors import InputError
from kshell.geometry.components import Floats
from kshell.geometry.curve import Curve
from kshell.geometry.exact import SymbolicMap
from kshell.geometry.quadrature import over_interval

if TYPE_CHECKING:
    from kshell.geometry.chart import Chart
    from kshell.geometry.places import Range

CLOSED = 1e-9  # of the size: points nearer than that are one
SMOOTH = 1e-7  # radians: sides are glued only where the tangent planes agree to that


@dataclass(frozen=True)
class GaussBonnet:
    """The terms of the theorem.

    Attributes
    ----------
    curvature : float
        Integral of the Gaussian curvature over the surface.
    boundary : float
        Integral of the geodesic curvature over the boundary, the surface to the left.
    corners : tuple of float
        Exterior angles.
    characteristic : int
        Euler characteristic of the region.
    """

    curvature: float
    boundary: float
    corners: tuple[float, ...]
    characteristic: int

    @property
    def total(self) -> float:
        """Sum of the left-hand side."""
        return self.curvature + self.boundary + sum(self.corners)

    @property
    def residual(self) -> float:
        """What the two sides differ by: rounding and quadrature, if the theorem and the program are right."""
        return self.total - 2.0 * math.pi * self.characteristic


def gauss_bonnet(
    chart: Chart, u_range: Sequence[float] | None = None, v_range: Sequence[float] | None = None
) -> GaussBonnet:
    """Evaluate every term for the part of a chart over a rectangle (the whole domain if none is given).

    Raises
    ------
    InputError
        If the chart is singular inside, or at a side that is not one smooth pole (a cone's tip has an angle
        of its own: leave it out of the range).
    """
    u, v = chart.ranges(u_range, v_range)
    lines, size = _sides(chart, u, v), _size(chart, u, v)
    pole = {side: _is_pole(chart, line, size) for side, line in lines.items()}
    glued = {a: _is_glued(chart, u, v, a, size) and not pole[a + "0"] for a in "uv"}
    for side in lines:
        if pole[side] and glued["v" if side[0] == "u" else "u"]:
            _refuse_tip(chart, side, u, v)
    open_sides = [side for side in lines if not pole[side] and not glued[side[0]]]

    curvature = chart.integrate(lambda s: s.gaussian_curvature, u, v, scale=1.0)
    boundary = sum(_turning(chart, lines[side]) for side in open_sides)
    corners = tuple(_exterior_angle(chart, lines, u, v, pair) for pair in _corner_pairs(open_sides))
    return GaussBonnet(curvature, boundary, corners, _characteristic(chart, pole, glued))


def _sides(chart: Chart, u: Range, v: Range) -> dict[str, Curve]:
    """The four sides as paths in the parameters, t from 0 to 1, the rectangle to the left."""

    def line(u_text: str, v_text: str) -> Curve:
        constants = {"a": u[0], "b": u[1], "c": v[0], "d": v[1]}
        return Curve(SymbolicMap.from_texts([u_text, v_text, "0"], ["t"], constants), name="side")

    return {
        "v0": line("a + (b - a)*t", "c"),
        "u1": line("b", "c + (d - c)*t"),
        "v1": line("b + (a - b)*t", "d"),
        "u0": line("a", "d + (c - d)*t"),
    }


def _size(chart: Chart, u: Range, v: Range) -> float:
    grid = chart(*np.meshgrid(np.linspace(*u, 9), np.linspace(*v, 9)))
    return float(np.ptp(grid.reshape(-1, 3), axis=0).max())


def _is_pole(chart: Chart, line: Curve, size: float) -> bool:
    path = line(np.linspace(0.0, 1.0, 17))
    x = chart(path[:, 0], path[:, 1])
    return bool(np.ptp(x, axis=0).max() <= CLOSED * size)


def _refuse_tip(chart: Chart, side: str, u: Range, v: Range) -> None:
    """Raise InputError unless the parameter line next to a pole turns by 2 pi, as around a smooth point."""
    near = {"u0": 1e-4, "u1": 1.0 - 1e-4, "v0": 1e-4, "v1": 1.0 - 1e-4}[side]
    if side[0] == "v":
        line = _sides(chart, u, (v[0] + near * (v[1] - v[0]), v[1]))["v0"]
    else:
        line = _sides(chart, (u[0], u[0] + near * (u[1] - u[0])), v)["u1"]
    turning = abs(_turning(chart, line))
    if abs(turning - 2.0 * math.pi) > 1e-3:
        raise InputError(
            f"{chart.name}: the side {side} is one point, around which the surface turns by {turning:.6g} "
            "instead of 2 pi: it is a tip, where curvature is concentrated; choose a range without it"
        )


def _is_glued(chart: Chart, u: Range, v: Range, axis: str, size: float) -> bool:
    """Whether the two sides coincide, with one tangent plane at each inner point."""
    inner = np.linspace(0.0, 1.0, 19)[1:-1]
    if axis == "u":
        along = v[0] + (v[1] - v[0]) * inner
        first, last = (np.full_like(along, u[0]), along), (np.full_like(along, u[1]), along)
    else:
        along = u[0] + (u[1] - u[0]) * inner
        first, last = (along, np.full_like(along, v[0])), (along, np.full_like(along, v[1]))
    a, b = chart(*first), chart(*last)
    if np.abs(a - b).max() > CLOSED * size or np.ptp(a, axis=0).max() <= CLOSED * size:
        return False
    return bool(np.abs(chart.at(*first).normal - chart.at(*last).normal).max() < SMOOTH)


def _turning(chart: Chart, line: Curve) -> float:
    curve = chart.along(line)

    def integrand(t: Floats) -> Floats:
        p = curve.at(t)
        return p.geodesic_curvature * p.space.speed

    return over_interval(integrand, 0.0, 1.0, "the turning of a side", scale=1.0)


def _corner_pairs(open_sides: list[str]) -> list[tuple[str, str]]:
    around = ["v0", "u1", "v1", "u0"]
    pairs = zip(around, around[1:] + around[:1], strict=True)
    return [pair for pair in pairs if pair[0] in open_sides and pair[1] in open_sides]


def _exterior_angle(
    chart: Chart, lines: dict[str, Curve], u: Range, v: Range, pair: tuple[str, str]
) -> float:
    arriving, leaving = (
        lines[side].derivatives(t, order=1) for side, t in zip(pair, (1.0, 0.0), strict=True)
    )
    s = chart.at(arriving[0][0], arriving[0][1])
    return float(s.angle_between(arriving[1][:2], leaving[1][:2]))


def _characteristic(chart: Chart, pole: dict[str, bool], glued: dict[str, bool]) -> int:
    poles = sum(pole.values())
    if glued["u"] and glued["v"]:
        return 0
    for axis, other in (("u", "v"), ("v", "u")):
        if glued[axis]:
            return pole[other + "0"] + pole[other + "1"]
    if poles:
        raise InputError(
            f"{chart.name}: a side is a pole but the sides beside it are not glued smoothly, so the region "
            "has a corner there whose angle this chart does not give: choose a range without the pole"
        )
    return 1
