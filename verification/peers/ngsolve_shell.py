"""Linear Koiter shells by NGSolve: hybridised moments, membrane strain interpolated into Regge elements.

    python verification/peers/ngsolve_shell.py JOB.json        see job.py

Arrays of a mesh: count, of cells. Of the job: problem, a name of surfaces.py, whose grid is cut into triangles and
moved to the surface; element, the order. The moment that is read is its trace. A script that
needs numpy and ngsolve alone.

Symbols (Neunteufel & Schoeberl, arXiv:2304.13806)
-------
u, du       displacement of degree ORDER
m, dm       moments of degree ORDER - 1, eliminated in the elements
h, dh       rotation of the edges, of degree ORDER - 1
n, t, e     normal of the surface, tangent of an edge, n x t
"""

from __future__ import annotations

import os
from typing import Any

import netgen.meshing as netgen
import ngsolve as ng
import numpy as np
from job import run
from surfaces import FREEDOMS, SURFACES, Surface

KEPT: list[Any] = []  # what meshes refer to without owning it
# of the reference triangle of NGSolve
CORNERS = ((1.0, 0.0), (0.0, 1.0), (0.0, 0.0))


def held(surface: Surface, freedoms: str) -> str:
    """Sides on which one of the freedoms vanishes, as NGSolve writes it."""
    return "|".join(side for side, how in surface.held.items() if set(FREEDOMS[how]) & set(freedoms))


def curved_mesh(surface: Surface, order: int, count: int) -> tuple[Any, Any]:
    """The grid of the parameters, moved to the surface by polynomials; and what must outlive it.

    The mesh is not curved by its geometry: from order 3 on that takes a hundred times as long as all the rest.
    """
    geometry = netgen.SurfaceGeometry(lambda x, y, z: (x, y, 0 * x))
    along, across = surface.grid(count)
    mesh = ng.Mesh(geometry.GenerateMesh(quads=False, nx=along, ny=across))
    motion = ng.GridFunction(ng.VectorH1(mesh, order=order))
    x, y, z = surface.place(ng.x, ng.y, ng)
    motion.Set(ng.CF((x - ng.x, y - ng.y, z)), definedon=mesh.Boundaries(".*"))
    mesh.SetDeformation(motion)
    return mesh, (geometry, motion)


def vertex(mesh: Any, s: float, t: float) -> int:
    """The one at a point of the grid."""
    points = np.array([v.point for v in mesh.vertices])
    return int(np.argmin(np.sum((points - (s, t, 0.0)) ** 2, axis=1)))


def solve(arrays: dict[str, Any], job: dict[str, Any]) -> Any:
    """Mesh, assemble, solve."""
    surface = SURFACES[job["problem"]]
    order = int(job["element"])
    young, nu, t = surface.material
    mesh, needed = curved_mesh(surface, order, int(arrays["count"]))
    fixed = {f"dirichlet{a}_bbnd": held(surface, k) for a, k in zip("xyz", "123", strict=True)}
    displacement = ng.VectorH1(mesh, order=order, **fixed)
    space = ng.FESpace(
        [
            displacement,
            ng.HDivDivSurface(mesh, order=order - 1, discontinuous=True),
            ng.NormalFacetSurface(mesh, order=order - 1, dirichlet_bbnd=held(surface, "456")),
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

    count = displacement.components[0].ndof
    for corner, freedom in surface.pinned:
        for free in (space.FreeDofs(), space.FreeDofs(True)):
            free[(freedom - 1) * count + vertex(mesh, *corner)] = False
    form.Assemble()
    load = ng.LinearForm(space)
    if any(surface.dead):
        load += ng.CF(surface.dead) * du * ng.ds
    load.Assemble()
    for corner, force in surface.points:
        at = vertex(mesh, *corner)
        for axis, component in enumerate(force):
            load.vec.FV()[axis * count + at] += component
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

    def read() -> dict[str, Any]:
        corner, axis, sign = surface.read
        at = vertex(mesh, *corner)
        middle = vertex(mesh, *surface.moment)
        moment = ng.Trace(solution.components[1])

        def evaluate(element: Any, corner: tuple[float, float]) -> float:
            rule = ng.IntegrationRule(points=[corner], weights=[1.0])
            return float(moment(mesh.GetTrafo(element)(rule))[0][0])

        around = []
        for element in mesh.Elements(ng.BND):
            numbers = [v.nr for v in element.vertices]
            if middle in numbers:
                around.append(evaluate(element, CORNERS[numbers.index(middle)]))
        return {
            "unknowns": int(sum(space.FreeDofs(True))),
            "w": sign * float(solution.components[0].components[axis].vec[at]),
            "compliance": float(ng.InnerProduct(load.vec, solution.vec)),
            "M": abs(float(np.mean(around))),
        }

    KEPT.append(needed)
    return read


if __name__ == "__main__":
    ng.SetNumThreads(1)
    run(solve, f"ngsolve {ng.__version__}")
    os._exit(0)  # the interpreter's own end crashes on the functions that the geometry holds
