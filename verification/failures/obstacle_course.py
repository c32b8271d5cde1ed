"""The linear obstacle course of shells on grids of the parameter plane: one deflection per problem and order."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

REFERENCES = {"scordelis_lo": 0.300592457, "pinched_cylinder": 1.828195e-5, "hemisphere_hole": 0.0935216}
TITLES = {
    "scordelis_lo": "Scordelis-Lo roof",
    "pinched_cylinder": "pinched cylinder",
    "hemisphere_hole": "hemisphere with a hole",
}


def grid(cells: int, size: tuple[float, float], grade: float) -> Any:
    """Triangles on [0, size] with alternating diagonals, graded towards the origin."""
    from kshell.mesh.mesh import Mesh

    side = np.linspace(0, 1, cells + 1) ** grade
    x, y = np.meshgrid(side * size[0], side * size[1], indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    i, j = (index.ravel() for index in np.indices((cells, cells)))
    a, b = i * (cells + 1) + j, (i + 1) * (cells + 1) + j
    even = ((i + j) % 2 == 0)[:, None]
    first = np.where(even, np.stack([a, b, b + 1], 1), np.stack([a, b, a + 1], 1))
    second = np.where(even, np.stack([a, b + 1, a + 1], 1), np.stack([b, b + 1, a + 1], 1))
    return Mesh(points, np.concatenate([first, second]).astype(np.int32))


def solve(problem: str, order: int, mesh: Any) -> tuple[int, float]:
    """Unknowns and the deflection of the benchmark, from the mesh in the parameter plane."""
    from kshell.shell import loads
    from kshell.shell.koiter import Koiter
    from kshell.shell.linear import solve_linear
    from kshell.shell.section import Section
    from kshell.shell.supports import Supports
    from kshell.shell.surface import Surface

    lift, size, section = PARAMETERS[problem]
    surface = Surface(mesh, order, lift)
    koiter = Koiter(surface, Section.isotropic(*section))
    boundary = mesh.boundary_edges
    middle = mesh.points[mesh.edges[boundary]].mean(axis=1)

    def side(axis: int, value: float) -> Any:
        return boundary[np.abs(middle[:, axis] - value) < 1e-9 * size[axis]]

    def vertex(x: float, y: float) -> int:
        return int(np.argmin(np.abs(mesh.points[:, :2] - (x, y)).sum(axis=1)))

    supports = Supports(surface)
    supports.symmetry(side(0, 0.0))
    if problem != "scordelis_lo":
        supports.symmetry(side(0, size[0]))
    if problem == "hemisphere_hole":
        a, b = vertex(0, 0), vertex(size[0], 0)
        supports.translation([a], "z")
        load = loads.point_force(surface, a, [1, 0, 0]) + loads.point_force(surface, b, [0, -1, 0])
        read, sign = 3 * a, 1.0
    else:
        supports.symmetry(side(1, 0.0))
        supports.diaphragm(side(1, size[1]))
        node = vertex(0, 0)
        load = loads.point_force(surface, node, [0, 0, -0.25])
        if problem == "scordelis_lo":
            node = vertex(size[0], 0)
            load = loads.traction(surface, [0, 0, -90.0])
        read, sign = 3 * node + 2, -1.0
    reduction = supports.reduction()
    answer = solve_linear(koiter, load, reduction)
    return int(reduction.basis.shape[1]), sign * float(answer.x[read])


def cylinder(radius: float) -> Callable[[Floats], Floats]:
    """Arc length and axis to a cylinder with its crown at z = radius."""
    return lambda q: np.column_stack(
        [radius * np.sin(q[:, 0] / radius), q[:, 1], radius * np.cos(q[:, 0] / radius)]
    )


def sphere(radius: float) -> Callable[[Floats], Floats]:
    """Longitude and latitude, times the radius, to a sphere."""

    def lift(q: Floats) -> Floats:
        a, b = q[:, 0] / radius, q[:, 1] / radius
        return radius * np.column_stack([np.cos(a) * np.cos(b), np.sin(a) * np.cos(b), np.sin(b)])

    return lift


PARAMETERS: dict[str, tuple[Callable[[Floats], Floats], tuple[float, float], tuple[float, float, float]]] = {
    "scordelis_lo": (cylinder(25.0), (25.0 * np.radians(40.0), 25.0), (4.32e8, 0.0, 0.25)),
    "pinched_cylinder": (cylinder(300.0), (150.0 * np.pi, 300.0), (3e6, 0.3, 3.0)),
    "hemisphere_hole": (sphere(10.0), (5.0 * np.pi, 4.0 * np.pi), (6.825e7, 0.3, 0.04)),
}
