"""What two solutions of one plate differ by: d = C^-1 m + kappa_0 - kappa(w_h), and the same for springs.

m are equilibrated moments, w_h a conforming deflection, kappa_0 an initial curvature. All products are in energy; a
spring of stiffness k adds k (w' - w_h), w' being the deflection whose force k w' is part of the equilibrium of m.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kshell.elements.hierarchic import orthonormal
from kshell.elements.quadrature import interval_rule, triangle_rule
from kshell.error.conforming import Conforming
from kshell.error.equilibrated import Equilibrated
from kshell.plate.forms import AreaSpring, EdgeSpring, PointSpring
from kshell.plate.hhj.tables import edge_reference
from kshell.plate.hhj.translate import along, places

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

LARGEST_SPRING = (
    8  # degree of deflections whose squares are integrated exactly: that of the quintics, or the order
)


@dataclass(frozen=True)
class SpringPart:
    """One spring at points: k times weights, the difference of deflections (or slopes), and the conforming one."""

    triangles: Ints
    weights: Floats
    difference: Floats
    conforming: Floats


class Difference:
    """The difference of a conforming and an equilibrated solution.

    Parameters
    ----------
    conforming : Conforming
    d : (dof,) array
        The conforming deflection.
    equilibrated : Equilibrated
    degree : int
        Of polynomials that are integrated exactly: the same for all differences that meet in products.
    stress : (T, 3) array or None
        Moments of a functional int s : kappa, to be added to those of the element.
    initial : bool
        Whether the initial curvature of the problem is part of it; not so in duals.
    """

    def __init__(
        self,
        conforming: Conforming,
        d: Floats,
        equilibrated: Equilibrated,
        degree: int,
        stress: Floats | None = None,
        initial: bool = True,
    ) -> None:
        self.own, self.deflection = conforming, d
        problem, triangles = conforming.problem, conforming.triangles
        self.xi, weights = triangle_rule(degree)
        self.weights = weights * triangles.area[:, None]
        every = np.arange(len(triangles))
        xy = triangles.xy(self.xi)
        self.curvature = conforming.curvature(d, self.xi)
        psi = orthonormal(equilibrated.order - 1, self.xi)
        self.moments = psi @ equilibrated.moments
        if stress is not None:
            self.moments = self.moments + stress[:, None]
        if problem.section.constant_per_triangle:
            bending = problem.section.bending_per_triangle()
            flat = bending.strides[0] == 0
            stiffness = bending[0] if flat else bending
            compliance: Floats = np.linalg.inv(stiffness).astype(np.float64)
            self.stress = self.curvature @ stiffness  # C kappa(w_h); C is symmetric
            strain: Floats = self.moments @ compliance
        else:
            bending = problem.bending.at(every, xy)
            self.stress = (bending @ self.curvature[..., None])[..., 0]
            strain = np.linalg.solve(bending, self.moments[..., None])[..., 0].astype(np.float64)
        self.strain = strain - self.curvature
        self.force = self.moments - self.stress
        if initial and problem.loads.curvatures:
            kappa = problem.loads.initial_curvature(every, xy)
            bent = (problem.bending.at(every, xy) @ kappa[..., None])[..., 0]
            self.strain, self.force = self.strain + kappa, self.force + bent
        self.springs = _spring_parts(conforming, d, equilibrated)

    def per_triangle(self, other: Difference) -> Floats:
        """(T,) energy product with another difference, by triangle."""
        out = (self.weights * (self.force * other.strain).sum(axis=2)).sum(axis=1)
        for mine, its in zip(self.springs, other.springs, strict=True):
            np.add.at(out, mine.triangles, (mine.weights * mine.difference * its.difference).sum(axis=1))
        return np.asarray(out, dtype=np.float64)

    def with_deflection(self, other: Difference) -> float:
        """Energy product with the conforming deflection of another difference."""
        out = float((self.weights * (self.force * other.curvature).sum(axis=2)).sum())
        for mine, its in zip(self.springs, other.springs, strict=True):
            out += float((mine.weights * mine.difference * its.conforming).sum())
        return out

    def energy(self) -> float:
        """Half the energy product of the conforming deflection with itself."""
        out = float((self.weights * (self.stress * self.curvature).sum(axis=2)).sum())
        for part in self.springs:
            out += float((part.weights * part.conforming**2).sum())
        return 0.5 * out

    def bent(self) -> Floats:
        """(T,) energy product of the conforming deflection with itself, by triangle, springs apart."""
        return np.asarray((self.weights * (self.stress * self.curvature).sum(axis=2)).sum(axis=1))

    @property
    def cancelled(self) -> float:
        """Energy of the curvatures that rounding the slopes of w would make, times the curvatures, over eps."""
        triangles = self.own.triangles
        height = triangles.area / triangles.lengths.max(axis=1)
        size = (self.weights * np.abs(self.stress).sum(axis=2)).sum(axis=1)
        return float((size * self.own.slopes(self.deflection) / height).sum())

    def equilibrium(self) -> Floats:
        """(dof,) the functional that the equilibrated side exerts: moments times curvatures, and its springs."""
        own = self.own
        out = own.functional(self.moments * self.weights[..., None], self.xi)
        for part, rows in zip(self.springs, _spring_rows(own), strict=True):
            values = part.weights * (part.difference + part.conforming)
            local = (values[:, None] @ rows)[:, 0]
            np.add.at(out, own.dofs[part.triangles], local)
        return out


def _points_of_springs() -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
    degree = 2 * LARGEST_SPRING
    return triangle_rule(degree), interval_rule(degree // 2 + 1)


def _spring_rows(own: Conforming) -> list[Floats]:
    """(n, point, 21) per spring: the conforming deflection, or slope, at its points from physical unknowns."""
    out = []
    basis = own.element.basis
    (xi, _), (s, _) = _points_of_springs()
    for _, form in own.problem.supports.springs:
        if isinstance(form, AreaSpring):
            out.append(basis.tabulate(xi, 0)[:, 0] @ own.transform[form.triangles])
        elif isinstance(form, EdgeSpring):
            owner, place = places(own.triangles, form.edges)
            at = edge_reference(place, s)
            if not form.rotation:
                out.append(basis.tabulate(at, 0)[..., 0, :] @ own.transform[owner])
                continue
            gradient = np.swapaxes(own.triangles.inverse[owner], 1, 2)[:, None] @ basis.tabulate(at, 1)
            normal = own.triangles.normals[owner, place]
            out.append((normal[:, None, None] @ gradient)[:, :, 0] @ own.transform[owner])
        elif isinstance(form, PointSpring):
            vertex = form.domain.mesh.triangles[form.triangles, np.abs(form.rows).argmax(axis=1) // 6]
            place = (own.triangles.corners[form.triangles] == vertex[:, None]).argmax(axis=1)
            rows = np.zeros((len(vertex), 1, own.element.count))
            rows[np.arange(len(vertex)), 0, 6 * place] = 1.0
            out.append(rows)
    return out


def _spring_parts(own: Conforming, d: Floats, equilibrated: Equilibrated) -> list[SpringPart]:
    system, local = equilibrated.system, equilibrated.solution.local
    tables, triangles = system.tables, own.triangles
    (xi, w), (s, ws) = _points_of_springs()
    out = []
    rows_of = _spring_rows(own)
    for (_, form), rows in zip(own.problem.supports.springs, rows_of, strict=True):
        if isinstance(form, AreaSpring):
            chosen = form.triangles
            weights = form.stiffness(triangles.xy(xi, chosen)) * w * triangles.area[chosen, None]
            other = local[chosen] @ tables.inside(xi).T
        elif isinstance(form, EdgeSpring):
            chosen, place = places(triangles, form.edges)
            size = triangles.lengths[chosen, place][:, None]
            weights = form.stiffness(along(triangles, form.edges, s)) * ws * size
            maker = tables.slopes_on_edge if form.rotation else tables.on_edge
            values = np.stack([maker(edge, s) for edge in range(3)])[place]
            other = (values @ local[chosen][..., None])[..., 0] / (size if form.rotation else 1.0)
        else:
            assert isinstance(form, PointSpring)
            chosen = form.triangles
            weights = form.stiffness[:, None]
            other = (rows[:, :, ::6][:, :, :3] @ local[chosen][:, :3, None])[..., 0]
        mine = (rows @ d[own.dofs[chosen]][..., None])[..., 0]
        out.append(SpringPart(chosen, weights, other - mine, mine))
    return out
