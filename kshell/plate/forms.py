"""The energy of a plate as a sum of forms, each giving element matrices in batches.

Every form is an integral of rows^T C rows, where rows are derivatives of w at quadrature points. In straight
triangles with constant stiffness the bending form has a closed expression and is used where it applies.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from kshell.elements import AffineTriangles, PlateElement, matrices
from kshell.material.section import Section
from kshell.plate.domain import Domain, EdgePatch

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Field = Callable[[Floats], Floats]  # values (...,) at points (..., 2)

VARIABLE_DEGREE = 9  # quadrature where the stiffness varies in a triangle: w'' w'' is of degree 6


class Form(Protocol):
    """A quadratic form given triangle by triangle; a triangle may occur more than once.

    Attributes
    ----------
    everywhere : bool
        Whether it covers the plate, in the blocks of its domain.
    """

    everywhere: bool

    def blocks(self) -> Iterator[tuple[Ints, Ints]]:
        """Batches: (positions in this form, triangle numbers)."""

    def matrices(self, positions: Ints, transform: Floats) -> Floats:
        """(n, local, local) matrices in the unknowns that ``transform`` leads to."""

    def products(self, positions: Ints, transform: Floats, motion: Floats) -> Floats:
        """(n, local) these matrices times a motion, given as (n, reference dof, 1) on the reference triangle."""
        return self.matrices(positions, np.concatenate([transform, motion], axis=2))[:, :-1, -1]


@dataclass(frozen=True)
class Weights:
    """The weight W of an `AreaForm` in some triangles, all of them straight or all of them curved.

    Attributes
    ----------
    order : int
        k, as of the form.
    weight : (n, r, r) or (n, point, r, r) array
        Constant in each triangle, or at points, with the areas that belong to them.
    xi : (point, 2) or (n, point, 2) array or None
        Reference coordinates of the points; None where it is constant in each triangle.
    """

    order: int
    weight: Floats
    xi: Floats | None = None

    def matrices(self, element: PlateElement, affine: AffineTriangles, transform: Floats) -> Floats:
        """(n, local, local) integrals of (D^k v)^T W D^k w."""
        if self.xi is None:
            return matrices.weighted(element, affine, self.order, self.weight, transform)
        rows = matrices.rows(element, affine, self.xi, self.order, transform)
        return matrices.integrate_products(rows, self.weight, rows)

    def some(self, which: Ints) -> Weights:
        """Those of some of the triangles."""
        own = self.xi is not None and self.xi.ndim == 3
        return replace(
            self, weight=self.weight[which], xi=self.xi[which] if own and self.xi is not None else self.xi
        )


class AreaForm(Form):
    """Integral of (D^k v)^T W D^k w over triangles: its batches are numbered as the triangles are.

    Attributes
    ----------
    domain : Domain
    element : PlateElement
    """

    domain: Domain
    element: PlateElement

    @abstractmethod
    def weights(self, triangles: Ints) -> Weights:
        """W in a batch of triangles, none longer than a block."""

    def blocks(self) -> Iterator[tuple[Ints, Ints]]:
        for block in self.domain.blocks():
            yield block, block

    def matrices(self, positions: Ints, transform: Floats) -> Floats:
        return self.weights(positions).matrices(self.element, self.domain.affine(positions), transform)

    def products(self, positions: Ints, transform: Floats, motion: Floats) -> Floats:
        found = self.weights(positions)
        if found.xi is not None:
            return super().products(positions, transform, motion)
        affine = self.domain.affine(positions)
        force = matrices.weighted_product(self.element, affine, found.order, found.weight, motion[..., 0])
        return (force[:, None] @ transform)[:, 0]


@dataclass
class Bending(AreaForm):
    """Bending energy, integral of kappa^T D kappa."""

    everywhere = True

    domain: Domain
    element: PlateElement
    section: Section

    def __post_init__(self) -> None:
        constant = self.section.constant_per_triangle
        self.constant = self.section.bending_per_triangle() if constant else None

    def weights(self, triangles: Ints) -> Weights:
        if self.constant is not None and not self.domain.is_curved[triangles[0]]:
            return Weights(2, self.constant[triangles])
        patch = next(self.domain.patches(self._degree(), triangles))
        return Weights(2, self.stiffness(patch.triangles, patch.xy, patch.weights), patch.xi)

    def _degree(self) -> int:
        bending_degree = 2 * (self.element.maxdeg - 2)
        return bending_degree if self.constant is not None else bending_degree + VARIABLE_DEGREE - 6

    def stiffness(self, triangles: Ints, xy: Floats, weights: Floats) -> Floats:
        """D times the quadrature weights at points (n, point, 2): (n, point, 3, 3)."""
        return weights[..., None, None] * self.at(triangles, xy)

    def at(self, triangles: Ints, xy: Floats) -> Floats:
        """D at points (n, point, 2) of triangles (n,)."""
        if self.constant is not None:
            return np.broadcast_to(self.constant[triangles][:, None], (*xy.shape[:2], 3, 3))
        z = np.broadcast_to(self.domain.mesh.points[0, 2], (*xy.shape[:2], 1))
        return self.section.bending(triangles, np.concatenate([xy, z], axis=2))


@dataclass
class AreaSpring(AreaForm):
    """Winkler foundation: integral of k w^2 over some triangles; ``degree`` is that of k, None: no polynomial."""

    everywhere = False

    domain: Domain
    element: PlateElement
    triangles: Ints
    stiffness: Field
    degree: int | None = None

    def blocks(self) -> Iterator[tuple[Ints, Ints]]:
        for block in self.domain.blocks(self.triangles):
            yield block, block

    def weights(self, triangles: Ints) -> Weights:
        patch = next(self.domain.patches(2 * self.element.maxdeg, triangles))
        return Weights(0, (patch.weights * self.stiffness(patch.xy))[..., None, None], patch.xi)


@dataclass
class EdgeSpring(Form):
    """Elastic edge: integral of k w^2, or of k w_n^2 for a rotational spring; ``degree`` as in `AreaSpring`."""

    everywhere = False

    domain: Domain
    element: PlateElement
    edges: Ints
    stiffness: Field
    rotation: bool
    degree: int | None = None

    def __post_init__(self) -> None:
        self.patch = edge_patch_for(self.domain, self.element, self.edges)

    def blocks(self) -> Iterator[tuple[Ints, Ints]]:
        yield np.arange(len(self.patch.edges)), self.patch.triangles

    def rows(self, positions: Ints, transform: Floats) -> Floats:
        """w, or w_n, at the edge's points: (n, point, 1, local)."""
        affine = self.domain.affine(self.patch.triangles[positions])
        return edge_rows(self.element, affine, self.patch, positions, self.rotation, transform)

    def matrices(self, positions: Ints, transform: Floats) -> Floats:
        rows = self.rows(positions, transform)
        weight = self.patch.weights[positions] * self.stiffness(self.patch.xy[positions])
        return matrices.integrate_products(rows, weight[..., None, None], rows)


@dataclass
class PointSpring(Form):
    """Springs k (row . d)^2 at vertices, each with one row on the physical degrees of freedom of a triangle."""

    everywhere = False

    element: PlateElement
    domain: Domain
    triangles: Ints
    rows: Floats
    stiffness: Floats

    def blocks(self) -> Iterator[tuple[Ints, Ints]]:
        yield np.arange(len(self.triangles)), self.triangles

    def matrices(self, positions: Ints, transform: Floats) -> Floats:
        # transform = M L, with M from physical to reference and L from unknowns to physical
        m = self.element.transformation(self.domain.affine(self.triangles[positions]))
        rows = np.linalg.solve(np.swapaxes(m, 1, 2), self.rows[positions, :, None])
        reduced = np.swapaxes(rows, 1, 2) @ transform
        return self.stiffness[positions, None, None] * np.swapaxes(reduced, 1, 2) @ reduced


def edge_patch_for(domain: Domain, element: PlateElement, edges: Ints) -> EdgePatch:
    """Gauss points for products along edges; Morley functions jump across them, so that both sides count alike."""
    points = element.maxdeg + 2
    return domain.edge_patch(edges, points) if element.maxdeg > 2 else domain.shared_edge_patch(edges, points)


def edge_rows(
    element: PlateElement,
    affine: AffineTriangles,
    patch: EdgePatch,
    positions: Ints | slice,
    slope: bool,
    transform: Floats,
) -> Floats:
    """w, or its derivative along the outward normal, at points of edges: (n, point, 1, local)."""
    xi = patch.xi[positions]
    if not slope:
        return matrices.rows(element, affine, xi, 0, transform)
    gradient = matrices.rows(element, affine, xi, 1, transform)
    return patch.normal[positions][:, :, None, :] @ gradient
