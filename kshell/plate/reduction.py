"""From conditions on single vertices and edges to the unknowns that remain.

Conditions are rows acting on the (scaled) degrees of freedom of one fan of a vertex, whole edge degrees of
freedom, or, for slopes on curved edges, rows acting on one triangle. At each vertex the null space of its
rows, and of those that tie its fans, gives the free directions, so corners, oblique edges, changes of support and
supports that meet lines of discontinuity need no special case.

Symbols
-------
d    degrees of freedom (layout order, scaled);  q  unknowns;  d = T q + g
z    those of a vertex: w, w_x, w_y, then w_xx, w_xy, w_yy of each of its fans
B    orthonormal basis of z: free directions first, then the fixed ones
s    slope at the true middle of a curved edge inside, common to its two triangles
"""

from __future__ import annotations

from collections.abc import Iterator
from copy import copy
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.plate.conditions import Conditions, SharedSlopes
from kshell.plate.layout import Layout
from kshell.plate.slaves import Slaves

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# Eigenvalues of the rows' Gram matrix below this are free directions. Where a clamped arc meets a line of
# symmetry at a right angle the rows depend on each other; the tangent of a coarse arc is off by up to 0.03,
# which makes that eigenvalue 4e-4. True corners of 12 degrees and more start at 9e-4.
DEPENDENT = 5e-4
TIE = 5.0  # weight of the rows that tie fans: lines that turn by more than half a degree are not straight
ABSENT = 1e6  # eigenvalue of the places of z that a vertex does not have
CONFLICT = 1e-4  # values read off curved edges by interpolation agree only so far


class Reduction:
    """The unknowns left by a set of conditions.

    Parameters
    ----------
    layout : Layout
    conditions : Conditions
    shared : SharedSlopes, optional
        Of the curved edges inside.

    Attributes
    ----------
    count : int
        Number of unknowns.
    unknown : (dof,) int array
        Unknown stored at each degree of freedom (at constrained vertices: at each direction of B, at the slopes of
        both triangles at a curved edge inside: s), or -1.
    sizes : (node,) int array
        Unknowns of each vertex, then of each edge.
    particular : (dof,) array
        g, physical.
    """

    def __init__(self, layout: Layout, conditions: Conditions, shared: SharedSlopes | None = None) -> None:
        self.layout = layout
        b, fans = layout.per_vertex, layout.fans
        of_row = np.concatenate([*conditions.fans, np.zeros(0, dtype=np.int64)])
        rows = np.concatenate(conditions.rows or [np.zeros((0, b))])
        values = np.concatenate(conditions.values or [np.zeros(0)])
        self.fan_place = (
            _place_among_fans(fans.vertex) if fans.extra else np.zeros(len(fans.vertex), np.int64)
        )
        if fans.extra:
            tie_rows = _tie_rows(fans.tangent, self.fan_place[fans.tied], self._last_place)
            rows = np.concatenate([self.rows_at_vertices(rows, of_row), tie_rows])
            of_row = np.concatenate([of_row, np.repeat(fans.tied[:, 0], 2)])
            values = np.append(values, np.zeros(len(tie_rows)))
        self.vertices, inverse = np.unique(fans.vertex[of_row], return_inverse=True)
        self.slots = self._vertex_slots(rows.shape[1])
        self.bases, free_counts, scaled = self._vertex_bases(rows, values, inverse)

        present = self.slots >= 0
        is_free = np.ones(layout.count, dtype=bool)
        is_free[self.slots[present]] = (np.arange(rows.shape[1]) < free_counts[:, None])[present]
        fixed_edges = np.concatenate(
            [*conditions.edges, *conditions.triangle_edges, np.zeros(0, dtype=np.int64)]
        )
        fixed_edges, slopes = self._edge_slopes(fixed_edges, conditions)
        is_free[layout.edge_dofs(fixed_edges)] = False
        is_free[layout.first_side :] = False
        order = np.argsort(layout.node, kind="stable") if layout.count > layout.first_hessian else slice(None)
        self.unknown = np.full(layout.count, -1, dtype=np.int32)
        self.count = int(is_free.sum())
        in_order = is_free[order]
        self.unknown[order] = np.where(in_order, np.cumsum(in_order) - 1, -1)
        self.sizes = np.bincount(layout.node[is_free], minlength=layout.vertex_count + len(layout.mesh.edges))

        self.slaves = Slaves(layout, conditions, shared)
        self.unknown[self.slaves.slots] = self.unknown[layout.edge_dofs(self.slaves.edges)]
        self.particular = np.zeros(layout.count)
        self.particular[self.slots[present]] = scaled[present] * layout.scale[self.slots[present]]
        self.particular[layout.edge_dofs(fixed_edges)] = slopes  # at curved edges those of the true middles
        self.slaves.fill(self.particular)

    def _edge_slopes(self, edges: Ints, conditions: Conditions) -> tuple[Ints, Floats]:
        """The edges, once each, and their prescribed slopes."""
        values = np.concatenate([*conditions.edge_values, *conditions.triangle_values, np.zeros(0)])
        unique, first, inverse = np.unique(edges.astype(np.int64), return_index=True, return_inverse=True)
        miss = np.abs(values - values[first][inverse])
        if miss.any() and miss.max() > CONFLICT * np.abs(values).max():
            ends = self.layout.mesh.edges[edges[int(miss.argmax())]]
            x, y = self.layout.mesh.points[ends, :2].mean(axis=0)
            raise InputError(
                f"supports prescribe different rotations of the edge at ({x:g}, {y:g}): hold the rotation once there"
            )
        return unique, values[first]

    @property
    def _last_place(self) -> int:
        return int(self.fan_place.max(initial=0))

    def ties_of(self, vertices: list[int]) -> Iterator[tuple[int, Floats]]:
        """The rows (n, width) on z that tie the fans of vertices, for those that have several."""
        fans = self.layout.fans
        of_tie = fans.vertex[fans.tied[:, 0]]
        for v in vertices:
            mine = np.flatnonzero(of_tie == v)
            if len(mine):
                yield v, _tie_rows(fans.tangent[mine], self.fan_place[fans.tied[mine]], self._last_place)

    def rows_at_vertices(self, rows: Floats, fans: Ints) -> Floats:
        """Rows on fans (n, 6) as rows on z (n, width)."""
        if not self.layout.fans.extra:
            return rows
        out = np.zeros((len(rows), 6 + 3 * self._last_place))
        out[:, :3] = rows[:, :3]
        at = 3 + 3 * self.fan_place[fans]
        out[np.arange(len(rows))[:, None], at[:, None] + np.arange(3)] = rows[:, 3:]
        return out

    def _vertex_slots(self, width: int) -> Ints:
        """(vertex, width) degree of freedom at each place of z, -1 beyond the fans there are."""
        layout = self.layout
        slots = np.full((len(self.vertices), width), -1, dtype=np.int64)
        slots[:, : layout.per_vertex] = layout.vertex_dofs(self.vertices)
        if layout.fans.extra:
            further = np.arange(layout.vertex_count, len(layout.fans.vertex))
            row = np.searchsorted(
                self.vertices, layout.fans.vertex[further]
            )  # all are tied, so all are there
            at = 3 + 3 * self.fan_place[further]
            slots[row[:, None], at[:, None] + np.arange(3)] = layout.fan_dofs(further)[:, 3:]
        return slots

    def _vertex_bases(
        self, rows: Floats, values: Floats, inverse: Ints
    ) -> tuple[Floats, NDArray[np.int64], Floats]:
        """Bases B (vertex, width, width), number of free directions, and the particular solution (scaled)."""
        b, n = rows.shape[1], len(self.vertices)
        gram = np.zeros((n, b, b))
        np.add.at(gram, inverse, rows[:, :, None] * rows[:, None, :])
        right = np.zeros((n, b))
        np.add.at(right, inverse, rows * values[:, None])
        vertex, absent = np.nonzero(self.slots < 0)
        gram[vertex, absent, absent] = ABSENT
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
        transform : (n, reference dof, column) array
            As many columns for each of the three vertices, then one for each edge.
        unknown : (n, column) int array
            Unknown number of each column, -1 where the column is fixed.
        """
        layout, b = self.layout, self.layout.per_vertex
        out = transform
        if len(self.slaves.edges):
            out = self.slaves.eliminated(triangles, out)
        out = out * layout.scale[dofs][:, None, :]
        if b == 1:  # nothing to turn: a condition on a single number fixes it
            return out, self.unknown[dofs]
        place = self.vertex_place[layout.mesh.triangles[triangles]]
        if layout.fans.extra and self._several[layout.mesh.triangles[triangles]].any():
            return self._between_fans(triangles, dofs, out, place)
        for v in range(3):
            here = np.flatnonzero(place[:, v] >= 0)
            block = slice(v * b, (v + 1) * b)
            if len(here):
                out[here, :, block] = out[here, :, block] @ self.bases[place[here, v], :b, :b]
        return out, self.unknown[dofs]

    @cached_property
    def _several(self) -> NDArray[np.bool_]:
        """(vertex,) whether a vertex has several fans."""
        return np.bincount(self.layout.fans.vertex) > 1

    def _between_fans(
        self, triangles: Ints, dofs: Ints, out: Floats, place: Ints
    ) -> tuple[Floats, NDArray[np.int32]]:
        """`local_transform` where vertices have several fans: their unknowns may be more than those of one fan."""
        layout, b = self.layout, self.layout.per_vertex
        corners = layout.mesh.triangles[triangles]
        width = max(b, int(self.sizes[corners].max()))
        n = len(triangles)
        wide = np.zeros((n, out.shape[1], 3 * width + 3))
        unknown = np.full((n, 3 * width + 3), -1, dtype=np.int32)
        wide[:, :, 3 * width :] = out[:, :, 3 * b :]
        unknown[:, 3 * width :] = self.unknown[dofs[:, 3 * b :]]
        row = np.concatenate([np.arange(3), np.zeros(3, dtype=np.int64)])
        for v in range(3):
            own = out[:, :, v * b : (v + 1) * b]
            plain = np.flatnonzero(place[:, v] < 0)
            wide[plain, :, v * width : v * width + b] = own[plain]
            unknown[plain, v * width : v * width + b] = self.unknown[dofs[plain, v * b : (v + 1) * b]]
            here = np.flatnonzero(place[:, v] >= 0)
            if not len(here):
                continue
            at = place[here, v]
            rows = np.tile(row, (len(here), 1))
            rows[:, 3:] = (
                3 + 3 * self.fan_place[layout.fans.corner[triangles[here], v]][:, None] + np.arange(3)
            )
            most = min(width, self.bases.shape[2])
            basis = self.bases[at[:, None], rows, :most]
            wide[here, :, v * width : v * width + most] = own[here] @ basis
            slots = self.slots[at, :most]
            unknown[here, v * width : v * width + most] = np.where(slots >= 0, self.unknown[slots], -1)
        return wide, unknown

    def expand(self, q: Floats) -> Floats:
        """All degrees of freedom d (dof,), physical, from the unknowns."""
        return self.spread(q[:, None])[:, 0] + self.particular

    def spread(self, q: Floats) -> Floats:
        """T q (dof, n), physical, of unknowns (unknown, n)."""
        present = self.slots >= 0
        d = np.append(q, np.zeros((1, q.shape[1])), axis=0)[self.unknown]  # -1, fixed, takes the last row
        z = np.where(present[..., None], d[self.slots], 0.0)
        d[self.slots[present]] = (self.bases @ z)[present]
        d *= self.layout.scale[:, None]
        self.slaves.fill(d)
        return d

    def gathered(self, f: Floats) -> Floats:
        """T' f (unknown, n), loads on the unknowns, of loads (dof, n) on physical degrees of freedom."""
        present = self.slots >= 0
        f = self.slaves.gathered(f) * self.layout.scale[:, None]
        z = np.where(present[..., None], f[self.slots], 0.0)
        f[self.slots[present]] = (self.bases.swapaxes(1, 2) @ z)[present]
        out = np.zeros((self.count + 1, f.shape[1]))
        if len(self.slaves.edges):  # unknowns that both sides of an edge have
            np.add.at(out, self.unknown, f)
        else:
            out[self.unknown] = f  # -1, fixed, takes the last row
        return out[:-1]

    def matrix(self) -> sp.csr_matrix:
        """T as a sparse matrix (dof, unknown), giving physical degrees of freedom."""
        layout, width = self.layout, self.slots.shape[1]
        present = self.slots >= 0  # (vertex, width)
        plain = np.ones(layout.count, dtype=bool)
        plain[self.slots[present]] = False
        plain &= self.unknown >= 0
        row = [np.flatnonzero(plain)]
        column = [self.unknown[plain]]
        value = [layout.scale[plain]]
        grid_row = np.repeat(self.slots[:, :, None], width, axis=2)
        unknown = np.where(present, self.unknown[self.slots], -1)
        grid_column = np.repeat(unknown[:, None, :], width, axis=1)
        keep = (grid_row >= 0) & (grid_column >= 0) & (self.bases != 0)
        row.append(grid_row[keep])
        column.append(grid_column[keep])
        value.append(self.bases[keep] * layout.scale[grid_row[keep]])
        shape = (layout.count, self.count)
        t = sp.csr_matrix((np.concatenate(value), (np.concatenate(row), np.concatenate(column))), shape=shape)
        if len(self.slaves.edges):
            t = (self.slaves.matrix() @ t).tocsr()
        return t


def _place_among_fans(vertex: Ints) -> Ints:
    """(fan,) position of each fan among those of its vertex."""
    order = np.argsort(vertex, kind="stable")
    start = np.searchsorted(vertex[order], vertex[order])
    out = np.empty(len(vertex), dtype=np.int64)
    out[order] = np.arange(len(vertex)) - start
    return out


def _tie_rows(tangent: Floats, place: Ints, last: int) -> Floats:
    """(2 n, width) rows (H_1 - H_2) t = 0 on z, from tangents (n, 2) and places (n, 2), up to ``last``, of the fans."""
    n, width = len(tangent), 6 + 3 * last
    out = np.zeros((n, 2, width))
    each = np.arange(n)
    weight = TIE / np.sqrt(2.0)
    for side, sign in enumerate((weight, -weight)):
        first = 3 + 3 * place[:, side]
        for component in range(2):  # of H t: (xx, xy) t and (xy, yy) t
            for axis in range(2):
                out[each, component, first + component + axis] = sign * tangent[:, axis]
    return out.reshape(2 * n, width)
