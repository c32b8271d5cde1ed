"""The midsurface of order p: the places of the nodes and the rest geometry on a mesh of triangles in space."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.elements.reference import VERTICES
from kshell.errors import InputError
from kshell.mesh.higher import higher_nodes, order_of
from kshell.mesh.mesh import Mesh
from kshell.scene.on_chart import ChartLift
from kshell.shell.koiter.numbering import NumberedMesh
from kshell.shell.reference import (
    LARGEST_ORDER,
    ReferenceTriangle,
    first_derivatives,
    lagrange,
    lattice,
    reference_triangle,
)
from kshell.shell.vectors import cross, dot, norm

Floats = NDArray[np.float64]


class Surface(NumberedMesh):
    """Nodes of order p in space, with the numbers of `NumberedMesh`.

    Parameters
    ----------
    mesh : Mesh
        Its nodes give the curved geometry: vertices, mid-edge nodes, and those of order 3 and 4.
    order : int
        From 1 to `LARGEST_ORDER`.
    lift : callable, optional
        Takes points (n, 3) of the mesh to the surface (n, 3): a chart of a mesh that lies in its
        parameter plane, or a projection onto the exact surface.
    hinges : (n,) int array, optional
        Edges across which the sheets may turn freely.
    offsets : (node, 3), optional
        By which the nodes are moved in the end.

    Attributes
    ----------
    flat_nodes, nodes : (node, 3)
        Nodes before and after `lift`.
    reference : ReferenceTriangle

    Raises
    ------
    InputError
        If there is no such order, or a triangle is degenerate or folds onto itself.
    """

    def __init__(
        self,
        mesh: Mesh,
        order: int,
        lift: Callable[[Floats], Floats] | None = None,
        hinges: ArrayLike = (),
        offsets: Floats | None = None,
    ) -> None:
        if not 1 <= order <= LARGEST_ORDER:
            raise InputError(f"shell elements have order 1 to {LARGEST_ORDER}, not {order}")
        super().__init__(mesh, order, hinges)
        self.reference: ReferenceTriangle = reference_triangle(order)
        self.flat_nodes = self._flat_nodes()
        # of a surface that is moved off its chart there is no formula
        self._chart = lift if isinstance(lift, ChartLift) and offsets is None else None
        self.nodes = self.flat_nodes if lift is None else np.asarray(lift(self.flat_nodes), dtype=float)
        if offsets is not None:
            self.nodes = self.nodes + offsets
        self._check()

    def _flat_nodes(self) -> Floats:
        mesh, p = self.mesh, self.order
        known = higher_nodes(mesh)  # (triangle, node of the mesh, 3)
        if known is None:
            known = mesh.points[mesh.triangles]
            if mesh.midpoints is not None:
                known = np.concatenate([known, mesh.midpoints[mesh.triangle_edges]], axis=1)
        shape = lagrange(order_of(mesh), lattice(p))
        nodes = np.empty((self.node_count, 3))
        nodes[self.triangle_nodes] = np.einsum("nk,tkx->tnx", shape, known)
        nodes[: len(mesh.points)] = mesh.points
        return nodes

    def _check(self) -> None:
        if self.nodes.shape != (self.node_count, 3) or not np.all(np.isfinite(self.nodes)):
            raise InputError(
                f"{self.mesh.source}: the chart does not give a finite point for every node of the mesh"
            )
        x1, x2 = self.tangents(self.reference.first)
        normal = cross(x1, x2)
        middle = normal.mean(axis=2, keepdims=True)
        least = np.min(dot(normal, middle), axis=1)
        side = (
            self.mesh.size
            if self.nodes is self.flat_nodes
            else float(np.linalg.norm(np.ptp(self.nodes, axis=0)))
        )
        longest = np.max(np.maximum(norm(x1), norm(x2)), axis=1)
        bad = np.flatnonzero(
            (least <= 0) | (norm(middle)[:, 0] <= 1e-12 * longest * max(longest.max(), 1e-6 * side))
        )
        if len(bad):
            x, y, z = self.nodes[self.triangle_nodes[bad[0], :3]].mean(axis=0)
            raise InputError(
                f"{self.mesh.source}: {len(bad)} triangle(s) are degenerate or turned inside out, the first near "
                f"({x:.6g}, {y:.6g}, {z:.6g}): straighten the mesh there or refine it"
            )

    def jets(self, field: Floats, tables: Floats, triangles: slice | NDArray = slice(None)) -> Floats:
        """Derivatives of a nodal field at reference points.

        Parameters
        ----------
        field : (node, 3)
        tables : (d, point, n) derivatives of the Lagrange polynomials

        Returns
        -------
        (d, 3, triangle, point). Differences within the triangle are taken first, so nothing is lost far
        from the origin.
        """
        local = field[self.triangle_nodes[triangles]]  # (triangle, node, 3)
        local = np.ascontiguousarray(np.moveaxis(local - local[:, :1], 2, 0))  # (3, triangle, node)
        result = np.matmul(local.reshape(-1, local.shape[2]), tables.swapaxes(1, 2))
        return result.reshape(len(tables), 3, -1, tables.shape[1])

    def tangents(self, first: Floats, triangles: slice | NDArray = slice(None)) -> Floats:
        """Tangent vectors X,1 and X,2 of the rest surface: (2, 3, triangle, point)."""
        return self.jets(self.nodes, first, triangles)

    def exact_normals(self, nodes: NDArray[np.integer]) -> Floats | None:
        """(n, 3) unit normals of the surface at nodes by the formulas of its chart; None where there are none."""
        return None if self._chart is None else self._chart.normals(self.flat_nodes[nodes])

    @cached_property
    def vertex_normals(self) -> Floats:
        """(vertex, 3) unit normals, averaged over the triangles at the vertex by their angle there.

        At folds and branches this is a mean that belongs to no sheet. It is zero where the mean vanishes.
        """
        x1, x2 = self.tangents(np.stack([self.corner_tables[0], self.corner_tables[1]]))
        normal = cross(x1, x2)
        normal /= norm(normal)
        total = np.zeros((len(self.mesh.points), 3))
        np.add.at(total, self.mesh.triangles, np.moveaxis(normal * self.corner_angles, 0, 2))
        length = np.linalg.norm(total, axis=1, keepdims=True)
        return np.divide(total, length, out=np.zeros_like(total), where=length > 1e-9)

    @cached_property
    def corner_tables(self) -> Floats:
        """(2, 3, n) derivatives of the Lagrange polynomials at the corners."""
        return first_derivatives(self.order, VERTICES)

    @cached_property
    def corner_angles(self) -> Floats:
        """(triangle, 3) angle of the triangle at each corner, between its straight edges."""
        x = np.moveaxis(self.nodes[self.mesh.triangles], 2, 0)
        a, b = x[:, :, [1, 2, 0]] - x, x[:, :, [2, 0, 1]] - x
        return np.arctan2(norm(cross(a, b)), dot(a, b))

    @cached_property
    def area_elements(self) -> Floats:
        """(triangle, q) area of the rest surface per area of the reference triangle at the interior points."""
        return norm(cross(*self.tangents(self.reference.first)))

    @cached_property
    def edge_stretch(self) -> Floats:
        """(triangle, 3 p) length of the rest edge per unit of its parameter, at its Gauss points."""
        return norm(self.edge_tangents)

    @cached_property
    def edge_tangents(self) -> Floats:
        """(3, triangle, 3 p) tangent of the edges as the triangle walks them, at the Gauss points."""
        x1, x2 = self.tangents(self.reference.edge_first)
        t = self.reference.edge_tangents
        return x1 * t[:, 0] + x2 * t[:, 1]
