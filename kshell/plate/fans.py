"""Fans: the triangles around a vertex between lines across which second derivatives may jump.

Quintics of Argyris have one Hessian H per vertex. Where a line crosses the plate at which the stiffness jumps, or the
rotation is held, the solution has one on each side. Each fan of triangles between such lines therefore has an H of
its own, and across a line with tangent t

    (H_1 - H_2) t = 0

keeps the deflection continuously differentiable: with w and grad w common, the tangential derivatives of w_t and w_n
agree on both sides. What is left free is w_nn on either side of a straight line, two jumps where two lines
cross, none at a kink or at the end of a line. There the exact H is not bounded; to follow it better all edges
at such a vertex count as lines (Hessians of a macro element: L. L. Schumaker, Approximation Theory II (1976) 365-386).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.fans import fans_between
from kshell.mesh.mesh import Mesh
from kshell.plate.domain import Domain
from kshell.scene.lines import InnerLines

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

STRAIGHT_ON = np.cos(np.radians(1.0))  # of the angle between tangents of one line at a vertex


@dataclass(frozen=True)
class Fans:
    """Fans of a mesh, numbered from 0: first one for each vertex, then the further ones.

    Attributes
    ----------
    corner : (triangle, 3) int array
        Fan of each corner of each triangle.
    vertex : (fan,) int array
        Vertex of each fan.
    tied : (n, 2) int array
        Fans on both sides of a line.
    tangent : (n, 2) array
        Of these lines at the vertex.
    ends : (n,) int array
        Vertices inside the plate where a line ends or turns.
    vertex_count : int
    """

    corner: NDArray[np.integer]
    vertex: Ints
    tied: Ints
    tangent: Floats
    ends: Ints
    vertex_count: int

    @property
    def extra(self) -> int:
        """How many fans there are beyond one for each vertex."""
        return len(self.vertex) - self.vertex_count


def make_fans(domain: Domain, lines: InnerLines) -> Fans:
    """The fans between the lines of a plate."""
    mesh = domain.mesh
    if not (lines.jump | lines.held).any():
        return one_fan(mesh)
    # what is held may end where a step goes on
    ends = np.union1d(_ends(domain, lines.jump | lines.held), _ends(domain, lines.held))
    at_end = np.zeros(len(mesh.points), dtype=bool)
    at_end[ends] = True
    cut = np.repeat(lines.jump[:, None], 2, axis=1) | at_end[mesh.edges]  # (edge, end)
    cut &= (mesh.edge_counts > 1)[:, None]
    corner, vertex = fans_between(mesh, cut)
    tied, tangent = _ties(domain, cut, corner)
    return Fans(corner, vertex, tied, tangent, ends, len(mesh.points))


def one_fan(mesh: Mesh) -> Fans:
    """Without lines: every vertex has one fan."""
    none = np.zeros(0, dtype=np.int64)
    vertices = np.arange(len(mesh.points))
    return Fans(mesh.triangles, vertices, none.reshape(0, 2), np.zeros((0, 2)), none, len(vertices))


def _ends(domain: Domain, line: Flags) -> Ints:
    """Vertices inside where an edge of some (edge,) has no other in its direction."""
    mesh = domain.mesh
    edges = np.flatnonzero(line)
    if not len(edges):
        return edges
    outer = np.zeros(len(mesh.points), dtype=bool)
    outer[mesh.edges[mesh.boundary_edges]] = True
    away = domain.tangents(edges) * np.array([1.0, -1.0])[:, None]  # (edge, end, 2), out of the vertex
    around: dict[int, list[Floats]] = {}
    for pair, directions in zip(mesh.edges[edges].tolist(), away, strict=True):
        for v, direction in zip(pair, directions, strict=True):
            if not outer[v]:
                around.setdefault(v, []).append(direction)
    found = [v for v, directions in around.items() if not _all_go_on(np.array(directions))]
    return np.array(sorted(found), dtype=np.int64)


def _all_go_on(directions: Floats) -> bool:
    return bool(((directions @ directions.T).min(axis=1) < -STRAIGHT_ON).all())


def _ties(domain: Domain, cut: Flags, corner: Ints) -> tuple[Ints, Floats]:
    """Pairs of fans across the lines at each end of each cut edge, and the tangents there."""
    mesh = domain.mesh
    edges = np.flatnonzero(cut.any(axis=1))
    tangents = domain.tangents(edges)
    pairs, directions = [], []
    sides = domain.sides(edges)  # (side, edge) triangles
    for end in range(2):
        vertex = mesh.edges[edges, end]
        fans = np.stack(
            [corner[t, np.argmax(mesh.triangles[t] == vertex[:, None], axis=1)] for t in sides], axis=1
        )
        chosen = cut[edges, end] & (fans[:, 0] != fans[:, 1])
        pairs.append(fans[chosen])
        directions.append(tangents[chosen, end])
    return np.concatenate(pairs).reshape(-1, 2), np.concatenate(directions).reshape(-1, 2)
