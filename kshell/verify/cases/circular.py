"""Disks, rings and ellipses on meshes of order 1 and 2: curved edges of all kinds.

Outer radius (or longer semi-axis) 1, bending stiffness 1, nu = 0.3. On rings the first letter is the
inner edge, the second the outer: C clamped, S simply supported, F free, G guided (no slope, no force).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

import kshell as ks
from kshell.verify.cases import meshes
from kshell.verify.cases.case import Case, case
from kshell.verify.cases.plate import plate, runs
from kshell.verify.cases.quantities import At, Compliance, Quantity, Reaction

POINT_LAYERS = 3
ORIGIN = (0.0, 0.0)
EDGE = (1.0, 0.0)

RINGS = {  # radius of the hole: kinds of edges and load (q pressure, P force 1 and m moment along the inner edge)
    0.2: "CF.q SF.q FC.q FC.P FS.q FS.P FS.m CC.q SS.q SC.q CS.q GC.q GC.P GS.q GS.P",
    0.5: "SF.q FC.P FS.P FS.m CC.q SS.q CS.q GC.q GS.q GS.P",
}
LOADS = {
    "q": "uniform pressure",
    "P": "force 1 spread along the inner edge",
    "m": "moment 1 per length along the inner edge",
}


def disks() -> Iterator[Case]:
    """Whole disks, and quarters."""
    pressure, force = ks.Pressure(1.0), ks.PointForce((0, 0, 0), (0, 0, 1))
    moments: dict[str, Quantity] = {"M_c": At(ORIGIN, "Mx"), "Mt_edge": At(EDGE, "My")}
    sums: dict[str, Quantity] = {"compliance": Compliance(), "reaction": Reaction()}
    for kind, name in (("C", "clamped"), ("S", "ss")):
        at_edge: dict[str, Quantity] = {"Mr_edge": At(EDGE, "Mx")} if kind == "C" else {}
        words = {"C": "clamped", "S": "simply supported"}[kind]
        yield case(
            f"disk.{name}.uniform",
            f"{words} disk, uniform pressure",
            lambda n, order, kind=kind: plate(meshes.ellipse(n, order), {"edge": kind}, [pressure]),  # type: ignore[misc]
            {"w_c": At(ORIGIN, "w"), **moments, **at_edge, **sums},
            runs(4, 16, curved=True, koiter=(12, 6, 4)),
        )
        yield case(
            f"disk.{name}.uniform.quarter",
            f"a quarter of the {words} disk between planes of symmetry",
            lambda n, order, kind=kind: plate(  # type: ignore[misc]
                meshes.ellipse(n, order, quarter=True), {"edge": kind, "x0": "Y", "y0": "Y"}, [pressure]
            ),
            {"w_c": At(ORIGIN, "w"), **moments, **at_edge},
            runs(4, 16, curved=True),
            f"disk.{name}.uniform",
        )
        half: dict[str, Quantity] = {"w_half": At((0.5, 0.0), "w")}
        yield case(
            f"disk.{name}.point",
            f"{words} disk, force in the middle",
            lambda n, order, kind=kind: plate(  # type: ignore[misc]
                meshes.ellipse(n, order, layers=POINT_LAYERS), {"edge": kind}, [force]
            ),
            {"w_c": At(ORIGIN, "w"), **half, **at_edge, **sums},
            runs(4, 16, curved=True),
        )


def rings() -> Iterator[Case]:
    """All kinds of edges on two rings."""
    for b, kinds in RINGS.items():
        for kind in kinds.split():
            inner, outer, load = kind[0], kind[1], kind[3]
            yield case(
                f"annulus.{kind}.b{b:g}",
                f"ring of inner radius {b:g}, inner edge {inner}, outer {outer}, " + LOADS[load],
                _ring(b, inner, outer, load),
                _ring_quantities(b, inner, outer, load),
                runs(6 if b < 0.5 else 4, 24, curved=True),
            )
    yield case(
        "annulus.FC.q.b0.2.quarter",
        "a quarter of the ring between planes of symmetry",
        _ring(0.2, "F", "C", "q", quarter=True),
        {
            name: value
            for name, value in _ring_quantities(0.2, "F", "C", "q").items()
            if name not in ("reaction", "compliance")
        },
        runs(6, 24, curved=True),
        "annulus.FC.q.b0.2",
    )


def _ring(
    b: float, inner: str, outer: str, load: str, quarter: bool = False
) -> Callable[[int, int], ks.Scene]:
    loads = {
        "q": ks.Pressure(1.0),
        "P": ks.LineForce("inner", (0, 0, 1 / (2 * np.pi * b))),
        "m": ks.EdgeMoment("inner", 1.0),
    }
    straight = {"x0": "Y", "y0": "Y"} if quarter else {}

    def scene(refinement: int, order: int) -> ks.Scene:
        mesh = meshes.annulus(b, refinement, order, quarter)
        return plate(mesh, {"inner": inner, "outer": outer, **straight}, [loads[load]])

    return scene


def _ring_quantities(b: float, inner: str, outer: str, load: str) -> dict[str, Quantity]:
    """Deflections and moments that do not vanish."""
    hole, rim = (b, 0.0), EDGE
    out: dict[str, Quantity] = {"w_mid": At(((1 + b) / 2, 0.0), "w")}
    if inner in "FG":
        out["w_in"] = At(hole, "w")
    if outer == "F":
        out["w_out"] = At(rim, "w")
    if inner in "CG" and load == "q":
        out["Mr_in"] = At(hole, "Mx")
    out["Mt_in"] = At(hole, "My")
    if outer == "C":
        out["Mr_out"] = At(rim, "Mx")
    if load == "m":
        out["Mr_mid"] = At(((1 + b) / 2, 0.0), "Mx")
    if load in "qm":
        out["Mt_out"] = At(rim, "My")
    if inner in "CS" and outer in "CS":
        out["reaction_in"] = Reaction("inner")
    if load != "m":  # a moment needs no reaction
        out["reaction"] = Reaction()
    return {**out, "compliance": Compliance()}


def ellipses() -> Iterator[Case]:
    """Clamped, semi-axes 1 and 1/ratio."""
    for ratio in (1, 2):
        b = 1 / ratio
        yield case(
            f"ellipse.clamped.{ratio}",
            f"clamped ellipse, semi-axes 1 and {b:g}, uniform pressure",
            lambda n, order, b=b: plate(meshes.ellipse(n, order, b), {"edge": "C"}, [ks.Pressure(1.0)]),  # type: ignore[misc]
            {
                "w_c": At(ORIGIN, "w"),
                "Mx_c": At(ORIGIN, "Mx"),
                "My_c": At(ORIGIN, "My"),
                "Mn_end_a": At(EDGE, "Mx"),
                "Mn_end_b": At((0.0, b), "My"),
                "compliance": Compliance(),
                "reaction": Reaction(),
            },
            runs(5, 16, curved=True),
        )


def cases() -> list[Case]:
    """All of them."""
    return [one for family in (disks, rings, ellipses) for one in family()]
