"""The curved edges of a plate as its first mesh has them, which all finer meshes follow.

Each mesh draws its own curves through its nodes. New nodes that are put on those of the mesh before drift from the true
shape, a little with every level; here all lie on the curves of the first one, in whose nodes the shape is known.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.halve import halved
from kshell.mesh.mesh import Mesh
from kshell.mesh.refine import Refined, bisect
from kshell.mesh.triangulation import changed
from kshell.plate.curves import EdgeCurves
from kshell.plate.domain import Domain

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Followed:
    """Curved edges of a mesh as parts of those of the first one.

    Attributes
    ----------
    first : Domain
        Of the first mesh; of order 2 with its mid-edge nodes as vertices.
    pieces : (edge of the first mesh, 1 or 2) int array
        Places in the curves of that: a whole edge, or the halves from its lower and its higher vertex to its middle.
    ends : (n, 2) int array
        Vertices of the curved edges, the lower first.
    edge : (n,) int array
        The edge of the first mesh that each is a part of.
    span : (n, 2) array
        From where to where, of [0, 1] from the lower to the higher vertex of that.
    """

    first: Domain
    pieces: Ints
    ends: Ints
    edge: Ints
    span: Floats

    @classmethod
    def of(cls, mesh: Mesh, domain: Domain) -> Followed | None:
        """Of the first mesh; None where no edge is curved."""
        curves = domain.curves
        bent = curves.edges[curves.curved].astype(np.int64)
        if not len(bent):
            return None
        ends = np.sort(domain.mesh.edges[bent].astype(np.int64), axis=1)
        number = np.arange(len(bent))
        span = np.tile([0.0, 1.0], (len(bent), 1))
        if mesh.midpoints is None:
            return cls(domain, curves.place(bent)[:, None], ends, number, span)
        middle = len(mesh.points) + mesh.edge_index(ends)
        fine = halved(replace(mesh, midpoints=None))
        points = fine.points.copy()
        points[middle] = mesh.midpoints[mesh.edge_index(ends)]
        inner = domain.bent
        fine = replace(fine, points=points)
        lines = None
        if len(inner):
            both = np.sort(domain.mesh.edges[inner].astype(np.int64), axis=1)
            halfway = len(mesh.points) + mesh.edge_index(both)
            halves = [np.stack([both[:, end], halfway], axis=1) for end in range(2)]
            lines = fine.edge_index(np.concatenate(halves)).astype(np.int64)
        first = Domain(fine, True, lines)
        parts = [fine.edge_index(np.stack([ends[:, end], middle], axis=1)) for end in range(2)]
        return cls(first, first.curves.place(np.stack(parts, axis=1)), ends, number, span)

    def at(self, edge: Ints, t: Floats) -> Floats:
        """(n, 2) points t (n,) of edges of the first mesh."""
        if self.pieces.shape[1] == 1:
            return self._on(self.pieces[edge, 0], t)
        second = t > 0.5
        return self._on(self.pieces[edge, second.astype(int)], np.where(second, 2.0 - 2.0 * t, 2.0 * t))

    def _on(self, place: Ints, s: Floats) -> Floats:
        """Points s (n,) of curves (n,), by their places."""
        curves: EdgeCurves = self.first.curves
        ends = self.first.points[self.first.mesh.edges[curves.edges[place]]]
        power = s[:, None] ** np.arange(curves.shape.shape[1])
        bump = (s * (1.0 - s))[:, None] * (power[:, :, None] * curves.shape[place]).sum(axis=1)
        return np.asarray((1.0 - s)[:, None] * ends[:, 0] + s[:, None] * ends[:, 1] + bump)

    def bisected(self, mesh: Mesh, marked: NDArray[np.integer]) -> tuple[Refined, Followed]:
        """A mesh in its plane, of order 1 or 2, with triangles cut, new vertices and mid-edge nodes on the curves."""
        bent = mesh.edge_index(self.ends)
        middles = mesh.points[mesh.edges].mean(axis=1)
        half = self.span.mean(axis=1)
        middles[bent, :2] = self.at(self.edge, half)
        refined = bisect(replace(mesh, midpoints=None), marked, middles)
        fine = refined.mesh
        whole = fine.edge_index(self.ends) >= 0
        cut = np.ones(len(mesh.edges), dtype=bool)
        cut[fine.edge_index(mesh.edges) >= 0] = False
        vertex = len(mesh.points) + np.cumsum(cut) - 1
        new = vertex[bent[~whole]]
        ends, edge, span = [self.ends[whole]], [self.edge[whole]], [self.span[whole]]
        for end in range(2):
            ends.append(np.stack([self.ends[~whole, end], new], axis=1))
            edge.append(self.edge[~whole])
            span.append(np.stack([self.span[~whole, end], half[~whole]], axis=1))
        followed = replace(
            self, ends=np.concatenate(ends), edge=np.concatenate(edge), span=np.concatenate(span)
        )
        if mesh.midpoints is None:
            return refined, followed
        midpoints = fine.points[fine.edges].mean(axis=1)
        midpoints[fine.edge_index(followed.ends), :2] = followed.at(followed.edge, followed.span.mean(axis=1))
        return Refined(changed(fine, midpoints=midpoints), refined.parent), followed

    def missed(self, domain: Domain) -> Floats:
        """(edge,) by how much each edge of `Domain.curves` of a finer mesh misses those of the first, in its middle.

        Across the edge: where along it a point lies says nothing of its shape.
        """
        mesh, curves = domain.mesh, domain.curves
        out = np.zeros(len(curves.edges))
        edges = mesh.edge_index(self.ends).astype(np.int64)
        here, speed, bend = (part[:, 0] for part in domain.edge_motion(edges, np.array([0.5])))
        off = self.at(self.edge, self.span.mean(axis=1)) - here
        length = np.linalg.norm(speed, axis=1)
        ahead = (off * speed).sum(axis=1) / length
        across, turn = (part[:, 0] * speed[:, 1] - part[:, 1] * speed[:, 0] for part in (off, bend))
        # the curve itself is off its tangent by half its curvature, turn / length^3, times the square of the way
        out[curves.place(edges)] = np.abs(across / length - 0.5 * turn / length**3 * ahead**2)
        return out
