"""Slopes of curved edges that depend on the other degrees of freedom of their triangle.

The slope at the true middle of a curved edge, a row on the triangle's degrees of freedom, is zero where a support
holds it, and s, common to both triangles, inside the plate. Solved for the slope at the middle of the chord:

    row . d = s    ->    d_edge = (s - row_rest . d_rest) / row_edge

for all curved edges of a triangle together.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.plate.conditions import Conditions, SharedSlopes
from kshell.plate.layout import Layout

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True)
class _Elimination:
    """Triangles that have as many dependent slopes each.

    Attributes
    ----------
    triangles : (n,) int array
        Rising.
    number : (n, slope) int array
        Of the slopes among all.
    dofs : (n, local) int array
        Degrees of freedom.
    at, local : (n, slope) int arrays
        The slopes among all degrees of freedom, and among those of the triangle.
    rows : (n, slope, local) array
        On the other degrees of freedom, zero at the slopes.
    inverse : (n, slope, slope) array
        On s.
    """

    triangles: Ints
    number: Ints
    dofs: Ints
    at: Ints
    local: Ints
    rows: Floats
    inverse: Floats


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
    def _eliminations(self) -> list[_Elimination]:
        """Of all triangles, those together that have as many slopes."""
        if not len(self.edges):
            return []
        order = np.argsort(self.triangles, kind="stable")
        triangles, first, counts = np.unique(self.triangles[order], return_index=True, return_counts=True)
        out = []
        for count in np.unique(counts).tolist():
            here = np.flatnonzero(counts == count)
            chosen = order[first[here][:, None] + np.arange(count)]  # (n, slope)
            edges = self.layout.mesh.triangle_edges[triangles[here]]
            side = (edges[:, None] == self.edges[chosen][..., None]).argmax(axis=2)
            local = 3 * self.layout.per_vertex + side
            rows = self.rows[chosen]
            inverse = np.linalg.inv(np.take_along_axis(rows, local[:, None], axis=2))
            solved = -inverse @ rows
            np.put_along_axis(solved, local[:, None], 0.0, axis=2)
            dofs = self.layout.triangle_dofs(triangles[here])
            at = np.take_along_axis(dofs, local, axis=1)
            out.append(_Elimination(triangles[here], chosen, dofs, at, local, solved, inverse))
        return out

    def eliminated(self, triangles: Ints, transform: Floats) -> Floats:
        """Transforms (n, reference dof, dof) of triangles with s in the places of the slopes."""
        out = transform.copy()
        for e in self._eliminations:
            place = np.minimum(np.searchsorted(e.triangles, triangles), len(e.triangles) - 1)
            here = np.flatnonzero(e.triangles[place] == triangles)
            its = place[here]
            local, before = e.local[its][:, None], out[here]
            own = np.take_along_axis(before, local, axis=2)
            after = before + own @ e.rows[its]
            np.put_along_axis(after, local, own @ e.inverse[its], axis=2)
            out[here] = after
        return out

    def fill(self, d: Floats) -> None:
        """Set the slopes in physical degrees of freedom (dof,) or (dof, n) that hold s in their places before."""
        columns = d.reshape(len(d), -1)
        found = [e.rows @ columns[e.dofs] + e.inverse @ columns[e.at] for e in self._eliminations]
        for e, values in zip(self._eliminations, found, strict=True):
            d[e.at] = values.reshape(*e.at.shape, *d.shape[1:])

    def gathered(self, f: Floats) -> Floats:
        """Loads (dof, n) on physical degrees of freedom as those with s in the places of the slopes: `fill` turned."""
        out = f.copy()
        out[self.slots] = 0.0
        for e in self._eliminations:
            own = f[e.at]
            np.add.at(out, e.dofs, e.rows.swapaxes(1, 2) @ own)
            out[e.at] += e.inverse.swapaxes(1, 2) @ own
        return out

    def released(self, r: Floats) -> Floats:
        """(n,) what holds the slopes, whose rows are taken out of a residual (dof,) on physical degrees of freedom."""
        out = np.zeros(len(self.edges))
        for e in self._eliminations:
            own = (r[e.at][:, None] @ e.inverse)[:, 0]
            out[e.number] = own
            np.subtract.at(r, e.dofs, (own[:, None] @ self.rows[e.number])[:, 0])
        return out

    def matrix(self) -> sp.csr_matrix:
        """(dof, dof) what `fill` does."""
        size = (self.layout.count, self.layout.count)
        kept = np.ones(self.layout.count)
        kept[self.slots] = 0.0
        out = sp.csr_matrix(sp.diags(kept))
        for e in self._eliminations:
            rows = e.rows.copy()
            np.put_along_axis(rows, e.local[:, None], e.inverse, axis=2)
            of_row, of_column = (
                np.broadcast_to(x, rows.shape).ravel() for x in (e.at[..., None], e.dofs[:, None])
            )
            out = out + sp.csr_matrix((rows.ravel(), (of_row, of_column)), shape=size)
        return sp.csr_matrix(out)
