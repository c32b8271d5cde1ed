"""One measurement per process: CPU seconds on one thread, unknowns, and the numbers that are compared."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

import kshell as ks
from verification.cases.plate import plate
from verification.peers import ngsolve_plate, scikit_fem
from verification.work_precision.problems import METHODS, PROBLEMS, Method, Problem

REPEATS, PATIENCE = 3, 1.0  # three times, once where it takes longer
THREADS = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
LETTERS = {"clamped": "C", "supported": "S"}


def family(method: Method) -> str:
    """Which sizes a method takes."""
    return "hhj" if method.program == "ngsolve" else method.element


def solve_here(problem: Problem, method: Method, cells: int) -> dict[str, Any]:
    """Mesh arrays to values; kshell recovers all moments and reactions, scikit-fem only what is read."""
    x, y = problem.place
    if method.program == "kshell":
        scene = plate(problem.build(cells), {"edge": LETTERS[problem.kind]}, [ks.Pressure(1.0)])
        begin = time.process_time()
        result = ks.solve(scene, element=method.element, solver=method.solver, large_deflection=False)
        found = result.at((x, y, 0.0))
        return {
            "seconds": time.process_time() - begin,
            "unknowns": result.unknowns,
            "compliance": 2 * result.strain_energy,
            "w": float(found["u"][0, 2]),
            "M": float(found["M"][0, 0]),
            "version": f"kshell {ks.__version__}, {result.solver['name']}",
        }
    import skfem

    arrays = problem.arrays(cells)
    kind: Any = problem.kind
    begin = time.process_time()
    bare = scikit_fem.solve(arrays["points"], arrays["triangles"], method.element, kind)
    w, m = bare.deflection(x, y), bare.moment_xx(x, y) if method.element == "argyris" else np.nan
    return {
        "seconds": time.process_time() - begin,
        "unknowns": bare.unknowns,
        "compliance": bare.compliance,
        "w": w,
        "M": m,
        "version": f"scikit-fem {skfem.__version__}",
    }


def one(problem: str, method: str, cells: int) -> dict[str, Any]:
    """After a small solve that loads all modules; the best of some."""
    chosen = next(m for m in METHODS if m.id == method)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        solve_here(PROBLEMS[problem], chosen, 4)
        best = solve_here(PROBLEMS[problem], chosen, cells)
        for _ in range(REPEATS - 1 if best["seconds"] < PATIENCE else 0):
            best = min(best, solve_here(PROBLEMS[problem], chosen, cells), key=lambda found: found["seconds"])
    return best


def run_all(peers_python: str | None, most: float) -> Iterator[dict[str, Any]]:
    """All problems, methods and sizes whose unknowns stay below ``most``, one process each."""
    if peers_python is None and find_spec("ngsolve") is not None:
        peers_python = sys.executable
    with tempfile.TemporaryDirectory() as folder:
        for problem in PROBLEMS.values():
            for method in METHODS:
                if method.program == "ngsolve" and peers_python is None:
                    continue
                for cells in problem.sizes[family(method)]:
                    row = _row(problem, method, cells, peers_python, Path(folder))
                    yield row
                    if 4 * row["unknowns"] > most:
                        break


def _row(
    problem: Problem, method: Method, cells: int, peers_python: str | None, folder: Path
) -> dict[str, Any]:
    if method.program == "ngsolve":
        file = folder / f"{problem.id}-{cells}.npz"
        arrays: Any = problem.arrays(cells)
        np.savez(file, **arrays)
        place = f"{problem.place[0]},{problem.place[1]}"
        script = str(ngsolve_plate.__file__)
        repeats = str(REPEATS if cells <= 16 else 1)
        command = [str(peers_python), script, str(file), method.element, problem.kind, repeats, place]
    else:
        words = [problem.id, method.id, str(cells)]
        command = [sys.executable, "-m", "verification.work_precision", "--one", *words]
    done = subprocess.run(command, env={**os.environ, **THREADS}, capture_output=True, text=True, check=False)
    out: dict[str, Any] = {"problem": problem.id, "method": method.id, "cells": cells}
    if done.returncode:
        reason = (done.stderr.strip().splitlines() or ["killed"])[-1]
        nothing = dict.fromkeys(("seconds", "compliance error", "w error", "M error", "compliance"), np.nan)
        return {**out, "unknowns": 0, **nothing, "version": f"no answer: {reason}"}
    found = json.loads(done.stdout.strip().splitlines()[-1])
    out |= {name: found[name] for name in ("unknowns", "seconds")}
    for name in ("compliance", "w", "M"):
        reference = problem.references.get(name)
        value = found[name][0] if isinstance(found[name], list) else found[name]
        out[f"{name} error"] = abs(value / reference - 1) if reference else np.nan
    return {**out, "compliance": found["compliance"], "version": found["version"]}
