"""One process per program and problem: CPU seconds on one thread, unknowns, and the numbers that are compared."""

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
REPEATS, TOGETHER = (3, 12), 0.1  # three times at least, more where that is soon done
PATIENCE = 0.3  # once where it takes longer
ROUNDS = (
    2  # of all programs in turn: the least seconds count, so that no program meets the worse minutes alone
)
LONGEST = 4.0  # finer meshes of a method are left out behind that
LIMIT = 150  # CPU seconds of a process
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
    comparison: Comparison, names: Sequence[str], peers_python: str | None, folder: Path
) -> Iterator[dict[str, Any]]:
    """Measurements of methods that share a driver, coarse to fine; a row says why there is no more, if one failed."""
    methods = [METHODS[name] for name in names]
    python = interpreter(methods[0].program, peers_python)
    if python is None:
        yield from (_nothing(comparison, one, comparison.plan[one.id][0], "not installed") for one in methods)
        return
    while methods:
        lines, said = _run(python, comparison, methods, folder)
        for number, method in enumerate(methods):
            own = [line for line in lines if line["method"] == method.id]
            counts = comparison.plan[method.id]
            measured = [line for line in own if "seconds" in line]
            for count, line in zip(counts, measured, strict=False):
                yield _row(comparison, method, count, line)
            if not any("finished" in line for line in own):
                yield _nothing(comparison, method, counts[len(measured)], f"no answer: {said}")
                methods = methods[number + 1 :]  # those behind it had no chance
                break
        else:
            return


def _run(
    python: str, comparison: Comparison, methods: Sequence[Method], folder: Path
) -> tuple[list[dict[str, Any]], str]:
    """What a driver printed, and its last words."""
    problem: Any = comparison
    parts = []
    for method in methods:
        files = []
        for count in comparison.plan[method.id]:
            files.append(folder / f"{comparison.id}-{method.feed.replace(' ', '-')}-{count}.npz")
            if not files[-1].exists():
                np.savez(files[-1], **problem.arrays(method.feed, count))
        own = {"method": method.id, "element": method.element, "solver": method.solver}
        parts.append({**own, "meshes": [str(file) for file in files]})
    program = methods[0]
    job = {
        **problem.facts(program.program),
        "parts": parts,
        "repeats": REPEATS,
        "together": TOGETHER,
        "patience": PATIENCE,
        "longest": LONGEST,
    }
    file = folder / "job.json"
    file.write_text(json.dumps(job), encoding="utf-8")
    script = [str(DRIVERS / program.driver)] if program.driver else ["-m", "verification.work_precision.own"]
    done = subprocess.run(
        [python, *script, str(file)],
        env={**os.environ, **THREADS},
        cwd=None if program.driver else REPOSITORY,
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (LIMIT, LIMIT)),
    )
    lines = [json.loads(line) for line in done.stdout.splitlines() if line.startswith('{"method"')]
    words = [line for line in done.stderr.strip().splitlines() if not line.startswith("Process ")]
    return lines, words[-1] if words else f"ended after {LIMIT} s of CPU"


def run_all(comparisons: Sequence[Comparison], peers_python: str | None) -> Iterator[dict[str, Any]]:
    """All measurements of comparisons; methods that share a driver share a process."""
    with tempfile.TemporaryDirectory() as folder:
        for comparison in comparisons:
            drivers = dict.fromkeys((METHODS[name].program, METHODS[name].driver) for name in comparison.plan)
            best: dict[tuple[str, int], dict[str, Any]] = {}
            for _ in range(ROUNDS):
                for driver in drivers:
                    names = [
                        name
                        for name in comparison.plan
                        if (METHODS[name].program, METHODS[name].driver) == driver
                    ]
                    for row in rows_of(comparison, names, peers_python, Path(folder)):
                        known = best.setdefault((row["method"], row["cells"]), row)
                        if row["seconds"] < known["seconds"] or not known["unknowns"]:
                            best[row["method"], row["cells"]] = row
            yield from best.values()


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
