"""Meshes and models that the shell tests share."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.linear import LinearSolution, solve_linear
from kshell.equilibrium.reduction import Reduction
from kshell.mesh.mesh import Mesh
from kshell.shell.koiter.energy import Koiter
from kshell.shell.koiter.supports import Supports
from kshell.shell.koiter.surface import Surface
from kshell.shell.section import Section

Floats = NDArray[np.float64]


def rectangle(nx: int, ny: int, x0: float, x1: float, y0: float, y1: float, skew: float = 0.0) -> Mesh:
    """Triangles on a rectangle with alternating diagonals; `skew` shifts vertices by that part of a cell."""
    x, y = np.linspace(x0, x1, nx + 1), np.linspace(y0, y1, ny + 1)
    grid_x, grid_y = np.meshgrid(x, y, indexing="ij")
    points = np.column_stack([grid_x.ravel(), grid_y.ravel(), np.zeros(grid_x.size)])
    rng = np.random.default_rng(1)
    for axis, (low, high, n) in enumerate(((x0, x1, nx), (y0, y1, ny))):
        inside = (points[:, axis] > low + 1e-9) & (points[:, axis] < high - 1e-9)
        points[inside, axis] += skew * rng.uniform(-1, 1, inside.sum()) * (high - low) / n
    triangles = []
    for i in range(nx):
        for j in range(ny):
            a, b = i * (ny + 1) + j, (i + 1) * (ny + 1) + j
            if (i + j) % 2 == 0:
                triangles += [(a, b, b + 1), (a, b + 1, a + 1)]
            else:
                triangles += [(a, b, a + 1), (b, b + 1, a + 1)]
    return Mesh(points, np.array(triangles, dtype=np.int32))


def joined(*parts: tuple[Floats, NDArray]) -> Mesh:
    """One mesh of several (points, triangles), vertices at the same place merged."""
    points = np.concatenate([p for p, _ in parts])
    offsets = np.cumsum([0] + [len(p) for p, _ in parts])
    triangles = np.concatenate([t + o for (_, t), o in zip(parts, offsets, strict=False)])
    _, first, place = np.unique(np.round(points, 9), axis=0, return_index=True, return_inverse=True)
    return Mesh(points[first], place.reshape(-1)[triangles].astype(np.int32))


def panel(origin: tuple, along: tuple, across: tuple, n: int = 2) -> tuple[Floats, NDArray]:
    """A flat grid spanned by two vectors."""
    mesh = rectangle(n, n, 0, 1, 0, 1)
    s = mesh.points
    return np.asarray(origin, float) + s[:, :1] * np.array(along, float) + s[:, 1:2] * np.array(
        across, float
    ), mesh.triangles


def patch() -> Mesh:
    return rectangle(2, 2, 0, 1, 0, 0.8, skew=0.2)


def fold() -> Mesh:
    return joined(panel((0, 0, 0), (1, 0, 0), (0, 1, 0)), panel((0, 0, 0), (0, 1, 0), (-0.3, 0, 1)))


def tee() -> Mesh:
    return joined(
        panel((0, 0, 0), (1, 0, 0), (0, 1, 0)),
        panel((-1, 0, 0), (1, 0, 0), (0, 1, 0)),
        panel((0, 0, 0), (0, 1, 0), (0, 0, 1)),
    )


def box() -> Mesh:
    o, x, y, z = (0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)
    return joined(
        panel(o, y, x), panel(z, x, y), panel(o, x, z), panel(y, z, x), panel(o, z, y), panel(x, y, z)
    )


def strip(half_turns: int, n: int = 12, radius: float = 2.0) -> Mesh:
    """A closed strip; with one half turn a Moebius strip."""
    mesh = rectangle(n, 2, 0, 2 * np.pi, -0.4, 0.4)
    angle, s = mesh.points[:, 0], mesh.points[:, 1]
    turn = half_turns * angle / 2
    r = radius + s * np.cos(turn)
    points = np.column_stack([r * np.cos(angle), r * np.sin(angle), s * np.sin(turn)])
    return joined((points, mesh.triangles))


SHAPES = {"patch": patch, "fold": fold, "tee": tee, "box": box, "moebius": lambda: strip(1)}


def cylinder(radius: float) -> Callable[[Floats], Floats]:
    """Chart (arc length, axis): crown at z = radius, axis along y."""
    return lambda q: np.column_stack(
        [radius * np.sin(q[:, 0] / radius), q[:, 1], radius * np.cos(q[:, 0] / radius)]
    )


def sphere(radius: float) -> Callable[[Floats], Floats]:
    """Chart (longitude, latitude), both times the radius."""

    def lift(q: Floats) -> Floats:
        a, b = q[:, 0] / radius, q[:, 1] / radius
        return radius * np.column_stack([np.cos(a) * np.cos(b), np.sin(a) * np.cos(b), np.sin(b)])

    return lift


class Model:
    """A rectangle in a parameter plane, lifted to a surface, with edges and nodes found by coordinates."""

    def __init__(
        self, mesh: Mesh, order: int, section: Section, lift: Callable[[Floats], Floats] | None = None
    ) -> None:
        self.mesh = mesh
        self.surface = Surface(mesh, order, lift)
        self.koiter = Koiter(self.surface, section)
        self.supports = Supports(self.surface)

    def edges(self, axis: int, value: float) -> NDArray:
        boundary = self.mesh.boundary_edges
        middle = self.mesh.points[self.mesh.edges[boundary]].mean(axis=1)
        return boundary[np.abs(middle[:, axis] - value) < 1e-9]

    def vertex(self, *place: float) -> int:
        return int(np.argmin(((self.mesh.points[:, : len(place)] - place) ** 2).sum(axis=1)))

    def solve(self, load: Floats, springs: object = None) -> LinearSolution:
        return solve_linear(self.koiter, load, self.reduction(), springs)

    def reduction(self) -> Reduction:
        return self.supports.reduction()
