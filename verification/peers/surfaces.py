"""The shells that are compared, as data that any driver can read: it needs neither numpy nor kshell.

Each is a rectangle of parameters u, v over the unit square of s, t and a chart to space. Sides of the square are left
(s = 0), right (s = 1), bottom (t = 0) and top (t = 1); freedoms are 1 to 6, three translations and three rotations.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

Triple = tuple[float, float, float]
Corner = tuple[float, float]

# what a support holds, as freedoms of a node
FREEDOMS = {
    "clamped": "123456",
    "symmetry x": "156",  # the plane that has x as normal
    "symmetry y": "246",
    "symmetry z": "345",
    "diaphragm xy": "12",
}


@dataclass(frozen=True)
class Surface:
    """A shell.

    Attributes
    ----------
    chart : str and constants
        plane, polar, cylinder, sphere or hypar; the last three as in `kshell.geometry`.
    u, v : range of the parameters over s and t
    material : E, nu, thickness
    held : dict of side to a word of FREEDOMS
    read : (s, t), axis, sign
        The displacement that is compared.
    points : sequence of (s, t), force
    lines : sequence of side, force per length
    dead : force per area
    pinned : sequence of (s, t), freedom
    graded : (rule, strength) for s and for t
        How grids condense: "start", "end", "both" or "none".
    cells : cells along s and t for one of the count
    moment : (s, t)
        Where the moment is compared.
    steps : dict of program to int
        Load steps of programs that take them as given, the fewest with which they converge, if
        they do; large deflections if any.
    """

    chart: tuple[str, dict[str, float]]
    u: tuple[float, float]
    v: tuple[float, float]
    material: Triple
    held: dict[str, str]
    read: tuple[Corner, int, float]
    points: tuple[tuple[Corner, Triple], ...] = ()
    lines: tuple[tuple[str, Triple], ...] = ()
    dead: Triple = (0.0, 0.0, 0.0)
    pinned: tuple[tuple[Corner, int], ...] = ()
    graded: tuple[tuple[str, float], tuple[str, float]] = (("none", 0.0), ("none", 0.0))
    cells: tuple[float, float] = (1.0, 1.0)
    moment: Corner = (0.5, 0.5)
    steps: dict[str, int] = field(default_factory=dict)

    def grid(self, count: int) -> tuple[int, int]:
        """Cells along s and t."""
        along, across = (max(1, round(count * factor)) for factor in self.cells)
        return along, across

    def parameters(self, s: Any, t: Any, functions: Any = math) -> tuple[Any, Any]:
        """u and v; functions is math, numpy or ngsolve."""
        a, b = (
            _grade(x, *rule, functions) if rule[0] != "none" else x
            for x, rule in zip((s, t), self.graded, strict=True)
        )
        return self.u[0] + (self.u[1] - self.u[0]) * a, self.v[0] + (self.v[1] - self.v[0]) * b

    def place(self, s: Any, t: Any, functions: Any = math) -> tuple[Any, Any, Any]:
        """x, y, z."""
        u, v = self.parameters(s, t, functions)
        sin, cos = functions.sin, functions.cos
        name, constants = self.chart
        if name == "plane":
            return u, v, 0 * u
        if name == "polar":
            return v * cos(u), -v * sin(u), 0 * u
        if name == "hypar":
            return u, v, u * u - v * v
        radius = constants["R"]
        if name == "cylinder":
            return radius * cos(u), radius * sin(u), v
        return radius * cos(u) * sin(v), radius * sin(u) * sin(v), radius * cos(v)

    def normal(self, x: Any) -> Any:
        """Normals, of any length, at points (n, 3)."""
        name, _ = self.chart
        if name in ("plane", "polar"):
            return 0 * x + [0.0, 0.0, 1.0]
        if name == "hypar":
            return x * [-2.0, 2.0, 0.0] + [0.0, 0.0, 1.0]
        return x * ([1.0, 1.0, 0.0] if name == "cylinder" else [1.0, 1.0, 1.0])


def _grade(s: Any, rule: str, strength: float, functions: Any) -> Any:
    """Monotone from [0, 1] onto itself, smooth, slow at one end or at both."""
    if rule == "start":
        return s * (1 + strength * s) / (1 + strength)
    if rule == "end":
        return 1 - _grade(1 - s, "start", strength, functions)
    return s - strength * functions.sin(2 * math.pi * s) / (2 * math.pi)


def _roof(thickness: float) -> Surface:
    """A quarter of the Scordelis-Lo roof, its crown along x."""
    return Surface(
        chart=("cylinder", {"R": 25.0}),
        u=(0.0, math.radians(40.0)),
        v=(0.0, 25.0),
        material=(4.32e8, 0.0, thickness),
        held={"left": "symmetry y", "bottom": "symmetry z", "top": "diaphragm xy"},
        read=((1, 0), 0, -1.0),
        dead=(-90.0, 0.0, 0.0),
    )


SURFACES = {
    "scordelis_lo": _roof(0.25),
    "thin_roof": _roof(0.025),
    # an eighth of the cylinder, a quarter of the force at (300, 0, 0)
    "pinched_cylinder": Surface(
        chart=("cylinder", {"R": 300.0}),
        u=(0.0, math.pi / 2),
        v=(0.0, 300.0),
        material=(3e6, 0.3, 3.0),
        held={"left": "symmetry y", "right": "symmetry x", "bottom": "symmetry z", "top": "diaphragm xy"},
        points=(((0, 0), (-0.25, 0.0, 0.0)),),
        read=((0, 0), 0, -1.0),
        graded=(("start", 25.0), ("start", 25.0)),
    ),
    # a quarter, pulled at (10, 0, 0) and pushed at (0, 10, 0) by half of the forces of 2
    "hemisphere_hole": Surface(
        chart=("sphere", {"R": 10.0}),
        u=(math.pi / 2, 0.0),
        v=(math.pi / 2, math.pi / 10),
        material=(6.825e7, 0.3, 0.04),
        held={"left": "symmetry x", "right": "symmetry y"},
        points=(((1, 0), (1.0, 0.0, 0.0)), ((0, 0), (0.0, -1.0, 0.0))),
        pinned=(((1, 0), 3),),
        moment=(1.0, 0.5),  # in the middle symmetry makes it vanish
        read=((1, 0), 0, 1.0),
        graded=(("both", 0.9), ("start", 8.0)),
    ),
    # half of it, clamped at u = -1/2, under 8000 per volume
    "hypar": Surface(
        chart=("hypar", {}),
        u=(-0.5, 0.5),
        v=(0.0, 0.5),
        material=(2e11, 0.3, 1e-3),
        held={"left": "clamped", "bottom": "symmetry y"},
        dead=(0.0, 0.0, -8.0),
        read=((1, 0), 2, -1.0),
        graded=(("both", 0.9), ("end", 8.0)),
        cells=(1.0, 0.5),
    ),
    "strip": Surface(
        chart=("plane", {}),
        u=(0.0, 10.0),
        v=(0.0, 1.0),
        material=(1.2e6, 0.0, 0.1),
        held={"left": "clamped"},
        lines=(("right", (0.0, 0.0, 4.0)),),
        read=((1, 0), 2, 1.0),
        cells=(1.0, 1 / 16),
        steps={"Kratos": 5, "OpenSees": 20},
    ),
    "slit_annulus": Surface(
        chart=("polar", {}),
        u=(0.0, 2 * math.pi),
        v=(6.0, 10.0),
        material=(21e6, 0.0, 0.03),
        held={"left": "clamped"},
        lines=(("right", (0.0, 0.0, 0.8)),),
        read=((1, 1), 2, 1.0),
        cells=(5.0, 1.0),
        steps={"Kratos": 100, "OpenSees": 100},
    ),
}
