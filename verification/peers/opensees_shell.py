"""Plates and shells by OpenSees: thin triangles and quadrilaterals (discrete Kirchhoff bending). Needs openseespy.

    python verification/peers/opensees_shell.py JOB.json        see job.py

Arrays of a mesh: points (n, 3), cells (m, 3 or 4), fixed (n, 6), force (n, 3), read (node, axis, sign). Of the job:
element, a name of OpenSees; material (E, nu, thickness); steps, 0 for small deflections, else Newton's method in so
many load steps.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import openseespy.opensees as ops
from job import run

MOST_ITERATIONS = 60
TOLERANCE = 1e-6  # of the displacements, in Newton's method


def solve(arrays: dict[str, Any], job: dict[str, Any]) -> Any:
    """Model, assemble, solve."""
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    for number, x in enumerate(arrays["points"].tolist(), start=1):
        ops.node(number, *x)
    ops.section("ElasticMembranePlateSection", 1, *job["material"], 0.0)
    for number, nodes in enumerate((arrays["cells"] + 1).tolist(), start=1):
        ops.element(job["element"], number, *nodes, 1)
    fixed = arrays["fixed"].astype(int)
    for node in np.flatnonzero(fixed.any(axis=1)).tolist():
        ops.fix(node + 1, *fixed[node].tolist())
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    forces = arrays["force"]
    for node in np.flatnonzero(forces.any(axis=1)).tolist():
        ops.load(node + 1, *forces[node].tolist(), 0.0, 0.0, 0.0)
    ops.constraints("Plain")
    ops.numberer("RCM")
    ops.system("UmfPack")
    steps = job["steps"] or 1
    ops.test("NormDispIncr", TOLERANCE, MOST_ITERATIONS)
    ops.algorithm("Newton" if job["steps"] else "Linear")
    ops.integrator("LoadControl", 1.0 / steps)
    ops.analysis("Static")
    if ops.analyze(steps) != 0:
        raise SystemExit(f"no convergence from the load factor {ops.getTime():g} on")

    def read() -> dict[str, Any]:
        u = np.array([[ops.nodeDisp(k, axis) for axis in (1, 2, 3)] for k in range(1, len(forces) + 1)])
        node, axis, sign = arrays["read"].tolist()
        unknowns = int((fixed == 0).sum())
        return {
            "unknowns": unknowns,
            "w": sign * float(u[node, axis]),
            "compliance": float(np.sum(forces * u)),
        }

    return read


if __name__ == "__main__":
    run(solve, f"OpenSees {ops.version()}")
