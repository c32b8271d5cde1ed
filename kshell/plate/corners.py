"""Corners where the moments of a plate are infinite, so that the user hears of it.

Near a corner the deflection goes like r^lambda (`kshell.plate.corner_exponents`) and moments like r^(lambda - 2).
Between simply supported edges of interior angle omega lambda = pi / omega: infinite from 90 degrees on, but mildly so
up to about 120; between clamped or free edges beyond 180. Between edges that are held differently smaller angles are
enough: beside a line of symmetry those of half the size. Source: M. L. Williams, Proc. 1st US Nat. Congr. Appl. Mech.
(1952) 325-329.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.mesh import Mesh
from kshell.mesh.words import count, place
from kshell.plate.corner_exponents import corner_exponents
from kshell.plate.corner_stars import Plate
from kshell.plate.curves import EdgeCurves
from kshell.plate.domain import Domain
from kshell.plate.rims import edge_curves

Floats = NDArray[np.float64]

RE_ENTRANT = np.radians(190.0)
STRONG = 1.5 - 1e-6  # exponents from which moments are named: those of supported corners above 120 degrees
# radians up to which moments of plates of one stiffness are known to be finite, or to grow mildly
FINITE = {
    "obtuse supported corner": np.radians(120.0),
    "obtuse symmetry corner": np.radians(120.0),
    "evenly held corner": np.pi,
}
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


def infinite_moments(plate: Plate, angles: Mapping[int, float]) -> dict[int, str]:
    """Corners where moments grow without bound as the mesh is refined, with their kind, from the `corner_angles`."""
    mesh = plate.mesh
    held, turned = (np.zeros(len(mesh.edges), dtype=bool) for _ in range(2))
    for group in plate.supports.held:
        held[group.line] = True
        turned[group.edges] = True
    around: dict[int, list[int]] = {}
    for e in mesh.boundary_edges[np.isin(mesh.edges[mesh.boundary_edges], list(angles)).any(axis=1)].tolist():
        for v in mesh.edges[e].tolist():
            around.setdefault(v, []).append(e)
    kinds = {v: _kind(held[around[v]].tolist(), turned[around[v]].tolist()) for v in angles}
    even = plate.section.uniform
    asked = [
        v for v, a in angles.items() if a <= RE_ENTRANT and not (even and a <= FINITE.get(kinds[v], 0.0))
    ]
    strong: dict[int, float] = {}
    if asked:
        domain = plate.domain
        if not len(domain.boundary.edges):  # of chords
            domain = Domain(mesh, True, domain.bent)
        strong = corner_exponents(plate, domain, asked)
    out = {}
    for v, angle in angles.items():
        if angle > RE_ENTRANT:
            out[v] = "re-entrant corner"
        elif strong.get(v, 2.0) < STRONG:
            out[v] = kinds[v]
    return out


def _kind(held: list[bool], turned: list[bool]) -> str:
    """What a corner is called between two edges of which the deflection is held, and the slope."""
    if held[0] != held[1] or turned[0] != turned[1]:
        return "unevenly supported corner"
    if held[0] != turned[0]:
        return "obtuse supported corner" if held[0] else "obtuse symmetry corner"
    return "evenly held corner"


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
