"""Where the unknowns of Argyris functions on a chart live, with more than one set of them beside lines inside.

Argyris functions have continuous first derivatives and one Hessian per vertex. Across a line where the stiffness
jumps, or that is held or loaded, the displacement of a shell is continuous and so is its rotation about the line, but
strains in the surface may jump. Each fan of triangles between such lines therefore has derivatives of its own at
the vertex, and each side of an edge of a line a slope of its own at the middle. Across an edge with direction T is tied

    u,  u,T,  u,TT,   n . u,m,  (n . u,m),T        at its ends,    n . u,m    in the middle

which makes u exactly continuous, and the rotation exactly along straight lines and generators, and on others at five
conditions an edge; on a hinge u alone is tied. Where a line ends, turns or branches strains are not bounded; to follow
them better all edges at such a vertex separate fans, tied by all first derivatives across the edges that are no line.

Nodes are numbered: vertices with their first fans, edges with their first sides, further fans, second sides.

Symbols as in `kshell.shell.chart.edges`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.fans import fans_between
from kshell.mesh.mesh import Mesh

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

# a line that turns by less at a vertex is a curve there, followed by chords: 18 edges around a circle
CURVED_UP_TO = np.cos(np.radians(20.0))
# the cosine of a turn that is rounding
STRAIGHT = 1.0 - 1e-10


@dataclass(frozen=True)
class Ties:
    """Pairs of fans across edges that separate them, at one end of each.

    Attributes
    ----------
    fans : (n, 2)
    vertex : (n,)
    tangent : (n, 2)
        Unit direction T in the parameter plane, of a curved line the mean of its two edges.
    line : (n,)
        Whether strains may jump; if not, all first derivatives are continuous.
    hinge : (n,)
        Whether both sides turn freely.
    """

    fans: Ints
    vertex: Ints
    tangent: Floats
    line: Flags
    hinge: Flags


class Nodes:
    """Fans of vertices and sides of edges of a parameter mesh.

    Parameters
    ----------
    mesh : Mesh
        In the parameter plane.
    lines : (edge,) flags, optional
        Edges inside across which strains may jump.
    held : (edge,) flags, optional
        Those of them that supports hold, whose ends count as such where the line goes on, too.
    hinged : (edge,) flags, optional
        Edges inside about which both sides turn freely.

    Attributes
    ----------
    corner : (triangle, 3) fan of each corner
    vertex : (fan,) vertex of each fan
    lines, hinged : (edge,) flags
        Edges with two sides, and those of them that are hinges.
    second : (line edge,) the edges with two sides
    ends : (n,) vertices inside where a line ends, turns or branches
    curved : (n,) vertices inside where a line is curved in the parameter plane
    scalars : int
        Number of scalar degrees of freedom: 6 a fan, 1 a side.
    """

    def __init__(
        self,
        mesh: Mesh,
        lines: Flags | None = None,
        held: Flags | None = None,
        hinged: Flags | None = None,
    ) -> None:
        self.mesh = mesh
        inside = mesh.edge_counts > 1
        none = np.zeros(len(mesh.edges), dtype=bool)
        self.hinged: Flags = none if hinged is None else hinged & inside
        self.lines: Flags = self.hinged | (none if lines is None else lines & inside)
        self.second: Ints = np.flatnonzero(self.lines)
        self._onward, self.ends, self.curved = self._along(self.second)
        for some in (held, hinged):
            if some is not None:
                own = self._along(np.flatnonzero(some & inside))[1]
                self.ends = np.union1d(self.ends, own)
                self.curved = np.setdiff1d(self.curved, own)
        at_end = np.zeros(len(mesh.points), dtype=bool)
        at_end[self.ends] = True
        self._cut = (self.lines[:, None] | at_end[mesh.edges]) & inside[:, None]  # (edge, end)
        self.corner, self.vertex = fans_between(mesh, self._cut)
        self.first_fan = 6 * len(mesh.points) + len(mesh.edges)
        self.first_side = self.first_fan + 6 * (len(self.vertex) - len(mesh.points))
        self.scalars = self.first_side + len(self.second)

    # numbers of scalar degrees of freedom

    def fan_scalars(self, fans: NDArray[np.integer]) -> Ints:
        """(..., 6) of fans."""
        fans = np.asarray(fans, dtype=np.int64)
        vertices = len(self.mesh.points)
        first = np.where(fans < vertices, 6 * fans, self.first_fan + 6 * (fans - vertices))
        return first[..., None] + np.arange(6)

    def side_scalars(self, edges: NDArray[np.integer], side: int | Ints) -> Ints:
        """(n,) of edges, on their first or second side; both are one where no line runs along."""
        edges = np.asarray(edges, dtype=np.int64)
        first = 6 * len(self.mesh.points) + edges
        place = np.searchsorted(self.second, edges)
        return np.where((np.asarray(side) == 1) & self.lines[edges], self.first_side + place, first)

    @cached_property
    def triangle_scalars(self) -> Ints:
        """(triangle, 21)."""
        mesh = self.mesh
        side = np.zeros(mesh.triangle_edges.shape, dtype=np.int64)
        if len(self.second):
            owner = mesh.edge_owner[mesh.triangle_edges, 0]
            side = (owner != np.arange(len(mesh.triangles))[:, None]).astype(np.int64)
        edges = self.side_scalars(mesh.triangle_edges, side)
        return np.concatenate([self.fan_scalars(self.corner).reshape(-1, 18), edges], axis=1)

    @cached_property
    def groups(self) -> tuple[NDArray[np.integer], Ints]:
        """(triangle, 6) nodes of triangles, and the number (node,) of scalars at each."""
        mesh = self.mesh
        vertices, edges = len(mesh.points), len(mesh.edges)
        fans = np.where(self.corner < vertices, self.corner, self.corner + edges)
        further = len(self.vertex) - vertices
        sides = self.triangle_scalars[:, 18:] - 6 * vertices
        sides = np.where(sides < edges, sides, sides - 6 * further + further)
        sizes = np.repeat([6, 1, 6, 1], [vertices, edges, further, len(self.second)])
        return np.concatenate([fans, vertices + sides], axis=1), sizes

    def spread(self, at_vertices: Floats, at_edges: Floats) -> Floats:
        """(scalar, ...) from the values (vertex, 6, ...) and (edge, ...) that all their fans and sides have."""
        shape = at_edges.shape[1:]
        further = at_vertices[self.vertex[len(self.mesh.points) :]].reshape(-1, *shape)
        return np.concatenate([at_vertices.reshape(-1, *shape), at_edges, further, at_edges[self.second]])

    # what lies beside edges

    @cached_property
    def _beside(self) -> Ints:
        """(2, edge) triangles on both sides, the same one twice at the boundary."""
        return np.asarray(self.mesh.edge_table.sides // 3)

    def fans_at(self, edges: NDArray[np.integer], side: int) -> Ints:
        """(n, 2) fans at the lower and the higher vertex of edges, of the triangle on one side."""
        if len(self.vertex) == len(self.mesh.points):
            return self.mesh.edges[edges].astype(np.int64)
        triangles = self._beside[side, edges]
        corners = self.mesh.triangles[triangles][:, None] == self.mesh.edges[edges][:, :, None]
        return np.asarray(self.corner[triangles[:, None], np.argmax(corners, axis=2)], dtype=np.int64)

    def sides_in(self, triangles: NDArray[np.integer]) -> list[tuple[Ints, int]]:
        """Edges of triangles with the side on which they lie."""
        edges = np.unique(self.mesh.triangle_edges[triangles]).astype(np.int64)
        chosen = np.zeros(len(self.mesh.triangles), dtype=bool)
        chosen[triangles] = True
        return [(edges[chosen[self._beside[side, edges]]], side) for side in range(2)]

    @cached_property
    def ties(self) -> Ties:
        """What is tied at vertices."""
        mesh = self.mesh
        edges = np.flatnonzero(self._cut.any(axis=1))
        away = _directions(mesh, edges)
        at_end = np.zeros(len(mesh.points), dtype=bool)
        at_end[self.ends] = True
        fans, vertex, tangent, line, hinge = [], [], [], [], []
        pairs = np.stack([self.fans_at(edges, side) for side in range(2)], axis=2)  # (edge, end, side)
        for end in range(2):
            v = mesh.edges[edges, end].astype(np.int64)
            chosen = np.flatnonzero(self._cut[edges, end] & (pairs[:, end, 0] != pairs[:, end, 1]))
            t = away.copy()
            for k in chosen[~at_end[v[chosen]]]:
                onward = self._onward.get((int(edges[k]), int(v[k])))
                if onward is not None:
                    t[k] = onward
            fans.append(pairs[chosen, end])
            vertex.append(v[chosen])
            tangent.append(t[chosen])
            line.append(self.lines[edges[chosen]])
            hinge.append(self.hinged[edges[chosen]])
        return Ties(*(np.concatenate(part) for part in (fans, vertex, tangent, line, hinge)))

    def _along(self, edges: Ints) -> tuple[dict[tuple[int, int], Floats], Ints, Ints]:
        """Tangents of lines at (edge, vertex) inside, vertices where lines end, and those where they are curved."""
        mesh = self.mesh
        outer = np.zeros(len(mesh.points), dtype=bool)
        outer[mesh.edges[mesh.boundary_edges]] = True
        around: dict[int, list[tuple[int, Floats]]] = {}
        for e, t in zip(edges.tolist(), _directions(mesh, edges), strict=True):
            for v, direction in zip(mesh.edges[e].tolist(), (t, -t), strict=True):
                if not outer[v]:
                    around.setdefault(v, []).append((e, direction))
        onward: dict[tuple[int, int], Floats] = {}
        ends, curved = [], []
        for v, found in sorted(around.items()):
            directions = np.array([t for _, t in found])
            cosine = -(directions @ directions.T)
            partner = np.argmax(cosine, axis=1)
            if cosine.max(axis=1).min() < CURVED_UP_TO:
                ends.append(v)
                continue
            if cosine.max(axis=1).min() < STRAIGHT:
                curved.append(v)
            for k, (e, t) in enumerate(found):
                mean = t - directions[partner[k]]
                onward[e, v] = mean / np.linalg.norm(mean)
        return onward, np.array(ends, dtype=np.int64), np.array(curved, dtype=np.int64)


def _directions(mesh: Mesh, edges: Ints) -> Floats:
    """(n, 2) unit directions of edges in the parameter plane."""
    ends = mesh.points[mesh.edges[edges], :2]
    t = ends[:, 1] - ends[:, 0]
    return np.asarray(t / np.linalg.norm(t, axis=1, keepdims=True))
