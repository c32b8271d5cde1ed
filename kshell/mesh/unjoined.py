"""Places where parts of a mesh touch without being joined: doubled vertices, hanging nodes, loose parts.

Only the boundary can be torn: where a vertex is doubled or hangs on an edge, the edges around it belong to
one triangle. So the search looks at boundary edges, and at all vertices only when the mesh has several parts.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.mesh.connected import connected_parts
from kshell.mesh.distinct import distinct
from kshell.mesh.near import in_balls
from kshell.mesh.triangulation import Triangulation
from kshell.mesh.words import count, place

Ints = NDArray[np.signedinteger]
Bools = NDArray[np.bool_]

# vertices closer than this fraction of the shortest edge are at the same place
SAME_PLACE = 1e-4
# a vertex closer to an edge than this fraction of its length is on the edge
ON_EDGE = 1e-6

MERGE = (
    "Join them: in the .geo file `Coherence;` after the geometry (with OpenCASCADE `BooleanFragments`) or "
    "`Coherence Mesh;` at the end, in Python `gmsh.model.mesh.removeDuplicateNodes()`"
)


def unjoined(mesh: Triangulation) -> list[str]:
    """Raise at doubled vertices and hanging nodes; return notes on slits and on parts.

    Two vertices at one place are a slit, not an error, if both belong to named groups of curves or points
    and to the same part of the mesh.
    """
    one = not mesh.sheets.any()
    part = np.zeros(len(mesh.points), dtype=np.int64) if one else vertex_parts(mesh)
    n_parts = int(part.max()) + 1
    boundary = distinct(len(mesh.points), mesh.edges[mesh.boundary_edges])
    tolerance = SAME_PLACE * float(mesh.edge_lengths.min())
    named = _Named(mesh)

    notes: list[str] = []
    if len(boundary) or n_parts > 1:
        candidates = boundary if n_parts == 1 else np.arange(len(mesh.points))
        pairs = _pairs_at_one_place(mesh, candidates, tolerance)
        if len(pairs):
            meant = (part[pairs[:, 0]] == part[pairs[:, 1]]) & named.vertices[pairs].all(axis=1)
            if not meant.all():
                first = pairs[np.flatnonzero(~meant)[0]]
                raise InputError(
                    f"{mesh.source}: {count(int((~meant).sum()), 'pair')} of vertices at the same place that are "
                    f"not joined, e.g. at {place(mesh.points[first[0]])}: the triangles touch there without "
                    f"holding together. {MERGE}. If a slit is meant, give each of its two sides a named physical "
                    "curve"
                )
            notes.append(
                f"slit: {count(len(pairs), 'pair')} of vertices at the same place, e.g. at "
                f"{place(mesh.points[pairs[0, 0]])}"
            )
        _raise_on_hanging_nodes(mesh, boundary, part, named)
    return notes + _parts(mesh, part, n_parts)


def vertex_parts(mesh: Triangulation) -> Ints:
    """(vertex,) number of the part of the mesh, triangles being connected where they share a vertex."""
    return connected_parts(len(mesh.points), *mesh.edges.T)[1]


class _Named:
    """What is named in a mesh, looked up where it matters."""

    def __init__(self, mesh: Triangulation) -> None:
        self._mesh = mesh

    @cached_property
    def vertices(self) -> Bools:
        """(vertex,) whether the vertex belongs to a group of curves or points."""
        mesh = self._mesh
        named = np.zeros(len(mesh.points), dtype=bool)
        for name, group in mesh.groups.items():
            if name == f"{group.dimension}:{group.tag}":  # a number means that nobody thought of this curve
                continue
            if group.dimension == 1:
                named[mesh.edges[group.members]] = True
            elif group.dimension == 0:
                named[group.members] = True
        return named


def _pairs_at_one_place(mesh: Triangulation, candidates: Ints, tolerance: float) -> Ints:
    at = mesh.points[candidates]
    first, second = in_balls(at, at, np.full(len(at), tolerance))
    if len(first) == len(at):  # every one is near itself alone
        return np.zeros((0, 2), dtype=candidates.dtype)
    once = first < second
    pairs: Ints = candidates[np.stack([first[once], second[once]], axis=1)]
    return pairs


def _raise_on_hanging_nodes(mesh: Triangulation, boundary: Ints, part: Ints, named: _Named) -> None:
    """A vertex inside the edge of a triangle it does not belong to."""
    edges = mesh.boundary_edges
    if not len(edges):
        return
    ends = mesh.edges[edges]
    start, along = mesh.points[ends[:, 0]], mesh.points[ends[:, 1]] - mesh.points[ends[:, 0]]
    length = mesh.edge_lengths[edges]
    middle = start + 0.5 * along
    # a ball about the middle that leaves out the two ends
    radius = 0.5 * length * (1 - 1e-6)
    edge, vertex = in_balls(mesh.points[boundary], middle, radius)
    if not len(edge):
        return
    vertex = boundary[vertex]
    offset = mesh.points[vertex] - start[edge]
    share = np.sum(offset * along[edge], axis=1) / length[edge] ** 2
    distance = np.linalg.norm(offset - share[:, None] * along[edge], axis=1)
    own = (mesh.triangles[mesh.edge_owner[edges[edge], 0]] == vertex[:, None]).any(axis=1)  # a thin triangle
    # the two sides of a slit may be meshed differently
    slit = (
        (part[vertex] == part[ends[edge, 0]])
        & named.vertices[vertex]
        & named.vertices[ends[edge]].all(axis=1)
    )
    hangs = (distance < ON_EDGE * length[edge]) & ~own & ~slit
    if hangs.any():
        first = np.flatnonzero(hangs)[0]
        a, b = mesh.points[ends[edge[first]]]
        raise InputError(
            f"{mesh.source}: {count(len(np.unique(vertex[hangs])), 'hanging node')}: the vertex at "
            f"{place(mesh.points[vertex[first]])} lies inside the edge from {place(a)} to {place(b)} of a "
            f"triangle it does not belong to, so the two sides can move apart. {MERGE}, so that both sides "
            "share one curve, and mesh again"
        )


def _parts(mesh: Triangulation, part: Ints, n_parts: int) -> list[str]:
    if n_parts > 1:
        part_of_triangle = part[mesh.triangles[:, 0]]
        sizes = np.bincount(part_of_triangle, minlength=n_parts)
        smallest = int(np.argmin(sizes))
        inside = int(np.flatnonzero(part_of_triangle == smallest)[0])
        middle = mesh.points[mesh.triangles[inside]].mean(axis=0)
        return [
            f"the mesh falls into {n_parts} parts that are not connected; each needs supports of its own. "
            f"The smallest has {count(int(sizes[smallest]), 'triangle')} near {place(middle)}"
        ]
    sheets = mesh.sheets
    n_sheets = int(sheets.max()) + 1
    if n_sheets == 1:
        return []
    seen = np.zeros((len(mesh.points), 2), dtype=np.int64)  # lowest and highest sheet at each vertex
    seen[:, 0] = n_sheets
    np.minimum.at(seen[:, 0], mesh.triangles.ravel(), np.repeat(sheets, 3))
    np.maximum.at(seen[:, 1], mesh.triangles.ravel(), np.repeat(sheets, 3))
    pivot = int(np.flatnonzero(seen[:, 0] < seen[:, 1])[0])
    return [
        f"{n_sheets} parts of the mesh hang together by single vertices only, e.g. at "
        f"{place(mesh.points[pivot])}: they can turn about each other there"
    ]
