"""From conditions on single vertices and edges to the unknowns that remain.

Conditions are rows acting on the (scaled) degrees of freedom of one vertex, whole edge degrees of
freedom, or, for slopes on curved edges, rows acting on one triangle. At each vertex the null space of its
rows gives the free directions, so corners, oblique edges and changes of support need no special case.

Symbols
-------
d    degrees of freedom (layout order, scaled);  q  unknowns;  d = T q + g
B    orthonormal basis at a vertex: free directions first, then the fixed ones
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.plate.layout import Layout

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# Eigenvalues of the rows' Gram matrix below this are free directions. Where a clamped arc meets a line of
# symmetry at a right angle the rows depend on each other; the tangent of a coarse arc is off by up to 0.03,
# which makes that eigenvalue 4e-4. True corners of 12 degrees and more start at 9e-4.
DEPENDENT = 5e-4
CONFLICT = 1e-4  # values read off curved edges by interpolation agree only so far


@dataclass
class Conditions:
    """Rows collected from the supports.

    Attributes
    ----------
    vertices, rows, values
        Lists of (n,) vertex numbers, (n, per_vertex) rows on scaled degrees of freedom, (n,) values.
    edges
        List of (n,) edges whose degree of freedom is fixed at zero.
    triangle_edges, triangles, triangle_rows
        Lists of (n,) edges, (n,) triangles and (n, local) rows on physical degrees of freedom that
        determine the edges' degrees of freedom from the others of the triangle.
    slope_vertices, slopes
        Lists of (n,) vertices and (n, 2) directions in which the slope vanishes, for multigrid: what holds
        along an edge, whether the element has gradients at its vertices or not.
    """

    vertices: list[Ints] = field(default_factory=list)
    rows: list[Floats] = field(default_factory=list)
    values: list[Floats] = field(default_factory=list)
    edges: list[Ints] = field(default_factory=list)
    triangle_edges: list[Ints] = field(default_factory=list)
    triangles: list[Ints] = field(default_factory=list)
    triangle_rows: list[Floats] = field(default_factory=list)
    slope_vertices: list[Ints] = field(default_factory=list)
    slopes: list[Floats] = field(default_factory=list)

    def at_vertices(self, vertices: NDArray[np.integer], rows: Floats, values: Floats | float = 0.0) -> None:
        """Add one row per vertex; rows are normalised here."""
        size = np.linalg.norm(rows, axis=1)
        self.vertices.append(np.asarray(vertices, dtype=np.int64))
        self.rows.append(rows / size[:, None])
        self.values.append(np.broadcast_to(np.asarray(values, dtype=float), size.shape) / size)


class Reduction:
    """The unknowns left by a set of conditions.

    Parameters
    ----------
    layout : Layout
    conditions : Conditions

    Attributes
    ----------
    count : int
        Number of unknowns.
    unknown : (dof,) int array
        Unknown stored at each degree of freedom (at constrained vertices: at each direction of B), or -1.
    particular : (dof,) array
        g, physical.
    """

    def __init__(self, layout: Layout, conditions: Conditions) -> None:
        self.layout = layout
        b, n_dofs = layout.per_vertex, layout.count
        vertices = np.concatenate(conditions.vertices or [np.zeros(0, dtype=np.int64)])
        rows = np.concatenate(conditions.rows or [np.zeros((0, b))])
        values = np.concatenate(conditions.values or [np.zeros(0)])
        self.vertices, inverse = np.unique(vertices, return_inverse=True)
        self.bases, free_counts, scaled = self._vertex_bases(rows, values, inverse)

        is_free = np.ones(n_dofs, dtype=bool)
        slots = layout.vertex_dofs(self.vertices)
        is_free[slots.ravel()] = (np.arange(b) < free_counts[:, None]).ravel()
        fixed_edges = np.concatenate(
            [*conditions.edges, *conditions.triangle_edges, np.zeros(0, dtype=np.int64)]
        )
        is_free[layout.edge_dofs(np.unique(fixed_edges.astype(np.int64)))] = False
        self.unknown = np.where(is_free, np.cumsum(is_free) - 1, -1).astype(np.int32)
        self.count = int(is_free.sum())

        # edges that depend on their triangle; an edge may be asked for twice, by two groups
        edges = np.concatenate(conditions.triangle_edges or [np.zeros(0, dtype=np.int64)]).astype(np.int64)
        self.slave_edges, first = np.unique(edges, return_index=True)
        local = layout.element.count
        self.slave_triangles = np.concatenate(conditions.triangles or [np.zeros(0, dtype=np.int64)])[first]
        self.slave_rows = np.concatenate(conditions.triangle_rows or [np.zeros((0, local))])[first]

        self.particular = np.zeros(n_dofs)
        self.particular[slots.ravel()] = (scaled * layout.scale[slots]).ravel()
        self._fill_slaves(self.particular)

    def _vertex_bases(
        self, rows: Floats, values: Floats, inverse: Ints
    ) -> tuple[Floats, NDArray[np.int64], Floats]:
        """Bases B (vertex, b, b), number of free directions, and the particular solution (scaled)."""
        b, n = self.layout.per_vertex, len(self.vertices)
        gram = np.zeros((n, b, b))
        np.add.at(gram, inverse, rows[:, :, None] * rows[:, None, :])
        right = np.zeros((n, b))
        np.add.at(right, inverse, rows * values[:, None])
        eigenvalue, vector = np.linalg.eigh(gram)
        vector[np.abs(vector) < 1e-14] = 0.0
        fixed = eigenvalue > DEPENDENT
        inverse_value = np.where(fixed, 1 / np.where(fixed, eigenvalue, 1.0), 0.0)
        weights = inverse_value * (right[:, None] @ vector)[:, 0]
        solution = (vector @ weights[:, :, None])[..., 0]
        error = np.abs((solution[inverse] * rows).sum(1) - values)
        if len(values) and error.max() > CONFLICT * max(np.abs(values).max(), 1e-300):
            v = self.vertices[inverse[int(error.argmax())]]
            x, y = self.layout.mesh.points[v, :2]
            raise InputError(
                f"supports prescribe different values at ({x:g}, {y:g}): give one value there, or leave a "
                "gap of one element between the two supports"
            )
        return vector, b - fixed.sum(axis=1), solution

    def times(self, factor: float) -> Reduction:
        """The same with the prescribed motion times a factor."""
        out = copy(self)
        out.particular = factor * self.particular
        return out

    @cached_property
    def vertex_place(self) -> Ints:
        """(vertex,) position in `vertices`, or -1."""
        place = np.full(self.layout.vertex_count, -1, dtype=np.int64)
        place[self.vertices] = np.arange(len(self.vertices))
        return place

    @cached_property
    def slaves_by_triangle(self) -> dict[int, list[int]]:
        """Positions in `slave_edges` by triangle."""
        table: dict[int, list[int]] = {}
        for k, t in enumerate(self.slave_triangles.tolist()):
            table.setdefault(t, []).append(k)
        return table

    def _elimination(self, triangle: int) -> tuple[Ints, Floats]:
        """Local slave positions of a triangle, and their rows on the other degrees of freedom."""
        chosen = self.slaves_by_triangle[triangle]
        edges = self.layout.mesh.triangle_edges[triangle]
        first = 3 * self.layout.per_vertex
        local = np.array([first + int(np.flatnonzero(edges == self.slave_edges[k])[0]) for k in chosen])
        rows = self.slave_rows[chosen]
        solved: Floats = -np.linalg.solve(rows[:, local], rows).astype(np.float64)
        solved[:, local] = 0.0
        return local, solved

    def local_transform(
        self, triangles: Ints, dofs: Ints, transform: Floats
    ) -> tuple[Floats, NDArray[np.int32]]:
        """Turn transforms on physical degrees of freedom into transforms on the unknowns.

        Parameters
        ----------
        triangles : (n,) int array
        dofs : (n, local) int array
            Their degrees of freedom.
        transform : (n, reference dof, dof) array

        Returns
        -------
        transform : (n, reference dof, local) array
        unknown : (n, local) int array
            Unknown number of each column, -1 where the column is fixed.
        """
        layout, b = self.layout, self.layout.per_vertex
        out = transform
        if self.slaves_by_triangle:
            out = out.copy()
            for k in np.flatnonzero(np.isin(triangles, self.slave_triangles)):
                local, rows = self._elimination(int(triangles[k]))
                out[k] += out[k][:, local] @ rows
                out[k][:, local] = 0.0
        out = out * layout.scale[dofs][:, None, :]
        if b == 1:  # nothing to turn: a condition on a single number fixes it
            return out, self.unknown[dofs]
        place = self.vertex_place[layout.mesh.triangles[triangles]]
        for v in range(3):
            here = np.flatnonzero(place[:, v] >= 0)
            block = slice(v * b, (v + 1) * b)
            if len(here):
                out[here, :, block] = out[here, :, block] @ self.bases[place[here, v]]
        return out, self.unknown[dofs]

    def expand(self, q: Floats) -> Floats:
        """All degrees of freedom d (dof,), physical, from the unknowns."""
        layout = self.layout
        d = np.append(q, 0.0)[self.unknown]  # -1, a fixed direction, takes the last entry
        slots = layout.vertex_dofs(self.vertices)
        d[slots.ravel()] = (self.bases @ d[slots][:, :, None]).ravel()
        d = d * layout.scale
        fixed = self.particular.copy()
        self._fill_slaves(d)
        return d + fixed

    def _fill_slaves(self, d: Floats) -> None:
        """Set the edges that depend on their triangle."""
        for t in self.slaves_by_triangle:
            dofs = self.layout.triangle_dofs(np.array([t]))[0]
            local, rows = self._elimination(t)
            d[dofs[local]] = rows @ d[dofs]

    def matrix(self) -> sp.csr_matrix:
        """T as a sparse matrix (dof, unknown), giving physical degrees of freedom."""
        layout, b = self.layout, self.layout.per_vertex
        slots = layout.vertex_dofs(self.vertices)  # (vertex, b)
        plain = np.ones(layout.count, dtype=bool)
        plain[slots.ravel()] = False
        plain &= self.unknown >= 0
        row = [np.flatnonzero(plain)]
        column = [self.unknown[plain]]
        value = [layout.scale[plain]]
        grid_row = np.repeat(slots[:, :, None], b, axis=2)
        grid_column = np.repeat(self.unknown[slots][:, None, :], b, axis=1)
        keep = (grid_column >= 0) & (self.bases != 0)
        row.append(grid_row[keep])
        column.append(grid_column[keep])
        value.append(self.bases[keep] * layout.scale[grid_row[keep]])
        shape = (layout.count, self.count)
        t = sp.csr_matrix((np.concatenate(value), (np.concatenate(row), np.concatenate(column))), shape=shape)
        if self.slaves_by_triangle:
            parts_row, parts_column, parts_value = [], [], []
            for triangle in self.slaves_by_triangle:
                dofs = layout.triangle_dofs(np.array([triangle]))[0]
                local, rows = self._elimination(triangle)
                parts_row.append(np.repeat(dofs[local], len(dofs)))
                parts_column.append(np.tile(dofs, len(local)))
                parts_value.append(rows.ravel())
            size = (layout.count, layout.count)
            where = (np.concatenate(parts_row), np.concatenate(parts_column))
            t = (t + sp.csr_matrix((np.concatenate(parts_value), where), shape=size) @ t).tocsr()
        return t
