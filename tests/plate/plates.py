"""Small meshes and scenes that the plate tests share."""

from __future__ import annotations

from typing import Any

import numpy as np

import kshell as ks
from kshell.mesh.mesh import Mesh
from kshell.plate import PlateModel
from kshell.result.result import Result
from kshell.scene.structure import resolve

UNIT = {"E": 12 * (1 - 0.3**2), "nu": 0.3}  # with thickness 1 the bending stiffness D is 1


def rectangle(
    nx: int, ny: int | None = None, a: float = 1.0, b: float = 1.0, skew: float = 0.0, wobble: float = 0.0
) -> Mesh:
    """Right triangles on [0, a] x [0, b], with groups left, right, bottom, top, middle, plate, lower, upper."""
    ny = ny or nx
    x, y = np.meshgrid(np.linspace(0, a, nx + 1), np.linspace(0, b, ny + 1), indexing="ij")
    points = np.stack([x.ravel() + skew * y.ravel(), y.ravel()], axis=1)
    if wobble:
        inside = ((x > 0) & (x < a) & (y > 0) & (y < b)).ravel()
        random = np.random.default_rng(7).uniform(-1, 1, points.shape)
        points[inside] += wobble * np.array([a / nx, b / ny]) * random[inside]
    i, j = np.meshgrid(np.arange(nx), np.arange(ny), indexing="ij")
    v = (i * (ny + 1) + j).ravel()
    cells = np.stack([v, v + ny + 1, v + ny + 2, v + 1], axis=1)
    triangles = np.concatenate([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])
    k, m = np.arange(ny), np.arange(nx)
    last = nx * (ny + 1)
    groups: dict[str, Any] = {
        "left": np.stack([k, k + 1], axis=1),
        "right": np.stack([last + k, last + k + 1], axis=1),
        "bottom": np.stack([m * (ny + 1), (m + 1) * (ny + 1)], axis=1),
        "top": np.stack([m * (ny + 1) + ny, (m + 1) * (ny + 1) + ny], axis=1),
        "plate": triangles,
        "lower": triangles[np.tile(j.ravel() < ny // 2, 2)],
        "upper": triangles[np.tile(j.ravel() >= ny // 2, 2)],
    }
    if nx % 2 == 0:
        half = (nx // 2) * (ny + 1)
        groups["middle"] = np.stack([half + k, half + k + 1], axis=1)
    groups["edge"] = np.concatenate([groups[name] for name in ("left", "right", "bottom", "top")])
    return Mesh.from_arrays(points, triangles, groups)


def disk(rings: int, order: int = 1, radius: float = 1.0) -> Mesh:
    """A disk of `rings` rings of triangles around the centre, boundary nodes on the circle; group edge."""
    points, rows = [np.zeros((1, 2))], [np.zeros(1, dtype=int)]
    for r in range(1, rings + 1):
        angle = 2 * np.pi * np.arange(6 * r) / (6 * r)
        rows.append(len(np.concatenate(points)) + np.arange(6 * r))
        points.append(radius * r / rings * np.stack([np.cos(angle), np.sin(angle)], axis=1))
    x = np.concatenate(points)
    triangles = []
    for r in range(1, rings + 1):
        inner, outer = rows[r - 1], rows[r]
        for sector in range(6):
            for k in range(r):
                o = sector * r + k
                i = sector * (r - 1) + k
                a, b = outer[o % (6 * r)], outer[(o + 1) % (6 * r)]
                below = inner[i % max(6 * (r - 1), 1)]
                triangles.append((a, b, below))
                if k < r - 1:
                    triangles.append((below, b, inner[(i + 1) % (6 * (r - 1))]))
    edge = np.stack([rows[-1], np.roll(rows[-1], -1)], axis=1)
    mesh = Mesh.from_arrays(x, np.array(triangles), {"edge": edge, "centre": [0]})
    if order == 1:
        return mesh
    middle = mesh.points[mesh.edges].mean(axis=1)
    on = mesh.boundary_edges
    middle[on] *= radius / np.linalg.norm(middle[on], axis=1, keepdims=True)
    return Mesh(mesh.points, mesh.triangles, middle, mesh.groups)


def annulus(rings: int, around: int, hole: float = 0.4) -> Mesh:
    """A ring of outer radius 1; groups inner, outer and plate."""
    angle = 2 * np.pi * np.arange(around) / around
    radius = np.linspace(hole, 1.0, rings + 1)[:, None]
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=2).reshape(-1, 2)
    a = np.arange(len(points)).reshape(rings + 1, around)
    b = np.roll(a, -1, axis=1)
    cells = np.stack([a[:-1], a[1:], b[1:], b[:-1]], axis=2).reshape(-1, 4)
    triangles = np.concatenate([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])
    lines = {"inner": np.stack([a[0], b[0]], axis=1), "outer": np.stack([a[-1], b[-1]], axis=1)}
    return Mesh.from_arrays(points, triangles, {**lines, "plate": triangles})


def ellipse(rings: int, order: int = 1, long: float = 1.5) -> Mesh:
    """The same stretched along x."""
    mesh = disk(rings, order)
    stretch = np.array([long, 1.0, 1.0])
    middle = None if mesh.midpoints is None else mesh.midpoints * stretch
    return Mesh(mesh.points * stretch, mesh.triangles, middle, mesh.groups)


def ellipse_centre(long: float = 1.5) -> float:
    """Deflection of the centre of a clamped ellipse, q = D = 1 (Timoshenko & Woinowsky-Krieger, section 71).

    The strain energy is pi long / 6 times as much.
    """
    return 1.0 / (24.0 / long**4 + 16.0 / long**2 + 24.0)


EGG_LOAD = (
    "64 + 32*x + 8*x**2/3 + 16*y**2/3"  # D = 1: the clamped egg deflects by (1 - x^2 - y^2 (1 + x / 3))^2
)


def on_egg(points: Any) -> Any:
    """Points (n, 3) of the unit disk drawn out along their radius, those of the circle to the egg."""
    out = np.array(points)
    r = np.linalg.norm(out, axis=1)
    cosine, sine = (out[:, :2] / np.maximum(r, 1e-300)[:, None]).T
    cube = sine**2 * cosine / 3
    on = np.ones(len(out))
    for _ in range(50):  # r^2 + r^3 sin^2 cos / 3 = 1
        on -= (on**2 + cube * on**3 - 1) / (2 * on + 3 * cube * on**2)
    out[:, :2] *= on[:, None]
    return out


def egg(rings: int, order: int = 1) -> Mesh:
    """A disk drawn to the curve x^2 + y^2 (1 + x / 3) = 1, which is no conic."""
    mesh = disk(rings, order)
    middle = None if mesh.midpoints is None else on_egg(mesh.midpoints)
    return Mesh(on_egg(mesh.points), mesh.triangles, middle, mesh.groups)


def solve(
    mesh: Mesh, supports: list[Any], loads: list[Any], element: str = "argyris", **scene: Any
) -> Result:
    """Solve with D = 1 unless told otherwise."""
    settings: dict[str, Any] = {"thickness": 1.0, "material": ks.Isotropic(**UNIT)}
    if "layers" in scene:
        settings = {}
    settings.update(scene)
    made = ks.Scene(mesh=mesh, supports=supports, loads=loads, **settings)
    model = PlateModel(resolve(made, mesh), element)
    return model.recover(model.solve())
