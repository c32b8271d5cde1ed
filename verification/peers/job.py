"""What every driver does: read a job, measure each mesh of each of its parts, print one line of JSON for each.

    python verification/peers/DRIVER.py JOB.json

A job is a JSON object with

parts       objects with the name of a method, its meshes, and what else differs between methods, such as the element;
            meshes are npz files, coarse to fine, and which arrays they have stands in the driver
repeats     how often each is solved at least, and at most; the quickest counts
together    seconds that all of them may take beyond the least number of times
patience    seconds from which once is enough
longest     seconds from which no finer mesh is tried

and what the driver asks for, called the job there, of all parts or of one. Seconds are processor time of the process
and its children on one thread, from the arrays of a mesh to the solution: imports, files and a first small solve are
left out, and values are read behind the clock.
"""

from __future__ import annotations

import json
import resource
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

Arrays = dict[str, Any]
Read = Callable[[], dict[str, Any]]  # unknowns, w, compliance, M; what a program does not have is left out


def processor_seconds() -> float:
    """Of this process and of its children that have ended."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(u.ru_utime + u.ru_stime for u in used)


def run(
    solve: Callable[[Arrays, dict[str, Any]], Read],
    version: str,
    prepare: Callable[[Arrays, dict[str, Any]], Arrays] = lambda arrays, job: arrays,
) -> None:
    """Do the job that the command line names.

    Parameters
    ----------
    solve : function
        From arrays and job to a function that reads the values; it alone is timed.
    version : str
        Name and version of the program.
    prepare : function, optional
        From arrays and job to what `solve` takes, not timed.
    """
    whole = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    for part in whole["parts"]:
        job = {**whole, **part}
        for number, file in enumerate(job["meshes"]):
            arrays = prepare(dict(np.load(file)), job)
            if number == 0:
                solve(arrays, job)()
            best, found = _best(solve, arrays, job)
            print(
                json.dumps({"method": job["method"], "seconds": best, "version": version, **found}),
                flush=True,
            )
            if best > job["longest"]:
                break
        print(json.dumps({"method": job["method"], "finished": True}), flush=True)


def _best(
    solve: Callable[[Arrays, dict[str, Any]], Read], arrays: Arrays, job: dict[str, Any]
) -> tuple[float, dict[str, Any]]:
    """Least seconds, and what was found."""
    best, read = np.inf, dict
    least, most = job["repeats"]
    total = 0.0
    for number in range(most):
        begin = processor_seconds()
        found = solve(arrays, job)
        seconds = processor_seconds() - begin
        total += seconds
        if seconds < best:
            best, read = seconds, found
        if seconds > job["patience"] or (number + 1 >= least and total > job["together"]):
            break
    return float(best), read()
