"""What every driver does: read a job, measure each of its meshes, print one line of JSON for each.

    python verification/peers/DRIVER.py JOB.json

A job is a JSON object with

meshes      npz files, coarse to fine; which arrays they have stands in the driver
repeats     how often each is solved at most; the quickest counts
patience    seconds from which once is enough
longest     seconds from which no finer mesh is tried

and what the driver asks for. Seconds are processor time of the process and its children on one thread, from the
arrays of a mesh to the solution: imports, files and a first small solve are left out, and values are read when the
clock has stopped.
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
    job = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    for number, file in enumerate(job["meshes"]):
        arrays = prepare(dict(np.load(file)), job)
        if number == 0:
            solve(arrays, job)()
        best, read = np.inf, None
        for _ in range(job["repeats"]):
            begin = processor_seconds()
            found = solve(arrays, job)
            seconds = processor_seconds() - begin
            if seconds < best:
                best, read = seconds, found
            if seconds > job["patience"]:
                break
        assert read is not None
        print(json.dumps({"seconds": best, "version": version, **read()}), flush=True)
        if best > job["longest"]:
            break
