"""Supports of the Argyris discretisation on a chart: conditions along straight edges of the parameter plane.

A condition f = 0 along an edge means f = 0 and its derivatives along the edge at the vertices, which for a
quintic along the edge is exact. `free_motions` says what is left free.

Symbols, besides those of `kshell.shell.chart.edges`
-------
c          fixed direction in space
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.equilibrium.reduction import Reduction
from kshell.errors import InputError
from kshell.shell.chart.edges import (
    across,
    along_edge,
    coefficients_across,
    coefficients_along,
    edge_ends,
    main_conormal,
    vertex_sizes,
)
from kshell.shell.chart.free_motions import Conditions, free_motions
from kshell.shell.chart.surface import ChartSurface
from kshell.shell.evaluate import OfPlace
from kshell.shell.limits import USE_KOITER
from kshell.shell.planes import plane_normal, require_plane, within
from kshell.shell.vectors import AXES

Floats = NDArray[np.float64]

# step of differences of prescribed values, in the edge length
STEP = 0.02


class ChartSupports:
    """Conditions on the motion of a chart surface; every method adds some."""

    def __init__(self, surface: ChartSurface) -> None:
        self.surface = surface
        self._conditions = Conditions()
        # (triangle, 3, 3) projectors onto the directions in which triangles are held as a whole, summed
        self._whole = np.zeros((len(surface.mesh.triangles), 3, 3))

    def along(self, edges: ArrayLike, direction: ArrayLike, value: float = 0.0) -> None:
        """Prescribe the translation of edges along a direction, constant along each edge."""
        c = np.asarray(direction, dtype=float) / np.linalg.norm(direction)
        for vertices, fans, t in edge_ends(self.surface, edges):
            for coefficients in coefficients_along(t):
                rows = np.einsum("nk,x->nkx", coefficients, c).reshape(len(vertices), 18)
                first = coefficients[0, 0] != 0.0  # the value itself; its derivatives along the edge vanish
                self._conditions.add(fans, rows, np.full(len(vertices), value if first else 0.0))

    def at_vertices(self, vertices: ArrayLike, direction: ArrayLike, value: OfPlace) -> None:
        """Prescribe the translation of vertices along a unit direction, `value` of their places (n, 3)."""
        vertices = np.atleast_1d(np.asarray(vertices, dtype=np.int64))
        rows = np.zeros((len(vertices), 18))
        rows[:, :3] = direction
        self._conditions.add(vertices, rows, value(self._places(vertices)))

    def along_edges(self, edges: ArrayLike, direction: ArrayLike, value: OfPlace) -> None:
        """Prescribe the translation of edges along a unit direction, `value` of the places (n, 3) along them.

        The quintic along an edge takes the value and its first two derivatives from its ends.
        """
        steps = STEP * vertex_sizes(self.surface.mesh)
        for vertices, fans, t in edge_ends(self.surface, edges):
            prescribed = along_edge(self.surface, vertices, t, steps[vertices], value)
            for coefficients, right in zip(coefficients_along(t), prescribed, strict=True):
                rows = np.einsum("nk,x->nkx", coefficients, np.asarray(direction)).reshape(len(vertices), 18)
                self._conditions.add(fans, rows, right)

    def over_triangles(self, triangles: NDArray, direction: ArrayLike, value: OfPlace) -> None:
        """Prescribe the translation of the whole shell along a unit direction, the same at all places.

        Raises
        ------
        InputError
            If the value varies, or if the triangles are a part of the shell whose border is no line of the surface:
            second derivatives are continuous there, so holding them on one side bends the other side wrongly.
        """
        mesh = self.surface.mesh
        inside = np.bincount(mesh.triangle_edges[triangles].ravel(), minlength=len(mesh.edges))
        border = np.flatnonzero((inside > 0) & (inside < mesh.edge_counts) & ~self.surface.nodes.lines)
        if len(border):
            at = mesh.points[mesh.edges[border[0]]].mean(axis=0)
            raise InputError(
                "Argyris functions on a chart have continuous curvature, which a part of the shell that is held would "
                f"impose on the rest across its border, e.g. at (u, v) = ({at[0]:.6g}, {at[1]:.6g}): hold the border "
                f"curve and leave that part out of the mesh, or {USE_KOITER}"
            )
        along = np.asarray(direction, dtype=float)
        self._whole[triangles] += np.outer(along, along)
        nodes = self.surface.nodes
        fans = np.unique(nodes.corner[triangles])
        vertices = nodes.vertex[fans]
        values = value(self._places(vertices))
        if np.ptp(values) > 1e-12 * np.abs(values).max():
            raise InputError(
                "a prescribed translation that varies over a surface is not possible with Argyris elements on a chart, "
                f"whose functions cannot follow it inside triangles: prescribe it on curves, or {USE_KOITER}"
            )
        for k in range(6):
            rows = np.zeros((len(vertices), 6, 3))
            rows[:, k] = direction
            self._conditions.add(fans, rows.reshape(-1, 18), values if k == 0 else np.zeros(len(vertices)))
        for edges, side in nodes.sides_in(triangles):
            self._conditions.slopes.append((edges, side, np.asarray(direction)[None]))

    def at_rest(self, triangles: NDArray) -> bool:
        """Whether triangles are held as a whole in all directions."""
        return bool(np.linalg.eigvalsh(self._whole[triangles])[:, 0].min() > 1e-6)

    def rotation(self, edges: ArrayLike, directions: ArrayLike | None = None) -> None:
        """No rotation about edges: n . u,m = 0, or c . u,m = 0 for every row c of `directions` (k, 3).

        On a clamped edge the first holds exactly at large deflections, too.
        """
        edges = np.atleast_1d(np.asarray(edges, dtype=np.int64))
        fixed = None if directions is None else np.asarray(directions, dtype=float)
        for vertices, fans, t in edge_ends(self.surface, edges):
            n, n_t, m, m_t, _ = across(self.surface.chart, self.surface.mesh.points[vertices, :2], t)
            still = [] if fixed is None else [np.broadcast_to(c, n.shape) for c in fixed]
            for c, c_t in [(n, n_t)] if fixed is None else [(c, np.zeros_like(n)) for c in still]:
                for rows in coefficients_across(t, m, m_t, c, c_t):
                    self._conditions.add(fans, rows.reshape(-1, 18), np.zeros(len(vertices)))
        for side in range(2):
            chosen = edges if side == 0 else edges[self.surface.nodes.lines[edges]]
            if len(chosen):
                self._conditions.slopes.append((chosen, side, fixed))

    def translation(self, edges: ArrayLike, axes: str = "xyz", value: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        """Prescribe components, named by letters, of the displacement `value` (3,) along edges."""
        value = np.asarray(value, dtype=float)
        for letter in axes:
            self.along(edges, np.eye(3)[AXES[letter]], value[AXES[letter]])

    def vertex(self, vertices: ArrayLike, axes: str = "xyz", value: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        """Prescribe components of the displacement of vertices."""
        vertices = np.atleast_1d(np.asarray(vertices, dtype=np.int64))
        for letter in axes:
            rows = np.zeros((len(vertices), 18))
            rows[:, AXES[letter]] = 1.0
            self._conditions.add(
                vertices, rows, np.full(len(vertices), np.asarray(value, dtype=float)[AXES[letter]])
            )

    def clamp(self, edges: ArrayLike, value: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        """No rotation, translations zero or prescribed."""
        self.translation(edges, "xyz", value)
        self.rotation(edges)

    def simple(self, edges: ArrayLike, value: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        """No translation, free rotation."""
        self.translation(edges, "xyz", value)

    def symmetry(self, edges: ArrayLike, normal: ArrayLike | None = None) -> Floats:
        """The edges lie in a plane of symmetry. See `Supports.symmetry`.

        The derivative of u across the plane has no part along it, which is exact at any deflection.
        """
        axis = self._plane(edges, "a symmetry plane", normal, lambda: main_conormal(self.surface, edges))
        self.along(edges, axis)
        self.rotation(edges, within(axis))
        return axis

    def diaphragm(self, edges: ArrayLike, normal: ArrayLike | None = None) -> None:
        """A wall in the plane of the edges, rigid in its plane and soft across it."""
        axis = self._plane(edges, "a diaphragm", normal, None)
        for direction in within(axis):
            self.along(edges, direction)

    def reduction(self, tied: bool = True) -> Reduction:
        """The motions left. See `free_motions`."""
        return free_motions(self.surface, self._conditions, tied)

    def _plane(
        self, edges: ArrayLike, what: str, normal: ArrayLike | None, line: Callable[[], Floats] | None
    ) -> Floats:
        """Normal of the plane of edges, `line()` where they form a line."""
        vertices = np.unique(self.surface.mesh.edges[np.asarray(edges)])
        x = self._places(vertices)
        axis = plane_normal(x, what, normal, line)
        require_plane(x, axis, what)
        return axis

    def _places(self, vertices: NDArray) -> Floats:
        """(n, 3) where vertices are in space."""
        return self.surface.chart.derivatives(*self.surface.mesh.points[vertices, :2].T, order=0)[0]
