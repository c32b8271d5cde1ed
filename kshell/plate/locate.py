"""Which triangle a point lies in, and the nearest point of the plate when it lies in none."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.plate.domain import Domain

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FEW = 64  # triangles that are all looked at, for as many points
INSIDE = -1e-9  # smallest barycentric coordinate of a point that counts as inside
AT_CURVED_EDGE = -0.3  # how far outside the straight triangle its polynomial may be used at a curved edge


@dataclass(frozen=True)
class Located:
    """Points in triangles.

    Attributes
    ----------
    triangles : (n,) int array
    xi : (n, 1, 2) array
        Reference coordinates.
    xy : (n, 2) array
        The points used: the nearest ones of the plate.
    distance : (n,) array
        How far they were moved.
    """

    triangles: Ints
    xi: Floats
    xy: Floats
    distance: Floats


class Locator:
    """Point location on a planar mesh."""

    def __init__(self, domain: Domain) -> None:
        self.domain = domain

    @cached_property
    def _tree(self) -> Any:
        from scipy.spatial import cKDTree

        return cKDTree(self.domain.points[self.domain.mesh.triangles].mean(axis=1))

    def find(self, xy: Floats) -> Located:
        """Locate points (n, 2)."""
        n_triangles = len(self.domain.mesh.triangles)
        best = np.zeros(len(xy), dtype=np.int64)
        depth = np.full(len(xy), -np.inf)
        todo = np.arange(len(xy))
        for count in (
            3,
            12,
            64,
        ):  # near triangles first; on graded meshes the right one may be far down the list
            if not len(todo):
                break
            if n_triangles <= FEW and len(todo) <= FEW:
                near = np.broadcast_to(np.arange(n_triangles), (len(todo), n_triangles))
            else:
                near = self._tree.query(xy[todo], k=min(count, n_triangles))[1].reshape(len(todo), -1)
            self._improve(xy, todo, near, best, depth)
            todo = todo[depth[todo] < INSIDE]
        outside = []
        for k in todo:  # outside the mesh, or in a very uneven one: look at every triangle
            everything = np.arange(n_triangles)[None]
            self._improve(xy, np.array([k]), everything, best, depth)
            if depth[k] < INSIDE:
                outside.append(k)
        located = xy.copy()
        for k in outside:
            best[k], located[k] = self._nearest(xy[k])
        affine = self.domain.affine(best)
        xi = affine.reference_coordinates(located[:, None])
        return Located(best, xi, located, np.linalg.norm(located - xy, axis=1))

    def _improve(self, xy: Floats, which: Ints, candidates: Ints, best: Ints, depth: Floats) -> None:
        """Keep for each point the candidate (point, candidate) in which it lies deepest."""
        n, m = candidates.shape
        affine = self.domain.affine(candidates.ravel())
        points = np.repeat(xy[which], m, axis=0)[:, None]
        smallest = _smallest_barycentric(affine.reference_coordinates(points)[:, 0]).reshape(n, m)
        choice = smallest.argmax(axis=1)
        found = smallest[np.arange(n), choice]
        better = found > depth[which]
        best[which[better]] = candidates[np.arange(n), choice][better]
        depth[which[better]] = found[better]

    def _nearest(self, point: Floats) -> tuple[int, Floats]:
        """Nearest triangle and nearest point of the plate to a point outside the straight triangles."""
        corners = self.domain.points[self.domain.mesh.triangles]
        start, along = corners, np.roll(corners, -1, axis=1) - corners
        s = np.clip(((point - start) * along).sum(-1) / (along**2).sum(-1), 0.0, 1.0)
        foot = start + s[..., None] * along
        distance = np.linalg.norm(foot - point, axis=-1)
        t, edge = np.unravel_index(int(distance.argmin()), distance.shape)
        if self.domain.is_curved[t]:
            affine = self.domain.affine(np.array([t]))
            depth = _smallest_barycentric(affine.reference_coordinates(point[None, None])[0])[0]
            if depth > AT_CURVED_EDGE and self._behind_curve(int(t), point):
                return int(t), point
        return int(t), foot[t, edge]

    def _behind_curve(self, triangle: int, point: Floats) -> bool:
        """Whether a point just outside a straight triangle lies inside its curved edge, up to rounding."""
        edges = self.domain.mesh.triangle_edges[triangle]
        edges = edges[self.domain.mesh.edge_counts[edges] == 1].astype(np.int64)
        s = np.linspace(0.0, 1.0, 65)
        patch = self.domain.edge_points(edges, s, np.ones(65))
        offset = point - patch.xy
        nearest = np.unravel_index(int((offset**2).sum(-1).argmin()), offset.shape[:2])
        size = self.domain.mesh.edge_lengths[edges[nearest[0]]]
        return bool((offset[nearest] * patch.normal[nearest]).sum() < 1e-3 * size)


def _smallest_barycentric(xi: Floats) -> Floats:
    return np.minimum(np.minimum(xi[..., 0], xi[..., 1]), 1 - xi[..., 0] - xi[..., 1])
