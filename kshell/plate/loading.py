"""Loads as linear forms: pressures, forces and moments of edges and of points, initial curvatures.

Work of a load on a virtual deflection v: pressure q v, line force p v, edge moment -m v_n (m positive
puts the face z = +t/2 in tension), moment vector m_x v_y - m_y v_x, initial curvature kappa_0
kappa(v)^T D kappa_0 with kappa = (v_xx, v_yy, 2 v_xy).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kshell.elements import PlateElement, matrices
from kshell.plate.domain import Domain, Patch
from kshell.plate.forms import Bending, edge_patch_for, edge_rows
from kshell.plate.linear_form import Scaled, resultant_of

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Field = Callable[[Ints, Floats], Floats]  # values (n, point, ...) at points (n, point, 2) of triangles (n,)

LOAD_DEGREE = 6  # polynomial degree of a varying load that is integrated exactly


class Summed(NamedTuple):
    """Of a pressure: works (triangle, reference dof) where kept, force and moments about a centre, gross force."""

    reference: Floats | None
    centre: Floats
    total: Floats
    gross: float


@dataclass
class AreaLoad(Scaled):
    """Pressure on some triangles: a number, or values at points, without the factor.

    ``degree`` is that of the pressure as a polynomial; None where it is none, or not known to be one. ``order`` is that
    of the functions it works on: the resultant is integrated as its work is, so that both are of the same load where it
    jumps inside triangles.
    """

    domain: Domain
    element: PlateElement
    triangles: Ints | None
    given: float | Field
    degree: int | None = None
    order: int | None = None  # that of the element if absent

    def on_order(self, order: int, points: int) -> AreaLoad:
        """The same load on functions of another order; ``points`` are those of `EdgeLoad`."""
        return self if self.order == order else replace(self, order=order, kept={})

    @property
    def uniform(self) -> float | None:
        """The pressure with its factor; None where it is values at points."""
        return None if callable(self.given) else self.factor * self.given

    @property
    def everywhere(self) -> bool:
        return self.triangles is None

    def blocks(self) -> Iterator[tuple[Ints, Ints]]:
        for block in self.domain.blocks(self.triangles):
            yield block, block

    @property
    def rule(self) -> int:
        """The degree of polynomials for which it is integrated."""
        order = self.element.maxdeg if self.order is None else self.order
        return order + (LOAD_DEGREE if callable(self.given) else 0)

    def values(self, triangles: Ints, xy: Floats) -> Floats:
        """Pressure (n, point) at points (n, point, 2) of triangles (n,)."""
        return self.factor * self.values_given(triangles, xy)

    def values_on(self, patch: Patch) -> Floats:
        """The same (n, point) at the points of a patch."""
        return self.factor * self._given_on(patch)

    def values_given(self, triangles: Ints, xy: Floats) -> Floats:
        """Pressure (n, point) without the factor."""
        if callable(self.given):
            return self.given(triangles, xy)
        return np.full(xy.shape[:2], self.given)

    def _vectors(self, positions: Ints, transform: Floats) -> Floats:
        affine = self.domain.affine(positions)
        curved = self.domain.is_curved[positions[0]]
        if not callable(self.given) and not curved:
            pressure = np.full(len(positions), self.given)
            return matrices.load(self.element, affine, pressure, transform)
        works = self._summed(True).reference if callable(self.given) else None
        if works is not None:
            reference = works[positions]
        else:
            reference = self._on_reference(next(self.domain.patches(self.rule, positions)))[0]
        return (reference[:, None] @ transform)[:, 0]

    def _on_reference(self, patch: Patch) -> tuple[Floats, Floats]:
        """Work (n, dof) on the functions of the reference triangle, and the forces (n, point) it comes from."""
        force = patch.weights * self._given_on(patch)
        basis = self.element.basis.tabulate(patch.xi, 0)[..., 0, :]  # (..., point, reference dof)
        return (force @ basis if basis.ndim == 2 else (force[:, None] @ basis)[:, 0]), force

    def _given_on(self, patch: Patch) -> Floats:
        """The pressure (n, point) on a patch, without the factor; that of the last one is kept."""
        known: tuple[Patch, Floats] | None = self.kept.get("on patch")
        if known is None or known[0] is not patch:
            known = self.kept["on patch"] = patch, self.values_given(patch.triangles, patch.xy)
        return known[1]

    def _summed(self, works: bool = False) -> Summed:
        """All that is summed of values at points, at once, with works where these are asked for and kept."""
        works = works and self.domain.few and callable(self.given)
        known: Summed | None = self.kept.get("summed")
        if known is None or (works and known.reference is None):
            known = self.kept["summed"] = self._sum(works)
        return known

    def _sum(self, works: bool) -> Summed:
        domain, varies = self.domain, callable(self.given)
        reference = np.zeros((len(domain.mesh.triangles), self.element.count)) if works else None
        centre, total, gross = domain.points.mean(axis=0), np.zeros(3), 0.0
        # a constant pressure has moments of degree 1
        for patch in domain.patches(self.rule if varies else 1, self.triangles):
            if reference is not None:
                reference[patch.triangles], force = self._on_reference(patch)
            else:
                force = patch.weights * self._given_on(patch)
            total += resultant_of(force, patch.xy, centre)
            gross += float(np.abs(force).sum())
        return Summed(reference, centre, total, gross)

    def _resultant(self, origin: Floats) -> Floats:
        if self.triangles is None and not callable(self.given):
            area, x, y = self.domain.moments_of_area
            return self.given * np.array([area, y - origin[1] * area, origin[0] * area - x])
        found = self._summed()
        return found.total + resultant_of(found.total[0], found.centre, origin) * np.array([0.0, 1.0, 1.0])

    def _gross(self, size: float) -> float:
        if self.triangles is None and not callable(self.given):
            return float(abs(self.given) * self.domain.moments_of_area[0])
        return self._summed().gross


@dataclass
class EdgeLoad(Scaled):
    """Force per length along z on edges, or a bending moment per length; ``given`` and ``degree`` as in `AreaLoad`.

    ``points`` are those of the rule on each edge; as the element asks for if absent.
    """

    domain: Domain
    element: PlateElement
    edges: Ints
    given: Callable[[Floats], Floats]  # (n, point) at points (n, point, 2)
    moment: bool
    degree: int | None = None
    points: int | None = None

    def on_order(self, order: int, points: int) -> EdgeLoad:
        """The same load by another rule on each edge."""
        return self if self.points == points else replace(self, points=points, kept={})

    @property
    def everywhere(self) -> bool:
        return False

    def __post_init__(self) -> None:
        if self.points is None:
            self.patch = edge_patch_for(self.domain, self.element, self.edges)
        else:
            self.patch = self.domain.edge_patch(self.edges, self.points)

    def value(self, xy: Floats) -> Floats:
        """(n, point) at points (n, point, 2)."""
        return self.factor * self.given(xy)

    def blocks(self) -> Iterator[tuple[Ints, Ints]]:
        yield np.arange(len(self.patch.edges)), self.patch.triangles

    def _vectors(self, positions: Ints, transform: Floats) -> Floats:
        affine = self.domain.affine(self.patch.triangles[positions])
        rows = edge_rows(self.element, affine, self.patch, positions, self.moment, transform)
        value = self.given(self.patch.xy[positions])
        weight = self.patch.weights[positions] * (-value if self.moment else value)
        return (weight[:, None] @ rows[:, :, 0])[:, 0]

    def _resultant(self, origin: Floats) -> Floats:
        value = self.given(self.patch.xy) * self.patch.weights
        if not self.moment:
            return resultant_of(value, self.patch.xy, origin)
        # turning about x by 1 is v = y with v_n = n_y, about y it is v = -x with v_n = -n_x
        normal = self.patch.normal
        return np.array([0.0, -(value * normal[..., 1]).sum(), (value * normal[..., 0]).sum()])

    def _gross(self, size: float) -> float:
        total = np.abs(self.given(self.patch.xy) * self.patch.weights).sum()
        return float(total / size if self.moment else total)


@dataclass
class PointLoad(Scaled):
    """Rows on the physical degrees of freedom of triangles: forces and moments at vertices; without the factor."""

    domain: Domain
    element: PlateElement
    triangles: Ints
    rows: Floats  # (n, local)
    given: Floats  # (3,) force, moments about x and y through the vertex
    xy: Floats  # (2,) where

    @property
    def everywhere(self) -> bool:
        return False

    @property
    def total(self) -> Floats:
        """(3,) force, moments about x and y through the vertex."""
        return self.factor * self.given

    def blocks(self) -> Iterator[tuple[Ints, Ints]]:
        yield np.arange(len(self.triangles)), self.triangles

    def _vectors(self, positions: Ints, transform: Floats) -> Floats:
        m = self.element.transformation(self.domain.affine(self.triangles[positions]))
        rows = np.linalg.solve(np.swapaxes(m, 1, 2), self.rows[positions, :, None])
        return (np.swapaxes(rows, 1, 2) @ transform)[:, 0]

    def _resultant(self, origin: Floats) -> Floats:
        return np.array([0.0, *self.given[1:]]) + resultant_of(self.given[:1], self.xy[None], origin)

    def _gross(self, size: float) -> float:
        return float(np.abs(self.given / np.array([1.0, size, size])).max())


@dataclass
class CurvatureLoad(Scaled):
    """Initial curvature kappa_0 = (w_xx, w_yy, 2 w_xy) that the plate takes up without moments.

    ``given`` and ``degree`` as in `AreaLoad`; ``given_left`` (face, triangles, points) are stresses (n, point, 3) that
    layers keep all the same.
    """

    bending: Bending
    triangles: Ints | None
    given: Field  # (n, point, 3) at points (n, point, 2) of triangles (n,)
    degree: int | None = None
    given_left: Callable[[int, Ints, Floats], Floats] | None = None

    def curvature(self, triangles: Ints, xy: Floats) -> Floats:
        """(n, point, 3) at points (n, point, 2) of triangles (n,)."""
        return self.factor * self.given(triangles, xy)

    def left(self, face: int, triangles: Ints, xy: Floats) -> Floats:
        """(n, point, 3) stresses that layers keep."""
        if self.given_left is None:
            return np.zeros((*xy.shape[:2], 3))
        return self.factor * self.given_left(face, triangles, xy)

    @property
    def everywhere(self) -> bool:
        return self.triangles is None

    def blocks(self) -> Iterator[tuple[Ints, Ints]]:
        for block in self.bending.domain.blocks(self.triangles):
            yield block, block

    def _vectors(self, positions: Ints, transform: Floats) -> Floats:
        domain, element = self.bending.domain, self.bending.element
        patch = next(domain.patches(element.maxdeg - 2 + LOAD_DEGREE, positions))
        rows = matrices.rows(element, domain.affine(positions), patch.xi, 2, transform)
        weighted = self.bending.stiffness(patch.triangles, patch.xy, patch.weights)
        moment = (weighted @ self.given(patch.triangles, patch.xy)[..., None])[..., 0]  # (n, point, 3)
        return np.einsum("eqk,eqku->eu", moment, rows)

    def _resultant(self, origin: Floats) -> Floats:
        return np.zeros(3)  # self-equilibrated

    def _gross(self, size: float) -> float:
        """The largest moment per length that holding the curvature back would take: a force."""
        patches = self.bending.domain.patches(2, self.triangles)
        return float(
            max(
                np.abs(self.bending.at(p.triangles, p.xy) @ self.given(p.triangles, p.xy)[..., None]).max()
                for p in patches
            )
        )
