"""Plates by GetFEM: Argyris, Hsieh-Clough-Tocher and Morley elements. A script that needs numpy and getfem alone.

    python verification/peers/getfem_plate.py JOB.json        see job.py

Arrays of a mesh: points (vertex, 2), triangles (triangle, 3). Of the job: element, a key of ELEMENTS; kind, clamped or
supported; place (x, y), where w is read. Bending stiffness 1, nu = 0.3, pressure 1. Edges are held by a penalty of 1e9,
as the program's own examples do.
"""

from __future__ import annotations

from typing import Any

import getfem
import numpy as np
from job import run

NU = 0.3
PENALTY = 1e9
ELEMENTS = {
    "argyris": ("FEM_ARGYRIS", "IM_TRIANGLE(10)"),
    "hct": ("FEM_HCT_TRIANGLE", "IM_HCT_COMPOSITE(IM_TRIANGLE(6))"),
    "morley": ("FEM_MORLEY", "IM_TRIANGLE(4)"),
}


def solve(arrays: dict[str, Any], job: dict[str, Any]) -> Any:
    """Mesh, assemble, solve."""
    corners = arrays["points"][arrays["triangles"]]  # (triangle, 3, 2)
    mesh = getfem.Mesh("empty", 2)
    mesh.add_convex(getfem.GeoTrans("GT_PK(2,1)"), np.asfortranarray(corners.transpose(2, 1, 0)))
    element, rule = ELEMENTS[job["element"]]
    space = getfem.MeshFem(mesh, 1)
    space.set_fem(getfem.Fem(element))
    integration = getfem.MeshIm(mesh, getfem.Integ(rule))
    mesh.set_region(1, mesh.outer_faces())
    model = getfem.Model("real")
    model.add_fem_variable("u", space)
    for name, value in (("D", 1.0), ("nu", NU), ("q", 1.0)):
        model.add_initialized_data(name, [value])
    model.add_Kirchhoff_Love_plate_brick(integration, "u", "D", "nu")
    model.add_source_term_brick(integration, "u", "q")
    model.add_Dirichlet_condition_with_penalization(integration, "u", PENALTY, 1)
    if job["kind"] == "clamped":
        model.add_normal_derivative_Dirichlet_condition_with_penalization(integration, "u", PENALTY, 1)
    model.solve("lsolver", "mumps")

    def read() -> dict[str, Any]:
        u = model.variable("u")
        where = getfem.Slice("points", mesh, np.array(job["place"], dtype=float).reshape(2, 1))
        return {
            "unknowns": int(space.nbdof()),
            "w": float(np.ravel(getfem.compute_interpolate_on(space, u, where))[0]),
            "compliance": float(getfem.asm("generic", integration, 0, "u", -1, model)),
        }

    return read


if __name__ == "__main__":
    getfem.util_trace_level(0)
    run(solve, "GetFEM")
