"""Linear Koiter shells by NGSolve: hybridised moments, membrane strain interpolated into Regge elements.

    python verification/peers/ngsolve_shell.py PROBLEM ORDER CELLS REPEATS

PROBLEM is scordelis_lo, pinched_cylinder or hemisphere_hole, a quarter of each on a regular grid of CELLS x CELLS
squares cut in two. Prints JSON: CPU seconds from the mesh on to the value on one thread (imports and a first small
solve left out), unknowns of the linear system, and the deflection that the benchmark asks for. A script that needs
numpy and ngsolve alone.

Symbols (Neunteufel & Schoeberl, arXiv:2304.13806)
-------
u, du       displacement of degree ORDER
m, dm       moments of degree ORDER - 1, eliminated in the elements
h, dh       rotation of the edges, of degree ORDER - 1
n, t, e     normal of the surface, tangent of an edge, n x t
"""

from __future__ import annotations

import json
import os
import sys
import time
from math import cos, pi, sin
from typing import Any

# E, nu, thickness; where each displacement component and the rotation vanish (left and right: first parameter 0
# and 1, bottom and top: second); point loads (parameters, force); dead load; where the answer is read, its axis
PROBLEMS: dict[str, dict[str, Any]] = {
    "scordelis_lo": {
        "material": (4.32e8, 0.0, 0.25),
        "held": ("left|top", "bottom", "top", "left|bottom"),
        "points": (),
        "dead": -90.0,
        "read": ((1, 0), 2, -1.0),
    },
    "pinched_cylinder": {
        "material": (3e6, 0.3, 3.0),
        "held": ("left|top", "bottom", "right|top", "left|right|bottom"),
        "points": (((0, 0), (0, 0, -0.25)),),
        "dead": 0.0,
        "read": ((0, 0), 2, -1.0),
    },
    "hemisphere_hole": {
        "material": (6.825e7, 0.3, 0.04),
        "held": ("right", "left", "", "left|right"),
        "points": (((0, 0), (1, 0, 0)), ((1, 0), (0, -1, 0))),
        "dead": 0.0,
        "read": ((0, 0), 0, 1.0),
    },
}


def place(problem: str, s: Any, t: Any, c: Any = cos, sn: Any = sin) -> tuple[Any, Any, Any]:
    """The surface over the unit square."""
    if problem == "scordelis_lo":
        a = s * (40 * pi / 180)
        return 25.0 * sn(a), t * 25.0, 25.0 * c(a)
    if problem == "pinched_cylinder":
        a = s * (pi / 2)
        return 300.0 * sn(a), t * 300.0, 300.0 * c(a)
    a, b = s * (pi / 2), t * (72 * pi / 180)
    return 10.0 * c(b) * c(a), 10.0 * c(b) * sn(a), 10.0 * sn(b)


def solve(problem: str, order: int, cells: int) -> tuple[int, float]:
    """Mesh, assemble, solve; unknowns and the answer."""
    import netgen.meshing as netgen
    import ngsolve as ng

    data = PROBLEMS[problem]
    young, nu, t = data["material"]
    surface = netgen.SurfaceGeometry(lambda x, y, z: place(problem, x, y, ng.cos, ng.sin))
    marks = [list(map(float, place(problem, *p))) for p, _ in data["points"]]
    names = {"bbbpts": marks, "bbbnames": [f"P{k}" for k in range(len(marks))]} if marks else {}
    mesh = ng.Mesh(surface.GenerateMesh(quads=False, nx=cells, ny=cells, **names)).Curve(order)
    x, y, z, rotation = data["held"]
    displacement = ng.VectorH1(mesh, order=order, dirichletx_bbnd=x, dirichlety_bbnd=y, dirichletz_bbnd=z)
    space = ng.FESpace(
        [
            displacement,
            ng.HDivDivSurface(mesh, order=order - 1, discontinuous=True),
            ng.NormalFacetSurface(mesh, order=order - 1, dirichlet_bbnd=rotation),
        ]
    )
    (u, m, h), (du, dm, dh) = space.TnT()
    m, h, dm, dh = m.Trace(), h.Trace(), dm.Trace(), dh.Trace()
    regge = ng.HCurlCurl(mesh, order=order - 1, discontinuous=True)
    n, tangent = ng.specialcf.normal(3), ng.specialcf.tangential(3)
    e = ng.Cross(n, tangent)
    tangential = ng.Id(3) - ng.OuterProduct(n, n)

    def strain(v: Any) -> Any:
        return ng.Interpolate(ng.Sym(tangential * ng.Grad(v).Trace()), regge)

    def bend(v: Any) -> Any:
        return (v.Operator("hesseboundary").trans * n).Reshape((3, 3))

    def stress(a: Any) -> Any:
        return young / (1 - nu**2) * ((1 - nu) * a + nu * ng.Trace(a) * tangential)

    def compliance(a: Any) -> Any:
        return (1 + nu) / young * (a - nu / (1 + nu) * ng.Trace(a) * tangential)

    form = ng.BilinearForm(space, symmetric=True, condense=True)
    form += (t * ng.InnerProduct(stress(strain(u)), strain(du))).Compile() * ng.ds
    bending = -12 / t**3 * ng.InnerProduct(compliance(m), dm)
    bending += ng.InnerProduct(dm, bend(u)) + ng.InnerProduct(m, bend(du))
    form += bending.Compile() * ng.ds
    turn = -m[e, e] * (ng.Grad(du).Trace()[n, e] - dh * e) - dm[e, e] * (ng.Grad(u).Trace()[n, e] - h * e)
    form += turn.Compile() * ng.ds(element_boundary=True)

    def vertex(p: tuple[float, float]) -> int:
        at = place(problem, *p)
        return next(v.nr for v in mesh.vertices if sum((v.point[i] - at[i]) ** 2 for i in range(3)) < 1e-12)

    count = displacement.components[0].ndof
    if problem == "hemisphere_hole":  # hold it along z at the first force
        for free in (space.FreeDofs(), space.FreeDofs(True)):
            free[2 * count + vertex((0, 0))] = False
    form.Assemble()
    load = ng.LinearForm(space)
    if data["dead"]:
        load += data["dead"] * du[2] * ng.ds
    load.Assemble()
    for p, force in data["points"]:
        for axis, component in enumerate(force):
            load.vec.FV()[axis * count + vertex(p)] += component
    inverse = form.mat.Inverse(space.FreeDofs(True), inverse="sparsecholesky")
    solution = ng.GridFunction(space)
    right = load.vec.CreateVector()
    right.data = load.vec + form.harmonic_extension_trans * load.vec
    solution.vec.data = inverse * right
    rest = right.CreateVector()
    rest.data = right - form.mat * solution.vec
    solution.vec.data += inverse * rest  # one step of refinement
    solution.vec.data += form.harmonic_extension * solution.vec
    solution.vec.data += form.inner_solve * right
    where, axis, sign = data["read"]
    return int(sum(space.FreeDofs(True))), sign * float(
        solution.components[0].components[axis].vec[vertex(where)]
    )


def main(problem: str, order: str, cells: str, repeats: str) -> None:
    """Solve and print."""
    import ngsolve

    ngsolve.SetNumThreads(1)
    solve(problem, int(order), 2)
    seconds, unknowns, value = [], 0, 0.0
    for _ in range(int(repeats)):
        begin = time.process_time()
        unknowns, value = solve(problem, int(order), int(cells))
        seconds.append(time.process_time() - begin)
    answer = {"unknowns": unknowns, "value": value, "seconds": min(seconds)}
    print(json.dumps({**answer, "version": f"ngsolve {ngsolve.__version__}"}), flush=True)
    os._exit(0)  # the interpreter's own end crashes on the functions that the geometry holds


if __name__ == "__main__":
    main(*sys.argv[1:])
