"""Plates by scikit-fem alone: its own Morley and Argyris elements, its forms, scipy's solver.

Edges are held as a careful user would: clamped and simply supported edges fix all that vanishes along a straight
edge (value, tangential derivatives), each straight mesh edge for itself.

    python verification/peers/scikit_fem.py JOB.json        see job.py

Arrays of a mesh: points (vertex, 2), triangles (triangle, 3). Of the job: element, morley or argyris; kind, clamped or
supported; place (x, y), where w and M_xx are read.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import spsolve

Floats = NDArray[np.float64]
Kind = Literal["clamped", "supported"]
NU = 0.3


@dataclass(frozen=True)
class BarePlate:
    """A plate of bending stiffness 1 and nu = 0.3 under the pressure 1.

    Attributes
    ----------
    basis : skfem.Basis
    u : (basis function,) array
    unknowns : int
        Free ones.
    compliance : float
    """

    basis: Any
    u: Floats
    unknowns: int
    compliance: float

    def deflection(self, x: float, y: float) -> float:
        """At a point."""
        return float((self.basis.probes(np.array([[x], [y]])) @ self.u)[0])

    def moment_xx(self, x: float, y: float) -> float:
        """-(w_xx + nu w_yy) at a point."""
        cell = self.basis.mesh.element_finder()(np.array([x]), np.array([y]))
        local = self.basis.mapping.invF(np.array([[[x]], [[y]]]), tind=cell)
        hessian = np.zeros((2, 2))
        for i, number in enumerate(self.basis.element_dofs[:, cell[0]]):
            field = self.basis.elem.gbasis(self.basis.mapping, local[:, 0], i, tind=cell)[0]
            hessian += self.u[number] * field.hess[:, :, 0, 0]
        return float(-(hessian[0, 0] + NU * hessian[1, 1]))


def solve(points: Floats, triangles: NDArray[np.integer], element: str, kind: Kind) -> BarePlate:
    """Assemble and solve.

    Parameters
    ----------
    points : (vertex, 2) array
    triangles : (triangle, 3) array
    element : "morley" or "argyris"
    kind : "clamped" or "supported"
        Of the whole boundary.
    """
    import skfem
    from skfem.helpers import dd, ddot, eye, trace

    mesh = skfem.MeshTri(np.ascontiguousarray(points.T), np.ascontiguousarray(triangles.T))
    used = {"morley": skfem.ElementTriMorley, "argyris": skfem.ElementTriArgyris}[element]()
    basis = skfem.Basis(mesh, used, intorder={"morley": 4, "argyris": 8}[element])

    @skfem.BilinearForm
    def bending(u: Any, v: Any, _: Any) -> Any:
        return ddot((1 - NU) * dd(u) + NU * eye(trace(dd(u)), 2), dd(v))

    @skfem.LinearForm
    def pressure(v: Any, _: Any) -> Any:
        return 1.0 * v

    matrix, load = bending.assemble(basis), pressure.assemble(basis)
    free = _free(basis, element, kind)
    reduced = free.T @ load
    u = free @ spsolve((free.T @ matrix @ free).tocsc(), reduced)
    return BarePlate(basis, u, free.shape[1], float(load @ u))


def _free(basis: Any, element: str, kind: Kind) -> sp.csr_matrix:
    """Columns that span the functions which obey the conditions of the edges."""
    mesh = basis.mesh
    edges = mesh.boundary_facets()
    fixed = np.zeros(basis.N, dtype=bool)
    rows: list[int] = []
    columns: list[int] = []
    values: list[float] = []
    count = 0
    if kind == "clamped":
        fixed[basis.facet_dofs[0, edges]] = True
    vertices = np.unique(mesh.facets[:, edges])
    if element == "morley":
        fixed[basis.nodal_dofs[0, vertices]] = True
    else:
        tangents: dict[int, list[Floats]] = {int(v): [] for v in vertices}
        for edge in edges:
            a, b = mesh.facets[:, edge]
            t = mesh.p[:, b] - mesh.p[:, a]
            for v in (a, b):
                tangents[int(v)].append(t / np.linalg.norm(t))
        for v, several in tangents.items():
            own = basis.nodal_dofs[:, v]
            fixed[own] = True
            kept = _null_space(np.concatenate([_conditions(t, kind) for t in several]))
            rows += list(np.repeat(own, kept.shape[1]))
            columns += list(np.tile(count + np.arange(kept.shape[1]), 6))
            values += list(kept.ravel())
            count += kept.shape[1]
    plain = np.flatnonzero(~fixed)
    rows += list(plain)
    columns += list(count + np.arange(len(plain)))
    values += [1.0] * len(plain)
    return sp.csr_matrix((values, (rows, columns)), shape=(basis.N, count + len(plain)))


def _conditions(t: Floats, kind: Kind) -> Floats:
    """What an edge along t fixes of u, u_x, u_y, u_xx, u_xy, u_yy."""
    x, y = float(t[0]), float(t[1])
    rows: list[list[float]] = [[1, 0, 0, 0, 0, 0], [0, x, y, 0, 0, 0], [0, 0, 0, x * x, 2 * x * y, y * y]]
    if kind == "clamped":  # the slope along the normal (-y, x), and its change along the edge
        rows += [[0, -y, x, 0, 0, 0], [0, 0, 0, -x * y, x * x - y * y, x * y]]
    return np.array(rows, dtype=float)


def _null_space(rows: Floats) -> Floats:
    _, sizes, directions = np.linalg.svd(rows)
    return directions[int(np.sum(sizes > 1e-10)) :].T


def _measured(arrays: dict[str, Any], job: dict[str, Any]) -> Callable[[], dict[str, Any]]:
    plate = solve(arrays["points"], arrays["triangles"], job["element"], job["kind"])

    def read() -> dict[str, Any]:
        found = {
            "unknowns": plate.unknowns,
            "compliance": plate.compliance,
            "w": plate.deflection(*job["place"]),
        }
        return {**found, "M": plate.moment_xx(*job["place"])} if job["element"] == "argyris" else found

    return read


if __name__ == "__main__":
    import skfem
    from job import run

    run(_measured, f"scikit-fem {skfem.__version__}")
