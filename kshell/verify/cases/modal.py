"""Frequencies and buckling loads of plates: squares, rectangles, rhombi, triangles and disks.

Bending stiffness 1, mass 1 per area, nu = 0.3 where nothing else is said. Frequencies are omega = (value)^(1/2),
buckling loads are factors of membrane forces of size pi^2 on plates whose short side is 1, of size 1 on disks. Sides
in the order x = 0, x = a, y = 0, y = b: C clamped, S simply supported, F free.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

import kshell as ks
from kshell.result.result import Result
from kshell.verify.cases import meshes
from kshell.verify.cases.case import Case, Run, case, reference_names
from kshell.verify.cases.quantities import EVERY_ELEMENT, Quantity
from kshell.verify.cases.rectangles import SIDES

Build = Callable[[int, int], ks.Scene]
FIRST_FEW = 24  # of families whose numbers among all frequencies are not known
LAYERS = 6  # of smaller triangles at corners with a singularity
# at the obtuse corners of supported rhombi, where w is like r^(pi / angle), by their acute angle
SUPPORTED_LAYERS = {75: 6, 60: 12, 45: 16, 30: 28}
SQUARE_CORNERS = ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0))


@dataclass(frozen=True)
class Eigen:
    """The frequency, or load factor, with a number (from 0); rigid motions are not counted."""

    number: int
    kind: Literal["omega", "frequency", "factor"] = "omega"
    elements: tuple[str, ...] = EVERY_ELEMENT

    def of(self, result: Result) -> float:
        return _values(result, self.kind)[self.number]


@dataclass(frozen=True)
class Nearest:
    """The frequency, or load factor, nearest to a known one: of families that are mixed with others."""

    known: float
    kind: Literal["omega", "factor"] = "omega"
    elements: tuple[str, ...] = EVERY_ELEMENT

    def of(self, result: Result) -> float:
        return min(_values(result, self.kind), key=lambda value: abs(value - self.known))


def _values(result: Result, kind: str) -> list[float]:
    values = [entry["value"] for entry in result.eigen if "name" not in entry]
    if kind == "frequency":
        return [value**0.5 / (2 * np.pi) for value in values]
    return [value**0.5 for value in values] if kind == "omega" else [v for v in values if v > 0]


def scene(
    mesh: ks.Mesh,
    held: Sequence[Any],
    loads: Sequence[Any] = (),
    material: Any = None,
    nu: float = 0.3,
    **options: Any,
) -> ks.Scene:
    """A plate of thickness 1, stiffness 1 and mass 1."""
    own = material or ks.Isotropic(E=12 * (1 - nu**2), nu=nu, density=1.0)
    solve = {"error": "off", **options}
    return ks.Scene(
        mesh=mesh, thickness=1.0, material=own, supports=list(held), loads=list(loads), solve=solve
    )


def edges(sides: str, in_plane: bool = True) -> list[Any]:
    """Supports of the sides of a rectangle; clamped ones may leave the plane free for loads there."""
    clamped: Callable[[str], Any] = ks.Clamped if in_plane else (lambda on: ks.Fixed(on, "zr"))
    kinds = {"C": clamped, "S": ks.SimplySupported}
    return [kinds[letter](on) for on, letter in zip(SIDES, sides, strict=True) if letter != "F"]


def squares() -> Iterator[Case]:
    """Frequencies of rectangles a x b, a = 1."""
    table = {  # id: sides, b, nu, corners that are refined, whether values are families
        "CCCC": ("CCCC", 1.0, 0.3, (), False),
        "CFFF": ("CFFF", 1.0, 0.3, SQUARE_CORNERS[::2], False),
        "FFFF": ("FFFF", 1.0, 0.3, (), False),
        "CCFF": ("CCFF", 1.0, 0.3, SQUARE_CORNERS, False),
        "SFFF": ("SFFF", 1.0, 0.3, (), False),
        "CFCF": ("CFCF", 1.0, 0.3, SQUARE_CORNERS, False),
        "FFFF.nu0": ("FFFF", 1.0, 0.0, (), False),
        "FFFF.nu0.225": ("FFFF", 1.0, 0.225, (), False),
        "CFFF.nu0": ("CFFF", 1.0, 0.0, SQUARE_CORNERS[::2], False),
        "FFFF.ba2": ("FFFF", 2.0, 0.3, (), False),
        "CFFF.ba0.5": ("CFFF", 0.5, 0.3, ((0.0, 0.0), (0.0, 0.5)), False),
        "SSSS": ("SSSS", 1.0, 0.3, (), False),
        "SCSC": ("SSCC", 1.0, 0.3, (), True),
        "SSSC": ("SSSC", 1.0, 0.3, (), True),
        "SFSF": ("SSFF", 1.0, 0.3, (), True),
        "SSSF": ("SSSF", 1.0, 0.3, (), True),
    }
    for name, (sides, b, nu, corners, families) in table.items():
        words = f"frequencies of a rectangle {sides}, b/a = {b:g}, nu = {nu:g}"
        count = FIRST_FEW if families else 10
        yield _case(f"vibration.{name}", words, _rectangle(sides, b, nu, corners, count), families)


def _rectangle(sides: str, b: float, nu: float, corners: Sequence[Any], count: int) -> Build:
    def build(n: int, order: int) -> ks.Scene:
        mesh = meshes.rectangle(1.0, b, n, refine=corners, layers=LAYERS if len(corners) else 0)
        return scene(mesh, edges(sides), nu=nu, analysis="modes", count=count)

    return build


def rhombi() -> Iterator[Case]:
    """Frequencies of rhombi of side 1."""
    for kind, letters in (("CCCC", "C"), ("SSSS", "S"), ("CFFF", "F")):
        for angle in (75, 60, 45, 30):
            if kind == "CCCC" and angle == 45:
                continue
            words = f"frequencies of a rhombus {kind}, acute angle {angle} degrees"
            yield _case(f"vibration.rhombus.{kind}.{angle}", words, _held_rhombus(letters, angle))


def _held_rhombus(letters: str, angle: int) -> Build:
    """Clamped (C) or supported (S) all around, or clamped along x (F)."""
    held = {"C": ks.Clamped("edge"), "S": ks.SimplySupported("edge"), "F": ks.Clamped("y0")}[letters]

    def build(n: int, order: int) -> ks.Scene:
        mesh = rhombus(angle, n, SUPPORTED_LAYERS[angle] if letters == "S" else LAYERS)
        return scene(mesh, [held], analysis="modes", count=6)

    return build


def rhombus(angle: float, n: int, layers: int) -> ks.Mesh:
    """Refined at all corners; groups "edge", and "y0" for the side along x."""
    points, triangles = meshes.grid(n, n, falling=True)
    points, triangles = meshes.refined_at(points, triangles, SQUARE_CORNERS, layers)
    t = np.radians(angle)
    moved = points @ np.array([[1, 0], [np.cos(t), np.sin(t)]])
    return meshes.mesh(moved, triangles, {"edge": meshes.everywhere, "y0": lambda x, y: y < 1e-9})


def triangles() -> Iterator[Case]:
    """Frequencies of simply supported triangles: those of membranes, squared."""
    corners = {
        "equilateral": ((0, 0), (1, 0), (0.5, np.sqrt(0.75))),
        "45.90.45": ((0, 0), (1, 0), (0, 1)),
        "30.60.90": ((0, 0), (0.5, 0), (0, np.sqrt(0.75))),
    }
    for name, places in corners.items():
        words = f"frequencies of a simply supported triangle {name}"
        yield _case(f"vibration.triangle.{name}", words, _triangle(places))


def _triangle(places: Sequence[Any]) -> Build:
    def build(n: int, order: int) -> ks.Scene:
        return scene(meshes.triangle(places, n), [ks.SimplySupported("edge")], analysis="modes", count=8)

    return build


def disks() -> Iterator[Case]:
    """Frequencies and buckling loads of disks of radius 1."""
    held: Mapping[str, list[Any]] = {
        "clamped": [ks.Clamped("edge")],
        "ss": [ks.SimplySupported("edge")],
        "free": [],
    }
    methods = (Run("argyris", 8, 2), Run("morley", 24))
    for name, supports in held.items():
        build = _disk(supports, (), analysis="modes", count=60)
        yield _case(f"vibration.disk.{name}", f"frequencies of a disk, {name}", build, True, methods)
    squeeze = ks.LineForce("edge", ("-x", "-y", 0.0))
    for name, support in (("clamped", ks.Fixed("edge", "zr")), ("ss", ks.SimplySupported("edge"))):
        build = _disk([support], [squeeze], analysis="buckling", count=2)
        words = f"buckling of a disk under uniform compression, {name}"
        yield _case(f"buckling.disk.{name}", words, build, False, methods, "factor")


def _disk(supports: Sequence[Any], loads: Sequence[Any], **options: Any) -> Build:
    def build(n: int, order: int) -> ks.Scene:
        return scene(meshes.ellipse(n, order), supports, loads, **options)

    return build


def buckling() -> Iterator[Case]:
    """Buckling of rectangles with short side 1 under N_x, N_x = N_y, or shear."""
    table = {  # id: sides, a, b, forces xx yy xy
        "SSSS.x": ("SSSS", 1.0, 1.0, (1, 0, 0)),
        "SSSS.xy": ("SSSS", 1.0, 1.0, (1, 1, 0)),
        "CCCC.x": ("CCCC", 1.0, 1.0, (1, 0, 0)),
        "CCCC.xy": ("CCCC", 1.0, 1.0, (1, 1, 0)),
        "CCCC.shear": ("CCCC", 1.0, 1.0, (0, 0, 1)),
        "SSSS.shear": ("SSSS", 1.0, 1.0, (0, 0, 1)),
        "SSSS.shear.ab2": ("SSSS", 2.0, 1.0, (0, 0, 1)),
        "CCCC.shear.ab2": ("CCCC", 2.0, 1.0, (0, 0, 1)),
        "SSSF.x": ("SSSF", 1.0, 1.0, (1, 0, 0)),
        "SSCC.x": ("SSCC", 1.0, 1.0, (1, 0, 0)),
        "CCSS.x": ("CCSS", 1.0, 1.0, (1, 0, 0)),
        "CCCC.orthotropic.x": ("CCCC", 1.0, 1.0, (1, 0, 0)),
    }
    for name, (sides, a, b, forces) in table.items():
        material = ks.Orthotropic(E1=25.0, E2=1.0, nu12=0.25, G12=0.5) if "orthotropic" in name else None
        build = _pressed(sides, a, b, forces, material, 8)
        yield _case(f"buckling.{name}", f"buckling of a rectangle {sides}, {name}", build, kind="factor")
    for ratio in (0.5, 1.0, np.sqrt(2), 1.5, 2.0, 3.0):
        words = f"buckling of a supported rectangle under N_x, a/b = {ratio:.4g}"
        build = _pressed("SSSS", ratio, 1.0, (1, 0, 0), None, 2)
        yield _case(f"buckling.SSSS.x.ab{ratio:.4g}", words, build, kind="factor")


def _pressed(
    sides: str, a: float, b: float, forces: tuple[float, float, float], material: Any, count: int
) -> Build:
    def build(n: int, order: int) -> ks.Scene:
        points, cells = meshes.grid(round(a * n), round(b * n))
        near = 1e-9
        named: dict[str, meshes.Where] = {
            "x0": lambda x, y: x < near,
            "x1": lambda x, y: x > a - near,
            "y0": lambda x, y: y < near,
            "y1": lambda x, y: y > b - near,
        }
        mesh = meshes.mesh(points * np.array([a, b]), cells, named)
        held = edges(sides, in_plane=False)
        return scene(mesh, held, pressed(*forces), material, analysis="buckling", count=count)

    return build


def pressed(xx: float, yy: float, xy: float) -> list[Any]:
    """Line forces on the sides of a rectangle for N = -pi^2 (xx, yy), and shear pi^2 xy."""
    p = np.pi**2
    forces = {
        "x0": (p * xx, -p * xy),
        "x1": (-p * xx, p * xy),
        "y0": (-p * xy, p * yy),
        "y1": (p * xy, -p * yy),
    }
    return [ks.LineForce(on, (*force, 0.0)) for on, force in forces.items() if any(force)]


def _case(
    id: str,
    description: str,
    build: Build,
    families: bool = False,
    runs: tuple[Run, ...] = (Run("argyris", 12), Run("morley", 32)),
    kind: Literal["omega", "factor"] = "omega",
) -> Case:
    """A case with one quantity for each value of its reference."""
    known = reference_names(id)
    quantities: dict[str, Quantity] = {
        name: Nearest(value, kind) if families else Eigen(number, kind)
        for number, (name, value) in enumerate(known.items())
    }
    return case(id, description, build, quantities, runs)


def cases() -> list[Case]:
    """All of them."""
    families = (squares, rhombi, triangles, disks, buckling)
    return [one for family in families for one in family()]
