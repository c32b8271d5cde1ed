"""Cylindrical shells: roofs, pinched cylinders, edges of tubes, and a quarter circle bent without stretching."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

import kshell as ks
from kshell.verify.cases.case import TRUE_SURFACE, Case, Run, case
from kshell.verify.cases.quantities import Compliance, Moves, Quantity, Tensor
from kshell.verify.cases.shell import Parameters, Shell, runs, to_start

DOWN, OUT = (0.0, 0.0, -1.0), (1.0, 0.0, 0.0)


def lying(radius: float) -> ks.geometry.Chart:
    """(arc length, axis): crown at z = radius, axis along y, normal outward."""
    r = repr(float(radius))
    return ks.geometry.Chart.from_expressions(f"{r}*sin(u/{r})", "v", f"{r}*cos(u/{r})", name="cylinder")


def roofs() -> Iterator[Case]:
    """The Scordelis-Lo roof, a quarter of it, and the same ten times thinner."""
    radius, half = 25.0, np.radians(40.0)
    quarter = Parameters((0, radius * half), (0, 25.0), ("crown", "free", "middle", "wall"))
    edge = (radius * np.sin(half), 0.0, radius * np.cos(half))
    values: dict[str, Quantity] = {
        "w_free_edge": Moves(edge, (0, 0, 1)),
        "w_crown": Moves((0, 0, radius), (0, 0, 1)),
    }
    for name, thickness, energy in (("", 0.25, True), (".thin", 0.025, False)):
        scene = {
            "thickness": thickness,
            "material": ks.Isotropic(E=4.32e8, nu=0.0),
            "supports": [ks.Symmetry(["middle", "crown"]), ks.Fixed("wall", "xz")],
            "loads": [ks.Traction((0, 0, -360.0 * thickness))],
        }
        shell = Shell(lying(radius), lambda n: quarter.mesh(n, max(n // 2, 2)), scene)
        yield case(
            f"shell.scordelis_lo{name}",
            f"a quarter of the Scordelis-Lo roof, thickness {thickness:g}",
            shell,
            {**values, "compliance": Compliance()} if energy else {"w_free_edge": values["w_free_edge"]},
            runs((16, 32), (8, 16), (6, 12), argyris=(4, 8)),
        )


def pinched() -> Iterator[Case]:
    """Between two forces: with rigid diaphragms at the ends and without; an eighth of the cylinder."""
    # radius, half length, thickness, E, nu, force
    kinds: dict[str, tuple[float, ...]] = {
        "diaphragm": (300.0, 300.0, 3.0, 3e6, 0.3, 1.0),
        "diaphragm.thin": (300.0, 300.0, 0.3, 3e6, 0.3, 1.0),
        "free": (4.953, 5.175, 0.094, 10.5e6, 0.3125, 100.0),
    }
    for name, (radius, length, thickness, E, nu, force) in kinds.items():
        grade = to_start(2.0)
        eighth = Parameters(
            (0, radius * np.pi / 2), (0, length), ("top", "side", "middle", "end"), grade, grade
        )
        top = (0.0, 0.0, radius)
        supports: list[Any] = [ks.Symmetry(["top", "side", "middle"])]
        if name.startswith("diaphragm"):
            supports.append(ks.Fixed("end", "xz"))
        scene = {
            "thickness": thickness,
            "material": ks.Isotropic(E=E, nu=nu),
            "supports": supports,
            "loads": [ks.PointForce(top, (0, 0, -force / 4))],
        }
        yield case(
            f"shell.pinched_cylinder.{name}",
            f"an eighth of a cylinder pinched by two forces, t/R = {thickness / radius:.2g}, ends {name.split('.')[0]}",
            Shell(lying(radius), lambda n, eighth=eighth: eighth.mesh(n, n), scene),  # type: ignore[misc]
            {"w_force": Moves(top, DOWN)},
            runs((16, 32), (10, 20), (8, 14), argyris=(6, 10)),
        )


def tubes() -> Iterator[Case]:
    """The end of a long tube, R = 1, t = 0.01: force and moment along its rim, and clamped under pressure."""
    sector = Parameters((0, 0.2), (0, 1.5), ("cuts", "cuts", "end", "far"), grade_v=to_start(1.5))
    rim = (1.0, 0.0, 0.0)
    beyond = (1.0, 0.0, np.pi / 12.85407003320672)
    tilt: Quantity = Moves(rim, (0, 1, 0), "rotation")
    widens: Quantity = Moves(rim, OUT)
    symmetric = ks.Symmetry(["cuts", "far"])
    kinds: dict[str, tuple[list[Any], Any, dict[str, Quantity]]] = {
        "force": ([symmetric], ks.LineForce("end", ("x", "y", 0)), {"w_end": widens, "slope_end": tilt}),
        "moment": ([symmetric], ks.EdgeMoment("end", 1.0), {"w_end": widens, "slope_end": tilt}),
        "clamped.pressure": (
            [symmetric, ks.Fixed("end", "xyr")],
            ks.Pressure(1.0),
            {"w_far": Moves((1, 0, 1.5), OUT), "w_most": Moves(beyond, OUT), "M_end": Tensor(rim, "M", "yy")},
        ),
    }
    words = {
        "force": "a force of 1 per length along its rim",
        "moment": "a moment of 1 per length along its rim",
        "clamped.pressure": "pressure 1, the rim clamped but free along the axis",
    }
    for name, (supports, load, quantities) in kinds.items():
        scene = {
            "thickness": 0.01,
            "material": ks.Isotropic(E=1.0, nu=0.3),
            "supports": supports,
            "loads": [load],
        }
        yield case(
            f"shell.tube.{name}",
            f"end of a long tube, t/R = 0.01, {words[name]}",
            Shell(ks.geometry.Cylinder(), lambda n: sector.mesh(max(n // 6, 2), n), scene),
            quantities,
            runs((32, 64), (18, 36), (12, 24), argyris=(8, 16)),
        )


def rings() -> Iterator[Case]:
    """A quarter circle, R = 1, nu = 0, bent by a force at its tip so that it hardly stretches."""
    quarter = Parameters((0, np.pi / 2), (0, 1.0), ("root", "tip", "sides", "sides"))
    for t in (1e-1, 1e-3, 1e-5):
        stiffness = t**3 / 12
        scene = {
            "thickness": t,
            "material": ks.Isotropic(E=1.0, nu=0.0),
            "supports": [ks.Clamped("root")],
            "loads": [ks.LineForce("tip", (stiffness, 0, 0))],
        }
        yield case(
            f"shell.quarter_circle.t{t:g}",
            f"quarter circle in pure bending, t/R = {t:g}",
            Shell(lying(1.0), lambda n: quarter.mesh(n, max(n // 4, 1)), scene),
            {"u_tip": Moves((1.0, 0.5, 0.0), OUT), "compliance": Compliance(stiffness)},
            (
                *runs((16, 32), (8, 16), (4, 8)),
                *([Run("argyris", 4, TRUE_SURFACE)] if t > 1e-2 else []),
            ),
        )


def cases() -> list[Case]:
    """All of them."""
    return [one for family in (roofs, pinched, tubes, rings) for one in family()]
