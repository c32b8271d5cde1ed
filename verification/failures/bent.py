"""Surfaces bent without stretching, or taken with a flat second fundamental form, whose bending energy is known.

The sizes are those of the energy benchmark of the paper "Better Bending: Analysis, Construction and Verification of
Discrete Bending Models for Kirchhoff-Love Shells" (SIGGRAPH 2026):
a half cylinder, the tangent developable of a helix, a half torus, a sphere and a sheet with a crease.

Symbols
-------
D, nu         bending stiffness of a plate, Poisson's ratio
k1, k2        principal curvatures
Koiter        1/2 D integral of  k1^2 + k2^2 + 2 nu k1 k2
squared H     1/2 D integral of  (k1 + k2)^2, which hinges are meant to measure
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kshell.geometry import Chart, Plane, Sphere, Torus
from kshell.mesh.mesh import Mesh
from verification.geometry.meshes import random_sphere

Floats = NDArray[np.float64]
Map = Callable[[Floats], Floats]
Back = Callable[[Floats], tuple[Floats, Floats]]

NU = 0.3
FAMILIES = ("one diagonal", "alternating", "crossed", "irregular")
_PATTERNS = {"alternating": "alternate", "crossed": "crossed"}
SHAKEN = 0.25  # of a cell
RADIUS, HEIGHT = 0.0325, 0.122  # half cylinder
HELIX, PITCH, BREADTH = 0.02, 0.1, 0.1  # radius, rise per turn, and the first ruling's length
AXIS, TUBE = 0.03, 0.015  # half torus
BALL = 0.03
VEE = (0.01, 0.1)


@dataclass(frozen=True)
class Bent:
    """A mesh and the maps that bend it.

    Attributes
    ----------
    mesh : Mesh
        Flat triangles: in a parameter plane, or near the surface.
    place, normal : function
        Points of the flat triangles (n, 3) to the surface and to its unit normal there.
    rest : function or None
        The same points in the flat shape; None: the surface has its own lengths at rest, but no curvature.
    koiter, squared : float
        The exact energies over D.
    """

    mesh: Mesh
    place: Map
    normal: Map
    rest: Map | None
    koiter: float
    squared: float


def _turned(mesh: Mesh, cells: int) -> Mesh:
    """A mesh of one diagonal with that of every other cell, chosen at random, turned."""
    pairs = mesh.triangles.reshape(-1, 2, 3).copy()  # (a, b, c), (a, c, d) of each cell
    chosen = np.random.default_rng(cells).random(len(pairs)) < 0.5
    a, b, c, d = pairs[chosen, 0, 0], pairs[chosen, 0, 1], pairs[chosen, 0, 2], pairs[chosen, 1, 2]
    pairs[chosen] = np.stack([np.stack([a, b, d], 1), np.stack([b, c, d], 1)], 1)
    return Mesh(mesh.points, pairs.reshape(-1, 3))


def rectangle(n_u: int, n_v: int, size: tuple[float, float], family: str, shake: float = SHAKEN) -> Mesh:
    """[0, size] in cells, of one of the `FAMILIES`; in "irregular" meshes inner vertices are moved, too."""
    pattern = _PATTERNS.get(family, "diagonal")
    flat = Plane().mesh(n_u, n_v, order=1, u_range=(0.0, size[0]), v_range=(0.0, size[1]), pattern=pattern)
    if family != "irregular":
        return Mesh(flat.points, flat.triangles)
    points = flat.points.copy()
    moved = np.random.default_rng(n_u).uniform(-shake, shake, (len(points), 2)) * np.divide(size, (n_u, n_v))
    inside = ((points[:, :2] > 1e-12) & (points[:, :2] < np.array(size) * (1 - 1e-12))).all(axis=1)
    points[inside, :2] += moved[inside]
    return _turned(Mesh(points, flat.triangles), n_u)


def half_cylinder(n: int, family: str) -> Bent:
    """n cells around."""
    size = (np.pi * RADIUS, HEIGHT)
    energy = 0.5 / RADIUS**2 * size[0] * size[1]

    def normal(q: Floats) -> Floats:
        angle = q[:, 0] / RADIUS
        return np.column_stack([np.cos(angle), np.sin(angle), np.zeros(len(q))])

    def place(q: Floats) -> Floats:
        return RADIUS * normal(q) + np.outer(q[:, 1], [0.0, 0.0, 1.0])

    mesh = rectangle(n, round(n * size[1] / size[0]), size, family)
    return Bent(mesh, place, normal, lambda q: q, energy, energy)


def helix_developable(n: int, family: str) -> Bent:
    """n cells along one turn of the helix; rulings from `BREADTH` to twice that."""
    rise = PITCH / (2 * np.pi)
    speed = np.hypot(HELIX, rise)
    bend = HELIX / speed  # the flat helix is an arc of radius speed / bend
    first = BREADTH / HELIX
    size = (2 * np.pi, first)
    energy = 0.5 * np.log(2) * rise**2 * 2 * np.pi / (HELIX * speed)

    def place(q: Floats) -> Floats:
        angle, along = q[:, 0], first + q[:, 1]
        c, s = np.cos(angle), np.sin(angle)
        return np.column_stack([HELIX * (c - along * s), HELIX * (s + along * c), rise * (angle + along)])

    def flat(q: Floats) -> Floats:
        angle, along = bend * q[:, 0], speed * (first + q[:, 1])
        c, s = np.cos(angle), np.sin(angle)
        arc = speed / bend
        return np.column_stack([arc * c - along * s, arc * s + along * c, np.zeros(len(q))])

    def normal(q: Floats) -> Floats:
        angle = q[:, 0]  # minus the binormal of the helix: (x,1 x x,2) of the parameters
        across = np.column_stack([rise * np.sin(angle), -rise * np.cos(angle), np.full(len(q), HELIX)])
        return -across / speed

    return Bent(rectangle(n, max(1, round(0.8 * n)), size, family), place, normal, flat, energy, energy)


def _on_chart(
    chart: Chart, back: Back, cells: tuple[int, int], v_range: tuple[float, float], family: str
) -> Mesh:
    """A mesh of a surface of revolution; `back` takes its points to u and v."""
    pattern = _PATTERNS.get(family, "diagonal")
    mesh = chart.mesh(*cells, order=1, v_range=v_range, pattern=pattern)
    mesh = Mesh(mesh.points, mesh.triangles)
    if family != "irregular":
        return mesh
    u, v = back(mesh.points)
    inner = np.ones(len(u), dtype=bool)
    inner[np.unique(mesh.edges[mesh.boundary_edges])] = False
    move = np.random.default_rng(cells[1]).uniform(-SHAKEN, SHAKEN, (2, len(u))) * inner
    u, v = u + move[0] * 2 * np.pi / cells[0], v + move[1] * (v_range[1] - v_range[0]) / cells[1]
    return _turned(Mesh(chart(u, v), mesh.triangles), cells[1])


def half_torus(n: int, family: str) -> Bent:
    """The upper half, n cells around the tube."""
    torus = Torus(AXIS, TUBE)

    def back(q: Floats) -> tuple[Floats, Floats]:
        x, y, z = q.T
        return np.arctan2(y, x), np.arctan2(-z, np.hypot(x, y) - AXIS)

    # 4 H^2 of the whole torus is 4 pi^2 R^2 / (r sqrt(R^2 - r^2)); half of it, and K adds up to zero
    energy = np.pi**2 * AXIS**2 / (TUBE * np.sqrt(AXIS**2 - TUBE**2))
    mesh = _on_chart(torus, back, (round(2 * n * AXIS / TUBE), n), (-np.pi, 0.0), family)
    return Bent(
        mesh,
        lambda q: torus(*back(q)),
        lambda q: torus.at(*back(q)).normal,
        None,
        energy,
        energy,
    )


def octahedron(n: int) -> Mesh:
    """Each face cut into n * n triangles, normals inward."""
    ij = [(i, j) for i in range(n + 1) for j in range(n + 1 - i)]
    number = {place: k for k, place in enumerate(ij)}
    up = [(number[i, j], number[i + 1, j], number[i, j + 1]) for i, j in ij if i + j < n]
    down = [(number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]) for i, j in ij if i + j < n - 1]
    local = np.array(up + down)
    face = np.array([(i, j, n - i - j) for i, j in ij]) / n
    points, triangles = [], []
    for k, signs in enumerate(np.array(np.meshgrid(*[(1, -1)] * 3)).reshape(3, -1).T):
        points.append(face * signs)
        triangles.append((local if np.prod(signs) < 0 else local[:, ::-1]) + k * len(ij))
    every = np.concatenate(points)
    _, first, inverse = np.unique(
        np.round(every * n).astype(int), axis=0, return_index=True, return_inverse=True
    )
    return Mesh(every[first], inverse.reshape(-1)[np.concatenate(triangles)].astype(np.int32))


def _ball(mesh: Mesh, outward: Map, solid_angle: float) -> Bent:
    """Flat triangles near a part of the unit sphere, normals inward, and the map to the sphere."""
    mesh = Mesh(BALL * mesh.points, mesh.triangles)
    exact = 0.5 * (2 + 2 * NU) * solid_angle, 2 * solid_angle
    return Bent(mesh, lambda q: BALL * outward(q / BALL), lambda q: -outward(q / BALL), None, *exact)


def sphere(n: int, family: str) -> Bent:
    """An octahedron with n cells on an edge, or ("irregular") as many vertices at random."""

    def outward(q: Floats) -> Floats:
        return np.asarray(q / np.linalg.norm(q, axis=1, keepdims=True))

    flat = octahedron(n) if family != "irregular" else random_sphere(4 * n * n + 2, seed=n)
    return _ball(Mesh(outward(flat.points), flat.triangles), outward, 4 * np.pi)


def sphere_zone(n: int, family: str) -> Bent:
    """Between the latitudes -45 and 45 degrees, n cells high."""

    def back(q: Floats) -> tuple[Floats, Floats]:
        x, y, z = q.T
        return np.arctan2(y, x), np.arctan2(np.hypot(x, y), z)

    def outward(q: Floats) -> Floats:
        """At the same height, so that the rims stay circles of latitude."""
        across = np.sqrt(1 - q[:, 2:] ** 2) / np.linalg.norm(q[:, :2], axis=1, keepdims=True)
        return np.concatenate([q[:, :2] * across, q[:, 2:]], axis=1)

    mesh = _on_chart(Sphere(1.0), back, (4 * n, n), (np.pi / 4, 3 * np.pi / 4), family)
    return _ball(mesh, outward, 4 * np.pi * np.sin(np.pi / 4))


def vee(n: int, opening: float) -> Bent:
    """A flat strip folded along its middle, n cells on each side; the angle between the sides in radians.

    A crease has infinite energy. That given is of a circular arc in its place, as long as a cell is wide.
    """
    half = VEE[0] / 2
    c, s = np.cos(opening / 2), np.sin(opening / 2)

    def place(q: Floats) -> Floats:
        x = q[:, 0] - half
        return np.column_stack([x * s, q[:, 1], np.abs(x) * c])

    def normal(q: Floats) -> Floats:
        x = q[:, 0] - half
        return np.column_stack([-np.sign(x) * c, np.zeros(len(q)), np.full(len(q), s)])

    energy = 0.5 * (np.pi - opening) ** 2 * VEE[1] / (half / n)
    mesh = rectangle(2 * n, round(2 * n * VEE[1] / VEE[0]), VEE, "one diagonal")
    return Bent(mesh, place, normal, lambda q: q, energy, energy)


SHAPES: dict[str, Callable[[int, str], Bent]] = {
    "half cylinder": half_cylinder,
    "helix developable": helix_developable,
    "half torus": half_torus,
    "sphere": sphere,
}
