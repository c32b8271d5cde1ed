"""Corners where the moments of a plate are infinite, so that the user hears of it.

Near a corner of interior angle omega the deflection goes like r^lambda with lambda < 2 (and moments like
r^(lambda - 2)) between simply supported edges from omega = 90 degrees on, lambda = pi / omega, mildly so
up to about 120 degrees; between clamped or free edges beyond 180 degrees. Source: M. L. Williams, Proc. 1st US
Nat. Congr. Appl. Mech. (1952) 325-329.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.mesh import Mesh
from kshell.mesh.words import count, place
from kshell.plate.curves import edge_curves
from kshell.plate.supports import Supports

Floats = NDArray[np.float64]

OBTUSE = np.radians(120.0)
RE_ENTRANT = np.radians(190.0)
SMOOTH = 1 - 1e-6  # cosine between tangents that belong to one smooth line


def corner_angles(mesh: Mesh) -> dict[int, float]:
    """Interior angle (radians) at each corner of the boundary, by vertex."""
    curves = edge_curves(mesh, mesh.boundary_edges)
    ends = mesh.edges[curves.edges]
    tangents: dict[int, list[Floats]] = {}
    for k, pair in enumerate(ends.tolist()):
        for end, v in enumerate(pair):
            tangents.setdefault(v, []).append(curves.tangent[k, end])
    corners = {v for v, t in tangents.items() if len(t) == 2 and abs(float(t[0] @ t[1])) < SMOOTH}
    total = np.zeros(len(mesh.points))
    x = mesh.points[mesh.triangles]
    for k in range(3):
        a, b = x[:, (k + 1) % 3] - x[:, k], x[:, (k + 2) % 3] - x[:, k]
        cosine = (a * b).sum(1) / (np.linalg.norm(a, axis=1) * np.linalg.norm(b, axis=1))
        np.add.at(total, mesh.triangles[:, k], np.arccos(np.clip(cosine, -1, 1)))
    return {v: float(total[v]) for v in corners}


def singular_corners(mesh: Mesh, supports: Supports) -> list[str]:
    """Warnings about corners that need a mesh refined towards them."""
    held = np.zeros(len(mesh.edges), dtype=bool)
    clamped = np.zeros(len(mesh.edges), dtype=bool)
    for group in supports.held:
        held[group.line] = True
        clamped[np.intersect1d(group.line, group.edges)] = True
    boundary = mesh.boundary_edges
    around: dict[int, list[int]] = {}
    for e in boundary.tolist():
        for v in mesh.edges[e].tolist():
            around.setdefault(v, []).append(e)
    obtuse, re_entrant = [], []
    for v, angle in corner_angles(mesh).items():
        edges = around[v]
        if angle > RE_ENTRANT:
            re_entrant.append((v, angle))
        elif angle > OBTUSE and held[edges].all() and not clamped[edges].all():
            obtuse.append((v, angle))
    out = []
    for corners, kind in ((obtuse, "obtuse supported corner"), (re_entrant, "re-entrant corner")):
        if corners:
            v, angle = max(corners, key=lambda corner: corner[1])
            out.append(
                f"{count(len(corners), kind)}: at {place(mesh.points[v])} the edges meet at {np.degrees(angle):.0f} "
                "degrees inside the plate, where moments grow without bound; values near it depend on the mesh, and "
                "the deflection converges slowly: refine the mesh towards the corner"
            )
    return out
