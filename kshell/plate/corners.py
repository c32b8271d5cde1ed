"""Corners where the moments of a plate are infinite, so that the user hears of it.

Near a corner of interior angle omega the deflection goes like r^lambda with lambda < 2 (and moments like
r^(lambda - 2)) between simply supported edges from omega = 90 degrees on, lambda = pi / omega, mildly so
up to about 120 degrees; between clamped or free edges beyond 180 degrees. Source: M. L. Williams, Proc. 1st US
Nat. Congr. Appl. Mech. (1952) 325-329.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.mesh import Mesh
from kshell.mesh.words import count, place
from kshell.plate.curves import EdgeCurves
from kshell.plate.held import Supports
from kshell.plate.rims import edge_curves

Floats = NDArray[np.float64]

OBTUSE = np.radians(120.0)
RE_ENTRANT = np.radians(190.0)
SMOOTH = 1 - 1e-6  # cosine between tangents that belong to one smooth line


def corner_angles(mesh: Mesh, shape: EdgeCurves | None = None) -> dict[int, float]:
    """Interior angle (radians) at each corner of the boundary, by vertex.

    ``shape`` of the boundary edges saves rebuilding it where it is known.
    """
    curves = edge_curves(mesh, mesh.boundary_edges) if shape is None else shape
    count, at = len(mesh.points), mesh.edges[curves.edges].ravel()
    if not len(at):
        return {}
    x, y = (np.bincount(at, curves.tangent[..., k].ravel(), count) for k in range(2))
    # of two unit vectors |a + b|^2 = 2 + 2 a.b
    cosine = 0.5 * (x * x + y * y) - 1.0
    at_corner = (np.bincount(at, minlength=count) == 2) & (np.abs(cosine) < SMOOTH)
    if not at_corner.any():
        return {}
    triangle, local = np.nonzero(at_corner[mesh.triangles])
    vertex, after, before = (mesh.triangles[triangle, (local + step) % 3] for step in range(3))
    a, b = mesh.points[after] - mesh.points[vertex], mesh.points[before] - mesh.points[vertex]
    cosine = (a * b).sum(1) / np.sqrt((a * a).sum(1) * (b * b).sum(1))
    total = np.bincount(vertex, np.arccos(np.minimum(np.maximum(cosine, -1.0), 1.0)), count)
    return {v: float(total[v]) for v in np.flatnonzero(at_corner).tolist()}


def infinite_moments(mesh: Mesh, supports: Supports, angles: Mapping[int, float]) -> dict[int, str]:
    """Corners where moments grow without bound as the mesh is refined, with their kind, from the `corner_angles`."""
    if max(angles.values(), default=0.0) <= OBTUSE:
        return {}
    held = np.zeros(len(mesh.edges), dtype=bool)
    clamped = np.zeros(len(mesh.edges), dtype=bool)
    for group in supports.held:
        held[group.line] = True
        turned = np.zeros(len(mesh.edges), dtype=bool)
        turned[group.edges] = True
        clamped[group.line] |= turned[group.line]
    around: dict[int, list[int]] = {}
    for e in mesh.boundary_edges.tolist():
        for v in mesh.edges[e].tolist():
            around.setdefault(v, []).append(e)
    out = {}
    for v, angle in angles.items():
        edges = around[v]
        if angle > RE_ENTRANT:
            out[v] = "re-entrant corner"
        elif angle > OBTUSE and held[edges].all() and not clamped[edges].all():
            out[v] = "obtuse supported corner"
    return out


def singular_corners(mesh: Mesh, found: Mapping[int, str], angles: Mapping[int, float]) -> list[str]:
    """Warnings about corners of `infinite_moments`, that need a mesh refined towards them."""
    out = []
    for kind in sorted(set(found.values())):
        corners = [(v, angles[v]) for v in found if found[v] == kind]
        v, angle = max(corners, key=lambda corner: corner[1])
        out.append(
            f"{count(len(corners), kind)}: at {place(mesh.points[v])} the edges meet at {np.degrees(angle):.0f} "
            "degrees inside the plate, where moments grow without bound; values near it depend on the mesh, and "
            "the deflection converges slowly: refine the mesh towards the corner"
        )
    return out
