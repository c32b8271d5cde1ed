"""Triangles in space with their edges and named groups: what checks, builders and `Mesh` stand on.

Edges are numbered as scikit-fem numbers facets (sorted by lower, then higher vertex), and the
edges of a triangle (a, b, c) are (a, b), (b, c), (a, c) in that order.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.mesh import kernels
from kshell.mesh.connected import connected_parts

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

# local vertices of the three edges of a triangle
EDGE_VERTICES = np.array([[0, 1], [1, 2], [0, 2]])
FIRST, SECOND = EDGE_VERTICES.T

KIND_OF_DIMENSION = ("point", "curve", "surface")
# distance from a plane, as a fraction of the mesh size, that still counts as flat
FLAT = 1e-9


@dataclass(frozen=True)
class Group:
    """A named part of a mesh.

    Attributes
    ----------
    dimension : int
        0 for points, 1 for curves, 2 for surfaces.
    members : (n,) int array
        Vertex, edge or triangle indices, sorted, without repetition.
    tag : int or None
        The integer a gmsh file knows the group by.
    lost : int
        Cells the source puts in the group that are no vertex, edge or triangle of the mesh. A group with
        lost cells cannot be selected: a support or load would act on a part of it only.
    """

    dimension: int
    members: Ints
    tag: int | None = None
    lost: int = 0

    @property
    def kind(self) -> str:
        """ "point", "curve" or "surface"."""
        return KIND_OF_DIMENSION[self.dimension]


@dataclass(frozen=True)
class Curving:
    """How the flat triangles of a curved surface were taken, see `kshell.mesh.curving`.

    Attributes
    ----------
    order : int
        The largest order of elements that the nodes are good for.
    reason : str
        Why.
    warnings : tuple of str
    polygonal : bool
        Whether the flat triangles are the shape itself: flat parts, and true folds where they meet.
    """

    order: int
    reason: str
    warnings: tuple[str, ...] = ()
    polygonal: bool = False


@dataclass(frozen=True, eq=False)
class Higher:
    """The nodes of triangles of order 3 or 4, see `kshell.mesh.higher`.

    Attributes
    ----------
    order : int
    nodes : (triangle, node, 3) array
        Places: corners, then edge by edge walked around, then inside.
    """

    order: int
    nodes: Floats


@dataclass(frozen=True, eq=False)
class EdgeTable:
    """The edges of a mesh.

    Attributes
    ----------
    edges : (edge, 2) int array
        Vertices, the lower index first.
    of_triangles : (triangle, 3) int array
        Numbers of the local edges (0, 1), (1, 2), (0, 2).
    counts : (edge,) int array
        How many triangles share each.
    sides : (2, edge) int array
        The first and the last place 3 triangle + local edge at which it occurs.
    """

    edges: Ints
    of_triangles: Ints
    counts: Ints
    sides: NDArray[np.int64]

    def reordered(self, of_triangles: Ints) -> EdgeTable:
        """That of the same triangles with their edges in another order."""
        flat = of_triangles.ravel()
        place, sides = np.arange(len(flat)), np.empty_like(self.sides)
        sides[0, flat[::-1]] = place[::-1]
        sides[1, flat] = place
        return EdgeTable(self.edges, of_triangles, self.counts, sides)


@dataclass(frozen=True, eq=False)
class Triangulation:
    """Triangles in space; what the rest of kshell takes is its subclass `kshell.Mesh`.

    Attributes
    ----------
    points : (vertex, 3) float array
        Vertices only; the mid-edge nodes of an order-2 mesh are in `midpoints`.
    triangles : (triangle, 3) int array
        Vertex indices, consistently oriented within each connected sheet.
    midpoints : (edge, 3) float array or None
        Where the node on each edge lies, for a mesh of order 2.
    groups : dict of str to Group
        Physical groups; a group without a name is called "dimension:tag", e.g. "1:7".
    notes : tuple of str
        What was repaired or is worth knowing, in words for the user.
    source : str
        Where the mesh came from, for messages.
    curving : Curving or None
        Of flat triangles that stand for a curved surface.
    higher : Higher or None
        All nodes of triangles of order 3 and 4 of a file, see `kshell.mesh.higher`.
    parts : (triangle,) int array or None
        Of a file that gmsh has divided: the part of each triangle, from 0.
    """

    points: Floats
    triangles: Ints
    midpoints: Floats | None = None
    groups: dict[str, Group] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    source: str = "mesh"
    curving: Curving | None = None
    higher: Higher | None = None
    parts: Ints | None = None

    @property
    def order(self) -> int:
        """Polynomial order of the geometry by vertices and mid-edge nodes, 1 or 2."""
        return 1 if self.midpoints is None else 2

    @cached_property
    def edge_table(self) -> EdgeTable:
        """All about the edges that follows from the triangles."""
        n = len(self.points)
        if kernels.compiled is not None:
            return _compiled_table(n, self.triangles)
        corners = self.triangles.astype(np.int64)
        one, other = corners[:, FIRST], corners[:, SECOND]
        every = (np.minimum(one, other) * n + np.maximum(one, other)).ravel()
        order = every.argsort()
        rising = every[order]
        new = np.ones(len(every), dtype=bool)
        np.not_equal(rising[1:], rising[:-1], out=new[1:])
        inverse = np.empty(len(every), dtype=np.int64)
        inverse[order] = new.cumsum() - 1
        start = new.nonzero()[0]
        edges = np.empty((len(start), 2), dtype=np.int32)
        key = rising[start]
        edges[:, 0] = low = key // n
        edges[:, 1] = key - low * n
        counts = np.full(len(start), len(every), dtype=np.int32)
        counts[:-1] = start[1:]
        counts -= start.astype(np.int32)
        sides = np.empty((2, len(start)), dtype=np.int64)
        if len(start):
            np.minimum.reduceat(order, start, out=sides[0])
            np.maximum.reduceat(order, start, out=sides[1])
        return EdgeTable(edges, inverse.reshape(-1, 3).astype(np.int32), counts, sides)

    @property
    def edges(self) -> Ints:
        """(edge, 2) vertices of each edge, the lower index first."""
        return self.edge_table.edges

    @property
    def triangle_edges(self) -> Ints:
        """(triangle, 3) edge index of the local edges (0, 1), (1, 2), (0, 2)."""
        return self.edge_table.of_triangles

    @property
    def edge_counts(self) -> Ints:
        """(edge,) how many triangles share each edge."""
        return self.edge_table.counts

    @cached_property
    def edge_owner(self) -> Ints:
        """(edge, 2) one triangle at each edge and its local edge number there (the first one found)."""
        first = self.edge_table.sides[0]
        out = np.empty((len(first), 2), dtype=np.int32)
        out[:, 0] = triangle = first // 3
        out[:, 1] = first - 3 * triangle
        return out

    @cached_property
    def boundary_edges(self) -> Ints:
        """(n,) edges that belong to one triangle only."""
        return (self.edge_counts == 1).nonzero()[0].astype(np.int32)

    @cached_property
    def edge_lengths(self) -> Floats:
        """(edge,) straight length between the end vertices."""
        along = self.points[self.edges[:, 1]] - self.points[self.edges[:, 0]]
        return np.asarray(np.sqrt((along * along).sum(axis=1)))

    @cached_property
    def areas(self) -> Floats:
        """(triangle,) area of the flat triangle between the vertices."""
        a, b, c = (self.points[self.triangles[:, k]].T for k in range(3))
        u, v = b - a, c - a
        x, y, z = u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]
        return np.asarray(0.5 * np.sqrt(x * x + y * y + z * z))

    @cached_property
    def extent(self) -> tuple[float, float, float]:
        """Lengths of the bounding box."""
        x, y, z = (self.points.max(axis=0) - self.points.min(axis=0)).tolist()
        return x, y, z

    @property
    def size(self) -> float:
        """Diagonal of the bounding box."""
        return math.hypot(*self.extent)

    @property
    def is_flat(self) -> bool:
        """Whether all vertices lie in one plane z = const."""
        return self.extent[2] <= FLAT * self.size

    @cached_property
    def sheets(self) -> NDArray[np.int64]:
        """(triangle,) number of the part of the mesh, triangles being connected where they share an edge."""
        one, other = self.edge_table.sides // 3
        if self.edge_counts.max(initial=0) > 2:  # edges where sheets branch
            one, other = one[self.triangle_edges].ravel(), np.repeat(np.arange(len(self.triangles)), 3)
        return connected_parts(len(self.triangles), one, other)[1]

    def edge_index(self, ends: ArrayLike) -> Ints:
        """Edge numbers of vertex pairs.

        Parameters
        ----------
        ends : (n, 2) int array

        Returns
        -------
        (n,) int array, -1 where the mesh has no such edge.
        """
        n = len(self.points)
        pair = np.sort(np.asarray(ends, dtype=np.int64).reshape(-1, 2), axis=1)
        table = self.edges[:, 0].astype(np.int64) * n + self.edges[:, 1]
        key = pair[:, 0] * n + pair[:, 1]
        place = np.minimum(np.searchsorted(table, key), len(table) - 1)
        return np.where(table[place] == key, place, -1).astype(np.int32)


def _compiled_table(vertices: int, triangles: Ints) -> EdgeTable:
    """`Triangulation.edge_table` by compiled loops."""
    most = triangles.size
    edges, counts = np.empty((most, 2), dtype=np.int32), np.empty(most, dtype=np.int32)
    of_triangles, sides = np.empty((len(triangles), 3), dtype=np.int32), np.empty((2, most), dtype=np.int64)
    rooms = np.zeros(vertices + 1, dtype=np.int64), np.empty(most, dtype=np.int64)
    corners = np.ascontiguousarray(triangles, dtype=np.int32)
    found = kernels.compiled.edges_of(corners, *rooms, edges, of_triangles, counts, sides)
    if found < 0:
        raise IndexError(f"a triangle names a vertex that is none of 0 to {vertices - 1}")
    # copies, as twice as many were made room for
    return EdgeTable(edges[:found].copy(), of_triangles, counts[:found].copy(), sides[:, :found].copy())


M = TypeVar("M", bound=Triangulation)

# what depends on points and triangles alone
KEPT = (
    "edge_table",
    "edge_owner",
    "boundary_edges",
    "edge_lengths",
    "areas",
    "extent",
    "sheets",
)


def changed(mesh: M, **changes: Any) -> M:
    """The mesh with other attributes but the same points and triangles; what follows from these is kept."""
    new = replace(mesh, **changes)
    new.__dict__.update({name: mesh.__dict__[name] for name in KEPT if name in mesh.__dict__})
    return new
