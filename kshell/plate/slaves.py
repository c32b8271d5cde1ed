"""Slopes of curved edges that depend on the other degrees of freedom of their triangle.

The slope at the true middle of a curved edge, a row on the triangle's degrees of freedom, is zero where a support
holds it, and s, common to both triangles, inside the plate. Solved for the slope at the middle of the chord:

    row . d = s    ->    d_edge = (s - row_rest . d_rest) / row_edge

for all curved edges of a triangle together.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.plate.conditions import Conditions, SharedSlopes
from kshell.plate.layout import Layout

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class Slaves:
    """The dependent slopes of a plate.

    Attributes
    ----------
    edges, triangles, slots : (n,) int arrays
        Edge, triangle and degree of freedom of each.
    rows : (n, local) array
        On the physical degrees of freedom of the triangle.
    """

    def __init__(self, layout: Layout, conditions: Conditions, shared: SharedSlopes | None) -> None:
        self.layout = layout
        local = layout.element.count
        none = np.zeros(0, dtype=np.int64)
        edges = np.concatenate([*conditions.triangle_edges, none])
        triangles = np.concatenate([*conditions.triangles, none])
        rows = np.concatenate([*conditions.triangle_rows, np.zeros((0, local))])
        if shared is not None:  # behind those that are held, which go first
            edges = np.concatenate([edges, shared.edges])
            triangles = np.concatenate([triangles, shared.triangles])
            rows = np.concatenate([rows, shared.rows])
        # an edge may be asked for twice, by two groups
        first = np.unique(edges * len(layout.mesh.triangles) + triangles, return_index=True)[1]
        self.edges, self.triangles, self.rows = edges[first], triangles[first], rows[first]
        self.slots = layout.edge_dofs(self.edges)
        second = self.triangles != layout.mesh.edge_owner[self.edges, 0]
        if second.any():
            place = np.searchsorted(layout.bent, self.edges[second])
            self.slots[second] = layout.first_side + place

    @cached_property
    def by_triangle(self) -> dict[int, list[int]]:
        """Positions by triangle."""
        table: dict[int, list[int]] = {}
        for k, t in enumerate(self.triangles.tolist()):
            table.setdefault(t, []).append(k)
        return table

    def _elimination(self, triangle: int) -> tuple[Ints, Floats, Floats]:
        """Local positions in a triangle, and their rows on the other degrees of freedom and on s."""
        chosen = self.by_triangle[triangle]
        edges = self.layout.mesh.triangle_edges[triangle]
        first = 3 * self.layout.per_vertex
        local = np.array([first + int(np.flatnonzero(edges == self.edges[k])[0]) for k in chosen])
        rows = self.rows[chosen]
        inverse = np.linalg.inv(rows[:, local])
        solved: Floats = -inverse @ rows
        solved[:, local] = 0.0
        return local, solved, inverse

    def eliminated(self, triangles: Ints, transform: Floats) -> Floats:
        """Transforms (n, reference dof, dof) of triangles with s in the places of the slopes."""
        out = transform.copy()
        for k in np.flatnonzero(np.isin(triangles, self.triangles)):
            local, rows, inverse = self._elimination(int(triangles[k]))
            own = out[k][:, local]
            out[k] += own @ rows
            out[k][:, local] = own @ inverse
        return out

    def fill(self, d: Floats) -> None:
        """Set the slopes in physical degrees of freedom (dof,) or (dof, n) that hold s in their places before."""
        found = d.copy()
        for t in self.by_triangle:
            dofs = self.layout.triangle_dofs(np.array([t]))[0]
            local, rows, inverse = self._elimination(t)
            found[dofs[local]] = rows @ d[dofs] + inverse @ d[dofs[local]]
        d[:] = found

    def gathered(self, f: Floats) -> Floats:
        """Loads (dof, n) on physical degrees of freedom as those with s in the places of the slopes: `fill` turned."""
        out = f.copy()
        out[self.slots] = 0.0
        for t in self.by_triangle:
            dofs = self.layout.triangle_dofs(np.array([t]))[0]
            local, rows, inverse = self._elimination(t)
            own = f[dofs[local]]
            out[dofs] += rows.T @ own
            out[dofs[local]] += inverse.T @ own
        return out

    def matrix(self) -> sp.csr_matrix:
        """(dof, dof) what `fill` does."""
        kept = np.ones(self.layout.count)
        kept[self.slots] = 0.0
        parts_row, parts_column, parts_value = [], [], []
        for triangle in self.by_triangle:
            dofs = self.layout.triangle_dofs(np.array([triangle]))[0]
            local, rows, inverse = self._elimination(triangle)
            rows[:, local] = inverse
            parts_row.append(np.repeat(dofs[local], len(dofs)))
            parts_column.append(np.tile(dofs, len(local)))
            parts_value.append(rows.ravel())
        size = (self.layout.count, self.layout.count)
        where = (np.concatenate(parts_row), np.concatenate(parts_column))
        return sp.csr_matrix(sp.diags(kept) + sp.csr_matrix((np.concatenate(parts_value), where), shape=size))
