"""kshell's driver: `python -m verification.work_precision.own JOB.json`, see verification/peers/job.py.

Timed is all from the arrays to the displacements of the vertices: mesh with its checks, scene, supports, assembly,
solution, energies, and the check of equilibrium. With the solver "bare" a shell is solved without the last two. Moments
and other fields are recovered when they are looked at, behind the clock.
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

import kshell as ks
from kshell.errors import KshellWarning
from verification.peers.job import Read, run
from verification.peers.surfaces import SURFACES
from verification.work_precision.catalogue import COMPARISONS
from verification.work_precision.methods import BARE
from verification.work_precision.problems import mesh_of


def solve(arrays: dict[str, Any], job: dict[str, Any]) -> Read:
    """Mesh arrays to displacements."""
    comparison = COMPARISONS[job["problem"]]
    scene = comparison.scene(mesh_of(arrays))
    element, _, order = job["element"].partition(" ")
    options = {
        **comparison.options(),
        "element": element,
        "error": "off",
    }  # no other program estimates its error
    if order:
        options["order"] = int(order)
    if job["solver"] == BARE:
        return _bare(scene, options, job["problem"])
    result = ks.solve(scene, solver=job["solver"], **options)
    np.abs(result.fields["displacement"]).max()
    return lambda: {"unknowns": result.unknowns, **comparison.read(result)}


def _bare(scene: ks.Scene, options: dict[str, Any], problem: str) -> Read:
    """A linear shell without recovery and reactions: what the other programs do."""
    from kshell.analysis.models import model_of

    model = model_of(scene, **options)
    mesh, solution = model.structure.parameters, model.solve()

    def read() -> dict[str, Any]:
        surface = SURFACES[problem]
        corner, axis, sign = surface.read
        parameters = np.array(surface.parameters(*corner))
        vertex = int(np.argmin(np.linalg.norm(mesh.points[:, :2] - parameters, axis=1)))
        stride = 18 if options["element"] == "argyris" else 3
        w = sign * float(solution.x[stride * vertex + axis])
        return {
            "unknowns": model.unknowns,
            "w": w,
            "compliance": float(model.problem.load @ solution.x),
        }

    return read


if __name__ == "__main__":
    warnings.simplefilter("ignore", KshellWarning)
    run(solve, f"kshell {ks.__version__}")
