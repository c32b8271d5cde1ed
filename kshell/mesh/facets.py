"""Whether flat triangles stand for a curved surface: neighbours that meet at many small angles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.orient import shared_edges
from kshell.mesh.triangulation import Triangulation
from kshell.mesh.vectors import cross

Floats = NDArray[np.float64]

# angles between neighbours that are neither rounding nor a fold that is meant as one
SMALLEST, LARGEST = np.radians(0.5), np.radians(30.0)
FEW = 0.1  # part of the inner edges below which such angles are folds of flat sheets


@dataclass(frozen=True)
class Facets:
    """Flat triangles of a curved surface.

    Attributes
    ----------
    angle : float
        Largest angle between neighbours that counts as curvature, radians.
    at : (3,) array
        The middle of that edge.
    """

    angle: float
    at: Floats


def facets(mesh: Triangulation) -> Facets | None:
    """What is curved about a mesh of flat triangles; None for flat sheets, with folds or without, and for order 2."""
    if mesh.midpoints is not None:
        return None
    a, b, c = (mesh.points[mesh.triangles[:, k]] for k in range(3))
    normal = cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    pairs, agree = shared_edges(mesh)
    if not len(pairs):
        return None
    one, other = normal[pairs[:, 0] // 3], normal[pairs[:, 1] // 3]
    other = np.where(agree[:, None], other, -other)
    angle = np.arctan2(np.linalg.norm(cross(one, other), axis=1), np.sum(one * other, axis=1))
    curved = (angle > SMALLEST) & (angle < LARGEST)
    if curved.mean() <= FEW:
        return None
    worst = int(np.argmax(np.where(curved, angle, 0.0)))
    triangle, local = divmod(int(pairs[worst, 0]), 3)
    edge = mesh.triangle_edges[triangle, local]
    return Facets(float(angle[worst]), mesh.points[mesh.edges[edge]].mean(axis=0))
