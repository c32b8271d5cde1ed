"""Element matrices in batches: stiffness, mass, geometric stiffness, loads, and rows of derivatives.

Every function takes ``transform``, the (triangle, reference dof, unknown) matrix that gives reference
degrees of freedom from the unknowns of the triangle. `PlateElement.transformation` gives it for the
physical degrees of freedom; multiplied by scalings or support conditions it gives matrices in the
reduced unknowns at the same cost.

Symbols
-------
R_ab     constant tables: integrals of products of the a-th and b-th reference derivatives
D        bending stiffness, moments M = -D (w_xx, w_yy, 2 w_xy)
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kshell.elements.affine import AffineTriangles
from kshell.elements.base import PlateElement
from kshell.elements.reference import DualBasis

Floats = NDArray[np.float64]

TOGETHER = 32_768  # entries of matrices made at a time: what lies between them stays in the cache


@lru_cache(maxsize=16)
def _tables(basis: DualBasis, order: int) -> Floats:
    """(partial * partial, basis * basis) integrals of products of derivatives, made once per basis."""
    table = basis.product_integrals(order)
    return table.reshape(table.shape[0] ** 2, -1)


def _constant_coefficient(element: PlateElement, order: int, weight: Floats, transform: Floats) -> Floats:
    """transform^T (sum_ab weight_ab R_ab) transform for weights (triangle, partial, partial)."""
    n, columns = element.count, transform.shape[2]
    flat, tables = weight.reshape(len(weight), -1), _tables(element.basis, order)
    out = np.empty((len(weight), columns, columns))
    step = max(1, TOGETHER // n**2)
    for begin in range(0, len(weight), step):
        some = slice(begin, begin + step)
        reference = (flat[some] @ tables).reshape(-1, n, n)
        np.matmul(np.swapaxes(transform[some], 1, 2), reference @ transform[some], out=out[some])
    return out


def weighted(
    element: PlateElement, triangles: AffineTriangles, order: int, weight: Floats, transform: Floats
) -> Floats:
    """Integral of (D^k v)^T W (D^k w) exactly, with the derivatives D^k of `rows` and W constant in each triangle.

    Parameters
    ----------
    order : int
        k, 0 to 2.
    weight : (triangle, partial, partial) array
        W.

    Returns
    -------
    (triangle, unknown, unknown) array.
    """
    return _constant_coefficient(element, order, _reference_weight(triangles, order, weight), transform)


def weighted_product(
    element: PlateElement, triangles: AffineTriangles, order: int, weight: Floats, vector: Floats
) -> Floats:
    """`weighted` times a function with reference degrees of freedom (triangle, reference dof).

    Returns
    -------
    (triangle, reference dof) array, without the matrices being formed.
    """
    reference = _reference_weight(triangles, order, weight).reshape(len(vector), 1, -1)
    n = element.count
    tables = _tables(element.basis, order).reshape(-1, n)  # R_ab is symmetric together with a and b
    return (reference @ (vector @ tables.T).reshape(len(vector), -1, n))[:, 0]


def _reference_weight(triangles: AffineTriangles, order: int, weight: Floats) -> Floats:
    """(triangle, partial, partial) W in reference derivatives, times the area."""
    area = np.abs(triangles.determinant)[:, None, None]
    to_xy = derivative_map(triangles, order)
    return weight * area if to_xy is None else np.swapaxes(to_xy, 1, 2) @ weight @ to_xy * area


def stiffness(
    element: PlateElement, triangles: AffineTriangles, bending: Floats, transform: Floats
) -> Floats:
    """Integral of kappa(v)^T D kappa(w), kappa = (w_xx, w_yy, 2 w_xy) and D (triangle, 3, 3) in force times length."""
    return weighted(element, triangles, 2, bending, transform)


def mass(element: PlateElement, triangles: AffineTriangles, density: Floats, transform: Floats) -> Floats:
    """Integral of density v w, density (triangle,) per unit area: mass, or a Winkler foundation."""
    return weighted(element, triangles, 0, density[:, None, None], transform)


def geometric_stiffness(
    element: PlateElement, triangles: AffineTriangles, membrane_force: Floats, transform: Floats
) -> Floats:
    """Integral of grad v . N grad w, N (triangle, 2, 2) force per length, constant in each triangle."""
    return weighted(element, triangles, 1, membrane_force, transform)


def load(element: PlateElement, triangles: AffineTriangles, pressure: Floats, transform: Floats) -> Floats:
    """Integral of q v for q (triangle,) constant in each triangle: a (triangle, unknown) array."""
    weight = np.abs(triangles.determinant) * pressure
    return weight[:, None] * np.einsum("r,eru->eu", element.basis.integrals, transform)


def rows(
    element: PlateElement, triangles: AffineTriangles, points: Floats, order: int, transform: Floats
) -> Floats:
    """Derivatives in x, y at reference points, as rows that act on the unknowns of each triangle.

    Parameters
    ----------
    points : (point, 2) or (triangle, point, 2) array
        Reference coordinates, the same for all triangles or each its own; outside is allowed.
    order : int
        0: w; 1: w_x, w_y; 2: w_xx, w_yy, 2 w_xy; 3: w_xxx, w_xxy, w_xyy, w_yyy.

    Returns
    -------
    (triangle, point, partial, unknown) array.
    """
    reference = element.basis.tabulate(points, order)  # (..., point, partial, basis)
    to_xy = derivative_map(triangles, order)
    if to_xy is not None:
        reference = to_xy[:, None] @ reference
    shape = (len(triangles), *reference.shape[-3:])
    flat = np.broadcast_to(reference, shape).reshape(len(triangles), -1, element.count)
    return (flat @ transform).reshape(*shape[:3], transform.shape[2])


def derivative_map(triangles: AffineTriangles, order: int) -> Floats | None:
    """(triangle, partial, partial) from derivatives in xi to those of `rows` in x, y; None for the identity."""
    if order == 0:
        return None
    if order == 1:
        return np.swapaxes(triangles.inverse, 1, 2)
    return triangles.curvature_map if order == 2 else triangles.third_map


def integrate_products(left: Floats, weight: Floats, right: Floats) -> Floats:
    """sum_q left_q^T weight_q right_q.

    Parameters
    ----------
    left, right : (triangle, point, partial, unknown) arrays
    weight : (triangle, point, partial, partial) array

    Returns
    -------
    (triangle, unknown, unknown) array.
    """
    n = left.shape[0]
    weighted = (weight @ right).reshape(n, -1, right.shape[-1])
    return np.swapaxes(left.reshape(n, -1, left.shape[-1]), 1, 2) @ weighted
