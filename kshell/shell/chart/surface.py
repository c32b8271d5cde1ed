"""The Argyris discretisation of a shell on a chart: three Cartesian components, exact geometry.

The mesh lies in the parameter plane (u, v) of a chart X(u, v). Each component of the displacement is an
Argyris function of (u, v), so the displaced surface has continuous tangent planes and curvature is a
plain second derivative. On each triangle everything is expressed in its reference coordinates, in which
the derivatives of the basis are constant tables, times the transformation M of the triangle.

Unknown 3 i + m is component m of the scalar degree of freedom i: value, d/du, d/dv, d2/du2, d2/dudv,
d2/dv2 at each vertex (i = 6 vertex + k), then the derivative along the edge normal at each edge midpoint. Behind them
come those of the further fans of vertices and of the second sides of edges beside lines inside, see `nodes.py`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.elements.affine import AffineTriangles
from kshell.elements.argyris import ElementArgyris
from kshell.elements.quadrature import triangle_rule
from kshell.elements.reference import VERTICES
from kshell.errors import InputError
from kshell.mesh.mesh import Mesh
from kshell.shell.chart.nodes import Flags, Nodes
from kshell.shell.vectors import cross, norm

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]
Chosen = slice | NDArray[Any]

# exact for products of second derivatives with a smooth surface; 16 points
QUADRATURE_DEGREE = 8


class ChartLike(Protocol):
    """What is needed of a chart (kshell.geometry.Chart has it)."""

    derivatives: Callable[..., tuple[Floats, ...]]


class ChartSurface:
    """Unknowns and geometry of a mesh in the parameter plane of a chart.

    Parameters
    ----------
    mesh : Mesh
        Its x and y are the parameters u and v; straight triangles.
    chart : Chart
    lines, held, hinged : (edge,) flags, optional
        Edges inside across which strains may jump, those that supports hold, and hinges.

    Attributes
    ----------
    nodes : Nodes
    unknowns : int
    scalar : (triangle, 21) int array of scalar degrees of freedom
    triangle_unknowns : (triangle, 63) int array, component by component
    points, weights : (q, 2), (q,) quadrature on the reference triangle

    Raises
    ------
    InputError
        If the chart is singular at a vertex or quadrature point.
    """

    def __init__(
        self,
        mesh: Mesh,
        chart: ChartLike,
        lines: Flags | None = None,
        held: Flags | None = None,
        hinged: Flags | None = None,
    ) -> None:
        self.mesh = mesh
        self.chart = chart
        self.affine = AffineTriangles.of_mesh(mesh)
        self.points, self.weights = triangle_rule(QUADRATURE_DEGREE)
        basis = ElementArgyris.basis
        self.tables = jets_of_basis(self.points)
        self.transformation = ElementArgyris().transformation(self.affine)  # (triangle, 21, 21) M
        self.nodes = Nodes(mesh, lines, held, hinged)
        self.scalar: Ints = self.nodes.triangle_scalars.astype(np.int32)
        self.scalars = self.nodes.scalars
        self.unknowns = 3 * self.scalars
        components = 3 * self.scalar[:, None, :] + np.arange(3)[:, None]
        self.triangle_unknowns: Ints = components.reshape(len(self.scalar), 3 * len(basis)).astype(np.int32)
        self.positions, self.first, self.second = self.geometry(self.points)
        self.area_elements = norm(cross(*self.first))
        self._require_tangents(self.points, self.first)
        self._require_tangents(VERTICES, self.geometry(VERTICES)[1])

    def _require_tangents(self, points: Floats, first: Floats) -> None:
        longest = np.maximum(norm(first[0]), norm(first[1])).max()
        bad = np.argwhere(~(norm(cross(*first)) > 1e-10 * longest**2))
        if len(bad):
            u, v = self.parameters(points[bad[0, 1]], bad[0, :1])[0, 0]
            raise InputError(
                f"the chart is singular at (u, v) = ({u:.6g}, {v:.6g}): its tangents are parallel or vanish there; "
                "leave such a point out of the mesh"
            )

    def parameters(self, points: ArrayLike, triangles: Chosen = slice(None)) -> Floats:
        """(triangle, point, 2) parameters u, v of reference points."""
        corners = self.affine.corners[triangles]
        points = np.asarray(points, dtype=float).reshape(-1, 2)
        return corners[:, :1] + points @ np.swapaxes(self.affine.jacobian[triangles], 1, 2)

    def geometry(self, points: Floats, triangles: Chosen = slice(None)) -> tuple[Floats, Floats, Floats]:
        """Position (3, triangle, point), first (2, 3, ...) and second (3, 3, ...) derivatives by reference coordinates.

        Second derivatives are listed 11, 22, 12.
        """
        uv = self.parameters(points, triangles)
        x, x_i, x_ij = self.chart.derivatives(uv[..., 0], uv[..., 1], order=2)
        j = self.affine.jacobian[triangles][:, None]  # (triangle, 1, parameter, reference)
        first = np.swapaxes(j, -1, -2) @ x_i  # (triangle, point, reference, 3)
        second = np.einsum("tpijx,tia,tjb->abxtp", x_ij, j[:, 0], j[:, 0])
        return (
            np.ascontiguousarray(np.moveaxis(x, 2, 0)),
            np.ascontiguousarray(np.moveaxis(first, (2, 3), (0, 1))),
            np.stack([second[0, 0], second[1, 1], second[0, 1]]),
        )

    def shape(self, tables: Floats, triangles: Chosen = slice(None)) -> Floats:
        """Tables (d, q, 21) of the reference basis in the unknowns of triangles: (d, triangle, q, 21)."""
        m = self.transformation[triangles]
        d, q, n = tables.shape
        result = np.matmul(tables.reshape(d * q, n), m)
        return np.ascontiguousarray(np.moveaxis(result.reshape(-1, d, q, n), 1, 0))

    def local(self, x: Floats, triangles: Chosen = slice(None)) -> Floats:
        """Degrees of freedom of triangles: (3, triangle, 21)."""
        return np.ascontiguousarray(np.moveaxis(x.reshape(-1, 3)[self.scalar[triangles]], 2, 0))


def jets_of_basis(points: Floats) -> Floats:
    """(6, q, 21) reference basis: value, d1, d2, d11, d22, d12."""
    basis = ElementArgyris.basis
    value, first, second = (np.moveaxis(basis.tabulate(points, order), -2, 0) for order in range(3))
    return np.ascontiguousarray(np.concatenate([value, first, second[[0, 2, 1]]]))
