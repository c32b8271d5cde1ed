"""Plates by NGSolve: hybridised Hellan-Herrmann-Johnson elements. A script that needs numpy and ngsolve alone.

    python verification/peers/ngsolve_plate.py MESH.npz ORDER KIND REPEATS X,Y [X,Y ...]

MESH.npz has points (vertex, 2), triangles (triangle, 3), edges (boundary edge, 2). KIND is clamped or supported.
Bending stiffness 1, nu = 0.3, pressure 1. Prints JSON: CPU seconds from the arrays to the values on one thread
(imports and a first small solve left out), unknowns of the linear system, compliance, deflections, M_xx at the points.

Symbols (Comodi 1989; Neunteufel & Schoeberl, arXiv:2304.13806)
-------
w, dw       deflection of degree ORDER, continuous, and its test function
m, dm       -M of degree ORDER - 1, without continuity, eliminated in the elements
h, dh       normal slope on the edges, of degree ORDER - 1
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

NU = 0.3
BESIDE = 1e-9  # moments jump between elements: the mean of four values beside the point is taken


def to_netgen(points: Any, triangles: Any, edges: Any) -> Any:
    """The mesh, its boundary named "edge"."""
    import netgen.meshing as netgen
    import ngsolve

    mesh = netgen.Mesh(dim=2)
    inside = mesh.Add(netgen.FaceDescriptor(surfnr=1, domin=1, domout=0, bc=1))
    numbers = [mesh.Add(netgen.MeshPoint(netgen.Pnt(float(x), float(y), 0.0))) for x, y in points]
    for a, b, c in triangles:
        mesh.Add(netgen.Element2D(inside, [numbers[a], numbers[b], numbers[c]]))
    for a, b in edges:
        mesh.Add(netgen.Element1D([numbers[a], numbers[b]], index=1))
    mesh.SetBCName(0, "edge")
    return ngsolve.Mesh(mesh)


def solve(arrays: dict[str, Any], order: int, kind: str, places: list[tuple[float, float]]) -> dict[str, Any]:
    """Assemble, solve, evaluate."""
    import ngsolve as ng

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
    load = ng.LinearForm(dw * ng.dx).Assemble().vec
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
    around = [(x + a * BESIDE, y + b * 2 * BESIDE) for x, y in places for a in (-1, 1) for b in (-1, 1)]
    moments = np.array([-found_m[0, 0](mesh(x, y)) for x, y in around]).reshape(-1, 4).mean(axis=1)
    return {
        "unknowns": int(sum(free)),
        "compliance": float(ng.InnerProduct(load, solution.vec)),
        "w": [float(found_w(mesh(x, y))) for x, y in places],
        "M": moments.tolist(),
    }


def main(file: str, order: str, kind: str, repeats: str, *places: str) -> None:
    """Solve and print."""
    import ngsolve

    ngsolve.SetNumThreads(1)
    arrays = dict(np.load(Path(file)))
    points = [(float(x), float(y)) for x, y in (place.split(",") for place in places)]
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    around = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
    small = {"points": corners, "triangles": np.array([[0, 1, 2], [0, 2, 3]]), "edges": around}
    solve(small, int(order), kind, [(0.4, 0.3)])
    seconds, answer = [], {}
    for _ in range(int(repeats)):
        begin = time.process_time()
        answer = solve(arrays, int(order), kind, points)
        seconds.append(time.process_time() - begin)
    print(json.dumps({**answer, "seconds": min(seconds), "version": f"ngsolve {ngsolve.__version__}"}))


if __name__ == "__main__":
    main(*sys.argv[1:])
