"""What the plate elements share: a dual basis on the reference triangle and its transformation.

A function v on a triangle is known by its degrees of freedom d (values and derivatives in x, y at
vertices, normal derivatives at edge midpoints). Pulled back to the reference triangle, its reference
degrees of freedom are  M d  with a small matrix M per triangle (Kirby, arXiv:1706.09017; Dominguez &
Sayas, ACM TOMS 35, 2008), so that

    v(x(xi)) = sum_r phi_r(xi) (M d)_r

with phi_r the reference basis. Tables of phi_r are made once; only M depends on the triangle.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from kshell.elements.affine import AffineTriangles
from kshell.elements.reference import DualBasis

if TYPE_CHECKING:
    from skfem.element import DiscreteField

Floats = NDArray[np.float64]


class PlateElement(ABC):
    """A triangle for fourth-order problems, usable in any scikit-fem form. It keeps no state.

    It has what scikit-fem asks of an element, but is none of its classes: to load them takes as long as a small solve.

    Attributes
    ----------
    basis : DualBasis
        The reference basis.
    vertex_powers, edge_powers : tuple of int
        Order of derivative of each degree of freedom at a vertex and at an edge: dividing by
        h^power makes the degrees of freedom of one size.
    """

    basis: DualBasis
    vertex_powers: tuple[int, ...]
    edge_powers: tuple[int, ...]
    nodal_dofs: int
    facet_dofs: int
    maxdeg: int
    dofnames: tuple[str, ...]
    doflocs: Floats
    interior_dofs = 0
    edge_dofs = 0
    dim = 2

    @property
    def name(self) -> str:
        """The name used in scene files."""
        return type(self).__name__.removeprefix("Element").lower()

    @property
    def count(self) -> int:
        """Degrees of freedom of a triangle."""
        return 3 * len(self.vertex_powers) + 3 * len(self.edge_powers)

    def transformation(self, triangles: AffineTriangles) -> Floats:
        """(triangle, reference dof, dof) M: reference degrees of freedom from physical ones.

        Kept with the triangles, so not to be written to.
        """
        known = triangles.transformations
        if type(self) not in known:
            known[type(self)] = self._transformation(triangles)
        return known[type(self)]

    @abstractmethod
    def _transformation(self, triangles: AffineTriangles) -> Floats:
        """M of the element."""

    @property
    def refdom(self) -> Any:
        """The reference triangle of scikit-fem."""
        from skfem.refdom import RefTri

        return RefTri

    def orient(self, mapping: Any, i: int, tind: NDArray[np.integer] | None = None) -> NDArray[np.integer]:
        """Signs of a basis function on elements: all the same (scikit-fem's interface)."""
        return np.ones(len(mapping.mesh.t[0] if tind is None else tind), dtype=np.int64)

    def _bfun_counts(self) -> NDArray[np.integer]:
        """Basis functions of vertices, edges in space, facets and interior (scikit-fem's interface)."""
        return np.array([3 * self.nodal_dofs, 0, 3 * self.facet_dofs, 0])

    def __mul__(self, other: Any) -> Any:
        """Both as one element (scikit-fem's interface)."""
        from skfem.element import ElementComposite

        return ElementComposite(self, *(other.elems if isinstance(other, ElementComposite) else [other]))

    def gbasis(
        self, mapping: Any, X: Floats, i: int, tind: NDArray[np.integer] | None = None
    ) -> tuple[DiscreteField]:
        """Value, gradient and Hessian of basis function ``i`` (scikit-fem's interface).

        ``X`` is (2, point), or (2, element, point) where every element has its own points.
        """
        from skfem.element import DiscreteField

        mesh = mapping.mesh
        t = mesh.t.T if tind is None else mesh.t[:, tind].T
        triangles = AffineTriangles.of_arrays(mesh.p.T, t)
        column = self.transformation(triangles)[:, :, i]  # (element, reference dof)
        points = np.moveaxis(X, 0, -1)  # (..., point, 2)

        def derivative(order: int, to_xy: Floats) -> Floats:
            table = self.basis.tabulate(points, order)  # (..., point, partial, reference dof)
            reference = np.einsum("...pdr,er->edp" if X.ndim == 2 else "epdr,er->edp", table, column)
            return np.einsum("exd,edp->xep", to_xy, reference)

        value = derivative(0, np.ones((len(triangles), 1, 1)))[0]
        grad = derivative(1, np.swapaxes(triangles.inverse, 1, 2))
        xx, yy, two_xy = derivative(2, triangles.curvature_map)
        hess = np.array([[xx, two_xy / 2], [two_xy / 2, yy]])
        return (DiscreteField(value, grad, hess=hess),)
