"""Random motions: each ends at its time, or with the last good state and the reason; nothing crosses, no NaN.

Run with ``python -m verification.benchmarks.motion_robustness [FIRST LAST] > motion_robustness.md``. Shapes (strip,
cap, roof, tube, pair of sheets), thickness, distortion of the mesh, supports or none, loads in time, initial
velocity, damping, scheme, steps and contact (obstacles, self contact, friction) are drawn at random, with the number of
the run as the seed. Times are a few periods of the first mode, forces and velocities such that shells bend by up to
half of their size. Starts that are refused, such as an obstacle that touches at the start, are counted as such.

A run is sound if its files can be read and hold finite numbers only, gaps stay positive, and no energy appears from
nowhere: kinetic and strain energy never exceed what they began with and what loads, supports and obstacles did, by more
than a tenth of the largest.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import kshell as ks
from kshell.verify.cases.large_scenes import rectangle
from verification.benchmarks.random_runs import finished, read_back, table

# CPU time after which a run is interrupted
SECONDS = 40
SHAPES = ("strip", "cap", "roof", "tube", "pair")
SCHEMES = ("auto", "alpha", "em", "bdf2", "euler")


def random_mesh(draw: np.random.Generator) -> tuple[str, ks.Mesh]:
    """A shape and its mesh, of a size of about 1."""
    shape = SHAPES[draw.integers(len(SHAPES))]
    n = int(draw.integers(2, 5))
    length = float(draw.uniform(1.0, 3.0)) if shape == "strip" else 1.0
    mesh = rectangle(length, 1.0, n * (2 if shape == "strip" else 1), n)
    points = mesh.points.copy()
    inside = np.ones(len(points), dtype=bool)
    inside[mesh.edges[mesh.boundary_edges]] = False
    points[inside, :2] += (
        float(draw.uniform(0.0, 0.25)) / n * draw.uniform(-1, 1, (int(inside.sum()), 2)) * [length, 1.0]
    )
    x, y = points[:, 0] / length, points[:, 1]
    rise = float(draw.uniform(0.05, 0.3))
    if shape == "cap":
        points[:, 2] = rise * 4 * (x * (1 - x) + y * (1 - y)) / 2
    elif shape == "roof":
        points[:, 2] = rise * 4 * x * (1 - x)
    elif shape == "tube":  # open along a line
        angle = 5.0 * (x - 0.5)
        points[:, 0], points[:, 2] = 0.5 + 0.3 * np.sin(angle), 0.3 * (1.0 - np.cos(angle))
    if shape == "pair":
        above = points + [0.0, 0.0, 0.2]
        both = np.concatenate([points, above])
        count = len(points)
        groups = {
            "x0": mesh.edges[mesh.boundary_edges][
                np.all(points[mesh.edges[mesh.boundary_edges], 0] < 1e-9, axis=1)
            ]
        }
        return shape, ks.Mesh.from_arrays(
            both, np.concatenate([mesh.triangles, mesh.triangles + count]), groups=groups
        )
    return shape, replace(mesh, points=points)


def random_motion(seed: int) -> tuple[str, ks.Scene, bool]:
    """Shape and scene of a seed, and whether it has contact."""
    draw = np.random.default_rng(seed)
    shape, mesh = random_mesh(draw)
    thickness = float(10 ** draw.uniform(-3.0, -1.5))
    young, density = float(10 ** draw.uniform(5, 11)), float(10 ** draw.uniform(2, 4))
    material = ks.Isotropic(young, float(draw.uniform(0.0, 0.45)), density=density)
    supports: list[Any] = [[], [ks.Clamped("x0")], [ks.Fixed("x0", "xyz")]][draw.integers(3)]
    # speed of bending waves as long as the shape, and the deflection that is wanted
    omega = 3.5 * thickness * np.sqrt(young / (12 * density))
    reach = float(10 ** draw.uniform(-2.0, -0.3))
    g = reach * omega**2
    sign = float(draw.choice([-1.0, 1.0]))
    pressure = sign * g * density * thickness
    loads: list[Any] = [
        [ks.Gravity((0.2 * g, 0.0, -g))],
        [ks.Pressure(f"{pressure}*sin({omega}*t)")],
        [ks.Pressure(pressure, follower=True)],
        [ks.Traction((0.3 * pressure, f"{pressure}*min({omega}*t, 1)", pressure))],
        [],
    ][draw.integers(5)]
    given: dict[str, Any] = {}
    if not loads or draw.integers(2):
        v = reach * omega
        turn = f"{v}*(x - 0.5)"
        given["initial_velocity"] = [(0.0, 0.0, -v), (0.3 * v, turn, f"{v}*cos(6*y)")][draw.integers(2)]
    given["damping"] = [None, {"ratio": 0.05}, {"drag": 0.3 * omega}, {"viscosity": 0.1 / omega}][
        draw.integers(4)
    ]
    contact = bool(draw.integers(2))
    scheme = SCHEMES[draw.integers(len(SCHEMES))]
    if contact:
        scheme = "auto" if scheme == "em" else scheme
        given["contact"] = ks.Contact(
            friction=float(draw.choice([0.0, 0.3])), self=bool(draw.integers(2)), speed=1e-2 * reach * omega
        )
        below = -0.02 - float(draw.uniform(0.0, 0.2)) - thickness
        move = [0.0, 0.0, f"{0.5 * reach}*sin({omega}*t)"] if draw.integers(3) == 0 else None
        given["obstacles"] = [
            [ks.Obstacle({"kind": "plane", "point": (0, 0, below), "normal": (0, 0, 1)}, motion=move)],
            [ks.Obstacle({"kind": "sphere", "centre": (0.5, 0.5, below - 0.3), "radius": 0.3}, motion=move)],
            [
                ks.Obstacle(
                    {"kind": "cylinder", "point": (0.5, 0, below - 0.1), "axis": (0, 1, 0), "radius": 0.1},
                    motion=move,
                )
            ],
        ][draw.integers(3)]
    period = 2 * np.pi / omega
    options = {
        "analysis": "dynamic", "time": period * float(draw.uniform(0.3, 1.0)), "scheme": scheme,
        "order": int(draw.integers(1, 3)), "output": 5,
    }  # fmt: skip
    if draw.integers(2) or contact:
        options["step"] = period / float(draw.choice([15, 40]))
    scene = ks.Scene(
        mesh=mesh, thickness=thickness, material=material, supports=supports, loads=loads,
        probes={"middle": (0.5, 0.5, 0.0)}, solve=options, **given,
    )  # fmt: skip
    return shape, scene, contact


def faults(result: ks.Result, folder: Path) -> list[str]:
    """What is not sound, in words."""
    found, finite = read_back(folder)
    out = [] if finite else ["fields are not finite"]
    history = found["history"]
    if min(history.get("smallest_gap", [1.0])) <= 0.0:
        out.append("surfaces meet")
    kinetic, strain = (np.array(history[name]) for name in ("kinetic_energy", "strain_energy"))
    gained = kinetic + strain - kinetic[0] - strain[0] - np.array(history["external_work"])
    largest = max(kinetic.max(), strain.max())
    told = any("added energy" in words for words in result.warnings)
    if largest > 0 and gained.max() > 0.1 * largest and not told:
        out.append(f"energy from nowhere: {gained.max() / largest:.2g}")
    return out


HEAD = (
    "| seed | shape | unknowns | contact | scheme | order | steps | rejected | iterations | t / end | balance "
    "| CPU s | outcome |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|"
)


def one(seed: int, folder: Path) -> tuple[str, str, float]:
    """A line of the table without its end, the outcome and the CPU seconds."""
    shape, scene, contact = random_motion(seed)
    outcome, result, took = finished(scene, folder, SECONDS)
    touching = "yes" if contact else "no"
    if result is None:
        return f"| {seed} | {shape} | | {touching} | | | | | | | |", outcome, took
    wrong = faults(result, folder)
    outcome = f"NOT SOUND ({'; '.join(wrong)}), {outcome}" if wrong else outcome
    options, solver = scene.solve, result.solver
    row = (
        f"| {seed} | {shape} | {result.unknowns} | {touching} | {options.scheme} | {options.order} | "
        f"{solver['steps']} | {solver['rejected']} | {solver['iterations']} | "
        f"{result.history['time'][-1] / options.time:.4g} | {result.balance:.0e} |"
    )
    return row, outcome, took


if __name__ == "__main__":
    print(HEAD)
    table(*map(int, sys.argv[1:3] or ("0", "200")), one)
