"""Constant tables of the Koiter triangle of order p: everything that does not depend on the mesh.

One object per order, made once. All strain measures of the element are polynomials on the reference
triangle, so most of the work of an energy evaluation is a product with one of these tables.

Symbols
-------
N_j        Lagrange polynomial of degree p at node j (displacement, geometry)
N_j,a      its derivative along the reference coordinate a = 1, 2; second derivatives are listed 11, 22, 12
psi_k      Lagrange polynomial of degree p - 1
Phi_r      basis of symmetric tensors, r = 3 k + v: psi_k in the component v of 11, 22, 12
w_q, w_g   weights of the interior points and of the Gauss points of the edges (an edge has length 1)
T, nu      tangent of an edge of the reference triangle and its outward normal, both of the length of the edge
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial.legendre import Legendre
from numpy.typing import NDArray

from kshell.elements.quadrature import interval_rule, triangle_rule
from kshell.elements.reference import VERTICES, DualBasis, monomials

Floats = NDArray[np.float64]

LARGEST_ORDER = 6  # of Koiter elements: tables of monomials are good to 1e-12 there
# walked counterclockwise; numbered as the edges of kshell.mesh.Mesh
EDGES = ((0, 1), (1, 2), (2, 0))
# a symmetric tensor is the list of its components 11, 22, 12; contractions count the last one twice
TWICE = np.array([1.0, 1.0, 2.0])


def lattice(degree: int) -> Floats:
    """Lagrange nodes: vertices, then edge by edge (walked counterclockwise), then the interior. (node, 2)."""
    if degree == 0:
        return np.array([[1 / 3, 1 / 3]])
    nodes = [*VERTICES]
    for a, b in EDGES:
        nodes += [VERTICES[a] + (VERTICES[b] - VERTICES[a]) * k / degree for k in range(1, degree)]
    nodes += [np.array([i / degree, j / degree]) for i in range(1, degree) for j in range(1, degree - i)]
    return np.array(nodes)


def subdivision(degree: int) -> NDArray[np.int64]:
    """(degree^2, 3) triangles between neighbouring nodes of the lattice."""
    number = {(round(x * degree), round(y * degree)): k for k, (x, y) in enumerate(lattice(degree).tolist())}
    out = []
    for i, j in number:
        if i + j < degree:
            out.append((number[i, j], number[i + 1, j], number[i, j + 1]))
        if i + j < degree - 1:
            out.append((number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]))
    return np.array(out)


@lru_cache(maxsize=8)
def _lagrange(degree: int) -> DualBasis:
    return DualBasis(degree, monomials(degree, lattice(degree)))


def lagrange(degree: int, points: Floats) -> Floats:
    """Lagrange polynomials on the lattice: (point, node)."""
    return _lagrange(degree).tabulate(points)[..., 0, :]


def first_derivatives(degree: int, points: Floats) -> Floats:
    """(2, point, node): along the two reference coordinates."""
    return np.ascontiguousarray(np.moveaxis(_lagrange(degree).tabulate(points, 1), -2, 0))


def second_derivatives(degree: int, points: Floats) -> Floats:
    """(3, point, node): 11, 22, 12."""
    table = _lagrange(degree).tabulate(points, 2)
    return np.ascontiguousarray(np.moveaxis(table, -2, 0)[[0, 2, 1]])


def edge_quadrature(count: int) -> tuple[Floats, Floats, Floats]:
    """Gauss points of the three edges, each walked counterclockwise.

    Returns points (3 count, 2), weights (3 count,) that add up to 1 on each edge, and tangents (3 count, 2).
    """
    x, w = interval_rule(count)
    tangents = np.array([VERTICES[b] - VERTICES[a] for a, b in EDGES])
    starts = np.array([VERTICES[a] for a, _ in EDGES])
    points = starts[:, None] + x[None, :, None] * tangents[:, None]
    return points.reshape(-1, 2), np.tile(w, 3), np.repeat(tangents, count, axis=0)


@dataclass(frozen=True)
class ReferenceTriangle:
    """Tables of one order p. Sizes: n nodes, q interior points, g = 3 p edge points, r strain functions.

    Attributes
    ----------
    order : int
    nodes : (n, 2) Lagrange nodes
    points, weights : (q, 2), (q,) interior quadrature
    values, first, second : (q, n), (2, q, n), (3, q, n) of N at the interior points
    edge_points, edge_weights, edge_tangents : (g, 2), (g,), (g, 2)
    edge_values, edge_first : (g, n), (2, g, n) of N at the edge points
    psi : (q, k) of psi at the interior points
    edge_psi : (g, k)
    edge_normal : (3, g) components of nu (x) nu, for the contraction with a symmetric tensor: 11, 22, twice 12
    regge_points, regge_weights : (s, 2), (r, s, 3)
        The Regge interpolant of a strain field E is sum_r c_r Phi_r, c_r = sum_sv regge_weights_rsv E_v(s).
    membrane : (r, n, n)
        c_r = 1/2 sum_ij membrane_rij x_i . x_j, for the first fundamental form of the surface with nodes x_i.
    """

    order: int
    nodes: Floats
    points: Floats
    weights: Floats
    values: Floats
    first: Floats
    second: Floats
    edge_points: Floats
    edge_weights: Floats
    edge_tangents: Floats
    edge_values: Floats
    edge_first: Floats
    psi: Floats
    edge_psi: Floats
    edge_normal: Floats
    regge_points: Floats
    regge_weights: Floats
    membrane: Floats

    @property
    def strains(self) -> int:
        """Number r of membrane strain functions; there are as many moment functions."""
        return 3 * self.psi.shape[1]


def regge_interpolation(degree: int) -> tuple[Floats, Floats]:
    """Points and weights that interpolate a strain field into the Regge space of a degree.

    The degrees of freedom are the moments of the tangential component E_tt on each edge against
    polynomials of the degree, and the moments of E inside against polynomials of one degree less
    (Li, Regge finite elements, 2018; Neunteufel and Schoeberl, arXiv:1907.06232). For the strain of a
    displacement of order p = degree + 1 the quadrature below is exact.

    Returns
    -------
    (s, 2) points and (r, s, 3) weights to the coefficients of Phi_r.
    """
    on_edge = max(1, (3 * degree + 2) // 2)
    edge_points, weights, tangents = edge_quadrature(on_edge)
    points = edge_points
    if degree > 0:
        inner, inner_weights = triangle_rule(3 * degree - 1)
        points = np.concatenate([edge_points, inner])

    functionals = []
    along = 2 * interval_rule(on_edge)[0] - 1
    for edge in range(3):
        here = slice(edge * on_edge, (edge + 1) * on_edge)
        t = tangents[edge * on_edge]
        for j in range(degree + 1):
            row = np.zeros((len(points), 3))
            row[here] = (weights[here] * Legendre.basis(j)(along))[:, None] * (
                np.array([t[0] ** 2, t[1] ** 2, 2 * t[0] * t[1]])
            )
            functionals.append(row)
    if degree > 0:
        for moment in monomials(degree - 1, inner).T:
            for v in range(3):
                row = np.zeros((len(points), 3))
                row[len(edge_points) :, v] = inner_weights * moment
                functionals.append(row)
    rows = np.array(functionals)  # (functional, point, component)

    psi = lagrange(degree, points)
    basis = np.einsum("sk,vw->kvsw", psi, np.eye(3)).reshape(len(rows), -1)  # Phi_r at the points
    square = rows.reshape(len(rows), -1) @ basis.T
    return points, np.linalg.solve(square, rows.reshape(len(rows), -1)).reshape(rows.shape)


@lru_cache(maxsize=LARGEST_ORDER)
def reference_triangle(order: int) -> ReferenceTriangle:
    """The tables of an order from 1 to `LARGEST_ORDER`."""
    points, weights = triangle_rule(2 * order)
    edge_points, edge_weights, tangents = edge_quadrature(order)
    normal = np.stack([tangents[:, 1], -tangents[:, 0]])
    regge_points, regge_weights = regge_interpolation(order - 1)

    d1, d2 = first_derivatives(order, regge_points)
    c11, c22, c12 = np.moveaxis(regge_weights, 2, 0)  # each (r, s)
    mixed = np.einsum("rs,si,sj->rij", c12, d1, d2)
    membrane = (
        np.einsum("rs,si,sj->rij", c11, d1, d1)
        + np.einsum("rs,si,sj->rij", c22, d2, d2)
        + 0.5 * (mixed + mixed.swapaxes(1, 2))
    )
    return ReferenceTriangle(
        order=order,
        nodes=lattice(order),
        points=points,
        weights=weights,
        values=lagrange(order, points),
        first=first_derivatives(order, points),
        second=second_derivatives(order, points),
        edge_points=edge_points,
        edge_weights=edge_weights,
        edge_tangents=tangents,
        edge_values=lagrange(order, edge_points),
        edge_first=first_derivatives(order, edge_points),
        psi=lagrange(order - 1, points),
        edge_psi=lagrange(order - 1, edge_points),
        edge_normal=np.stack([normal[0] ** 2, normal[1] ** 2, 2 * normal[0] * normal[1]]),
        regge_points=regge_points,
        regge_weights=regge_weights,
        membrane=membrane,
    )


def weighted_products(values: Floats, weight: Floats) -> Floats:
    """sum_q weight_q N_i N_j: values (q, n) or (element, q, n), weight (element, q); (element, n, n)."""
    if values.ndim == 2:
        pairs = np.einsum("qi,qj->qij", values, values).reshape(len(values), -1)
        return (weight @ pairs).reshape(-1, values.shape[1], values.shape[1])
    return np.matmul(values.swapaxes(1, 2) * weight[:, None, :], values)
