"""Values of plates at points spread over all triangles, for pictures; curved edges are followed."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.mesh import EDGE_VERTICES
from kshell.plate.places import points_3d
from kshell.plate.points import Located
from kshell.plate.recovery import Fields
from kshell.result.deferred import Deferred

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def sampled(fields: Fields, xi: Floats) -> Deferred[Floats]:
    """Fields (triangle, point, k) at reference points (point, 2), as in `kshell.result.sampled`."""
    domain = fields.domain
    every = np.arange(len(domain.mesh.triangles))
    shape = (len(every), len(xi))
    triangles = np.repeat(every, len(xi))
    xy = domain.places(every, xi)
    curved = domain.curved_triangles
    straight = np.flatnonzero(~domain.is_curved)
    beyond = (
        domain.affine(curved).reference_coordinates(xy[curved]) if len(curved) else np.zeros((0, *xi.shape))
    )

    def found(function: Callable[[Ints, Floats, Floats], Floats]) -> Floats:
        """Of straight triangles, which share their points, and of curved ones."""
        parts = [(some, at) for some, at in ((straight, xi), (curved, beyond)) if len(some)]
        values = [function(some, at, xy[some]) for some, at in parts]
        out = np.empty((*shape, values[0].shape[-1]))
        for (some, _), value in zip(parts, values, strict=True):
            out[some] = value
        return out

    def displacement() -> Floats:
        out = np.zeros((*shape, 3))
        out[..., 2:] = found(lambda some, at, _: fields.derivatives(some, at, 0))
        return out

    @cache
    def forces() -> tuple[Floats, Floats]:
        if fields.polynomial_moments:
            return found(fields.moment), found(fields.shear)
        at = Located(
            triangles, np.tile(xi, (len(every), 1))[:, None], xy.reshape(-1, 2), np.zeros(len(triangles))
        )
        moment, shear = fields.forces(at)
        return moment.reshape(*shape, 3), shear.reshape(*shape, 2)

    @cache
    def stresses() -> tuple[Floats, Floats]:
        top, bottom = fields.stresses(forces()[0].reshape(-1, 3), triangles, xy.reshape(-1, 2))
        return top.reshape(*shape, 3), bottom.reshape(*shape, 3)

    def position() -> Floats:
        mesh = domain.mesh
        if mesh.midpoints is None or domain.curves.curved.any():
            return points_3d(domain, xy)
        corners = mesh.points[mesh.triangles]  # of elements that take chords: the shape of the mesh
        weights = np.stack([1 - xi.sum(axis=1), xi[:, 0], xi[:, 1]])
        out = points_3d(domain, xy)
        for edge, (a, b) in enumerate(EDGE_VERTICES):
            aside = mesh.midpoints[mesh.triangle_edges[:, edge]] - 0.5 * (corners[:, a] + corners[:, b])
            out += 4 * (weights[a] * weights[b])[:, None] * aside[:, None]
        return out

    makers: dict[str, Callable[[], Floats]] = {
        "position": position,
        "displacement": displacement,
        "moment": lambda: forces()[0],
        "shear": lambda: forces()[1],
    }
    if fields.section.has_stress:
        makers |= {"stress_top": lambda: stresses()[0], "stress_bottom": lambda: stresses()[1]}
    return Deferred(makers)
