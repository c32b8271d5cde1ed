"""Supports of the Argyris discretisation on a chart: conditions along straight edges of the parameter plane.

A condition f = 0 along an edge means f = 0 and its derivatives along the edge at the vertices, which for a
quintic along the edge is exact. The conditions at each vertex are linear equations for its 18 unknowns;
their null space is what is left free. A rotation adds one equation at the midpoint of the edge.

Symbols
-------
T          direction of the edge in the parameter plane, d/dT = T^a d/dx^a
c          fixed direction in space
n          normal of the surface
m^a        direction in the parameter plane across the edge: at right angles to it on the surface
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp
from numpy.typing import ArrayLike, NDArray

from kshell.errors import InputError
from kshell.shell.chart.surface import ChartSurface
from kshell.shell.koiter.discretisation import USE_KOITER
from kshell.shell.koiter.supports import AXES, PLANAR, Reduction, snapped

Floats = NDArray[np.float64]
OfPlace = Callable[[Floats], Floats]

# equations on scaled unknowns count as dependent below this singular value
DEPENDENT = 1e-8
# step of differences of prescribed values, in the edge length
STEP = 0.02
# positions of the second derivatives uu, uv, vv among the unknowns of a vertex
SECOND = np.array([[3, 4], [4, 5]])


class ChartSupports:
    """Conditions on the motion of a chart surface; every method adds some."""

    def __init__(self, surface: ChartSurface) -> None:
        self.surface = surface
        self._vertices: list[NDArray] = []
        self._rows: list[Floats] = []
        self._values: list[Floats] = []
        self._slopes: list[tuple[NDArray, Floats | None]] = []
        mesh = surface.mesh
        sum_of_lengths = np.bincount(mesh.edges.ravel(), np.repeat(mesh.edge_lengths, 2), len(mesh.points))
        self._size = sum_of_lengths / np.bincount(mesh.edges.ravel(), minlength=len(mesh.points))

    def along(self, edges: ArrayLike, direction: ArrayLike, value: float = 0.0) -> None:
        """Prescribe the translation of edges along a direction, constant along each edge."""
        c = np.asarray(direction, dtype=float) / np.linalg.norm(direction)
        for vertices, t in self._ends(edges):
            for coefficients in _along_edge(t):
                rows = np.einsum("nk,x->nkx", coefficients, c).reshape(len(vertices), 18)
                first = coefficients[0, 0] != 0.0  # the value itself; its derivatives along the edge vanish
                self._add(vertices, rows, np.full(len(vertices), value if first else 0.0))

    def at_vertices(self, vertices: ArrayLike, direction: ArrayLike, value: OfPlace) -> None:
        """Prescribe the translation of vertices along a unit direction, `value` of their places (n, 3)."""
        vertices = np.atleast_1d(np.asarray(vertices, dtype=np.int64))
        rows = np.zeros((len(vertices), 18))
        rows[:, :3] = direction
        x = self.surface.chart.derivatives(*self.surface.mesh.points[vertices, :2].T, order=0)[0]
        self._add(vertices, rows, value(x))

    def along_edges(self, edges: ArrayLike, direction: ArrayLike, value: OfPlace) -> None:
        """Prescribe the translation of edges along a unit direction, `value` of the places (n, 3) along them.

        The quintic along an edge takes the value and its first two derivatives from its ends.
        """
        for vertices, t in self._ends(edges):
            prescribed = self._differences(vertices, t, value)
            for coefficients, right in zip(_along_edge(t), prescribed, strict=True):
                rows = np.einsum("nk,x->nkx", coefficients, np.asarray(direction)).reshape(len(vertices), 18)
                self._add(vertices, rows, right)

    def over_triangles(self, triangles: NDArray, direction: ArrayLike, value: OfPlace) -> None:
        """Prescribe the translation of the whole shell along a unit direction, the same at all places.

        Raises
        ------
        InputError
            If the value varies, or if the triangles are a part of the shell: second derivatives are continuous at
            vertices, so holding them on one side of a border bends the shell on the other side wrongly.
        """
        mesh = self.surface.mesh
        inside = np.bincount(mesh.triangle_edges[triangles].ravel(), minlength=len(mesh.edges))
        border = np.flatnonzero((inside > 0) & (inside < mesh.edge_counts))
        if len(border):
            at = mesh.points[mesh.edges[border[0]]].mean(axis=0)
            raise InputError(
                "Argyris functions on a chart have continuous curvature, which a part of the shell that is held would "
                f"impose on the rest across its border, e.g. at (u, v) = ({at[0]:.6g}, {at[1]:.6g}): hold the border "
                f"curve and leave that part out of the mesh, or {USE_KOITER}"
            )
        vertices = np.unique(mesh.triangles[triangles])
        values = value(self.surface.chart.derivatives(*mesh.points[vertices, :2].T, order=0)[0])
        if np.ptp(values) > 1e-12 * np.abs(values).max():
            raise InputError(
                "a prescribed translation that varies over a surface is not possible with Argyris elements on a chart, "
                f"whose functions cannot follow it inside triangles: prescribe it on curves, or {USE_KOITER}"
            )
        for k in range(6):
            rows = np.zeros((len(vertices), 6, 3))
            rows[:, k] = direction
            self._add(vertices, rows.reshape(-1, 18), values if k == 0 else np.zeros(len(vertices)))
        self._slopes.append((np.unique(mesh.triangle_edges[triangles]), np.asarray(direction)[None]))

    def _differences(self, vertices: NDArray, t: Floats, value: OfPlace) -> list[Floats]:
        """Value, d/dT and d2/dT2 at vertices, by central differences of order 6 along the edge."""
        step = STEP * self._size[vertices]
        offsets = step[:, None] * np.arange(-3, 4)  # (vertex, 7)
        uv = self.surface.mesh.points[vertices, None, :2] + offsets[..., None] * t[:, None]
        x = self.surface.chart.derivatives(uv[..., 0].ravel(), uv[..., 1].ravel(), order=0)[0]
        values = value(x).reshape(len(vertices), 7)
        values_less = values - values[:, 3:4]  # exact zeros for constants
        first = values_less @ np.array([-1, 9, -45, 0, 45, -9, 1]) / 60
        second = values_less @ np.array([2, -27, 270, -490, 270, -27, 2]) / 180
        return [values[:, 3], first / step, second / step**2]

    def rotation(self, edges: ArrayLike, directions: ArrayLike | None = None) -> None:
        """No rotation about edges: n . u,m = 0, or c . u,m = 0 for every row c of `directions` (k, 3).

        On a clamped edge the first holds exactly at large deflections, too.
        """
        edges = np.atleast_1d(np.asarray(edges, dtype=np.int64))
        fixed = None if directions is None else np.asarray(directions, dtype=float)
        for vertices, t in self._ends(edges):
            n, n_t, m, m_t, _ = self._across(self.surface.mesh.points[vertices, :2], t)
            still = [] if fixed is None else [np.broadcast_to(c, n.shape) for c in fixed]
            for c, c_t in [(n, n_t)] if fixed is None else [(c, np.zeros_like(n)) for c in still]:
                rows = np.zeros((len(vertices), 6, 3))
                rows[:, 1:3] = m[:, :, None] * c[:, None]
                self._add(vertices, rows.reshape(-1, 18), np.zeros(len(vertices)))
                rows = np.zeros((len(vertices), 6, 3))
                rows[:, 1:3] = m[:, :, None] * c_t[:, None] + m_t[:, :, None] * c[:, None]
                for a in range(2):
                    for b in range(2):
                        rows[:, SECOND[a, b]] += (m[:, a] * t[:, b])[:, None] * c
                self._add(vertices, rows.reshape(-1, 18), np.zeros(len(vertices)))
        self._slopes.append((edges, fixed))

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
            self._add(vertices, rows, np.full(len(vertices), np.asarray(value, dtype=float)[AXES[letter]]))

    def clamp(self, edges: ArrayLike, value: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        """No rotation, translations zero or prescribed."""
        self.translation(edges, "xyz", value)
        self.rotation(edges)

    def simple(self, edges: ArrayLike, value: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        """No translation, free rotation."""
        self.translation(edges, "xyz", value)

    def symmetry(self, edges: ArrayLike, normal: ArrayLike | None = None) -> None:
        """The edges lie in a plane of symmetry. See `Supports.symmetry`.

        The derivative of u across the plane has no part along it, which is exact at any deflection.
        """
        axis = self._plane(edges, "a symmetry plane", normal, self._conormal(edges))
        self.along(edges, axis)
        self.rotation(edges, np.linalg.svd(axis[None])[2][1:])

    def diaphragm(self, edges: ArrayLike, normal: ArrayLike | None = None) -> None:
        """A wall in the plane of the edges, rigid in its plane and soft across it."""
        axis = self._plane(edges, "a diaphragm", normal, None)
        for direction in np.linalg.svd(axis[None])[2][1:]:
            self.along(edges, direction)

    def reduction(self) -> Reduction:
        """The motions left: x = basis q + given.

        Raises
        ------
        InputError
            If two conditions prescribe different displacements of the same vertex.
        """
        surface = self.surface
        rows, columns, entries, count = [], [], [], 0
        given = np.zeros(surface.unknowns)
        fixed = np.zeros(surface.unknowns, dtype=bool)
        if self._vertices:
            for vertex, equations, values in self._by_vertex():
                unknowns = 18 * vertex + np.arange(18)
                fixed[unknowns] = True
                free, motion = self._null_space(vertex, equations, values)
                given[unknowns] = motion
                rows.append(np.repeat(unknowns, free.shape[1]))
                columns.append(np.tile(count + np.arange(free.shape[1]), 18))
                entries.append(free.ravel())
                count += free.shape[1]
        carried = sp.csr_matrix((surface.unknowns, surface.unknowns))
        if self._slopes:
            unknowns, free, kept, carried = self._midpoints()
            fixed[unknowns] = True
            for k in range(3):  # the last directions of each midpoint are free
                some = np.flatnonzero(kept > k)
                rows.append(unknowns[some].ravel())
                columns.append(np.repeat(count + np.arange(len(some)), 3))
                entries.append(free[some, 2 - k].ravel())
                count += len(some)
        rest = np.flatnonzero(~fixed)
        basis = sp.csc_matrix(
            (
                np.concatenate([np.ones(len(rest)), *entries]),
                (
                    np.concatenate([rest, *rows]),
                    np.concatenate([np.arange(len(rest)), *(c + len(rest) for c in columns)]),
                ),
            ),
            shape=(surface.unknowns, len(rest) + count),
        )
        basis = (basis + carried @ basis).tocsc()
        return Reduction(basis, given + carried @ given, np.zeros(0, dtype=np.int32))

    def _add(self, vertices: NDArray, rows: Floats, values: Floats) -> None:
        self._vertices.append(vertices)
        self._rows.append(rows)
        self._values.append(values)

    def _ends(self, edges: ArrayLike) -> list[tuple[NDArray, Floats]]:
        """For both ends of edges: vertices and the directions T."""
        mesh = self.surface.mesh
        ends = mesh.edges[np.atleast_1d(np.asarray(edges, dtype=np.int64))]
        t = mesh.points[ends[:, 1], :2] - mesh.points[ends[:, 0], :2]
        t = t / np.linalg.norm(t, axis=1, keepdims=True)
        return [(ends[:, 0], t), (ends[:, 1], t)]

    def _across(self, uv: Floats, t: Floats) -> tuple[Floats, Floats, Floats, Floats, Floats]:
        """n, dn/dT, m, dm/dT, and the unit conormal, at parameters (n, 2) of edges with directions t (n, 2).

        m^1 = -A_2b T^b, m^2 = A_1b T^b with the first fundamental form A, so m and T are at right angles.
        """
        _, x_a, x_ab = self.surface.chart.derivatives(uv[:, 0], uv[:, 1], order=2)
        x_t = np.einsum("nax,na->nx", x_a, t)
        x_at = np.einsum("nabx,nb->nax", x_ab, t)
        x_tt = np.einsum("nax,na->nx", x_at, t)
        lowered = np.einsum("nax,nx->na", x_a, x_t)
        lowered_t = np.einsum("nax,nx->na", x_at, x_t) + np.einsum("nax,nx->na", x_a, x_tt)
        m = np.stack([-lowered[:, 1], lowered[:, 0]], axis=1)
        m_t = np.stack([-lowered_t[:, 1], lowered_t[:, 0]], axis=1)
        normal = np.cross(x_a[:, 0], x_a[:, 1])
        area = np.linalg.norm(normal, axis=1, keepdims=True)
        n = normal / area
        n_t = (np.cross(x_at[:, 0], x_a[:, 1]) + np.cross(x_a[:, 0], x_at[:, 1])) / area
        n_t -= n * np.sum(n * n_t, axis=1, keepdims=True)
        conormal = np.einsum("nax,na->nx", x_a, m)
        return n, n_t, m, m_t, conormal / np.linalg.norm(conormal, axis=1, keepdims=True)

    def _conormal(self, edges: ArrayLike) -> Floats:
        conormals = np.concatenate(
            [self._across(self.surface.mesh.points[v, :2], t)[4] for v, t in self._ends(edges)]
        )
        return np.linalg.svd(conormals, full_matrices=False)[2][0]

    def _plane(
        self, edges: ArrayLike, what: str, normal: ArrayLike | None, straight: Floats | None
    ) -> Floats:
        """Normal of the plane of edges, `straight` where they form a line."""
        vertices = np.unique(self.surface.mesh.edges[np.asarray(edges)])
        x = self.surface.chart.derivatives(*self.surface.mesh.points[vertices, :2].T, order=0)[0]
        _, size, directions = np.linalg.svd(x - x.mean(axis=0), full_matrices=False)
        if normal is not None:
            axis = np.asarray(normal, dtype=float) / np.linalg.norm(normal)
        elif len(size) > 2 and size[1] > PLANAR * size[0]:
            axis = snapped(directions[2])
        elif straight is not None:
            axis = snapped(straight)
        else:
            raise InputError(f"{what}: the edges form a straight line: give the normal of the plane")
        height = np.abs((x - x.mean(axis=0)) @ axis)
        if height.max() > PLANAR * size[0]:
            raise InputError(
                f"{what} needs edges in one plane with normal ({axis[0]:.4g}, {axis[1]:.4g}, {axis[2]:.4g}), but they "
                f"miss it by {height.max():.3g}: split the group by planes"
            )
        return axis

    def _by_vertex(self) -> list[tuple[int, Floats, Floats]]:
        vertices = np.concatenate(self._vertices)
        order = np.argsort(vertices, kind="stable")
        rows, values = np.concatenate(self._rows)[order], np.concatenate(self._values)[order]
        unique, start = np.unique(vertices[order], return_index=True)
        parts = zip(unique, np.split(rows, start[1:]), np.split(values, start[1:]), strict=True)
        return [(int(v), r, c) for v, r, c in parts]

    def _null_space(self, vertex: int, rows: Floats, values: Floats) -> tuple[Floats, Floats]:
        """Free directions (18, k) and the prescribed motion (18,) of a vertex."""
        scale = np.repeat(
            self._size[vertex] ** np.array([0.0, -1, -1, -2, -2, -2]), 3
        )  # unknowns of one size
        scaled = rows * scale
        size = np.linalg.norm(scaled, axis=1)
        scaled, right = scaled / size[:, None], values / size
        u, s, v = np.linalg.svd(scaled)
        rank = int(np.sum(s > DEPENDENT))
        motion = v[:rank].T @ ((u[:, :rank].T @ right) / s[:rank])
        if np.abs(scaled @ motion - right).max() > 1e-6 * np.abs(right).max(initial=0.0):
            x, y = self.surface.mesh.points[vertex, :2]
            raise InputError(f"supports prescribe different displacements at (u, v) = ({x:.6g}, {y:.6g})")
        return v[rank:].T * scale[:, None], motion * scale

    def _midpoints(self) -> tuple[NDArray, Floats, NDArray, sp.csr_matrix]:
        """Unknowns (edge, 3) of edge midpoints with conditions, directions (edge, 3, 3) of which the last `kept`
        (edge,) are free, and what the vertices say about the others.

        With m = m_nu nu + m_tau T a condition is c . u,nu = -(m_tau / m_nu) c . u,T, and u,T at the midpoint of
        a quintic is 15/8 [u] / L - 7/16 (u,T + u,T) + L/32 [u,TT].
        """
        mesh = self.surface.mesh
        edges = np.unique(np.concatenate([e for e, _ in self._slopes]))
        ends = mesh.edges[edges]
        a, b = mesh.points[ends[:, 0], :2], mesh.points[ends[:, 1], :2]
        length = np.linalg.norm(b - a, axis=1)
        t = (b - a) / length[:, None]
        nu = np.stack([t[:, 1], -t[:, 0]], axis=1)  # the normal of kshell.elements.affine
        n, _, m, _, _ = self._across(0.5 * (a + b), t)
        slant = -np.sum(m * t, axis=1) / np.sum(m * nu, axis=1)
        unknowns = 3 * (6 * len(mesh.points) + edges)[:, None] + np.arange(3)
        conditions = np.zeros((len(edges), 3 * len(self._slopes), 3))
        for k, (some, fixed) in enumerate(self._slopes):
            mine = np.searchsorted(edges, some)
            directions = n[mine, None] if fixed is None else fixed[None]
            conditions[mine, 3 * k : 3 * k + directions.shape[1]] = directions
        _, size, directions = np.linalg.svd(conditions, full_matrices=False)
        independent = size > 1e-6
        onto = np.einsum("ei,eix,eiy->exy", independent, directions, directions)
        row, column, entry = [], [], []
        for vertices, sign in ((ends[:, 0], -1.0), (ends[:, 1], 1.0)):
            tx, ty = t.T
            second = sign * length / 32
            parts = np.stack(
                [
                    15 / 8 * sign / length,
                    -7 / 16 * tx,
                    -7 / 16 * ty,
                    second * tx**2,
                    2 * second * tx * ty,
                    second * ty**2,
                ],
                axis=1,
            )
            block = np.einsum("e,exy,ek->exky", slant, onto, parts)
            where = 18 * vertices[:, None] + np.arange(18)
            row.append(np.repeat(unknowns, 18, axis=1).ravel())
            column.append(np.repeat(where[:, None], 3, axis=1).ravel())
            entry.append(block.ravel())
        shape = (self.surface.unknowns, self.surface.unknowns)
        place = (np.concatenate(row), np.concatenate(column))
        carried = sp.csr_matrix((np.concatenate(entry), place), shape=shape)
        return unknowns, directions, 3 - independent.sum(axis=1), carried


def _along_edge(t: Floats) -> list[Floats]:
    """Coefficients (n, 6) of u, u,T and u,TT in the degrees of freedom of a vertex."""
    value, first, second = np.zeros((3, len(t), 6))
    value[:, 0] = 1.0
    first[:, 1:3] = t
    second[:, 3], second[:, 4], second[:, 5] = t[:, 0] ** 2, 2 * t[:, 0] * t[:, 1], t[:, 1] ** 2
    return [value, first, second]
