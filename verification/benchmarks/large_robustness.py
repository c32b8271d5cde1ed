"""Random large deflections: every run ends converged, or with the last good state and the reason.

Run with ``python -m verification.benchmarks.large_robustness [FIRST LAST] > large_robustness.md``. Shapes (strip, cap,
roof, box), thickness, load, distortion of the mesh and number of steps are drawn at random, with the number of the run
as the seed. Loads are multiples of the linear reference: they bend the shell linearly by one to twenty thicknesses, and
by no more than half of its span. That is up to fifty times the load at which a cap or a roof snaps through.

A run is sound if its files can be read and hold finite numbers only, and its state is in equilibrium.
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
SECONDS = 60
SHAPES = ("strip", "cap", "roof", "box")


def random_scene(seed: int) -> tuple[str, ks.Scene]:
    """The shape and the scene of a seed."""
    draw = np.random.default_rng(seed)
    shape = SHAPES[draw.integers(4)]
    n = int(draw.integers(4, 8))
    length = float(draw.uniform(2.0, 8.0)) if shape == "strip" else 1.0
    mesh = rectangle(length, 1.0, n * (2 if shape == "strip" else 1), n)
    thickness = float(10 ** draw.uniform(-2.7, -1.5))
    inside = np.ones(len(mesh.points), dtype=bool)
    inside[mesh.edges[mesh.boundary_edges]] = False
    points = mesh.points.copy()
    points[inside, :2] += float(draw.uniform(0.0, 0.3)) / n * draw.uniform(-1, 1, (int(inside.sum()), 2))
    rise = float(draw.uniform(0.02, 0.2))
    x, y = points[:, 0] / length, points[:, 1]
    if shape == "cap":
        points[:, 2] = rise * 4 * (x * (1 - x) + y * (1 - y)) / 2
    elif shape == "roof":
        points[:, 2] = rise * 4 * x * (1 - x)
    elif shape == "box":  # an open channel: bottom and two walls, folded at thirds
        third = np.clip((np.abs(x - 0.5) - 1 / 6) * 3, 0.0, 1.0)
        points[:, 0], points[:, 2] = 0.5 + np.clip(x - 0.5, -1 / 6, 1 / 6) * 3, third
    mesh = replace(mesh, points=points)
    supports: list[Any] = [ks.Clamped("x0")] if shape == "strip" else [ks.SimplySupported(["x0", "x1"])]
    if shape == "cap":
        supports = [ks.Clamped(["x0", "x1", "y0", "y1"])]
    if shape == "box":
        supports = [ks.Clamped("y0")]
    sign = float(draw.choice([-1.0, 1.0]))
    kinds: list[Any] = [
        ks.Pressure(sign),
        ks.Pressure(sign, follower=True),
        ks.Traction((0.3 * sign, 0.2, sign)),
        ks.PointForce(_nearest(points, (0.5 * length, 0.5, float(points[:, 2].mean()))), (0.0, 0.1, sign)),
    ]
    scene = ks.Scene(
        mesh=mesh, thickness=thickness, material=ks.Isotropic(1e6, 0.3), supports=supports,
        loads=[kinds[draw.integers(4)]], probes={"middle": (0.5 * length, 0.5, 0.0)},
    )  # fmt: skip
    order = int(draw.integers(1, 3))
    linear = replace(scene, loads=[replace(scene.loads[0], follower=False)]) if _follows(scene) else scene
    deflection = ks.solve(linear, model="shell", large_deflection=False, order=order).extremes["deflection"][
        "value"
    ]
    wanted = min(thickness * 20 ** float(draw.uniform(0.0, 1.0)), 0.5 * length)
    factor = wanted / deflection
    load = replace(scene.loads[0], value=_times(scene.loads[0].value, factor))
    options = {"analysis": "path" if draw.integers(2) else "static", "large_deflection": True}
    options |= {"order": order, "steps": int(draw.integers(1, 12))}
    return shape, replace(scene, loads=[load], solve=options)


def _nearest(points: Any, place: tuple[float, float, float]) -> tuple[float, ...]:
    """The vertex nearest to a place, which may lie off the surface."""
    return tuple(points[np.argmin(np.linalg.norm(points - place, axis=1))].tolist())


def _follows(scene: ks.Scene) -> bool:
    return bool(getattr(scene.loads[0], "follower", False))


def _times(value: Any, factor: float) -> Any:
    return value * factor if np.isscalar(value) else tuple(float(v) * factor for v in value)


def sound(result: ks.Result, folder: Path) -> bool:
    """Whether the files can be read and hold finite numbers only, and the state is in equilibrium."""
    _, finite = read_back(folder)
    return finite and result.balance < 1e-3


HEAD = (
    "| seed | shape | unknowns | load | analysis | steps | iterations | critical points | last factor | balance "
    "| CPU s | outcome |\n|---|---|---|---|---|---|---|---|---|---|---|---|"
)


def one(seed: int, folder: Path) -> tuple[str, str, float]:
    """A line of the table without its end, the outcome and the CPU seconds."""
    shape, scene = random_scene(seed)
    outcome, result, took = finished(scene, folder, SECONDS)
    assert result is not None
    outcome = outcome if sound(result, folder) else f"NOT SOUND, {outcome}"
    load = type(scene.loads[0]).__name__ + (", follower" if _follows(scene) else "")
    solver = result.solver
    row = (
        f"| {seed} | {shape} | {result.unknowns} | {load} | {scene.solve.analysis} | {solver['steps']} | "
        f"{solver['iterations']} | {len(result.critical)} | {result.path[-1]['factor']:.4g} | {result.balance:.0e} |"
    )
    return row, "converged" if outcome == "ended" else outcome, took


if __name__ == "__main__":
    print(HEAD)
    table(*map(int, sys.argv[1:3] or ("0", "200")), one)
