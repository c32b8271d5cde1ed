"""Plate problems on small unstructured meshes, made without a mesh generator, to test the solvers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.spatial import Delaunay

import kshell as ks
from kshell.elements import ElementArgyris, ElementMorley
from kshell.mesh.mesh import Group, Mesh
from kshell.plate.problem import PlateProblem
from kshell.scene.structure import resolve

ELEMENTS = {"morley": ElementMorley, "argyris": ElementArgyris}


def square(n: int, jitter: float = 0.25) -> tuple[np.ndarray, np.ndarray]:
    """Unit square with n x n cells, inner vertices displaced at random (by parts of a cell)."""
    x, y = np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1), indexing="ij")
    points = np.stack([x.ravel(), y.ravel()], axis=1)
    inside = np.all((points > 1e-9) & (points < 1 - 1e-9), axis=1)
    rng = np.random.default_rng(3)
    points[inside] += rng.uniform(-jitter, jitter, (inside.sum(), 2)) / n
    # a little curvature keeps Delaunay from making slivers of the straight sides
    lifted = points + 1e-7 * np.sin(np.pi * points[:, ::-1]) * np.sign(points - 0.5)
    return points, Delaunay(lifted).simplices


def cut(points: np.ndarray, triangles: np.ndarray, inside: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The triangles whose centre is inside, and the vertices that they use."""
    triangles = triangles[inside]
    used, inverse = np.unique(triangles, return_inverse=True)
    return points[used], inverse.reshape(-1, 3)


def l_shape(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Unit square without its upper right quarter; regular inside (n even)."""
    points, triangles = square(n, 0.0)
    centre = points[triangles].mean(axis=1)
    return cut(points, triangles, ~np.all(centre > 0.5, axis=1))


def disk_with_hole(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Ring between the radii 0.3 and 1, n cells across."""
    around = int(2 * np.pi * 0.65 / 0.7 * n)
    r, phi = np.meshgrid(np.linspace(0.3, 1, n + 1), np.arange(around) * 2 * np.pi / around, indexing="ij")
    phi = phi + np.pi / around * (np.arange(n + 1) % 2)[:, None]
    points = np.stack([(r * np.cos(phi)).ravel(), (r * np.sin(phi)).ravel()], axis=1)
    triangles = Delaunay(points).simplices
    return cut(points, triangles, np.linalg.norm(points[triangles].mean(axis=1), axis=1) > 0.3)


def graded(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Sector of 270 degrees whose triangles shrink towards the re-entrant corner, down to 1/50."""
    depth = np.log(50.0)
    across = round(n * 1.5 * np.pi / depth)
    s, phi = np.meshgrid(
        np.linspace(-depth, 0, n + 1), np.linspace(0, 1.5 * np.pi, across + 1), indexing="ij"
    )
    inside = (s > -depth + 1e-9) & (s < -1e-9) & (phi > 1e-9) & (phi < 1.5 * np.pi - 1e-9)
    shift = np.random.default_rng(5).uniform(-0.2, 0.2, (2, *s.shape)) * depth / n * inside
    triangles = stretched(n, n / across)[1]
    r, phi = np.exp(s + shift[0]).ravel(), (phi + shift[1]).ravel()
    return np.stack([r * np.cos(phi), r * np.sin(phi)], axis=1), triangles


def stretched(n: int, aspect: float) -> tuple[np.ndarray, np.ndarray]:
    """Unit square with cells that are ``aspect`` times longer than wide."""
    x, y = np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, int(n / aspect) + 1), indexing="ij")
    points = np.stack([x.ravel(), y.ravel()], axis=1)
    i = np.arange(x.size).reshape(x.shape)
    a, b, c, d = i[:-1, :-1].ravel(), i[1:, :-1].ravel(), i[1:, 1:].ravel(), i[:-1, 1:].ravel()
    return points, np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


def slit(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Unit square, slit along y = 1/2 from the left to the middle: two vertices at each point of the slit."""
    points, triangles = square(n, 0.0)
    on_slit = np.flatnonzero((np.abs(points[:, 1] - 0.5) < 1e-9) & (points[:, 0] < 0.5 - 1e-9))
    twin = np.arange(len(points))
    twin[on_slit] = len(points) + np.arange(len(on_slit))
    above = points[triangles].mean(axis=1)[:, 1] > 0.5
    triangles = np.where(above[:, None], twin[triangles], triangles)
    return np.concatenate([points, points[on_slit]]), triangles


def mesh_of(points: np.ndarray, triangles: np.ndarray, near: float = 1e-6, **regions: Any) -> Mesh:
    """A mesh whose boundary has the groups "left" (``near`` the smallest x), "bottom" (the smallest y),
    "rest" and "boundary"; further groups of triangles by a condition on their centres."""
    flat = np.column_stack([points, np.zeros(len(points))])
    d, e = (flat[triangles[:, k], :2] - flat[triangles[:, 0], :2] for k in (1, 2))
    triangles = np.where((d[:, 0] * e[:, 1] < d[:, 1] * e[:, 0])[:, None], triangles[:, [0, 2, 1]], triangles)
    mesh = Mesh(flat, triangles.astype(np.int32))
    boundary = mesh.boundary_edges
    farthest = points[mesh.edges[boundary]].max(axis=1) - points.min(axis=0)
    left = farthest[:, 0] < near
    bottom = ~left & (farthest[:, 1] < near)
    groups = {
        "boundary": Group(1, boundary),
        "left": Group(1, boundary[left]),
        "bottom": Group(1, boundary[bottom]),
        "rest": Group(1, boundary[~left & ~bottom]),
    }
    centre = points[triangles].mean(axis=1)
    for name, condition in regions.items():
        groups[name] = Group(2, np.flatnonzero(condition(*centre.T)).astype(np.int32))
    return Mesh(flat, triangles.astype(np.int32), groups=groups)


SUPPORTS = {
    "clamped": [ks.Clamped("boundary")],
    "simply supported": [ks.SimplySupported("boundary")],
    "mixed": [ks.Clamped("left"), ks.SimplySupported("bottom")],
    "cantilever": [ks.Clamped("left")],
    "symmetry": [ks.Symmetry("left"), ks.Clamped("rest")],
}


def plate(
    mesh: Mesh, element: str, supports: str | Sequence[Any], thickness: Any = 0.01, loads: Sequence[Any] = ()
) -> PlateProblem:
    """The plate problem of a steel plate under pressure."""
    scene = ks.Scene(
        mesh=mesh,
        thickness=thickness,
        material=ks.Isotropic(E=210e9, nu=0.3),
        supports=SUPPORTS[supports] if isinstance(supports, str) else list(supports),
        loads=list(loads) or [ks.Pressure(1e3)],
    )
    return PlateProblem(resolve(scene, mesh), ELEMENTS[element]())
