"""Points of a plate: the triangle each lies in, or the nearest point of the plate where it lies in none."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.closest import Locator
from kshell.plate.domain import Domain

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# distance from a triangle at a curved edge, in its size, below which a point lies on the plate: between the true edge
# and the parabola through its ends and its middle
AT_CURVE = 1e-3
ROUNDING = 1e-12  # the same at straight edges
FEW, KEPT = 16, 256  # points asked for at once that are kept, and how many


@dataclass(frozen=True)
class Located:
    """Points in triangles.

    Attributes
    ----------
    triangles : (n,) int array
    xi : (n, 1, 2) array
        Reference coordinates in the straight triangle; beyond it, for points between a chord and its curved edge.
    xy : (n, 2) array
        The points used: the nearest ones of the plate.
    distance : (n,) array
        How far they were moved.
    """

    triangles: Ints
    xi: Floats
    xy: Floats
    distance: Floats

    def of(self, place: int) -> Located:
        """One of them."""
        one = slice(place, place + 1)
        return Located(self.triangles[one], self.xi[one], self.xy[one], self.distance[one])

    @classmethod
    def together(cls, parts: Sequence[Located]) -> Located:
        """All of them, in arrays that may be changed."""
        columns = zip(*((p.triangles, p.xi, p.xy, p.distance) for p in parts), strict=True)
        return cls(*(np.concatenate(column) for column in columns))


class PlatePoints:
    """Point location on a planar mesh with curved edges."""

    def __init__(self, domain: Domain) -> None:
        self.domain = domain
        self._known: dict[bytes, Located] = {}

    @cached_property
    def _locator(self) -> Locator:
        """Of the triangles in the plane z = 0, of order 2 where there are curved edges."""
        domain, mesh = self.domain, self.domain.mesh
        curves = domain.curves
        nodes = domain.points[mesh.triangles]
        if curves.curved.any():
            middles = domain.points[mesh.edges].mean(axis=1)
            middles[curves.edges] += curves.deviation(np.arange(len(curves.edges)), np.array([0.5]))[:, 0]
            nodes = np.concatenate([nodes, middles[mesh.triangle_edges]], axis=1)
        return Locator(np.concatenate([nodes, np.zeros((*nodes.shape[:2], 1))], axis=2))

    def find(self, xy: Floats) -> Located:
        """Locate points (n, 2); where few are asked for, as of probes, each of them once."""
        if len(xy) > FEW or not len(xy):
            return self._find(xy)
        keys = [point.tobytes() for point in xy]
        if len(self._known) >= KEPT:
            self._known.clear()
        new = [k for k, key in enumerate(keys) if key not in self._known]
        if new:
            found = self._find(xy[new])
            self._known.update({keys[k]: found.of(place) for place, k in enumerate(new)})
        return Located.together([self._known[key] for key in keys])

    def _find(self, xy: Floats) -> Located:
        found = self._locator.find(np.concatenate([xy, np.zeros((len(xy), 1))], axis=1))
        triangles, nearest = found.triangles, found.x[:, :2].copy()
        affine = self.domain.affine(triangles)
        tolerance = np.where(self.domain.is_curved[triangles], AT_CURVE, ROUNDING)
        close = found.distance < tolerance * np.sqrt(np.abs(affine.determinant))
        nearest[close] = xy[close]
        if len(self.domain.bent):
            triangles = self._across_lines(triangles, nearest)
            affine = self.domain.affine(triangles)
        xi = affine.reference_coordinates(nearest[:, None])
        return Located(triangles, xi, nearest, np.where(close, 0.0, found.distance))

    def _across_lines(self, triangles: Ints, xy: Floats) -> Ints:
        """The triangles on the true side of curved edges inside, for points between chord and curve."""
        domain, mesh = self.domain, self.domain.mesh
        out = triangles.copy()
        for k in range(3):
            edges = mesh.triangle_edges[triangles, k].astype(np.int64)
            at = np.flatnonzero(np.isin(edges, domain.bent))
            if not len(at):
                continue
            edges = edges[at]
            a, b = (domain.points[mesh.edges[edges, end]] for end in range(2))
            chord, offset = b - a, xy[at] - a
            square = (chord**2).sum(axis=1)
            place = domain.curves.place(edges)
            s = np.clip((offset * chord).sum(axis=1) / square, 0.0, 1.0)
            for _ in range(2):  # the curve drifts a little along its chord
                shift = _deviation(domain, place, s)
                s = np.clip(((offset - shift) * chord).sum(axis=1) / square, 0.0, 1.0)
            beyond = offset - _deviation(domain, place, s) - s[:, None] * chord
            normal = np.stack([chord[:, 1], -chord[:, 0]], axis=1)
            own = domain.points[mesh.triangles[triangles[at]]].mean(axis=1) - a
            other_side = (beyond * normal).sum(axis=1) * (own * normal).sum(axis=1) < 0
            sides = domain.sides(edges)
            other = np.where(sides[0] == triangles[at], sides[1], sides[0])
            out[at[other_side]] = other[other_side]
        return out


def _deviation(domain: Domain, place: Ints, s: Floats) -> Floats:
    """(n, 2) from chord to curve, each edge at its own s."""
    shape = domain.curves.shape[place]
    phi = ((s[:, None] ** np.arange(shape.shape[1]))[..., None] * shape).sum(axis=1)
    return (s * (1 - s))[:, None] * phi
