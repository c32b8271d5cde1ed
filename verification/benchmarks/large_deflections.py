"""Large deflections against references: value, error, seconds, load steps and iterations.

Run with ``python -m verification.benchmarks.large_deflections [--long]``; with --long also the refinement of the slit
annulus and the laminated roof. `verification.benchmarks.newton` times an iteration phase by phase.
"""

from __future__ import annotations

import sys
import time
import warnings
from typing import Any

import numpy as np

import kshell as ks
from kshell.analysis.models import model_of
from kshell.equilibrium.path import PathFollower
from kshell.shell.model import ShellModel
from kshell.shell.problem import ShellProblem
from kshell.verify.cases import large_scenes as scenes

HEAD = f"{'case':34s} {'value':>12s} {'reference':>12s} {'error':>9s} {'seconds':>8s} {'steps':>6s} {'iterations':>10s}"


def line(name: str, value: float, reference: float, result: ks.Result | None, seconds: float) -> None:
    """Print one row; errors are relative, absolute where the reference is zero."""
    error = value / reference - 1 if reference else value
    steps, iterations = ("", "") if result is None else (result.solver["steps"], result.solver["iterations"])
    print(
        f"{name:34s} {value:12.6f} {reference:12.6f} {error:9.1e} {seconds:8.2f} {steps:>6} {iterations:>10}",
        flush=True,
    )


def solved(scene: ks.Scene, **options: Any) -> tuple[ks.Result, float]:
    """The result and the seconds."""
    begin = time.perf_counter()
    result = ks.solve(scene, **{"large_deflection": True, **options})
    return result, time.perf_counter() - begin


def strips() -> None:
    """Cantilever, elastica, roll-up."""
    result, t = solved(scenes.cantilever(), order=2)
    u = result.probe("tip")["u"]
    line("cantilever -u", -u[0], scenes.CANTILEVER[0], result, t)
    line("cantilever w", u[2], scenes.CANTILEVER[1], result, t)
    for alpha, (w, shortening) in scenes.ELASTICA.items():
        result, t = solved(scenes.elastica(alpha), order=3)
        u = result.probe("tip")["u"] / 10
        line(f"elastica {alpha:g} w/L", u[2], w, result, t)
        line(f"elastica {alpha:g} shortening/L", -u[0], shortening, result, t)
    for turns in (1, 2):
        result, t = solved(scenes.roll_up(turns), order=2, steps=10 * turns)
        u = result.probe("tip")["u"]
        line(f"roll-up, {turns} turns, u", u[0], -12.0, result, t)
        line(f"roll-up, {turns} turns, w", u[2], 0.0, result, t)


def slit_annulus(meshes: list[tuple[int, int, int]]) -> None:
    """Inner and outer corner of the lifted side."""
    for radial, around, order in meshes:
        result, t = solved(scenes.slit_annulus(radial, around), order=order, steps=5)
        x = result.mesh.points
        lifted = np.abs(x[:, 1]) < 1e-9
        for radius, reference in zip((6.0, 10.0), scenes.ANNULUS, strict=True):
            ends = lifted & (np.abs(x[:, 0] - radius) < 1e-9)
            w = result.fields["displacement"][ends, 2].max()
            line(f"annulus {radial} x {around} p{order} r={radius:g}", w, reference, result, t)


def plates() -> None:
    """The clamped circular plate."""
    for Q, reference in scenes.VON_KARMAN.items():
        result, t = solved(scenes.von_karman(Q))
        line(f"von Karman plate Q = {Q}", result.probe("centre")["u"][2] / 0.01, reference, result, t)


def kernel(scene: ks.Scene) -> ShellProblem:
    """The problem of a scene, for displacement control."""
    model = model_of(scene)
    assert isinstance(model, ShellModel)
    return model.problem


def roof(layered: bool, sizes: list[int], table: list[tuple[float, float]]) -> None:
    """Load at the displacements of the table, and how far its points lie off the path.

    Where the path is steep, a small displacement is a large load: the distance is measured in the plane of load and
    displacement, against the limit load and the largest displacement.
    """
    limit = max(factor for factor, w in table if w < 15.0)
    for n in sizes:
        scene = scenes.roof(n, (0, 90, 0) if layered else ())
        problem = kernel(scene)
        equilibrium = problem.equilibrium()
        follower, state = PathFollower(equilibrium), equilibrium.start()
        crown = int(np.argmin(np.linalg.norm(problem.space.points - [0, 0, 2540], axis=1)))
        row = np.zeros(problem.discretisation.unknowns)
        row[3 * crown + 2] = 1.0
        begin, worst, iterations = time.perf_counter(), (0.0, 0.0), 0
        highest = 0.0
        loads: list[float] = []
        for factor, w in table:
            state = follower.displacement(state, row, -w - float(row @ state.x)).state
            iterations += state.iterations
            loads.append(state.factor)
            difference = (state.factor - factor) / limit
            worst = max(worst, (abs(difference), w))
            highest = max(highest, state.factor if w < 15.0 else 0.0)
            if n == sizes[-1]:
                print(
                    f"    w {w:7.3f}  load {state.factor:8.4f}  table {factor:8.4f}  {difference:+.4f} of the limit"
                )
        took = time.perf_counter() - begin
        line(f"roof{' 0/90/0' if layered else ''} {n} x {n} limit load", highest, limit, None, took)
        print(
            f"    largest difference {worst[0]:.4f} of the limit load, at w = {worst[1]}; {iterations} iterations",
            flush=True,
        )
        print(
            f"    largest distance of the table from the path {distance(loads, table, limit):.4f}", flush=True
        )
        compliance, left = extra_compliance(loads, table)
        print(
            f"    with {compliance:.4f} more displacement per factor: largest difference {left:.4f}",
            flush=True,
        )


def distance(loads: list[float], table: list[tuple[float, float]], limit: float) -> float:
    """Largest distance of a point of the table from the path, each axis against its size."""
    from scipy.interpolate import CubicSpline

    known, w = np.array(table).T
    path = CubicSpline(np.append(0.0, w), np.append(0.0, loads))
    fine = np.linspace(0.0, w[-1], 20_000)
    curve = np.stack([path(fine) / limit, fine / w[-1]], axis=1)
    points = np.stack([known / limit, w / w[-1]], axis=1)
    return max(float(np.linalg.norm(curve - point, axis=1).min()) for point in points)


def extra_compliance(loads: list[float], table: list[tuple[float, float]]) -> tuple[float, float]:
    """The displacement per factor that is to be added under the force to meet the table best, and what is left over.

    Shells with shear sink in under a point force by about P / (2 pi k G h) ln(span / element), which Koiter's do not;
    for the isotropic roof and elements of 16 that would be 0.13. That shear is what sets the table apart is not shown
    here: no shell with shear was computed.

    Returns
    -------
    compliance : float
    difference : float
        Largest left over, relative to the limit load.
    """
    from scipy.interpolate import CubicSpline
    from scipy.optimize import minimize_scalar

    known, w = np.array(table).T
    path = CubicSpline(np.append(0.0, w), np.append(0.0, loads))

    def left(c: float) -> np.ndarray:
        return path(w - c * known) - known

    c = float(minimize_scalar(lambda c: float(np.sum(left(c) ** 2)), bounds=(0.0, 2.0), method="bounded").x)
    return c, float(np.abs(left(c)).max() / max(factor for factor, w in table if w < 15.0))


def pull_out() -> None:
    """The table at its factors, with dead load steps at them."""
    begin = time.perf_counter()
    scene = scenes.pull_out()
    problem = kernel(scene)
    from kshell.equilibrium.load_steps import load_path

    equilibrium = problem.equilibrium()
    state = equilibrium.start()
    R, half = 4.953, 0.5 * 10.35
    places = [
        np.argmin(np.linalg.norm(problem.space.points - p, axis=1))
        for p in ([0, 0, R], [R, 0, 0], [R, half, 0])
    ]
    worst = np.zeros(3)
    for factor, *known in scenes.PULL_OUT:
        state = load_path(equilibrium, 1, factor, state).states[-1]
        found = [state.x[3 * places[0] + 2], -state.x[3 * places[1]], -state.x[3 * places[2]]]
        error = np.abs(np.array(found) / known - 1)
        worst = np.maximum(worst, error)
        print(
            f"    factor {factor:5.3f}  A {found[0]:.4f}  B {found[1]:.4f}  C {found[2]:.4f}  errors",
            np.round(error, 4),
        )
    print(f"pull-out 8 x 12 p2: largest errors of the table A {worst[0]:.4f} B {worst[1]:.4f} C {worst[2]:.4f}, "
          f"{time.perf_counter() - begin:.1f} s", flush=True)  # fmt: skip


def main(long: bool) -> None:
    """Print the table."""
    warnings.simplefilter("ignore")
    print(HEAD)
    strips()
    plates()
    slit_annulus([(6, 30, 2), *([(12, 60, 2), (6, 30, 3), (12, 60, 3)] if long else [])])
    pull_out()
    roof(False, [4, 8] if long else [4], scenes.ROOF)
    roof(True, [4, 8] if long else [4], scenes.LAMINATED_ROOF)


if __name__ == "__main__":
    main("--long" in sys.argv)
