"""Plates by NGSolve: hybridised Hellan-Herrmann-Johnson elements. A script that needs numpy and ngsolve alone.

    python verification/peers/ngsolve_plate.py JOB.json        see job.py

Arrays of a mesh: points (vertex, 2), triangles (triangle, 3), edges (boundary edge, 2). Of the job: element, the order;
kind, clamped or supported; place (x, y), where w and M_xx are read; round, for the unit disk: a mesh of Netgen's own,
of the same mean size, follows the circle; load, the pressure as an expression of x and y. Stiffness 1, nu = 0.3.

Symbols (Comodi 1989; Neunteufel & Schoeberl, arXiv:2304.13806)
-------
w, dw       deflection of degree ORDER, continuous, and its test function
m, dm       -M of degree ORDER - 1, without continuity, eliminated in the elements
h, dh       normal slope on the edges, of degree ORDER - 1
"""

from __future__ import annotations

from typing import Any

import netgen.meshing as netgen
import ngsolve as ng
import numpy as np
from job import run

NU = 0.3
BEYOND = 6  # degree of loads that are integrated exactly
BESIDE = 1e-9  # moments jump between elements: the mean of four values beside the point is taken


def to_netgen(points: Any, triangles: Any, edges: Any) -> Any:
    """The mesh, its boundary named "edge"."""
    mesh = netgen.Mesh(dim=2)
    inside = mesh.Add(netgen.FaceDescriptor(surfnr=1, domin=1, domout=0, bc=1))
    mesh.AddPoints(np.column_stack([points, np.zeros(len(points))]))
    mesh.AddElements(dim=2, index=inside, data=np.ascontiguousarray(triangles, dtype=np.int32), base=0)
    mesh.AddElements(dim=1, index=1, data=np.ascontiguousarray(edges, dtype=np.int32), base=0)
    mesh.SetBCName(0, "edge")
    return ng.Mesh(mesh)


def round_mesh(arrays: dict[str, Any], job: dict[str, Any]) -> dict[str, Any]:
    """The unit disk meshed by Netgen, with triangles about as large as those given."""
    if not job.get("round"):
        return arrays
    from netgen.geom2d import SplineGeometry

    circle = SplineGeometry()
    circle.AddCircle((0, 0), 1, bc="edge")
    size = float(np.sqrt(np.pi / len(arrays["triangles"]) * 4 / np.sqrt(3)))
    return {"round": circle.GenerateMesh(maxh=size)}


def solve(arrays: dict[str, Any], job: dict[str, Any]) -> Any:
    """Assemble and solve."""
    order, kind = int(job["element"]), job["kind"]
    if "round" in arrays:
        mesh = ng.Mesh(arrays["round"]).Curve(order)
    else:
        mesh = to_netgen(arrays["points"], arrays["triangles"], arrays["edges"])
    space = ng.FESpace(
        [
            ng.H1(mesh, order=order, dirichlet="edge"),
            ng.HDivDiv(mesh, order=order - 1, discontinuous=True),
            ng.NormalFacetFESpace(mesh, order=order - 1, dirichlet="edge" if kind == "clamped" else ""),
        ]
    )
    (w, m, h), (dw, dm, dh) = space.TnT()
    n = ng.specialcf.normal(2)
    compliance = (m - NU / (1 + NU) * ng.Trace(m) * ng.Id(2)) / (1 - NU)
    form = ng.BilinearForm(space, symmetric=True, condense=True)
    form += -ng.InnerProduct(compliance, dm) * ng.dx
    form += (ng.InnerProduct(m, dw.Operator("hesse")) + ng.InnerProduct(dm, w.Operator("hesse"))) * ng.dx
    turn, virtual = (ng.grad(w) - h) * n, (ng.grad(dw) - dh) * n
    form += -(n * (m * n) * virtual + n * (dm * n) * turn) * ng.dx(element_boundary=True)
    form.Assemble()
    if job["load"] == "1":
        load = ng.LinearForm(dw * ng.dx).Assemble().vec
    else:
        pressure = eval(job["load"], {"x": ng.x, "y": ng.y, "exp": ng.exp, "cos": ng.cos})
        load = ng.LinearForm(pressure * dw * ng.dx(bonus_intorder=BEYOND)).Assemble().vec
    free = space.FreeDofs(True)
    inverse = form.mat.Inverse(free, inverse="sparsecholesky")
    solution = ng.GridFunction(space)
    right = load.CreateVector()
    right.data = load + form.harmonic_extension_trans * load
    solution.vec.data = inverse * right
    rest = right.CreateVector()
    rest.data = right - form.mat * solution.vec
    solution.vec.data += inverse * rest  # one step of refinement
    solution.vec.data += form.harmonic_extension * solution.vec
    solution.vec.data += form.inner_solve * right
    found_w, found_m, _ = solution.components

    def read() -> dict[str, Any]:
        x, y = job["place"]
        around = [(x + a * BESIDE, y + b * 2 * BESIDE) for a in (-1, 1) for b in (-1, 1)]
        return {
            "unknowns": int(sum(free)),
            "compliance": float(ng.InnerProduct(load, solution.vec)),
            "w": float(found_w(mesh(x, y))),
            "M": float(np.mean([-found_m[0, 0](mesh(*place)) for place in around])),
        }

    return read


if __name__ == "__main__":
    ng.SetNumThreads(1)
    run(solve, f"ngsolve {ng.__version__}", round_mesh)
