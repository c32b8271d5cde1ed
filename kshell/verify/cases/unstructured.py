"""The meshes that come with kshell, made by gmsh: irregular triangles of order 1 and 2, read from files.

They are coarse. Morley's moments at the edges, constant in each triangle and recovered from few around a
vertex, mean little there and are left out; in clamped, narrow parts its deflection is off by half.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

import kshell as ks
from kshell.verify.cases.case import Case, Run, case
from kshell.verify.cases.plate import plate
from kshell.verify.cases.quantities import (
    ARGYRIS_ONLY,
    At,
    Compliance,
    Component,
    CornerForce,
    Point,
    Quantity,
    Reaction,
)

# beside the package in the repository, inside it where kshell is installed
VERIFY = Path(__file__).parents[1]
MESHES = next(folder for folder in (VERIFY / "meshes", VERIFY.parents[1] / "meshes") if folder.is_dir())
UNIFORM = (ks.Pressure(1.0),)
SUMS: dict[str, Quantity] = {"compliance": Compliance(), "reaction": Reaction()}
CENTRE, EDGE = (0.0, 0.0), (1.0, 0.0)


def build(
    files: Mapping[int, str], held: Mapping[str, str], loads: tuple[Any, ...]
) -> Callable[[int, int], ks.Scene]:
    """The scene on the file of each order."""

    def scene(refinement: int, order: int) -> ks.Scene:
        return plate(MESHES / files[order], held, loads)

    return scene


def edge_moment(point: Point, component: Component) -> At:
    """A moment at the edge, where Morley has none worth reading on coarse meshes."""
    return At(point, component, elements=ARGYRIS_ONLY)


def both(order: int = 1) -> tuple[Run, ...]:
    """Each element once."""
    return (Run("argyris", 1, order), Run("morley", 1, order))


def straight() -> Iterator[Case]:
    """Squares, a rhombus, the L-shape."""
    square, middle = {1: "unit_square.msh"}, (0.5, 0.5)
    at_middle: dict[str, Quantity] = {
        "w_c": At(middle, "w"),
        "Mx_c": At(middle, "Mx"),
        "My_c": At(middle, "My"),
    }
    yield case(
        "unstructured.square.ss",
        "simply supported square, uniform pressure",
        build(square, {"edge": "S"}, UNIFORM),
        {**at_middle, "R": CornerForce((1.0, 1.0)), **SUMS},
        both(),
        "ssss.uniform.ba1",
    )
    yield case(
        "unstructured.square.clamped",
        "clamped square, uniform pressure",
        build(square, {"edge": "C"}, UNIFORM),
        {**at_middle, "Mx_edge": edge_moment((0.0, 0.5), "Mx"), "reaction": Reaction()},
        both(),
        "clamped.uniform.ba1",
    )
    yield case(
        "unstructured.square.clamped.point",
        "clamped square, force in the middle",
        build(square, {"edge": "C"}, (ks.PointForce("centre", (0, 0, 1)),)),
        {"w_c": At(middle, "w"), "reaction": Reaction()},
        both(),
        "clamped.point.ba1",
    )
    sides = {"left": "S", "right": "S", "bottom": "F", "top": "F"}
    yield case(
        "unstructured.square.SFSF",
        "square on two opposite sides, uniform pressure",
        build(square, sides, UNIFORM),
        {
            **at_middle,
            "w_y1": At((0.5, 1.0), "w"),
            "Mx_y1": edge_moment((0.5, 1.0), "Mx"),
            "reaction": Reaction(),
        },
        both(),
        "levy.SFSF.ba1",
    )
    t = np.radians(30)
    oblique = ((1 + np.cos(t)) / 2, np.sin(t) / 2)
    for name, letter in (("clamped", "C"), ("ss", "S")):
        moments: dict[str, Quantity] = {"M1_c": At(oblique, "M1"), "M2_c": At(oblique, "M2")}
        yield case(
            f"unstructured.skew.{name}.30",
            f"rhombus with an acute angle of 30 degrees, {'clamped' if letter == 'C' else 'simply supported'}",
            build({1: "skew_plate.msh"}, {"edge": letter}, UNIFORM),
            {"w_c": At(oblique, "w"), **moments, "reaction": Reaction()},
            both(),
            f"skew.{name}.30",
        )
    yield case(
        "unstructured.lshape.clamped",
        "clamped L-shape with arms of width 1, uniform pressure",
        build({1: "l_shape.msh"}, {"edge": "C"}, UNIFORM),
        {"w_near": At((-0.5, 0.5), "w"), "w_arm": At((-0.5, -0.5), "w"), **SUMS},
        both(),
        "lshape.clamped.large",
    )


def curved() -> Iterator[Case]:
    """Disks, a sixth of one, a ring, an ellipse."""
    for name, letter in (("clamped", "C"), ("ss", "S")):
        moments: dict[str, Quantity] = {"M_c": At(CENTRE, "Mx"), "Mt_edge": edge_moment(EDGE, "My")}
        yield case(
            f"unstructured.disk.{name}",
            f"disk, {'clamped' if letter == 'C' else 'simply supported'}, uniform pressure",
            build({1: "disk.msh", 2: "disk_order2.msh"}, {"edge": letter}, UNIFORM),
            {"w_c": At(CENTRE, "w"), **moments, **SUMS},
            (*both(), Run("argyris", 1, order=2)),
            f"disk.{name}.uniform",
        )
        yield case(
            f"unstructured.sector.{name}",
            "a sixth of the disk, between planes of symmetry that meet at 60 degrees",
            build({2: "sector.msh"}, {"arc": letter, "straight": "Y"}, UNIFORM),
            {"w_c": At(CENTRE, "w"), "M_c": At(CENTRE, "Mx")},
            both(order=2),
            f"disk.{name}.uniform",
        )
    hole = 0.4
    loads: dict[str, Any] = {
        "FS.P": ks.LineForce("inner", (0, 0, 1 / (2 * np.pi * hole))),
        "FS.m": ks.EdgeMoment("inner", 1.0),
        "CS.q": ks.Pressure(1.0),
    }
    for kind, load in loads.items():
        quantities: dict[str, Quantity] = {
            "w_mid": At(((1 + hole) / 2, 0.0), "w"),
            "compliance": Compliance(),
        }
        if kind[0] == "F":
            quantities |= {"w_in": At((hole, 0.0), "w"), "Mt_in": edge_moment((hole, 0.0), "My")}
        if kind != "FS.m":
            quantities["reaction"] = Reaction()
        yield case(
            f"unstructured.annulus.{kind}.b0.4",
            "ring of inner radius 0.4, inner and outer edge " + ", ".join(kind[:2]),
            build({2: "annulus.msh"}, {"inner": kind[0], "outer": kind[1]}, (load,)),
            quantities,
            both(order=2),
            f"annulus.{kind}.b0.4",
        )
    yield case(
        "unstructured.ellipse.clamped.2",
        "clamped ellipse, semi-axes 2 and 1, uniform pressure",
        build({2: "ellipse.msh"}, {"edge": "C"}, UNIFORM),
        {
            "w_c": At(CENTRE, "w"),
            "Mx_c": At(CENTRE, "Mx"),
            "My_c": At(CENTRE, "My"),
            "Mn_end_a": edge_moment((2.0, 0.0), "Mx"),
            "Mn_end_b": edge_moment((0.0, 1.0), "My"),
            **SUMS,
        },
        both(order=2),
        "ellipse.clamped.2.large",
    )


def cases() -> list[Case]:
    """All of them."""
    return [one for family in (straight, curved) for one in family()]
