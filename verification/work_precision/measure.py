"""One process per method and problem: CPU seconds on one thread, unknowns, and the numbers that are compared."""

from __future__ import annotations

import json
import math
import os
import resource
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import verification.peers
from verification.work_precision.methods import METHODS, Method
from verification.work_precision.problems import QUANTITIES, Comparison

REPOSITORY = Path(__file__).parents[2]
DRIVERS = Path(verification.peers.__file__).parent
THREADS = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
REPEATS, PATIENCE = 3, 0.3  # three times, once where it takes longer
LONGEST = 6.0  # finer meshes of a method are left out behind that
LIMIT = 60  # CPU seconds of a process
# what must be there: a module of Python or a program
NEEDS = {
    "scikit-fem": "skfem",
    "NGSolve": "ngsolve",
    "Kratos": "KratosMultiphysics.StructuralMechanicsApplication, KratosMultiphysics.LinearSolversApplication",
    "OpenSees": "openseespy.opensees",
    "GetFEM": "getfem",
}
PROGRAMS = {"CalculiX": "ccx", "FreeFEM": "FreeFem++"}
SYSTEM_PYTHON = "/usr/bin/python3"  # distributions install GetFEM for it


@cache
def interpreter(program: str, peers_python: str | None) -> str | None:
    """The Python that runs the driver of a program, None where the program is not installed."""
    if program in PROGRAMS and shutil.which(PROGRAMS[program]) is None:
        return None
    if program not in NEEDS:
        return sys.executable
    for candidate in (peers_python, sys.executable, SYSTEM_PYTHON):
        if candidate is None or shutil.which(candidate) is None:
            continue
        done = subprocess.run(
            [candidate, "-c", f"import numpy, {NEEDS[program]}"], capture_output=True, check=False
        )
        if done.returncode == 0:
            return candidate
    return None


def rows_of(
    comparison: Comparison, method: Method, counts: Sequence[int], peers_python: str | None, folder: Path
) -> Iterator[dict[str, Any]]:
    """Measurements of a method, coarse to fine; a last row says why there is no more, if it failed."""
    problem: Any = comparison
    python = interpreter(method.program, peers_python)
    if python is None:
        yield _nothing(comparison, method, counts[0], "not installed")
        return
    files = []
    for count in counts:
        files.append(folder / f"{comparison.id}-{method.feed.replace(' ', '-')}-{count}.npz")
        if not files[-1].exists():
            np.savez(files[-1], **problem.arrays(method.feed, count))
    job = {
        **problem.facts(method.program),
        "meshes": [str(file) for file in files],
        "element": method.element,
        "solver": method.solver,
        "repeats": REPEATS,
        "patience": PATIENCE,
        "longest": LONGEST,
    }
    file = folder / "job.json"
    file.write_text(json.dumps(job), encoding="utf-8")
    script = [str(DRIVERS / method.driver)] if method.driver else ["-m", "verification.work_precision.own"]
    done = subprocess.run(
        [python, *script, str(file)],
        env={**os.environ, **THREADS},
        cwd=None if method.driver else REPOSITORY,
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (LIMIT, LIMIT)),
    )
    lines = [line for line in done.stdout.splitlines() if line.startswith('{"seconds"')]
    for count, line in zip(counts, lines, strict=False):
        yield _row(comparison, method, count, json.loads(line))
    if done.returncode and len(lines) < len(counts):
        words = [line for line in done.stderr.strip().splitlines() if not line.startswith("Process ")]
        said = words[-1] if words else f"ended after {LIMIT} s of CPU"
        yield _nothing(comparison, method, counts[len(lines)], f"no answer: {said}")


def run_all(
    comparisons: Sequence[Comparison], peers_python: str | None, programs: Sequence[str] = ()
) -> Iterator[dict[str, Any]]:
    """All measurements of comparisons, of some programs or of all."""
    with tempfile.TemporaryDirectory() as folder:
        for comparison in comparisons:
            for name, counts in comparison.plan.items():
                if not programs or METHODS[name].program in programs:
                    yield from rows_of(comparison, METHODS[name], counts, peers_python, Path(folder))


def _nothing(comparison: Comparison, method: Method, count: int, why: str) -> dict[str, Any]:
    out = {"problem": comparison.id, "method": method.id, "cells": count, "unknowns": 0, "seconds": math.nan}
    out |= {f"{name} error": math.nan for name in QUANTITIES}
    return {**out, "version": why}


def _row(comparison: Comparison, method: Method, count: int, found: dict[str, Any]) -> dict[str, Any]:
    out = _nothing(comparison, method, count, found["version"])
    out |= {"unknowns": found["unknowns"], "seconds": found["seconds"]}
    for name, reference in comparison.references.items():
        if name in found:
            out[f"{name} error"] = abs(found[name] / reference.value - 1)
    return out
