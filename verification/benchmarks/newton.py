"""Newton's iteration of shells under large deflections, phase by phase, and whole solves.

    python -m verification.benchmarks.newton [--cells 75] [--before FOLDER] [--beside NAME COMMAND] [--out FOLDER]

An iteration of a hinged cylindrical roof at p = 2: energy, forces and tangent; the tangent in the free motions;
factorisation; solution; stress extrapolated. Every program is measured in a process of its own on one thread, all in
one run; CPU seconds, the best of three iterations, the first one, which finds patterns and orders of elimination, and
the mean over the iterations of a load step, in which a tangent that has settled serves again. --before is a checkout
of an earlier version (``git worktree add FOLDER 819cdf4`` is the one before patterns were kept); --beside runs any
command that prints the same JSON, with the number of cells as its last argument. The solvers are the fastest
installed, and SuperLU alone.

Whole solves (strip, slit annulus, hemisphere with a hole of Sze, Liu & Lo 2004) are timed as scenes from `ks.solve`
to the result, and in their kernel from the mesh arrays to the last state; imports are left out.
"""

from __future__ import annotations

import argparse
import csv
import importlib.util
import json
import os
import subprocess
import sys
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
PHASES = ("tangent", "supports", "factorise", "solve", "stress")
REPEATS = 3
STEP = 0.2  # load factor of the load step
ONE_THREAD = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}


def roof(cells: int) -> Any:
    """The equilibrium problem of a quarter of the roof, order 2; works with any version of the kernel."""
    import numpy as np

    sys.path.insert(0, str(HERE))
    from shells import cylinder, grid

    from kshell.equilibrium.problem import Problem
    from kshell.shell.koiter import loads
    from kshell.shell.koiter.energy import Koiter
    from kshell.shell.koiter.supports import Supports
    from kshell.shell.koiter.surface import Surface
    from kshell.shell.section import Section

    mesh = grid(cells, (254.0, 254.0), 1.0)
    surface = Surface(mesh, 2, cylinder(2540.0))
    boundary = mesh.boundary_edges
    middle = mesh.points[mesh.edges[boundary]].mean(axis=1)
    supports = Supports(surface)
    supports.symmetry(boundary[middle[:, 0] < 1e-9])
    supports.symmetry(boundary[middle[:, 1] < 1e-9])
    supports.simple(boundary[middle[:, 0] > 254.0 - 1e-9])
    crown = int(np.argmin(np.abs(mesh.points[:, :2]).sum(axis=1)))
    load = loads.point_force(surface, crown, [0.0, 0.0, -750.0])
    return Problem(Koiter(surface, Section.isotropic(3102.75, 0.3, 12.7)), supports.reduction(), load)


def one(cells: int) -> dict[str, float]:
    """Measure the kshell of this process: seconds of each phase, and of the first iteration."""
    import numpy as np

    from kshell.equilibrium.newton import correct

    problem = roof(cells)
    energy, basis = problem.energy, problem.reduction.basis
    x = np.zeros(energy.unknowns)
    seconds: list[dict[str, float]] = []
    for _ in range(REPEATS + 1):
        marks = [time.process_time()]
        state, residual, _ = problem.evaluate(x, 0.01, 2, energy.rest)
        marks.append(time.process_time())
        if hasattr(problem, "_factoriser"):
            problem._factoriser.reduced(state.hessian, lower=not os.environ.get("SUPERLU_ALONE"))
        else:
            problem.reduction.reduce(state.hessian)
        marks.append(time.process_time())
        factor = problem.factorise(state.hessian)
        marks.append(time.process_time())
        step = basis @ factor.solve(basis.T @ residual)
        marks.append(time.process_time())
        if hasattr(state, "linear"):
            energy.extrapolated_stress(state.linear, step)
        else:
            energy.extrapolated_stress(x, step, energy.rest)
        marks.append(time.process_time())
        spent = dict(zip(PHASES, np.diff(marks), strict=True))
        spent["factorise"] -= spent["supports"]  # which it does again
        seconds.append(spent)
        x = x + 0.1 * step
    best = {phase: min(spent[phase] for spent in seconds[1:]) for phase in PHASES}
    begin = time.process_time()
    after = correct(problem, problem.start(), STEP)
    step_seconds = (time.process_time() - begin) / after.iterations
    return {"unknowns": basis.shape[1], **best, "first": sum(seconds[0].values()), "in a step": step_seconds}


def measured(command: list[str], **environment: str) -> dict[str, float]:
    """What a command prints as its last line of JSON."""
    env = {**os.environ, **ONE_THREAD, **environment}
    done = subprocess.run(command, env=env, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{' '.join(command)} failed:\n{done.stderr}")
    answer: dict[str, float] = json.loads(done.stdout.strip().splitlines()[-1])
    return answer


def phases(cells: list[int], before: str | None, beside: list[list[str]], out: Path) -> None:
    """Print the table and write it as CSV."""
    programs: list[tuple[str, list[str], dict[str, str]]] = []
    mine = [sys.executable, str(Path(__file__).resolve()), "--one"]
    if before is not None:
        programs.append(("before", mine, {"PYTHONPATH": str(Path(before).resolve())}))
        programs.append(
            ("before, SuperLU", mine, {"PYTHONPATH": str(Path(before).resolve()), "SUPERLU_ALONE": "1"})
        )
    programs += [(name, command.split(), {}) for name, command in beside]
    here = str(HERE.parents[1])
    programs.append(("now", mine, {"PYTHONPATH": here}))
    programs.append(("now, SuperLU", mine, {"PYTHONPATH": here, "SUPERLU_ALONE": "1"}))
    rows = []
    print(
        f"{'unknowns':>9s}  {'program':20s}"
        + "".join(f"{name:>10s}" for name in (*PHASES, "iteration", "first", "in a step"))
    )
    for n in cells:
        for name, command, environment in programs:
            answer = measured([*command, str(n)], **environment)
            spent = [answer[phase] for phase in PHASES]
            numbers = [
                *spent,
                sum(spent),
                *(answer.get(name, float("nan")) for name in ("first", "in a step")),
            ]
            rows.append([int(answer["unknowns"]), name, *(f"{s:.4f}" for s in numbers)])
            print(f"{rows[-1][0]:9d}  {name:20s}" + "".join(f"{s:10.3f}" for s in numbers), flush=True)
    with (out / "newton.csv").open("w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows(
            [
                ["unknowns", "program", *PHASES, "iteration", "first iteration", "iteration in a load step"],
                *rows,
            ]
        )


def superlu_alone() -> None:
    """Let the other back ends be not installed, for this process."""
    found = importlib.util.find_spec
    importlib.util.find_spec = lambda name, *more: (
        None if name in ("cvxopt", "pypardiso") else found(name, *more)
    )


def whole_solves() -> None:
    """Strip, slit annulus and hemisphere, as scenes and in the kernel."""
    import numpy as np

    import kshell as ks
    from kshell.analysis.models import model_of
    from kshell.equilibrium.load_steps import load_path
    from kshell.verify.cases import large_scenes as scenes

    def of_strip(result: ks.Result) -> list[float]:
        u = result.probe("tip")["u"]
        return [-u[0], u[2]]

    def of_annulus(result: ks.Result) -> list[float]:
        x, w = result.mesh.points, result.fields["displacement"][:, 2]
        at_slit = np.abs(x[:, 1]) < 1e-9
        return [float(w[at_slit & (np.abs(x[:, 0] - radius) < 1e-9)].max()) for radius in (6.0, 10.0)]

    def of_hemisphere(result: ks.Result) -> list[float]:
        return [result.probe("pull")["u"][0], -result.probe("push")["u"][1]]

    warnings.simplefilter("ignore")
    cases: list[tuple[str, ks.Scene, int, Callable[[ks.Result], list[float]], tuple[float, float]]] = [
        ("strip, 8 x 1", scenes.cantilever(), 1, of_strip, scenes.CANTILEVER),
        ("slit annulus, 6 x 30", scenes.slit_annulus(), 5, of_annulus, scenes.ANNULUS),
        ("hemisphere, 12 x 12", scenes.hemisphere(), 4, of_hemisphere, scenes.HEMISPHERE),
    ]
    ks.solve(scenes.cantilever(2), large_deflection=True)
    print(
        f"\n{'whole solve, p = 2, CPU s':28s}{'scene':>8s}{'kernel':>8s}{'steps':>7s}{'iterations':>11s}  errors"
    )
    for name, scene, steps, values, references in cases:
        begin = time.process_time()
        result = ks.solve(scene, large_deflection=True, order=2, steps=steps)
        of_scene = time.process_time() - begin
        begin = time.process_time()
        load_path(model_of(scene, large_deflection=True, order=2).equilibrium(), steps)
        of_kernel = time.process_time() - begin
        errors = np.array(values(result)) / references - 1
        print(
            f"{name:28s}{of_scene:8.3f}{of_kernel:8.3f}{result.solver['steps']:7d}{result.solver['iterations']:11d}  "
            + " ".join(f"{e:+.1e}" for e in errors),
            flush=True,
        )


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--one", type=int, metavar="CELLS", help="measure in this process and print JSON")
    parser.add_argument("--cells", type=int, nargs="+", default=[75])
    parser.add_argument("--before", metavar="FOLDER")
    parser.add_argument("--beside", nargs=2, action="append", default=[], metavar=("NAME", "COMMAND"))
    parser.add_argument("--out", type=Path, default=HERE)
    arguments = parser.parse_args()
    if arguments.one is not None:
        if os.environ.get("SUPERLU_ALONE"):
            superlu_alone()
        print(json.dumps(one(arguments.one)))
        return
    phases(arguments.cells, arguments.before, arguments.beside, arguments.out)
    whole_solves()


if __name__ == "__main__":
    main()
