"""Products with constant tables that turn fields at points into the strains of a triangle, and back.

The arrays of a block of triangles have the components of vectors in front, so that each function below is
one matrix product with thousands of rows. Symbols as in koiter/energy.py.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kshell.shell.kinematics import PAIRS
from kshell.shell.reference import TWICE, ReferenceTriangle, reference_triangle

Floats = NDArray[np.float64]


class StrainTables:
    """Tables of one order. Sizes: n nodes, q interior points, g edge points, k functions psi, r = 3 k."""

    def __init__(self, reference: ReferenceTriangle) -> None:
        ref = reference
        n, k = len(ref.nodes), ref.psi.shape[1]
        self._n, self._k = n, k
        self._membrane = ref.membrane.transpose(1, 0, 2).reshape(n, -1)  # (i, r j)
        self._membrane_pairs = ref.membrane.reshape(3 * k, -1)  # (r, i j)

        # l_r of b - B at the interior points and of the angle at the edge points; r = 3 k + v
        weighted = -ref.weights[:, None] * ref.psi  # (q, k)
        self._points = np.einsum("v,qk->vqk", TWICE, weighted)  # (v, q, k)
        on_edge = ref.edge_weights[:, None] * ref.edge_psi  # (g, k)
        self._edges = np.einsum("vg,gk->vgk", ref.edge_normal, on_edge) * np.array([1, 1, 1])[:, None, None]
        #: (r, g) l_r for a unit angle over |X'| at each edge point
        self.edges = self._edges.transpose(2, 0, 1).reshape(3 * k, -1)

        # columns: d b_v / d x,1, d b_v / d x,2, d b_v / d x,v at q; d theta / d x,1, d theta / d x,2 at g
        second = np.einsum("vqk,vqj->vqkj", self._points, ref.second)
        first = np.einsum("vqk,aqj->vaqkj", self._points, ref.first)
        edge = np.einsum("vgk,agj->vagkj", self._edges, ref.edge_first)
        self._bending = np.concatenate(
            [first[:, 0], first[:, 1], second, edge[:, 0], edge[:, 1]], axis=1
        ).reshape(3, -1, k * n)

        def pair(left: Floats, right: Floats) -> Floats:
            return np.einsum("qi,qj->qij", left, right).reshape(len(left), -1)

        # half of the symmetric second derivative: 11 and 22 count half, 12 once
        share = [1.0 if a != b else 0.5 for a, b in PAIRS]
        first_pairs = [s * pair(ref.first[a], ref.first[b]) for s, (a, b) in zip(share, PAIRS, strict=True)]
        mixed_pairs = [pair(second, first) for second in ref.second for first in ref.first]
        edge_pairs = [
            s * pair(ref.edge_first[a], ref.edge_first[b]) for s, (a, b) in zip(share, PAIRS, strict=True)
        ]
        self._pairs = np.concatenate([*first_pairs, *mixed_pairs, *edge_pairs])  # (q or g of each, n n)

    def membrane_gradient(self, position: Floats) -> Floats:
        """d c_r / d x_j for nodes x (3, triangle, n): sum_i membrane_rij x_i, (3, triangle, r, n)."""
        count = position.shape[1]
        return (position.reshape(-1, self._n) @ self._membrane).reshape(3, count, -1, self._n)

    def membrane_hessian(self, stress: Floats) -> Floats:
        """sum_r stress_r membrane_rij: (triangle, n n)."""
        return stress @ self._membrane_pairs

    def bending(self, curvature: Floats, angle: Floats) -> Floats:
        """l_r from (b - B) / J (3, triangle, q) and the angle over |X'| (triangle, g): (triangle, r)."""
        parts = [curvature[v] @ self._points[v] + angle @ self._edges[v] for v in range(3)]
        return np.stack(parts, axis=2).reshape(len(angle), -1)

    def bending_gradient(self, by_x: Floats, normal: Floats, by_edge: Floats) -> Floats:
        """d l_r / d x_j.

        Parameters
        ----------
        by_x : (v, a, 3, triangle, q) derivatives of b_v / J by x,a
        normal : (3, triangle, q) n / J
        by_edge : (a, 3, triangle, g) derivatives of theta / |X'| by x,a

        Returns
        -------
        (v, 3, triangle, k, n)
        """
        q, g = normal.shape[2], by_edge.shape[3]
        columns = np.empty((3, *normal.shape[:2], 3 * q + 2 * g))
        columns[..., :q], columns[..., q : 2 * q] = by_x[:, 0], by_x[:, 1]
        columns[..., 2 * q : 3 * q] = normal
        columns[..., 3 * q : 3 * q + g], columns[..., 3 * q + g :] = by_edge[0], by_edge[1]
        result = np.matmul(columns.reshape(3, -1, columns.shape[3]), self._bending)
        return result.reshape(3, 3, -1, self._k, self._n)

    def weights_of(self, moments: Floats) -> tuple[Floats, Floats]:
        """sum_r m_r l_r as weights: of (b - B)_v / J at q (v, triangle, q), of the angle / |X'| (triangle, g)."""
        m = moments.reshape(len(moments), self._k, 3)
        at_points = np.stack([m[:, :, v] @ self._points[v].T for v in range(3)])
        return at_points, moments @ self.edges

    def half_hessian(
        self, by_x: list[Floats], by_second: list[list[Floats]], by_edge: list[Floats]
    ) -> Floats:
        """H with H + H^T the second derivative by the nodes.

        Parameters
        ----------
        by_x : (3, 3, triangle, q) for each pair of derivatives x,a and x,b
        by_second : [v][a] (3, 3, triangle, q), by x,v and x,a
        by_edge : (3, 3, triangle, g) for each pair

        Returns
        -------
        (9 triangle, n n): rows are component of node i, component of node j, triangle.
        """
        # one product with all tables below each other: values side by side
        values = [*by_x, *(mine for of_second in by_second for mine in of_second), *by_edge]
        columns = np.empty((*values[0].shape[:3], len(self._pairs)))
        begin = 0
        for mine in values:
            columns[..., begin : begin + mine.shape[3]] = mine
            begin += mine.shape[3]
        return columns.reshape(-1, begin) @ self._pairs


@lru_cache(maxsize=4)
def strain_tables(order: int) -> StrainTables:
    """The tables of an order from 1 to 6."""
    return StrainTables(reference_triangle(order))
