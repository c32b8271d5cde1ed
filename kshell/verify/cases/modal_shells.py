"""Buckling of shells against classical loads, and published frequencies of thin plates and a membrane."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

import kshell as ks
from kshell.result.result import Result
from kshell.verify.cases import meshes
from kshell.verify.cases.case import Case, Run, case, reference_names
from kshell.verify.cases.modal import Build, Eigen, edges, rhombus
from kshell.verify.cases.quantities import Quantity
from kshell.verify.cases.shell import Parameters, Shell

E, NU = 1.0, 0.3
SIDES = ("u0", "u1", "v0", "v1")
# of the published plates: a side of 10 m, 0.05 m thick, steel of 8000 kg/m^3
STEEL = ks.Isotropic(E=200e9, nu=0.3, density=8000.0)


def tubes() -> Iterator[Case]:
    """A long tube under outer pressure: a quarter of a ring in plane strain, so of two waves and more."""
    thickness = 0.01
    bending = E * thickness**3 / 12 / (1 - NU**2)
    ring = Parameters((0, np.pi / 2), (0, 0.3), SIDES)
    for name, follower in (("", True), (".dead", False)):
        given = {
            "thickness": thickness,
            "material": ks.Isotropic(E=E, nu=NU),
            "supports": [ks.Symmetry(side) for side in SIDES],
            "loads": [ks.Pressure(-bending, follower=follower)],
            "solve": {"analysis": "buckling", "count": 3},
        }
        shell = Shell(ks.geometry.Cylinder(R=1.0), lambda n: ring.mesh(n, 1), given)
        words = f"buckling of a long tube under a pressure that {'turns with it' if follower else 'does not turn'}"
        yield _buckling(f"shell.buckling.tube{name}", words, shell, (8, 16), (6, 12))


def axial() -> Iterator[Case]:
    """A cylinder pressed along its axis by ends that slide outward freely, three half waves long; a narrow sector."""
    thickness = 0.01
    wave = np.pi * np.sqrt(thickness) / (12 * (1 - NU**2)) ** 0.25
    strain = thickness / np.sqrt(3 * (1 - NU**2))  # of the classical stress
    sector = Parameters((0, np.pi / 16), (0, 3 * wave), SIDES)
    given = {
        "thickness": thickness,
        "material": ks.Isotropic(E=E, nu=NU),
        "supports": [
            ks.Symmetry(["u0", "u1", "v0"]),
            ks.Fixed("v1", "zr", value=(0, 0, -3 * wave * strain)),
        ],
        "solve": {"analysis": "buckling", "count": 1},
    }
    shell = Shell(ks.geometry.Cylinder(R=1.0), lambda n: sector.mesh(2, n), given)
    words = "buckling of a cylinder under axial compression in waves around it"
    yield _buckling("shell.buckling.cylinder.axial", words, shell, (9, 18), (9, 18))


def sphere() -> Iterator[Case]:
    """A sphere under outer pressure, an octant of it."""
    thickness = 0.02
    classical = 2 * E * thickness**2 / np.sqrt(3 * (1 - NU**2))

    def build(n: int, order: int) -> ks.Scene:
        return ks.Scene(
            mesh=_octant(n, order),
            thickness=thickness,
            material=ks.Isotropic(E=E, nu=NU),
            supports=[ks.Symmetry(["x0", "y0", "z0"])],
            loads=[ks.Pressure(-classical)],
            solve={"analysis": "buckling", "count": 1},
        )

    yield _buckling(
        "shell.buckling.sphere", "buckling of a sphere under outer pressure", build, (12,), (8, 12)
    )


def _octant(n: int, order: int) -> ks.Mesh:
    """Of the unit sphere, n triangles along each side; groups x0, y0, z0 of the sides."""
    i, j = (k.ravel() for k in np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij"))
    inside = i + j <= n
    number = np.full((n + 2, n + 2), -1)
    number[i[inside], j[inside]] = np.arange(inside.sum())
    points = np.sin(np.stack([i, j, n - i - j], axis=1)[inside] / n * np.pi / 2)
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    p, q = i[i + j < n], j[i + j < n]
    upright = np.stack([number[p, q], number[p + 1, q], number[p, q + 1]], axis=1)
    p, q = i[i + j < n - 1], j[i + j < n - 1]
    turned = np.stack([number[p + 1, q], number[p + 1, q + 1], number[p, q + 1]], axis=1)
    triangles = np.concatenate([upright, turned])
    flat = ks.Mesh.from_arrays(points, triangles)
    ends = flat.edges[flat.boundary_edges]
    groups = {
        name: ends[(points[ends, axis] < 1e-12).all(axis=1)] for axis, name in enumerate(("x0", "y0", "z0"))
    }
    middles = points[flat.edges].mean(axis=1)
    middles /= np.linalg.norm(middles, axis=1, keepdims=True)
    return ks.Mesh.from_arrays(points, triangles, groups, middles if order == 2 else None)


def _buckling(
    id: str, description: str, build: Build, quadratic: tuple[int, ...], cubic: tuple[int, ...]
) -> Case:
    quantities: dict[str, Quantity] = {
        name: Eigen(number, "factor") for number, name in enumerate(reference_names(id))
    }
    runs = [Run("koiter", n, 2, degree) for degree, many in ((2, quadratic), (3, cubic)) for n in many]
    return case(id, description, build, quantities, tuple(runs))


def published_plates() -> Iterator[Case]:
    """FV12 and FV16 of NAFEMS: a free square and one clamped along a side; values are in units of Hz."""
    table: dict[str, tuple[str, Any]] = {
        "FV12": ("FFFF", "a free thin square plate"),
        "FV16": ("CFFF", "a thin square plate clamped along one side"),
    }
    for name, (sides, words) in table.items():
        id = f"vibration.nafems.{name}"
        numbers = (0, 1, 2, 5) if name == "FV12" else range(6)
        known = reference_names(id)
        quantities: dict[str, Quantity] = {
            mode: Eigen(number, "frequency") for number, mode in zip(numbers, known, strict=True)
        }

        def build(n: int, order: int, sides: str = sides) -> ks.Scene:
            mesh = meshes.rectangle(10.0, 10.0, n)
            return ks.Scene(
                mesh=mesh, thickness=0.05, material=STEEL, supports=edges(sides),
                solve={"analysis": "modes", "count": 6, "error": "off"},
            )  # fmt: skip

        yield case(
            id, f"frequencies of {words} (NAFEMS {name})", build, quantities, (Run("argyris", 8), Run("morley", 32))
        )  # fmt: skip


def rhombi() -> Iterator[Case]:
    """FV15 and FV22 of NAFEMS: a clamped rhombus of 45 degrees, thin, and as thick as a tenth of its side.

    This theory has no shear: of the thick one it gives 20 times the frequencies of the thin one, and the size of what
    is left out, with which the first frequency comes within 2 % of that of a plate with shear.
    """
    side = 10.0
    for name, thickness in (("FV15", 0.05), ("FV22", 1.0)):
        id = f"vibration.nafems.{name}"
        quantities: dict[str, Quantity] = {
            mode: Sheared() if mode == "f1.shear" else Eigen(number, "frequency")
            for number, mode in enumerate(reference_names(id))
        }

        def build(n: int, order: int, thickness: float = thickness) -> ks.Scene:
            unit = rhombus(45, n, 3)
            mesh = ks.Mesh.from_arrays(
                side * unit.points, unit.triangles, {"edge": unit.edges[unit.boundary_edges]}
            )
            return ks.Scene(
                mesh=mesh, thickness=thickness, material=STEEL, supports=[ks.Clamped("edge")],
                solve={"analysis": "modes", "count": 6},
            )  # fmt: skip

        words = (
            f"frequencies of a clamped rhombus of 45 degrees, t / side = {thickness / side:g} (NAFEMS {name})"
        )
        thick = name == "FV22"  # with its estimates
        runs = (Run("argyris", 8), Run("morley", 16 if thick else 32))
        yield case(id, words, build, quantities, runs, estimated=thick)


@dataclass(frozen=True)
class Sheared:
    """The first frequency with the share of shear in the budget, which is that of its square, taken off."""

    elements: tuple[str, ...] = ("argyris",)

    def of(self, result: Result) -> float:
        """In units of Hz."""
        return float(result.eigen[0]["frequency"] * np.sqrt(1.0 - result.error["budget"]["shear"]))


def membrane() -> Iterator[Case]:
    """FV32 of NAFEMS: a tapered membrane clamped at its wide end, vibrating in its plane."""
    id = "shell.nafems.FV32"

    def build(n: int, order: int) -> ks.Scene:
        points, cells = meshes.grid(2 * n, n)
        half = 2.5 - 2.0 * points[:, 0]  # at 10 x along
        moved = np.stack([10.0 * points[:, 0], (2.0 * points[:, 1] - 1.0) * half], axis=1)
        mesh = meshes.mesh(moved, cells, {"root": lambda x, y: x < 1e-9})
        every = ks.Mesh.from_arrays(
            mesh.points,
            mesh.triangles,
            {"root": mesh.edges[mesh.groups["root"].members], "all": mesh.triangles},
        )
        return ks.Scene(
            mesh=every, thickness=0.05, material=STEEL, supports=[ks.Fixed("root", "xy"), ks.Fixed("all", "z")],
            solve={"analysis": "modes", "model": "shell", "count": 6, "error": "off"},
        )  # fmt: skip

    quantities: dict[str, Quantity] = {
        name: Eigen(number, "frequency") for number, name in enumerate(reference_names(id))
    }
    runs = (Run("koiter", 8, 1, 2), Run("koiter", 4, 1, 3), Run("koiter", 8, 1, 3))
    yield case(id, "frequencies of a tapered membrane in its plane (NAFEMS FV32)", build, quantities, runs)


def strips() -> Iterator[Case]:
    """Narrow strips that buckle out of their plane: under their weight, and by end moments."""
    thickness = 0.001
    weight = thickness**2 / 12

    def upright(n: int, order: int) -> ks.Scene:
        return ks.Scene(
            mesh=_strip(n, 1, 1.0, 0.02), thickness=thickness, material=ks.Isotropic(E=1.0, nu=0.0, density=1.0),
            supports=[ks.Clamped("x0")], loads=[ks.Gravity((-weight, 0, 0))],
            solve={"analysis": "buckling", "count": 1, "error": "off"},
        )  # fmt: skip

    runs = (Run("argyris", 8), Run("morley", 32))
    words = "buckling of an upright cantilever under its own weight"
    yield _plate("buckling.strip.weight", words, upright, runs)
    length, unit = 40.0, _lateral(40.0)

    def bent(n: int, order: int) -> ks.Scene:
        pull = 12 * unit * length
        return _narrow(
            _strip(n, max(2, n // 20), length, 1.0), [ks.SimplySupported(["x0", "x1"])],
            [ks.LineForce("x0", (f"{pull!r}*y", 0, 0)), ks.LineForce("x1", (f"-{pull!r}*y", 0, 0))],
        )  # fmt: skip

    words = "lateral buckling of a strip between fork bearings, by equal end moments"
    yield _plate("buckling.strip.moment", words, bent, (Run("argyris", 40), Run("morley", 160)))

    def pushed(n: int, order: int) -> ks.Scene:
        return _narrow(
            _strip(n, 2, 50.0, 1.0), [ks.Fixed("x0", "xyz"), ks.Fixed((0, 0, 0), "r")],
            [ks.LineForce("x1", (0, -_lateral(50.0), 0))],
        )  # fmt: skip

    words = "lateral buckling of a narrow cantilever under a force at its end, height / length = 1/50"
    yield _plate("buckling.strip.tip", words, pushed, (Run("argyris", 25), Run("argyris", 50)))

    def column(n: int, order: int) -> ks.Scene:
        length, width, thin, e = 0.02, 0.0025, 6e-4, 200e9
        euler = np.pi**2 * e * thin**3 / 12 / (2 * length) ** 2
        mesh = ks.geometry.Plane().mesh(
            n, max(1, n // 8), 1, ("x0", "x1", "y0", "y1"), (0, length), (0, width), "alternate"
        )
        return ks.Scene(
            mesh=mesh, thickness=thin, material=ks.Isotropic(E=e, nu=0.0), supports=[ks.Clamped("x0")],
            loads=[ks.LineForce("x1", (-euler, 0, 0))], solve={"analysis": "buckling", "count": 1, "error": "off"},
        )  # fmt: skip

    words = "buckling of a thin strip of millimetres, in units of m, clamped at one end (Euler's column)"
    yield _plate("buckling.strip.column", words, column, (Run("argyris", 8), Run("morley", 32)))


def _strip(n_x: int, n_y: int, length: float, height: float) -> ks.Mesh:
    sides = ("x0", "x1", "y0", "y1")
    return ks.geometry.Plane().mesh(n_x, n_y, 1, sides, (0, length), (-height / 2, height / 2), "alternate")


def _lateral(length: float, thickness: float = 0.02) -> float:
    """(B C)^(1/2) / L^2 of a strip of E = 1, nu = 0 and height 1: B = E h t^3 / 12, C = G h t^3 / 3."""
    return float(np.sqrt(thickness**3 / 12 * thickness**3 / 6)) / length**2


def _narrow(mesh: ks.Mesh, held: list[Any], loads: list[Any], **options: Any) -> ks.Scene:
    solve = {"analysis": "buckling", "count": 2, "error": "off", **options}
    material = ks.Isotropic(E=1.0, nu=0.0)
    return ks.Scene(mesh=mesh, thickness=0.02, material=material, supports=held, loads=loads, solve=solve)


def _plate(id: str, words: str, build: Build, runs: tuple[Run, ...]) -> Case:
    return case(id, words, build, {"factor": Eigen(0, "factor")}, runs)


def cases() -> list[Case]:
    """All of them."""
    families = (tubes, axial, sphere, strips, published_plates, rhombi, membrane)
    return [one for family in families for one in family()]
