"""Plates with oblique, acute, obtuse and re-entrant corners under uniform pressure.

Bending stiffness 1, nu = 0.3, q = 1. Around corners where the solution is singular the meshes have
layers of smaller triangles; what accuracy the singularity leaves is in the allowed errors. The worst is
the obtuse corner of a simply supported skew plate: at 150 degrees w grows like r^(6/5) and the moments
are unbounded.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

import kshell as ks
from kshell.verify.cases import meshes
from kshell.verify.cases.case import Case, case
from kshell.verify.cases.plate import plate, runs
from kshell.verify.cases.quantities import At, Compliance, Quantity, Reaction

UNIFORM = (ks.Pressure(1.0),)


def build(mesh: Callable[[int], ks.Mesh], kind: str) -> Callable[[int, int], ks.Scene]:
    """The scene on any refinement, all edges of one kind."""

    def scene(refinement: int, order: int) -> ks.Scene:
        return plate(mesh(refinement), {"edge": kind}, UNIFORM)

    return scene


def skew() -> Iterator[Case]:
    """Rhombic plates of side 1."""
    for angle in (60, 45, 30):
        middle = _middle(angle)
        yield case(
            f"skew.clamped.{angle}",
            f"clamped rhombus, acute angle {angle} degrees",
            build(lambda n, angle=angle: meshes.rhombus(angle, n), "C"),  # type: ignore[misc]
            {
                "w_c": At(middle, "w"),
                "M1_c": At(middle, "M1"),
                "M2_c": At(middle, "M2"),
                "reaction": Reaction(),
            },
            runs(8, 32),
        )
    for angle, layers in ((75, 6), (30, 16)):
        middle = _middle(angle)
        quantities: dict[str, Quantity] = {"w_c": At(middle, "w"), "laplacian_c": At(middle, "laplacian")}
        if angle == 30:
            quantities |= {"M1_c": At(middle, "M1"), "M2_c": At(middle, "M2")}
        yield case(
            f"skew.ss.{angle}",
            f"simply supported rhombus, acute angle {angle} degrees",
            build(lambda n, angle=angle, layers=layers: meshes.rhombus(angle, n, layers), "S"),  # type: ignore[misc]
            {**quantities, "reaction": Reaction()},
            runs(8, 32),
        )


def _middle(angle: float) -> tuple[float, float]:
    t = np.radians(angle)
    return ((1 + np.cos(t)) / 2, np.sin(t) / 2)


def triangles() -> Iterator[Case]:
    """Simply supported triangles with a side of 1."""
    height = np.sqrt(3) / 2
    equilateral = [(0.0, 0.0), (1.0, 0.0), (0.5, height)]
    middle = (0.5, height / 3)
    yield case(
        "triangle.ss.equilateral",
        "simply supported equilateral triangle of side 1",
        build(lambda n: meshes.triangle(equilateral, n), "S"),
        {"w_c": At(middle, "w"), "Mx_c": At(middle, "Mx"), "My_c": At(middle, "My"), "reaction": Reaction()},
        runs(9, 36),
    )
    right = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]
    third = (1 / 3, 1 / 3)
    yield case(
        "triangle.ss.right",
        "simply supported triangle with two sides of 1 and a right angle, values at the centroid",
        build(lambda n: meshes.triangle(right, n), "S"),
        {"w_c": At(third, "w"), "laplacian_c": At(third, "laplacian"), "reaction": Reaction()},
        runs(9, 36),
    )


def regular() -> Iterator[Case]:
    """Simply supported regular polygons in the unit circle: they do not tend to the disk (Babuska's paradox)."""
    # sides: layers around the corners, refinements; w grows like r^(n / (n - 2)) from a corner
    how = {
        3: (0, 6, 24),
        4: (0, 6, 24),
        5: (4, 6, 20),
        6: (6, 6, 16),
        8: (10, 6, 16),
        12: (16, 6, 12),
        16: (14, 6, 10),
    }
    for sides, (layers, argyris, morley) in how.items():
        yield case(
            f"polygon.ss.{sides}",
            f"simply supported regular polygon of {sides} sides in the unit circle",
            build(lambda n, sides=sides, layers=layers: meshes.regular_polygon(sides, n, layers), "S"),  # type: ignore[misc]
            {"w_c": At((0.0, 0.0), "w"), "laplacian_c": At((0.0, 0.0), "laplacian"), "reaction": Reaction()},
            runs(argyris, morley),
        )


def re_entrant() -> Iterator[Case]:
    """The L-shape [0, 1]^2 without [1/2, 1]^2."""
    yield case(
        "lshape.clamped",
        "clamped L-shape, singular at the re-entrant corner",
        build(lambda n: meshes.l_shape(n, layers=10), "C"),
        {
            "w_near": At((0.25, 0.25), "w"),
            "Mx_near": At((0.25, 0.25), "Mx"),
            "w_arm": At((0.25, 0.75), "w"),
            "compliance": Compliance(),
            "reaction": Reaction(),
        },
        runs(12, 40),
    )


def cases() -> list[Case]:
    """All of them."""
    return [one for family in (skew, triangles, regular, re_entrant) for one in family()]
