"""What is drawn of a result: points on its surface, small flat triangles between them, and values there.

Where the elements are known each triangle of the mesh is divided, the more the fewer there are, and values inside are
those of the element, on edges the mean of both sides within a smooth piece. At the corners they are those of the
fields, and between the least and the largest of these everywhere: the colours are those of the numbers. Else, and of
many triangles, the points are the nodes of the mesh.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from kshell.draw.canvas import flat_triangles
from kshell.draw.pictures import MODAL, column_of, picture_field, picture_values
from kshell.draw.shape import deformed_nodes
from kshell.elements.lattice import numbers, pieces
from kshell.material.tensors import von_mises
from kshell.mesh.mesh import EDGE_VERTICES

if TYPE_CHECKING:
    from kshell.result.result import Result

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

MANY = 5_000  # triangles of the mesh from which they are not divided
ENOUGH = 6_000  # drawn triangles, if they need not be divided
MOST = 12  # parts of a side
VON_MISES = "von_mises_"


def parts_of_sides(result: Result) -> int:
    """Into how many parts the sides of triangles are divided."""
    count = len(result.mesh.triangles)
    if result.sampled is None or result.analysis in MODAL or count > MANY:
        return 1
    return max(2, min(MOST, int(np.sqrt(ENOUGH / count))))


class Drawn:
    """The drawn points of a result.

    Parameters
    ----------
    result : Result
    divided : bool
        Whether triangles may be divided.

    Attributes
    ----------
    rest : (node, 3)
        At rest; first those of the rows of fields.
    triangles : (n, 3) int array
    lines : (edge, point) int array
        Their numbers along the edges of the mesh.
    """

    def __init__(self, result: Result, divided: bool = True) -> None:
        self.result, self.parts = result, parts_of_sides(result) if divided else 1
        if self.parts > 1:
            self._number()
            self.rest = self._at_nodes("position", result.points)
        else:
            self.rest, self.triangles = flat_triangles(result.mesh, result.rows)
            self.lines = self._through_middles()

    def _through_middles(self) -> Ints:
        """Along edges: both ends, between them the node of the mesh where it has one."""
        mesh, rows = self.result.mesh, self.result.rows
        if mesh.midpoints is None:
            return mesh.edges
        middle = np.zeros(len(mesh.edges), dtype=np.int64)
        middle[rows.middle_edge] = len(rows.vertex) + np.arange(len(rows.middle_edge))
        return np.stack([mesh.edges[:, 0], middle, mesh.edges[:, 1]], axis=1)

    def _number(self) -> None:
        """Numbers of nodes: rows, then points on edges of each piece, then points inside triangles."""
        rows, mesh, inner = self.result.rows, self.result.mesh, self.parts - 1
        corners, edges, inside = numbers(self.parts)
        count = len(mesh.triangles)
        number = np.empty((count, len(corners) + edges.size + len(inside)), dtype=np.int64)
        number[:, corners] = rows.corner
        start = len(rows.vertex)
        ends = rows.corner[:, EDGE_VERTICES].astype(np.int64)  # (triangle, edge, 2)
        forward = np.arange(inner)
        along = np.where((ends[..., 0] < ends[..., 1])[..., None], forward, forward[::-1])
        number[:, edges] = start + rows.triangle_middles[..., None] * inner + along
        start += len(rows.middle_edge) * inner
        number[:, inside] = start + np.arange(count * len(inside)).reshape(count, -1)
        self._count = start + count * len(inside)
        self._between = np.concatenate([edges.ravel(), inside])
        self._numbers = number
        self.triangles = number[:, pieces(self.parts)].reshape(-1, 3)
        owner, local = mesh.edge_owner.T
        whole = np.concatenate([corners[EDGE_VERTICES[:, :1]], edges, corners[EDGE_VERTICES[:, 1:]]], axis=1)
        self.lines = number[owner[:, None], whole[local]]

    @cached_property
    def _shares(self) -> Floats:
        """(node,) one over the number of triangles that a node lies in, of those that are not rows."""
        found = np.bincount(self._numbers[:, self._between].ravel(), minlength=self._count)
        return 1.0 / np.maximum(found, 1)

    def _at_nodes(self, name: str, at_rows: Floats) -> Floats:
        """(node, k) a field: at rows as given, elsewhere the mean of the triangles."""
        assert self.result.sampled is not None
        found = self.result.sampled.at(self.parts)
        if name.startswith(VON_MISES):
            values = von_mises(found[f"stress_{name.removeprefix(VON_MISES)}"])[..., None]
        else:
            values = found[name]
        at = self._numbers[:, self._between].ravel()
        out = np.empty((self._count, values.shape[-1]))
        for column in range(out.shape[1]):
            sums = np.bincount(at, values[:, self._between, column].ravel(), self._count)
            out[:, column] = sums * self._shares
        out[: len(at_rows)] = at_rows
        return out

    @cached_property
    def _displacement(self) -> Floats:
        return self._at_nodes("displacement", self.result.fields["displacement"])

    def deformed(self, scale: float) -> Floats:
        """(node, 3) displaced by that times the displacement."""
        if self.parts == 1:
            return deformed_nodes(self.result, scale)[1]
        return self.rest if scale == 0.0 else self.rest + scale * self._displacement

    def values(self, what: str) -> Floats:
        """(node,) what a picture shows, within the range of its values at the nodes of the mesh."""
        marked, _ = picture_values(self.result, what)
        if self.parts == 1:
            return marked
        name, column, _ = picture_field(self.result, what)
        at_rows = self.result.fields[name].reshape(len(self.result.points), -1)
        values = column_of(self._at_nodes(name, at_rows), column)
        return np.clip(values, marked.min(), marked.max())
