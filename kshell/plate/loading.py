"""Loads as linear forms: element vectors in batches, and resultants for the check of equilibrium.

Work of a load on a virtual deflection v: pressure q v, line force p v, edge moment -m v_n (m positive
puts the face z = +t/2 in tension), moment vector m_x v_y - m_y v_x, initial curvature kappa_0
kappa(v)^T D kappa_0 with kappa = (v_xx, v_yy, 2 v_xy).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from kshell.elements import PlateElement, matrices
from kshell.plate.domain import Domain, Patch
from kshell.plate.forms import Bending, edge_patch_for, edge_rows

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Field = Callable[[Ints, Floats], Floats]  # values (n, point, ...) at points (n, point, 2) of triangles (n,)

LOAD_DEGREE = 6  # polynomial degree of a varying load that is integrated exactly


class LinearForm(Protocol):
    """A load, triangle by triangle; a triangle may occur more than once."""

    @property
    def everywhere(self) -> bool:
        """Whether it covers the plate, in the blocks of its domain."""

    def blocks(self) -> Iterator[tuple[Ints, Ints]]:
        """Batches: (positions in this load, triangle numbers)."""

    def vectors(self, positions: Ints, transform: Floats) -> Floats:
        """(n, local) element vectors in the unknowns that ``transform`` leads to."""

    def resultant(self, origin: Floats) -> Floats:
        """(3,) force along z, moments about x and y through ``origin``, straight from the data."""

    def gross(self, size: float) -> float:
        """Sum of absolute forces, moments divided by a size: the scale for errors of equilibrium."""

    def times(self, factor: float) -> LinearForm:
        """The same load times a factor."""


def resultant_of(force: Floats, xy: Floats, origin: Floats) -> Floats:
    """Force and moments of forces (...,) along z at points (..., 2)."""
    arm = xy - origin
    return np.array([force.sum(), (force * arm[..., 1]).sum(), -(force * arm[..., 0]).sum()])


@dataclass
class AreaLoad:
    """Pressure on some triangles: a number, or values at points.

    ``degree`` is that of the pressure as a polynomial; None where it is none, or not known to be one.
    """

    domain: Domain
    element: PlateElement
    triangles: Ints | None
    pressure: float | Field
    degree: int | None = None
    _latest: tuple[Floats, Floats] | None = field(default=None, init=False, repr=False, compare=False)

    @property
    def everywhere(self) -> bool:
        return self.triangles is None

    def blocks(self) -> Iterator[tuple[Ints, Ints]]:
        for block in self.domain.blocks(self.triangles):
            yield block, block

    def _degree(self) -> int:
        return self.element.maxdeg + (LOAD_DEGREE if callable(self.pressure) else 0)

    def values(self, triangles: Ints, xy: Floats) -> Floats:
        """Pressure (n, point) at points (n, point, 2) of triangles (n,)."""
        if not callable(self.pressure):
            return np.full(xy.shape[:2], self.pressure)
        if (
            self._latest is None or self._latest[0] is not xy
        ):  # patches at curved edges are kept, and asked for again
            self._latest = xy, self.pressure(triangles, xy)
        return self._latest[1]

    def vectors(self, positions: Ints, transform: Floats) -> Floats:
        affine = self.domain.affine(positions)
        curved = self.domain.is_curved[positions[0]]
        if not callable(self.pressure) and not curved:
            pressure = np.full(len(positions), self.pressure)
            return matrices.load(self.element, affine, pressure, transform)
        patch = next(self.domain.patches(self._degree(), positions))
        weight = patch.weights * self.values(patch.triangles, patch.xy)
        basis = self.element.basis.tabulate(patch.xi, 0)[..., 0, :]  # (..., point, reference dof)
        reference = weight @ basis if basis.ndim == 2 else (weight[:, None] @ basis)[:, 0]
        return (reference[:, None] @ transform)[:, 0]

    def times(self, factor: float) -> AreaLoad:
        pressure = self.pressure
        if not callable(pressure):
            return replace(self, pressure=factor * pressure)
        return replace(self, pressure=lambda triangles, xy: factor * pressure(triangles, xy))

    def _patches(self) -> Iterator[Patch]:
        """For resultants: a constant pressure has moments of degree 1."""
        return self.domain.patches(self._degree() if callable(self.pressure) else 1, self.triangles)

    def resultant(self, origin: Floats) -> Floats:
        if self.triangles is None and not callable(self.pressure):
            area, x, y = self.domain.moments_of_area
            return self.pressure * np.array([area, y - origin[1] * area, origin[0] * area - x])
        total = np.zeros(3)
        for patch in self._patches():
            force = patch.weights * self.values(patch.triangles, patch.xy)
            total += resultant_of(force, patch.xy, origin)
        return total

    def gross(self, size: float) -> float:
        if self.triangles is None and not callable(self.pressure):
            return float(abs(self.pressure) * self.domain.moments_of_area[0])
        return float(sum(np.abs(p.weights * self.values(p.triangles, p.xy)).sum() for p in self._patches()))


@dataclass
class EdgeLoad:
    """Force per length along z on edges, or a bending moment per length; ``degree`` as in `AreaLoad`."""

    domain: Domain
    element: PlateElement
    edges: Ints
    value: Callable[[Floats], Floats]  # (n, point) at points (n, point, 2)
    moment: bool
    degree: int | None = None

    everywhere = False

    def __post_init__(self) -> None:
        self.patch = edge_patch_for(self.domain, self.element, self.edges)

    def times(self, factor: float) -> EdgeLoad:
        return replace(self, value=lambda xy: factor * self.value(xy))

    def blocks(self) -> Iterator[tuple[Ints, Ints]]:
        yield np.arange(len(self.patch.edges)), self.patch.triangles

    def vectors(self, positions: Ints, transform: Floats) -> Floats:
        affine = self.domain.affine(self.patch.triangles[positions])
        rows = edge_rows(self.element, affine, self.patch, positions, self.moment, transform)
        value = self.value(self.patch.xy[positions])
        weight = self.patch.weights[positions] * (-value if self.moment else value)
        return (weight[:, None] @ rows[:, :, 0])[:, 0]

    def resultant(self, origin: Floats) -> Floats:
        value = self.value(self.patch.xy) * self.patch.weights
        if not self.moment:
            return resultant_of(value, self.patch.xy, origin)
        # turning about x by 1 is v = y with v_n = n_y, about y it is v = -x with v_n = -n_x
        normal = self.patch.normal
        return np.array([0.0, -(value * normal[..., 1]).sum(), (value * normal[..., 0]).sum()])

    def gross(self, size: float) -> float:
        total = np.abs(self.value(self.patch.xy) * self.patch.weights).sum()
        return float(total / size if self.moment else total)


@dataclass
class PointLoad:
    """Rows on the physical degrees of freedom of triangles: forces and moments at vertices."""

    domain: Domain
    element: PlateElement
    triangles: Ints
    rows: Floats  # (n, local)
    total: Floats  # (3,) force, moments about x and y through the vertex
    xy: Floats  # (2,) where

    everywhere = False

    def times(self, factor: float) -> PointLoad:
        return replace(self, rows=factor * self.rows, total=factor * self.total)

    def blocks(self) -> Iterator[tuple[Ints, Ints]]:
        yield np.arange(len(self.triangles)), self.triangles

    def vectors(self, positions: Ints, transform: Floats) -> Floats:
        m = self.element.transformation(self.domain.affine(self.triangles[positions]))
        rows = np.linalg.solve(np.swapaxes(m, 1, 2), self.rows[positions, :, None])
        return (np.swapaxes(rows, 1, 2) @ transform)[:, 0]

    def resultant(self, origin: Floats) -> Floats:
        return np.array([0.0, *self.total[1:]]) + resultant_of(self.total[:1], self.xy[None], origin)

    def gross(self, size: float) -> float:
        return float(np.abs(self.total / np.array([1.0, size, size])).max())


@dataclass
class CurvatureLoad:
    """Initial curvature kappa_0 = (w_xx, w_yy, 2 w_xy) that the plate takes up without moments.

    ``degree`` as in `AreaLoad`; ``left`` (face, triangles, points) are stresses (n, point, 3) that layers keep all the
    same.
    """

    bending: Bending
    triangles: Ints | None
    curvature: Field  # (n, point, 3) at points (n, point, 2) of triangles (n,)
    degree: int | None = None
    left: Callable[[int, Ints, Floats], Floats] | None = None

    @property
    def everywhere(self) -> bool:
        return self.triangles is None

    def blocks(self) -> Iterator[tuple[Ints, Ints]]:
        for block in self.bending.domain.blocks(self.triangles):
            yield block, block

    def vectors(self, positions: Ints, transform: Floats) -> Floats:
        domain, element = self.bending.domain, self.bending.element
        patch = next(domain.patches(element.maxdeg - 2 + LOAD_DEGREE, positions))
        rows = matrices.rows(element, domain.affine(positions), patch.xi, 2, transform)
        weighted = self.bending.stiffness(patch.triangles, patch.xy, patch.weights)
        moment = (weighted @ self.curvature(patch.triangles, patch.xy)[..., None])[..., 0]  # (n, point, 3)
        return np.einsum("eqk,eqku->eu", moment, rows)

    def times(self, factor: float) -> CurvatureLoad:
        left = self.left
        return replace(
            self,
            curvature=lambda triangles, xy: factor * self.curvature(triangles, xy),
            left=None if left is None else lambda face, triangles, xy: factor * left(face, triangles, xy),
        )

    def resultant(self, origin: Floats) -> Floats:
        return np.zeros(3)  # self-equilibrated

    def gross(self, size: float) -> float:
        """The largest moment per length that holding the curvature back would take: a force."""
        patches = self.bending.domain.patches(2, self.triangles)
        return float(
            max(
                np.abs(
                    self.bending.at(p.triangles, p.xy) @ self.curvature(p.triangles, p.xy)[..., None]
                ).max()
                for p in patches
            )
        )
