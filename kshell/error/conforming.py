"""The conforming side of a pair of bounds: Argyris solutions and what they are, triangle by triangle.

Triangles have their vertices in ascending order here, as those of `kshell.plate.hhj.geometry`, so that both sides share
reference points. Residuals are formed from strains of the deflection less the plane through the vertices of each
triangle: a conforming deflection needs no exact equations, but the sharper they hold the narrower the bounds are.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.elements.affine import AffineTriangles
from kshell.elements.quadrature import interval_rule, triangle_rule
from kshell.plate.assembly import assemble
from kshell.plate.hhj.geometry import Triangles
from kshell.plate.hhj.tables import edge_reference
from kshell.plate.hhj.translate import places
from kshell.plate.pattern import Pattern
from kshell.plate.problem import PlateProblem
from kshell.plate.product import strain_product
from kshell.solvers import Solution, prepare
from kshell.solvers.dense import DENSE_UP_TO

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

STEPS = 5
VERTEX_DOFS = 6  # w, w_x, w_y, w_xx, w_xy, w_yy
ROUNDING = 1e-16


class Conforming:
    """Argyris solutions of a plate, for any number of loads on one factorisation.

    Parameters
    ----------
    problem : PlateProblem
        With the Argyris element, straight edges.
    triangles : Triangles
        Of the same mesh.
    """

    def __init__(self, problem: PlateProblem, triangles: Triangles) -> None:
        self.problem, self.triangles = problem, triangles
        mesh, layout = problem.mesh, problem.layout
        self.element = problem.element
        affine = AffineTriangles.of_arrays(problem.domain.points, triangles.corners)
        self.transform = self.element.transformation(affine)  # (T, 21, 21)
        fans = np.take_along_axis(layout.fans.corner, triangles.order, axis=1)
        vertex = layout.fan_dofs(fans.ravel()).reshape(len(triangles), -1)
        self.dofs: Ints = np.concatenate([vertex, layout.edge_dofs(triangles.edges)], axis=1)
        self.reduction = problem.reduction.matrix().tocsr()
        self.particular = problem.reduction.particular
        self._points, self._area_weights = triangle_rule(6)
        self._product = None
        if problem.section.constant_per_triangle:
            every = np.arange(len(mesh.triangles))
            areas = (self._area_weights * triangles.area[:, None])[..., None, None]
            self._weighted = problem.bending.at(every, triangles.xy(self._points)) * areas
        else:  # at the points of the matrix, or this were another stiffness, which reactions do not balance
            self._product = strain_product(problem)
        self._name, self._why = "Cholesky (LAPACK)", "as few unknowns as these are solved densely"
        self._solve = self._factorise()

    def _factorise(self) -> Callable[[Floats], Floats]:
        problem = self.problem
        if problem.reduction.count <= DENSE_UP_TO:
            from scipy.linalg import cho_factor, cho_solve

            factor = cho_factor(problem.system.matrix)
            return lambda right: np.asarray(cho_solve(factor, right))
        prepared: Any = prepare(problem.assembled.matrix, None, "direct")
        self._name, self._why = prepared.name, prepared.why
        return lambda right: np.asarray(prepared.apply(right))

    @cached_property
    def _springs(self) -> Any:
        problem = self.problem
        springs = [form for form in problem.forms if form is not problem.bending]
        if not springs:
            return None
        pattern = Pattern(problem.reduction)
        return assemble(springs, [], problem.domain, problem.reduction, pattern).matrix

    def full(self, q: Floats, prescribed: bool = True) -> Floats:
        """(dof,) physical degrees of freedom of unknowns; with the prescribed motion or without."""
        d = self.reduction @ q
        return d + self.particular if prescribed else d

    def largest(self) -> float:
        """The largest deflection of a vertex."""
        every = np.arange(len(self.problem.mesh.points))
        w = self.full(self.unknowns)[self.problem.layout.vertex_dofs(every)[:, 0]]
        return float(np.abs(w).max())

    def reference(self, d: Floats) -> Floats:
        """(T, 21) of the deflection less the plane through the vertices, on the reference triangle."""
        local = d[self.dofs]
        w = local[:, : 3 * VERTEX_DOFS : VERTEX_DOFS]
        rise = np.stack([w[:, 1] - w[:, 0], w[:, 2] - w[:, 0]], axis=1)
        slope = (rise[:, None] @ self.triangles.inverse)[:, 0]  # (T, xy)
        local[:, : 3 * VERTEX_DOFS : VERTEX_DOFS] = 0.0
        for k in range(3):
            local[:, k * VERTEX_DOFS + 1 : k * VERTEX_DOFS + 3] -= slope
        local[:, 3 * VERTEX_DOFS :] -= (self.triangles.normals @ slope[..., None])[..., 0]
        return (self.transform @ local[..., None])[..., 0]

    def curvature(self, d: Floats, xi: Floats) -> Floats:
        """(T, point, 3) w_xx, w_yy, 2 w_xy at reference points (point, 2)."""
        table = self.element.basis.tabulate(xi, 2)[:, [0, 2, 1]]  # (point, 11 22 12, reference dof)
        found = self.reference(d) @ table.reshape(-1, table.shape[-1]).T
        return found.reshape(len(found), len(xi), 3) @ self.triangles.curvature_map.swapaxes(1, 2)

    def functional(self, moments: Floats, xi: Floats) -> Floats:
        """(dof,) the functional v -> sum over points of moments (T, point, 3) : curvature of v, weights included."""
        table = self.element.basis.tabulate(xi, 2)[:, [0, 2, 1]]
        reference = moments @ self.triangles.curvature_map
        local = reference.reshape(len(moments), -1) @ table.reshape(-1, table.shape[-1])
        force = (local[:, None] @ self.transform)[:, 0]
        return np.bincount(self.dofs.ravel(), force.ravel(), self.problem.layout.count).astype(np.float64)

    def curvature_functional(self, stress: Floats) -> Floats:
        """(dof,) the functional v -> int stress : curvature of v, stress (T, 3) constant in each triangle."""
        moments = stress[:, None] * (self._area_weights * self.triangles.area[:, None])[..., None]
        return self.functional(moments, self._points)

    def edge_integrals(self, edges: Ints, slopes: bool) -> tuple[Ints, Floats]:
        """(n,) a triangle at each edge, (n, 21) the integral of w, or of dw/dn, over it in physical unknowns."""
        owner, place = places(self.triangles, edges)
        s, ws = interval_rule(3)
        xi = edge_reference(place, s)
        length = self.triangles.lengths[owner, place][:, None]
        if slopes:
            gradient = np.swapaxes(self.triangles.inverse[owner], 1, 2)[
                :, None
            ] @ self.element.basis.tabulate(xi, 1)
            rows = (self.triangles.normals[owner, place][:, None, None] @ gradient)[:, :, 0]
        else:
            rows = self.element.basis.tabulate(xi, 0)[..., 0, :]
        return owner, ((length * (ws @ rows))[:, None] @ self.transform[owner])[:, 0]

    def once(self, right: Floats) -> Floats:
        """One solution with the factors, not refined."""
        return self._solve(right)

    def slopes(self, d: Floats) -> Floats:
        """(T,) size of the slope of the plane through the vertices of each triangle."""
        w = d[self.dofs[:, : 3 * VERTEX_DOFS : VERTEX_DOFS]]
        rise = np.stack([w[:, 1] - w[:, 0], w[:, 2] - w[:, 0]], axis=1)
        slope = (rise[:, None] @ self.triangles.inverse)[:, 0]
        return np.hypot(slope[:, 0], slope[:, 1])

    def forces(self, x: Floats) -> Floats:
        """(unknown,) K x of unknowns (unknown,)."""
        if self._product is not None:
            return np.asarray(self._product(x), dtype=np.float64)
        stress = (self._weighted @ self.curvature(self.reduction @ x, self._points)[..., None])[..., 0]
        force = np.asarray(self.reduction.T @ self.functional(stress, self._points))
        return force if self._springs is None else force + self._springs @ x

    def solve(self, right: Floats) -> Floats:
        """Unknowns under a load on the unknowns, refined with residuals from strains."""
        return np.asarray(self._refined(right).x, dtype=np.float64)

    def _refined(self, right: Floats) -> Solution:
        x, residual = np.zeros_like(right), right
        sizes: list[float] = []
        for _ in range(STEPS):
            step = self._solve(residual)
            sizes.append(float(np.sqrt(abs(step @ residual))))
            x = x + step
            if sizes[0] == 0.0 or (len(sizes) > 1 and self._finished(sizes)):
                break
            residual = right - self.forces(x)
        history = tuple(size / max(sizes[0], 1e-300) for size in sizes)
        left = float(np.linalg.norm(residual) / max(float(np.linalg.norm(right)), 1e-300))
        return Solution(x, self._name, self._why, len(sizes) - 1, history, history[-1], left)

    @staticmethod
    def _finished(sizes: list[float]) -> bool:
        rate = sizes[-1] / max(sizes[-2], 1e-300)
        return rate > 0.3 or sizes[-1] * rate < ROUNDING * sizes[0]

    @property
    def unknowns(self) -> Floats:
        """The solution of the problem itself."""
        return np.asarray(self.solution.x, dtype=np.float64)

    @cached_property
    def solution(self) -> Solution:
        """The same with how it was found; its errors are those before the last step."""
        a = self.problem.system
        return self._refined(np.asarray(a.load + a.fixed_load))
