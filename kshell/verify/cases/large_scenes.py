"""Scenes of large deflections with known answers: Sze, Liu & Lo (2004), the elastica, the von Karman plate.

Tables: X. H. Liu, K. Y. Sze and S. H. Lo, Finite Elements in Analysis and Design 40 (2004) 1551-1569, computed with
shells of four nodes that have shear; columns are load factor, then displacements.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import kshell as ks
from kshell.verify.cases.meshes import ellipse, grid, mesh

CANTILEVER = (3.28941, 6.69964)  # -u and w of the tip, converged
ANNULUS = (13.891, 17.528)
HEMISPHERE = (4.067, 8.178)
PULL_OUT = [
    (0.025, 0.819, 0.864, 0.872), (0.05, 1.26, 1.471, 1.493), (0.075, 1.527, 1.901, 1.946),
    (0.1, 1.707, 2.217, 2.293), (0.15, 1.936, 2.641, 2.792), (0.2, 2.079, 2.904, 3.106),
    (0.25, 2.18, 3.087, 3.31), (0.3, 2.257, 3.227, 3.452), (0.35, 2.321, 3.342, 3.556),
    (0.4, 2.376, 3.443, 3.632), (0.45, 2.425, 3.539, 3.688), (0.5, 2.473, 3.653, 3.718),
    (0.525, 2.543, 4.061, 3.58), (0.55, 2.577, 4.171, 3.518), (0.6, 2.618, 4.274, 3.452),
    (0.65, 2.648, 4.338, 3.41), (0.7, 2.672, 4.385, 3.378), (0.75, 2.692, 4.423, 3.353),
    (0.8, 2.71, 4.455, 3.332), (0.85, 2.726, 4.483, 3.313), (0.9, 2.741, 4.508, 3.297),
    (0.95, 2.755, 4.53, 3.283), (1.0, 2.768, 4.551, 3.269),
]  # fmt: skip
ROOF = [
    (0.0877, 0.693), (0.198, 1.638), (0.3473, 3.087), (0.4686, 4.477), (0.5647, 5.802), (0.6381, 7.057),
    (0.6908, 8.237), (0.7246, 9.339), (0.7412, 10.358), (0.7421, 11.293), (0.7286, 12.141), (0.7023, 12.903),
    (0.6649, 13.583), (0.6182, 14.188), (0.5643, 14.728), (0.5055, 15.217), (0.4442, 15.676), (0.383, 16.125),
    (0.3245, 16.59), (0.2717, 17.094), (0.2272, 17.657), (0.194, 18.299), (0.175, 19.028), (0.1729, 19.852),
    (0.1905, 20.771), (0.2303, 21.78), (0.295, 22.875), (0.3871, 24.049), (0.5093, 25.293), (0.6644, 26.601),
    (0.8549, 27.964), (1.0835, 29.374),
]  # fmt: skip
LAMINATED_ROOF = [
    (0.0546, 0.807), (0.1245, 1.956), (0.1938, 3.281), (0.2494, 4.548), (0.2925, 5.753), (0.3244, 6.892),
    (0.3459, 7.961), (0.3582, 8.959), (0.3618, 9.884), (0.3577, 10.735), (0.3464, 11.516), (0.3288, 12.227),
    (0.3057, 12.872), (0.2778, 13.458), (0.2461, 13.99), (0.2115, 14.477), (0.1749, 14.928), (0.0999, 15.774),
    (0.0638, 16.199), (0.0303, 16.648), (0.0007, 17.141), (-0.0236, 17.692), (-0.0411, 18.317),
    (-0.0504, 19.024), (-0.0503, 19.817), (-0.0394, 20.698), (-0.0165, 21.663), (0.0194, 22.707),
    (0.0697, 23.824), (0.1354, 25.005), (0.2178, 26.244), (0.3181, 27.533), (0.4374, 28.864), (0.5769, 30.229),
    (0.7374, 31.622), (1.0192, 33.748),
]  # fmt: skip
# alpha = P L^2 / EI: w / L and shortening / L, elliptic integrals (Bisshopp & Drucker 1945)
ELASTICA = {1.0: (0.30172077379981, 0.056433236283377), 2.0: (0.49345748039671, 0.16064172082517)}
# Q = q R^4 / (E h^4): w / h of a clamped plate with an immovable edge, nu = 0.3, from the equations of von Karman
VON_KARMAN = {
    1: 0.1680340728, 2: 0.3228353605, 5: 0.6796039971, 10: 1.051956765, 20: 1.493792403, 50: 2.198011365,
}  # fmt: skip


def rectangle(a: float, b: float, n_x: int, n_y: int, y: float = 0.0) -> ks.Mesh:
    """[0, a] x [y, y + b] in n_x by n_y cells, with the sides x0, x1, y0, y1."""
    points, triangles = grid(n_x, n_y)
    sides = {
        "x0": lambda x, _: x < 1e-9,
        "x1": lambda x, _: x > a - 1e-9,
        "y0": lambda _, v: v < y + 1e-9,
        "y1": lambda _, v: v > y + b - 1e-9,
    }
    return mesh(points * np.array([a, b]) + np.array([0.0, y]), triangles, sides)


def strip(n: int, length: float, load: Any, **changes: Any) -> ks.Scene:
    """A cantilever along x of width 1 and thickness 0.1, EI = 100."""
    data: dict[str, Any] = {
        "mesh": rectangle(length, 1.0, n, 1),
        "thickness": 0.1,
        "material": ks.Isotropic(E=1.2e6, nu=0.0),
        "supports": [ks.Clamped("x0")],
        "loads": [load],
        "probes": {"tip": (length, 1.0, 0.0)},
    }
    return ks.Scene(**{**data, **changes})


def cantilever(n: int = 8, share: float = 1.0) -> ks.Scene:
    """3.1: end shear 4."""
    return strip(n, 10.0, ks.LineForce("x1", (0, 0, 4.0 * share)), title="cantilever under end shear")


def elastica(alpha: float, n: int = 8) -> ks.Scene:
    """So thin that it does not stretch."""
    return strip(
        n, 10.0, ks.LineForce("x1", (0, 0, alpha)), thickness=0.01, material=ks.Isotropic(1.2e9, 0.0)
    )


def heavy(weight: float, n: int = 8) -> ks.Scene:
    """A thin cantilever under its own weight: rho g t L^3 / EI."""
    load = ks.Gravity((0, 0, -10.0 * weight))
    return strip(n, 10.0, load, thickness=0.01, material=ks.Isotropic(1.2e9, 0.0, density=1.0))


def roll_up(turns: float = 1, n: int = 24) -> ks.Scene:
    """3.2: an end moment 2 pi EI / L per turn; a plane of symmetry keeps the strip straight."""
    return strip(
        n, 12.0, ks.EdgeMoment("x1", -50 * np.pi / 3 * turns),
        supports=[ks.Clamped("x0"), ks.Symmetry("y0")], title=f"roll-up, {turns} turns",
    )  # fmt: skip


def slit_annulus(radial: int = 6, around: int = 30, share: float = 1.0) -> ks.Scene:
    """3.3: lifted along one side of the slit, clamped at the other."""
    chart = ks.geometry.Chart.from_expressions("v*cos(u)", "-v*sin(u)", "0*u")
    return ks.Scene(
        mesh=rectangle(2 * np.pi, 4.0, around, radial, y=6.0), chart=chart,
        thickness=0.03, material=ks.Isotropic(21e6, 0.0),
        supports=[ks.Clamped("x0")], loads=[ks.LineForce("x1", (0, 0, 0.8 * share))], title="slit annulus",
        solve={"element": "koiter", "order": 2},
    )  # fmt: skip


def hemisphere(n: int = 12, order: int = 2, share: float = 1.0) -> ks.Scene:
    """3.4: a quarter of a hemisphere with a hole of 18 degrees, pulled and pushed by forces of 400 at the equator."""
    chart = ks.geometry.Chart.from_expressions("10*cos(u)*cos(v)", "10*sin(u)*cos(v)", "10*sin(v)")
    pull, push = (10.0, 0.0, 0.0), (0.0, 10.0, 0.0)
    return ks.Scene(
        mesh=rectangle(0.5 * np.pi, 0.4 * np.pi, n, n), chart=chart, thickness=0.04,
        material=ks.Isotropic(6.825e7, 0.3),
        supports=[ks.Symmetry("x0"), ks.Symmetry("x1"), ks.Fixed(pull, "z")],
        loads=[ks.PointForce(pull, (200 * share, 0, 0)), ks.PointForce(push, (0, -200 * share, 0))],
        probes={"pull": pull, "push": push},
        title="hemisphere with a hole", solve={"element": "koiter", "order": order},
    )  # fmt: skip


def pull_out(n_axis: int = 8, n_around: int = 12, order: int = 2, share: float = 1.0) -> ks.Scene:
    """3.5: an eighth of an open cylinder pulled by 40000 at A; B on the side, C on the side at the free end."""
    R, half = 4.953, 0.5 * 10.35
    chart = ks.geometry.Chart.from_expressions(f"{R}*sin(u)", "v", f"{R}*cos(u)")
    return ks.Scene(
        mesh=rectangle(0.5 * np.pi, half, n_around, n_axis), chart=chart, thickness=0.094,
        material=ks.Isotropic(10.5e6, 0.3125),
        supports=[ks.Symmetry("x0"), ks.Symmetry("x1"), ks.Symmetry("y0")],
        loads=[ks.PointForce((0, 0, R), (0, 0, 1e4 * share))],
        probes={"A": (0, 0, R), "B": (R, 0, 0), "C": (R, half, 0)},
        title="pull-out of an open cylinder", solve={"element": "koiter", "order": order},
    )  # fmt: skip


def roof(
    n: int = 4, layup: tuple[int, ...] = (), thickness: float = 12.7, order: int = 3, share: float = 1.0
) -> ks.Scene:
    """3.8: a quarter of a shallow roof, hinged at its straight sides, under a force of 3000 at the crown.

    ``layup`` has the angles of fibres from the axis, bottom to top; the material is isotropic without.
    """
    chart = ks.geometry.Chart.from_expressions("2540*sin(u/2540)", "v", "2540*cos(u/2540)")
    section: dict[str, Any] = {"thickness": thickness, "material": ks.Isotropic(3102.75, 0.3)}
    if layup:
        ply = ks.Orthotropic(E1=3300.0, E2=1100.0, nu12=0.25, G12=660.0)
        # angles of a scene are counted from x, which is around the roof
        section = {"layers": [ks.Layer(ply, thickness / len(layup), 90.0 - angle) for angle in layup]}
    return ks.Scene(
        mesh=rectangle(254.0, 254.0, n, n), chart=chart, **section,
        supports=[ks.Symmetry("x0"), ks.Symmetry("y0"), ks.SimplySupported("x1")],
        loads=[ks.PointForce((0, 0, 2540), (0, 0, -750.0 * share))], probes={"crown": (0, 0, 2540)},
        title=" ".join(["hinged roof", "/".join(map(str, layup))]).strip(), solve={"element": "koiter", "order": order},
    )  # fmt: skip


def von_karman(Q: float, n: int = 12) -> ks.Scene:
    """A quarter of a clamped circular plate, R = 1, h = 0.01, whose edge does not move."""
    h = 0.01
    return ks.Scene(
        mesh=ellipse(n, order=2, quarter=True), thickness=h, material=ks.Isotropic(1.0, 0.3),
        supports=[ks.Clamped("edge"), ks.Symmetry("x0"), ks.Symmetry("y0")], loads=[ks.Pressure(Q * h**4)],
        probes={"centre": (0, 0, 0)}, title="clamped circular plate", solve={"model": "shell"},
    )  # fmt: skip


def clamped_square(Q: float, n: int = 8, nu: float = 0.3) -> ks.Scene:
    """A quarter of a clamped square plate, a = 1, h = 0.002, whose sides do not move, under the pressure Q E h^4."""
    h = 0.002
    return ks.Scene(
        mesh=rectangle(0.5, 0.5, n, n), thickness=h, material=ks.Isotropic(1.0, nu),
        supports=[ks.Clamped(["x0", "y0"]), ks.Symmetry(["x1", "y1"])], loads=[ks.Pressure(Q * h**4)],
        probes={"centre": (0.5, 0.5, 0)}, title="clamped square plate", solve={"model": "shell"},
    )  # fmt: skip


def semi_cylinder(n: int = 8, share: float = 1.0) -> ks.Scene:
    """3.7: half of a semi-cylinder, one end clamped, pinched by a force of 2000 at the crown of its free end.

    Its straight sides may slide on a plane, but neither lift nor turn about themselves.
    """
    R = 101.6
    chart = ks.geometry.Chart.from_expressions(f"{R}*sin(u)", "v", f"{R}*cos(u)")
    return ks.Scene(
        mesh=rectangle(0.5 * np.pi, 304.8, n, n), chart=chart, thickness=3.0,
        material=ks.Isotropic(2068.5, 0.3),
        supports=[ks.Clamped("y1"), ks.Symmetry("x0"), ks.Fixed("x1", "zr")],
        loads=[ks.PointForce((0, 0, R), (0, 0, -1000.0 * share))], probes={"crown": (0, 0, R)},
        title="pinched semi-cylinder", solve={"element": "koiter", "order": 3},
    )  # fmt: skip
