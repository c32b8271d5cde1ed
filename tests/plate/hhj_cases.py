"""Plates of the tests of the Hellan-Herrmann-Johnson element: stiffness 1, Poisson's ratio .3."""

from __future__ import annotations

import numpy as np

import kshell as ks
from kshell.elements import ElementArgyris
from kshell.mesh.mesh import Mesh
from kshell.plate.hhj import translate
from kshell.plate.hhj.geometry import Triangles
from kshell.plate.hhj.state import HHJSolution
from kshell.plate.hhj.system import HHJSystem
from kshell.plate.problem import PlateProblem
from kshell.scene.structure import resolve

MATERIAL = ks.Isotropic(E=12 * (1 - 0.3**2), nu=0.3)


def square(n: int, jitter: float = 0.0) -> Mesh:
    """n x n cells of the unit square; groups left, right, bottom, top, edge, middle (x = 1/2) and plate."""
    s = np.linspace(0, 1, n + 1)
    points = np.stack(np.meshgrid(s, s, indexing="ij"), axis=2).reshape(-1, 2)
    inside = ((points > 0) & (points < 1)).all(axis=1)
    points[inside] += jitter / n * np.random.default_rng(1).uniform(-1, 1, (int(inside.sum()), 2))
    number = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    triangles = np.concatenate(
        [np.stack([a, b, c], axis=2).reshape(-1, 3), np.stack([a, c, d], axis=2).reshape(-1, 3)]
    )
    lines = {
        "left": number[0],
        "right": number[-1],
        "bottom": number[:, 0],
        "top": number[:, -1],
        "middle": number[n // 2],
    }
    groups = {name: np.stack([line[:-1], line[1:]], axis=1) for name, line in lines.items()}
    groups["edge"] = np.concatenate([groups[name] for name in ("left", "right", "bottom", "top")])
    return Mesh.from_arrays(points, triangles, {**groups, "plate": triangles})


def l_shape(n: int, size: float = 0.5) -> Mesh:
    """Square of side 2 size without its quadrant of high x and y; n cells along ``size``; group edge."""
    s = np.linspace(0, 2 * size, 2 * n + 1)
    points = np.stack(np.meshgrid(s, s, indexing="ij"), axis=2).reshape(-1, 2)
    number = np.arange(len(points)).reshape(len(s), len(s))
    a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    triangles = np.concatenate(
        [np.stack([a, b, c], axis=2).reshape(-1, 3), np.stack([a, c, d], axis=2).reshape(-1, 3)]
    )
    centre = points[triangles].mean(axis=1)
    return whole_edge(points, triangles[~(centre > size).all(axis=1)])


def whole_edge(points: np.ndarray, triangles: np.ndarray) -> Mesh:
    """A mesh of the vertices in use, with the group edge of its whole boundary."""
    used, triangles = np.unique(triangles, return_inverse=True)
    bare = Mesh.from_arrays(points[used], triangles.reshape(-1, 3))
    return Mesh.from_arrays(points[used], bare.triangles, {"edge": bare.edges[bare.boundary_edges]})


def problem(mesh: Mesh, supports: list, loads: list, material=MATERIAL, thickness=1.0) -> PlateProblem:
    """The Argyris problem of a scene."""
    scene = ks.Scene(mesh=mesh, thickness=thickness, material=material, supports=supports, loads=loads)
    return PlateProblem(resolve(scene, mesh), ElementArgyris())


def hhj(of: PlateProblem, order: int) -> tuple[HHJSystem, HHJSolution]:
    """The same problem with this element."""
    triangles = Triangles(of.mesh)
    system = HHJSystem(
        triangles,
        order,
        translate.bending_stiffness(of.section),
        translate.held(triangles, order, of.supports),
        translate.springs(triangles, order, of.supports),
    )
    return system, system.solve(translate.load(system, of.loads.forms))


def nearest(mesh: Mesh, x: float, y: float) -> int:
    """The vertex at a place."""
    return int(np.hypot(mesh.points[:, 0] - x, mesh.points[:, 1] - y).argmin())
