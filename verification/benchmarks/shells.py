"""Linear shells: error of kshell and of NGSolve against CPU seconds, in one run.

    python -m verification.benchmarks.shells [--peers-python PYTHON] [--out FOLDER]

Scordelis-Lo roof, pinched cylinder and hemisphere with a hole, a quarter of each, orders 2 and 3, growing grids. Every
measurement is a process of its own on one thread: CPU seconds from the mesh arrays to the deflection, imports and a
first small solve left out, the best of three (NGSolve: one). kshell's grid of the cylinder is graded towards the force;
NGSolve's generator makes uniform grids only, so kshell is run on those as well. PYTHON is an interpreter that has
ngsolve; without it kshell is measured alone.

A target counts as reached where the error and that of the next finer grid are below it, so that an error which
happens to change sign does not win.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

HERE = Path(__file__).parent
REFERENCES = {"scordelis_lo": 0.300592457, "pinched_cylinder": 1.828195e-5, "hemisphere_hole": 0.0935216}
TITLES = {
    "scordelis_lo": "Scordelis-Lo roof",
    "pinched_cylinder": "pinched cylinder",
    "hemisphere_hole": "hemisphere with a hole",
}
GRIDS = {2: (4, 6, 8, 12, 16, 24, 32, 48), 3: (4, 6, 8, 12, 16, 24, 32)}
PEER_GRIDS = {2: (4, 8, 16, 32, 64), 3: (4, 8, 16)}
TARGETS = (1e-3, 1e-5)
GRADES = {"graded": 2.0, "uniform": 1.0}
TOO_LONG = 60.0  # seconds after which finer grids of a method are left out


@dataclass(frozen=True)
class Point:
    """One measurement."""

    problem: str
    program: str
    order: int
    cells: int
    unknowns: int
    error: float
    seconds: float


def grid(cells: int, size: tuple[float, float], grade: float) -> Any:
    """Triangles on [0, size] with alternating diagonals, graded towards the origin."""
    from kshell.mesh.mesh import Mesh

    side = np.linspace(0, 1, cells + 1) ** grade
    x, y = np.meshgrid(side * size[0], side * size[1], indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    i, j = (index.ravel() for index in np.indices((cells, cells)))
    a, b = i * (cells + 1) + j, (i + 1) * (cells + 1) + j
    even = ((i + j) % 2 == 0)[:, None]
    first = np.where(even, np.stack([a, b, b + 1], 1), np.stack([a, b, a + 1], 1))
    second = np.where(even, np.stack([a, b + 1, a + 1], 1), np.stack([b, b + 1, a + 1], 1))
    return Mesh(points, np.concatenate([first, second]).astype(np.int32))


def solve(problem: str, order: int, mesh: Any) -> tuple[int, float]:
    """Unknowns and the deflection of the benchmark, from the mesh in the parameter plane."""
    from kshell.shell import loads
    from kshell.shell.koiter import Koiter
    from kshell.shell.linear import solve_linear
    from kshell.shell.section import Section
    from kshell.shell.supports import Supports
    from kshell.shell.surface import Surface

    lift, size, section = PARAMETERS[problem]
    surface = Surface(mesh, order, lift)
    koiter = Koiter(surface, Section.isotropic(*section))
    boundary = mesh.boundary_edges
    middle = mesh.points[mesh.edges[boundary]].mean(axis=1)

    def side(axis: int, value: float) -> Any:
        return boundary[np.abs(middle[:, axis] - value) < 1e-9 * size[axis]]

    def vertex(x: float, y: float) -> int:
        return int(np.argmin(np.abs(mesh.points[:, :2] - (x, y)).sum(axis=1)))

    supports = Supports(surface)
    supports.symmetry(side(0, 0.0))
    if problem != "scordelis_lo":
        supports.symmetry(side(0, size[0]))
    if problem == "hemisphere_hole":
        a, b = vertex(0, 0), vertex(size[0], 0)
        supports.translation([a], "z")
        load = loads.point_force(surface, a, [1, 0, 0]) + loads.point_force(surface, b, [0, -1, 0])
        read, sign = 3 * a, 1.0
    else:
        supports.symmetry(side(1, 0.0))
        supports.diaphragm(side(1, size[1]))
        node = vertex(0, 0)
        load = loads.point_force(surface, node, [0, 0, -0.25])
        if problem == "scordelis_lo":
            node = vertex(size[0], 0)
            load = loads.traction(surface, [0, 0, -90.0])
        read, sign = 3 * node + 2, -1.0
    reduction = supports.reduction()
    answer = solve_linear(koiter, load, reduction)
    return int(reduction.basis.shape[1]), sign * float(answer.x[read])


def cylinder(radius: float) -> Callable[[Floats], Floats]:
    """Arc length and axis to a cylinder with its crown at z = radius."""
    return lambda q: np.column_stack(
        [radius * np.sin(q[:, 0] / radius), q[:, 1], radius * np.cos(q[:, 0] / radius)]
    )


def sphere(radius: float) -> Callable[[Floats], Floats]:
    """Longitude and latitude, times the radius, to a sphere."""

    def lift(q: Floats) -> Floats:
        a, b = q[:, 0] / radius, q[:, 1] / radius
        return radius * np.column_stack([np.cos(a) * np.cos(b), np.sin(a) * np.cos(b), np.sin(b)])

    return lift


PARAMETERS: dict[str, tuple[Callable[[Floats], Floats], tuple[float, float], tuple[float, float, float]]] = {
    "scordelis_lo": (cylinder(25.0), (25.0 * np.radians(40.0), 25.0), (4.32e8, 0.0, 0.25)),
    "pinched_cylinder": (cylinder(300.0), (150.0 * np.pi, 300.0), (3e6, 0.3, 3.0)),
    "hemisphere_hole": (sphere(10.0), (5.0 * np.pi, 4.0 * np.pi), (6.825e7, 0.3, 0.04)),
}


def one(problem: str, order: str, cells: str, grade: str) -> None:
    """Measure kshell in this process and print JSON."""
    size = PARAMETERS[problem][1]
    solve(problem, int(order), grid(2, size, 1.0))
    seconds, unknowns, value = [], 0, 0.0
    for _ in range(3):
        mesh = grid(int(cells), size, GRADES[grade])
        begin = time.process_time()
        unknowns, value = solve(problem, int(order), mesh)
        seconds.append(time.process_time() - begin)
    print(json.dumps({"unknowns": unknowns, "value": value, "seconds": min(seconds)}))


def measured(command: list[str], problem: str, program: str, order: int, cells: int) -> Point:
    """Run one process and read what it found."""
    environment = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", MKL_NUM_THREADS="1")
    done = subprocess.run(command, check=True, capture_output=True, text=True, env=environment)
    found = json.loads(done.stdout.strip().splitlines()[-1])
    error = abs(found["value"] / REFERENCES[problem] - 1)
    return Point(problem, program, order, cells, found["unknowns"], error, found["seconds"])


def run_all(peers_python: str | None) -> list[Point]:
    """All measurements, printed as they come."""
    points = []
    here = [sys.executable, "-m", "verification.benchmarks.shells", "--one"]
    for problem in REFERENCES:
        grades = ("uniform", "graded") if problem == "pinched_cylinder" else ("uniform",)
        plans = [
            (f"kshell{' graded' if grade == 'graded' else ''}", GRIDS, [*here, problem], [grade])
            for grade in grades
        ]
        if peers_python:
            script = str(HERE.parent / "peers" / "ngsolve_shell.py")
            plans.append(("NGSolve", PEER_GRIDS, [peers_python, script, problem], ["1"]))
        for program, grids, front, back in plans:
            for order, cells_list in grids.items():
                for cells in cells_list:
                    command = [*front, str(order), str(cells), *back]
                    point = measured(command, problem, program, order, cells)
                    points.append(point)
                    print(
                        f"{problem:18}{program:15} p = {order}  {cells:3} cells {point.unknowns:7} unknowns  "
                        f"error {point.error:.1e}  {point.seconds:8.3f} s",
                        flush=True,
                    )
                    if point.seconds > TOO_LONG:
                        break
    return points


def best(points: list[Point], target: float) -> Point | None:
    """The quickest measurement below a target whose next finer grid is below it, too."""
    good = []
    for order in sorted({p.order for p in points}):
        run = sorted((p for p in points if p.order == order), key=lambda p: p.cells)
        good += [
            p for p, finer in zip(run, [*run[1:], run[-1]], strict=True) if max(p.error, finer.error) < target
        ]
    return min(good, key=lambda p: p.seconds, default=None)


def draw(points: list[Point], path: Path) -> None:
    """Error against CPU seconds, one panel a problem."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(13, 4.6), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(1, 3, sharey=True)
    colours = {"kshell": "#1f5fa8", "kshell graded": "#7fb2e5", "NGSolve": "#c0392b"}
    for panel, problem in zip(axes, REFERENCES, strict=True):
        for program in dict.fromkeys(p.program for p in points if p.problem == problem):
            for order, style in ((2, "o-"), (3, "s--")):
                run = [p for p in points if (p.problem, p.program, p.order) == (problem, program, order)]
                x, y = [p.seconds for p in run], [max(p.error, 1e-9) for p in run]
                panel.loglog(
                    x, y, style, color=colours[program], label=f"{program}, p = {order}", markersize=4
                )
        panel.set_title(TITLES[problem])
        panel.set_xlabel("CPU seconds, one thread, from the mesh on")
        panel.grid(True, which="major", alpha=0.3)
        panel.legend(fontsize=8)
    axes[0].set_ylabel("relative error of the deflection")
    figure.savefig(path, dpi=110)


def main() -> None:
    """Measure, print, draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--peers-python", default=None, help="an interpreter that has ngsolve")
    parser.add_argument("--out", default=str(HERE), help="folder of shells.png and shells.csv")
    parser.add_argument("--one", nargs=4, default=None, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        problem, order, cells, grade = options.one
        one(problem, order, cells, grade)
        return
    points = run_all(options.peers_python)
    print(f"\n{'problem':20}{'target':>8}   quickest")
    for problem in REFERENCES:
        for target in TARGETS:
            words = []
            for program in dict.fromkeys(p.program for p in points):
                point = best([p for p in points if p.problem == problem and p.program == program], target)
                if point:
                    words.append(f"{program} {point.seconds:.3f} s (p = {point.order}, {point.unknowns})")
            print(f"{problem:20}{target:8.0e}   {'; '.join(words) or 'not reached'}")
    folder = Path(options.out)
    with (folder / "shells.csv").open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["problem", "program", "order", "cells", "unknowns", "relative error", "CPU seconds"])
        writer.writerows(
            [p.problem, p.program, p.order, p.cells, p.unknowns, f"{p.error:.3e}", f"{p.seconds:.4f}"]
            for p in points
        )
    draw(points, folder / "shells.png")


if __name__ == "__main__":
    main()
