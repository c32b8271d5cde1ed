"""Which place of the mesh each row of a field belongs to.

Where sheets meet, at folds and branches, or where the section or the moments jump, a vertex has as many values as
there are smooth pieces around it, each of them a row. First come all vertices in the order of the mesh, each with the
first of its pieces, then the further rows; without such lines rows are vertices.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.mesh import Mesh

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


@dataclass(frozen=True, eq=False)
class Rows:
    """Rows of fields.

    Attributes
    ----------
    mesh : Mesh
        In space.
    corner : (triangle, 3) int array
        The row of each corner of each triangle.
    vertex : (row,) int array
    patch_of_triangle : (triangle,) int array
        Number of the smooth piece of each triangle.
    """

    mesh: Mesh
    corner: Ints
    vertex: Ints
    patch_of_triangle: Ints

    @classmethod
    def of_vertices(cls, mesh: Mesh) -> Rows:
        """One row per vertex."""
        patches = np.zeros(len(mesh.triangles), dtype=np.int32)
        return cls(mesh, mesh.triangles, np.arange(len(mesh.points)), patches)

    @classmethod
    def of_patches(cls, mesh: Mesh, patches: Ints) -> Rows:
        """One row per vertex and piece; of several pieces at a vertex the one with the least number comes first."""
        count, triangles = len(mesh.points), mesh.triangles.astype(np.int64)
        key = triangles * (int(patches.max(initial=0)) + 1) + patches[:, None]
        pairs, place = np.unique(key.ravel(), return_inverse=True)
        vertex = pairs // (int(patches.max(initial=0)) + 1)
        first = np.append(True, np.diff(vertex) > 0) if len(vertex) else np.zeros(0, dtype=bool)
        number = vertex.copy()
        number[~first] = count + np.arange(int((~first).sum()))
        return cls(mesh, number[place].reshape(-1, 3), np.append(np.arange(count), vertex[~first]), patches)

    @property
    def extra(self) -> int:
        """How many rows there are beyond one for each vertex."""
        return len(self.vertex) - len(self.mesh.points)

    @property
    def points(self) -> Floats:
        """(row, 3)."""
        return self.mesh.points if not self.extra else self.mesh.points[self.vertex]

    @cached_property
    def patch(self) -> Ints:
        """(row,) number of the smooth piece, -1 at vertices of no triangle."""
        out = np.full(len(self.vertex), -1, dtype=np.int64)
        out[self.corner] = self.patch_of_triangle[:, None]
        return out

    @cached_property
    def group(self) -> NDArray[np.str_]:
        """(row,) the smallest surface group that has all triangles of the row, empty where there is none."""
        names = [name for name, group in self.mesh.groups.items() if group.dimension == 2]
        names.sort(key=lambda name: len(self.mesh.groups[name].members))
        around = np.bincount(self.corner.ravel(), minlength=len(self.vertex))
        chosen = np.zeros(len(self.vertex), dtype=np.int64)
        for number, name in enumerate(names, 1):
            inside = np.bincount(
                self.corner[self.mesh.groups[name].members].ravel(), minlength=len(self.vertex)
            )
            chosen[(chosen == 0) & (inside == around) & (around > 0)] = number
        return np.array(["", *names])[chosen]

    def names_of(self, triangles: Sequence[int]) -> list[str]:
        """Different names for triangles of sheets that meet: a surface group of each that no other belongs to.

        Where there is none, of two in one group, the smallest group with a number, or without groups "sheet".
        """
        groups = [(name, group.members) for name, group in self.mesh.groups.items() if group.dimension == 2]
        groups.sort(key=lambda group: len(group[1]))
        belongs = np.array([np.isin(triangles, members) for _, members in groups]).reshape(
            len(groups), len(triangles)
        )
        out: list[str] = []
        for k in range(len(triangles)):
            own = np.flatnonzero(belongs[:, k])
            alone = own[belongs[own].sum(axis=1) == 1]
            chosen = alone if len(alone) else own
            name = groups[chosen[0]][0] if len(chosen) else "sheet"
            same = sum(each == name or each.startswith(f"{name} (") for each in out)
            out.append(f"{name} ({same + 1})" if same else name)
        return out

    @cached_property
    def _middles(self) -> tuple[Ints, Ints, Ints]:
        ends = np.sort(self.corner[:, [[0, 1], [1, 2], [0, 2]]].astype(np.int64), axis=2).reshape(-1, 2)
        _, first, place = np.unique(
            ends[:, 0] * len(self.vertex) + ends[:, 1], return_index=True, return_inverse=True
        )
        edge = self.mesh.triangle_edges.ravel()[first]
        order = np.argsort(edge, kind="stable")  # as the edges of the mesh, where there is one node each
        back = np.empty(len(order), dtype=np.int64)
        back[order] = np.arange(len(order))
        return ends[first][order], edge[order], back[place].reshape(-1, 3)

    @property
    def middle_ends(self) -> Ints:
        """(middle, 2) rows at both ends of the mid-edge nodes, which like vertices are as many as pieces meet."""
        return self._middles[0]

    @property
    def middle_edge(self) -> Ints:
        """(middle,) edge of the mesh."""
        return self._middles[1]

    @property
    def triangle_middles(self) -> Ints:
        """(triangle, 3) mid-edge nodes on the edges (0, 1), (1, 2), (0, 2)."""
        return self._middles[2]

    @property
    def nodes(self) -> Floats:
        """(node, 3) places of the rows, then of the mid-edge nodes where the mesh has them."""
        if self.mesh.midpoints is None:
            return self.points
        return np.concatenate([self.points, self.mesh.midpoints[self.middle_edge]])

    @property
    def cells(self) -> Ints:
        """(triangle, 3 or 6) their numbers at each triangle."""
        if self.mesh.midpoints is None:
            return self.corner
        return np.concatenate([self.corner, self.triangle_middles + len(self.vertex)], axis=1)
