"""Shells curved in two directions: hemispheres, a sphere under pressure, hyperbolic paraboloids."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import kshell as ks
from kshell.verify.cases import meshes
from kshell.verify.cases.case import Case, case
from kshell.verify.cases.quantities import Compliance, Moves, Tensor
from kshell.verify.cases.shell import Parameters, Shell, runs, to_both_ends, to_end

LEANING = 1 / np.sqrt(3)


def octant(radius: float) -> ks.geometry.Chart:
    """The triangle u, v >= 0, u + v <= 1 onto an eighth of a sphere, corners onto the axes; normal outward."""
    x, y, z = "sin(pi/2*u)", "sin(pi/2*v)", "sin(pi/2*(1-u-v))"
    size = f"{float(radius)!r}/sqrt({x}**2+{y}**2+{z}**2)"
    return ks.geometry.Chart.from_expressions(
        f"{x}*{size}", f"{y}*{size}", f"{z}*{size}", name="octant of a sphere"
    )


def octant_mesh(n: int) -> ks.Mesh:
    """Its parameters in n * n triangles; sides "x = 0", "y = 0", "z = 0"."""
    plain = meshes.triangle([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)], n)
    sides: dict[str, meshes.Where] = {
        "x = 0": lambda u, v: u < 1e-9,
        "y = 0": lambda u, v: v < 1e-9,
        "z = 0": lambda u, v: u + v > 1 - 1e-9,
    }
    return meshes.mesh(plain.points[:, :2], plain.triangles.astype(np.int64), sides)


def hemispheres() -> Iterator[Case]:
    """Pulled and pushed at the equator by forces of 2, a quarter of it: the full one, and one with a hole."""
    radius = 10.0
    pull, push = (radius, 0.0, 0.0), (0.0, radius, 0.0)
    scene = {
        "thickness": 0.04,
        "material": ks.Isotropic(E=6.825e7, nu=0.3),
        "supports": [ks.Symmetry(["x = 0", "y = 0"]), ks.Fixed(pull, "z")],
        "loads": [ks.PointForce(pull, (1, 0, 0)), ks.PointForce(push, (0, -1, 0))],
    }
    values = {"u_pull": Moves(pull, (1, 0, 0)), "u_push": Moves(push, (0, 1, 0))}
    yield case(
        "shell.hemisphere.full",
        "a quarter of the pinched hemisphere",
        Shell(octant(radius), octant_mesh, scene),
        values,
        runs((16, 32), (12, 24), (8, 16), argyris=(4, 8)),
    )
    chart = ks.geometry.Chart.from_expressions(
        "10*cos(u)*cos(v)", "10*sin(u)*cos(v)", "10*sin(v)", name="sphere"
    )
    zone = Parameters((0, np.pi / 2), (0, np.radians(72)), ("y = 0", "x = 0", "equator", "hole"))
    yield case(
        "shell.hemisphere.hole",
        "a quarter of the pinched hemisphere with a hole of 18 degrees",
        Shell(chart, lambda n: zone.mesh(n, n), scene),
        values,
        runs((16, 32), (12, 24), (8, 16), argyris=(4, 8)),
    )


def spheres() -> Iterator[Case]:
    """Under internal pressure 1, an eighth of it; R = 1, E = 1, nu = 0.3."""
    middle = (LEANING, LEANING, LEANING)
    for t in (0.01, 0.1):
        scene = {
            "thickness": t,
            "material": ks.Isotropic(E=1.0, nu=0.3),
            "supports": [ks.Symmetry(["x = 0", "y = 0", "z = 0"])],
            "loads": [ks.Pressure(1.0)],
        }
        yield case(
            f"shell.sphere.pressure.t{t:g}",
            f"sphere under pressure, t/R = {t:g}",
            Shell(octant(1.0), octant_mesh, scene),
            {
                "w": Moves(middle, middle),
                "N": Tensor(middle, "membrane_stress_resultant", "xx"),
                "compliance": Compliance(),
            },
            runs((12, 24), (6, 12), (4, 8), argyris=(2, 4)),
        )


def rims() -> Iterator[Case]:
    """The rim of a hemisphere, R = 1, t = 0.01, under a force of 1 per length outwards."""
    sector = Parameters((0, 0.2), (np.pi / 6, np.pi / 2), ("cuts", "cuts", "far", "rim"), grade_v=to_end)
    rim = (1.0, 0.0, 0.0)
    scene = {
        "thickness": 0.01,
        "material": ks.Isotropic(E=1.0, nu=0.3),
        "supports": [ks.Symmetry("cuts"), ks.Fixed("far", "z")],  # the latter carries nothing
        "loads": [ks.LineForce("rim", ("x", "y", 0))],
    }
    yield case(
        "shell.sphere.edge",
        "rim of a hemisphere, t/R = 0.01, under a force of 1 per length along it",
        Shell(ks.geometry.Sphere(), lambda n: sector.mesh(max(n // 6, 2), n), scene),
        {"w_rim": Moves(rim, (1, 0, 0)), "slope_rim": Moves(rim, (0, -1, 0), "rotation")},
        runs((32, 64), (18, 36), (12, 24), argyris=(8, 16)),
    )


def hypars() -> Iterator[Case]:
    """z = x^2 - y^2, clamped at x = -1/2, under its own weight of 8000 per volume; half of it."""
    half = Parameters(
        (-0.5, 0.5), (0, 0.5), ("clamped", "free", "y = 0", "free side"),
        to_both_ends, lambda s: np.sin(np.pi / 2 * s),
    )  # fmt: skip
    tip = (0.5, 0.0, 0.25)
    for t in (1e-2, 1e-3, 1e-4):
        scene = {
            "thickness": t,
            "material": ks.Isotropic(E=2e11, nu=0.3),
            "supports": [ks.Clamped("clamped"), ks.Symmetry("y = 0")],
            "loads": [ks.Traction((0, 0, -8000.0 * t))],
        }
        yield case(
            f"shell.hypar.t{t:g}",
            f"hyperbolic paraboloid clamped at one side, t/L = {t:g}",
            Shell(ks.geometry.Hypar(), lambda n: half.mesh(n, n // 2), scene),
            {"w_tip": Moves(tip, (0, 0, 1)), "compliance": Compliance()},
            runs((16, 32), (12, 24), (10, 20), argyris=(8, 16)),
        )


def cases() -> list[Case]:
    """All of them."""
    return [one for family in (hemispheres, spheres, rims, hypars) for one in family()]
