"""The same scenes on several processes under mpiexec are those on one.

Skipped where PETSc or mpiexec is missing: install the extra `distributed`. All scenes of a number of processes are
solved in one run, because processes take longer to start than to solve.
"""

import json
import math
from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kshell as ks
from tests.distributed.processes import MISSING, run_code
from tests.plate.plates import disk

pytestmark = pytest.mark.skipif(bool(MISSING), reason=f"the extra distributed is not installed: {MISSING}")

# what is left of numbers that cancel, and what is computed from it
ROUNDING = (
    "balance",
    "algebra",
    "half_width",
    "expected",
    "estimate",
    "discretisation",
    "error.energy",
    "large_deflection",
)
PROGRAM = """
import json, sys, warnings
from pathlib import Path
import kshell as ks
from kshell.distributed.team import world

warnings.simplefilter("ignore")
folder = Path(sys.argv[1])
for file in sorted(folder.glob("*.toml")):
    scene = ks.Scene.load(file)
    result = ks.solve(scene, solver="petsc")
    result.save(folder / file.stem)
"""


def roof_mesh(order: int = 2, n: int = 5) -> ks.Mesh:
    names = ("free", "crown", "middle", "wall")
    geometry = 1 if order == 1 else 2
    return ks.geometry.Cylinder(1.0).mesh(n, n + 1, geometry, names, (0.87, math.pi / 2), (0.0, 1.0))


def roof(order: int, ratio: float, **more: Any) -> ks.Scene:
    given: dict[str, Any] = {
        "mesh": roof_mesh(order),
        "supports": [ks.Symmetry(["crown", "middle"]), ks.Fixed("wall", "xy")],
        "loads": [ks.Traction((0, -1, 0), name="weight")],
        "probes": {"edge": (0.644827, 0.764329, 0.0), "inside": (0.3, 0.95, 0.4)},
        "solve": {"order": order, "large_deflection": False},
    }
    material = ks.Isotropic(E=1e4 / ratio, nu=0.3, density=1.0)
    return ks.Scene(thickness=ratio, material=material, **{**given, **more})


def inclined() -> ks.Scene:
    """Supports in axes of their own, springs, a line force, a moment at a point and a prescribed motion."""
    c, s = math.cos(0.3), math.sin(0.3)
    return roof(
        2,
        1e-2,
        supports=[
            ks.Fixed("wall", "xy", value=(0, 1e-6, 0)),
            ks.Fixed("crown", "z", axes=((1, 0, 0), (0, c, s), (0, -s, c))),
            ks.Elastic("free", 10.0, "xyz"),
            ks.Elastic("surface", 5.0, "n"),
        ],
        loads=[
            ks.PointForce((0.3, 0.95, 0.4), (0, -1, 0)),
            ks.LineForce("middle", (0, -0.1, 0)),
            ks.PointMoment((0.644827, 0.764329, 0.0), (0, 0, 0.01)),
            ks.Temperature(gradient=1e-5, expansion=1e-3),
        ],
    )


def layered() -> ks.Scene:
    """A laminate that is not symmetric, of varying directions, under temperature."""
    ply = ks.Orthotropic(E1=1e6, E2=1e5, nu12=0.3, G12=5e4)
    return ks.Scene(
        mesh=roof_mesh(),
        layers=[ks.Layer(ply, 0.005, 0.0), ks.Layer(ply, 0.005, 60.0)],
        supports=[ks.Clamped("wall")],
        loads=[ks.Pressure("1 + z"), ks.Temperature(mean=3.0, gradient=10.0, expansion=1e-5)],
        direction=(0.0, 0.2, 1.0),
        probes={"inside": (0.3, 0.95, 0.4)},
        solve={"large_deflection": False},
    )


def linked() -> ks.Scene:
    """An edge that moves with a point as one body, and a thickness that varies inside triangles."""
    return ks.Scene(
        mesh=roof_mesh(),
        thickness="0.01 + 0.005*x",
        offset=0.002,
        material=ks.Isotropic(E=1e6, nu=0.3),
        supports=[ks.Clamped("crown"), ks.RigidLink("free", (0.7, 0.7, 0.5), name="tip")],
        loads=[ks.PointForce("tip", (0, -1, 0)), ks.PointMoment("tip", (0.1, 0, 0.3))],
        probes={"inside": (0.3, 0.95, 0.4)},
        solve={"large_deflection": False},
    )


def branched() -> ks.Scene:
    """Three sheets that meet at one line, with different thicknesses."""
    n = 4
    grid = [(i, j) for i in range(n + 1) for j in range(n + 1)]
    points, triangles, groups = [], [], {}
    number: dict[tuple[float, ...], int] = {}

    def vertex(x: float, y: float, z: float) -> int:
        key = (round(x, 9), round(y, 9), round(z, 9))
        if key not in number:
            number[key] = len(points)
            points.append(key)
        return number[key]

    for name, (dy, dz) in {"left": (-1.0, 0.0), "right": (1.0, 0.0), "web": (0.0, -1.0)}.items():
        at = {(i, j): vertex(i / n, dy * j / n, dz * j / n) for i, j in grid}
        own = []
        for i in range(n):
            for j in range(n):
                a, b, c, d = at[i, j], at[i + 1, j], at[i + 1, j + 1], at[i, j + 1]
                own += [[a, b, c], [a, c, d]]
        groups[name] = np.array(own)
        groups[f"{name} end"] = np.array([[at[0, j], at[0, j + 1]] for j in range(n)])
        triangles += own
    mesh = ks.Mesh.from_arrays(np.array(points), np.array(triangles), groups)
    return ks.Scene(
        mesh=mesh,
        thickness={"left": 0.02, "right": 0.01, "web": 0.03},
        material=ks.Isotropic(E=1e7, nu=0.3),
        supports=[ks.Clamped(["left end", "right end", "web end"])],
        loads=[ks.Pressure(1.0, "right"), ks.PointForce((1.0, 0.0, 0.0), (0, 0, -1.0))],
        probes={"joint": (1.0, 0.0, 0.0), "tip": (1.0, 1.0, 0.0)},
        solve={"order": 2, "large_deflection": False},
    )


def plate(element: str) -> ks.Scene:
    mesh = ks.geometry.Plane().mesh(9, 8, 1, ("left", "right", "bottom", "top"), (0.0, 1.0), (0.0, 1.0))
    return ks.Scene(
        mesh=mesh,
        thickness=0.01,
        material=ks.Isotropic(E=1e9, nu=0.3),
        supports=[
            ks.Clamped("left"),
            ks.Fixed("right", "z", value=(0, 0, 1e-4)),
            ks.Elastic("top", 1e4, "z"),
        ],
        loads=[ks.Pressure(100.0), ks.PointForce((0.5, 0.5, 0.0), (0, 0, 3.0))],
        probes={"centre": (0.5, 0.5, 0.0), "beside": (0.31, 0.77, 0.0)},
        solve={"element": element, "model": "plate", "large_deflection": False},
    )


def stepped_disk() -> ks.Scene:
    """Curved edges, a curved line at which the stiffness jumps, and a soft ground."""
    mesh = disk(4, 2)
    radius = np.linalg.norm(mesh.points[mesh.triangles][..., :2], axis=2)
    inner = np.flatnonzero((radius < 0.5 + 1e-9).all(axis=1))
    outer = np.setdiff1d(np.arange(len(mesh.triangles)), inner)
    groups = {**mesh.groups, "in": ks.mesh.Group(2, inner), "out": ks.mesh.Group(2, outer)}
    return ks.Scene(
        mesh=ks.Mesh(mesh.points, mesh.triangles, mesh.midpoints, groups),
        thickness={"in": 0.02, "out": 0.01},
        material=ks.Isotropic(E=1e9, nu=0.3),
        supports=[ks.SimplySupported("edge"), ks.Elastic("in", 1e5, "z")],
        loads=[ks.Pressure("100*(1 + x + 0.5*y)")],
        probes={"centre": (0.1, 0.0, 0.0)},
        solve={"element": "argyris", "model": "plate", "large_deflection": False},
    )


def large(**options: Any) -> ks.Scene:
    """A strip that bends far under a pressure that turns with it, or a path of it."""
    mesh = ks.geometry.Plane().mesh(8, 2, 1, ("left", "right", "bottom", "top"), (0.0, 10.0), (0.0, 1.0))
    return ks.Scene(
        mesh=mesh,
        thickness=0.1,
        material=ks.Isotropic(E=1e7, nu=0.0),
        supports=[ks.Clamped("left")],
        loads=[ks.LineForce("right", (0, 0, 40.0)), ks.Pressure(1.0, follower=True)],
        probes={"tip": (10.0, 0.5, 0.0)},
        solve={"model": "shell", "order": 2, **options},
    )


def cases() -> ks.Scene:
    loads = [ks.Traction((0, -1, 0), name="weight"), ks.LineForce("free", (0.1, 0, 0), name="push")]
    return roof(
        2,
        1e-2,
        loads=loads,
        cases=[ks.Case("one", ["weight"]), ks.Case("two", ["push"], [2.0])],
        combinations=[ks.Combination("both", {"one": 1.35, "two": 1.5})],
    )


# how to make it
SCENES: dict[str, Callable[[], ks.Scene]] = {
    "roof-1": lambda: roof(1, 1e-2),
    "roof-2": lambda: roof(2, 1e-3),
    "roof-2-thin": lambda: roof(2, 1e-4),
    "roof-3": lambda: roof(3, 1e-3),
    "inclined": inclined,
    "branched": branched,
    "layered": layered,
    "linked": linked,
    "cases": cases,
    "large": lambda: large(large_deflection=True),
    "path": lambda: large(analysis="path", steps=3),
    "auto": lambda: large(),
    "morley": lambda: plate("morley"),
    "argyris": lambda: plate("argyris"),
    "disk": stepped_disk,
}
# how far displacements, reactions, and everything else may be off. Small deflections are refined to 1e-11 of the
# energy; stresses are differences of displacements over the size of a triangle, of which rounding alone leaves 5e-12 at
# t/R = 1e-4. Large ones end where the work of what is left is 1e-13.
LINEAR, LARGE = (1e-10, 2e-10, 1e-9), (1e-10, 1e-10, 1e-8)
NOT_SMALL = ("large", "path", "auto")


def vibrating(supports: list[Any], mesh: ks.Mesh, **options: Any) -> ks.Scene:
    return ks.Scene(
        mesh=mesh,
        thickness=0.01,
        material=ks.Isotropic(E=1e6, nu=0.3, density=1.0),
        supports=supports,
        solve={"analysis": "modes", "count": 4, **options},
    )


def square() -> ks.Mesh:
    return ks.geometry.Plane().mesh(9, 8, 1, ("left", "right", "bottom", "top"), (0.0, 1.0), (0.0, 1.0))


MODES: dict[str, Callable[[], ks.Scene]] = {
    "modes-shell": lambda: vibrating([ks.Clamped("wall"), ks.Elastic("free", 1.0, "xyz")], roof_mesh()),
    "modes-free": lambda: vibrating([], roof_mesh()),
    "modes-plate": lambda: vibrating([ks.Clamped("left"), ks.SimplySupported("top")], square()),
    "modes-morley": lambda: vibrating([ks.Clamped("left")], square(), element="morley"),
}


# which are solved on how many processes: more of them than cores wait for each other most of the time
ON: dict[int, list[str]] = {
    1: ["roof-3", "cases", "auto", "argyris", "modes-plate"],
    2: [*SCENES, *MODES],
    4: [
        "roof-1",
        "roof-2",
        "roof-2-thin",
        "roof-3",
        "branched",
        "inclined",
        "linked",
        "path",
        "morley",
        "argyris",
        "disk",
    ],
}


@pytest.fixture(scope="module")
def several(tmp_path_factory: pytest.TempPathFactory) -> Callable[[int], Path]:
    """Makes a folder with the results of scenes on some processes."""

    @cache
    def solved(ranks: int) -> Path:
        folder = tmp_path_factory.mktemp(f"processes-{ranks}")
        makers = {**SCENES, **MODES}
        for name in ON[ranks]:
            makers[name]().save(folder / f"{name}.toml")
        done = run_code(ranks, PROGRAM, folder)
        assert done.returncode == 0, done.stderr
        return folder

    return solved


def pairs(of: Iterable[str]) -> list[tuple[int, str]]:
    return [(ranks, name) for ranks, names in ON.items() for name in names if name in of]


def reactions_of(document: dict[str, Any]) -> np.ndarray:
    """All forces and moments of supports, over the largest of each."""
    of = [r for part in [document, *document.get("cases", {}).values()] for r in part["reactions"].values()]
    forces, moments = (np.array([reaction[key] for reaction in of]) for key in ("force", "moment"))
    return np.concatenate([forces / np.abs(forces).max(), moments / np.abs(moments).max()])


def differences(one: Any, other: Any, where: str = "", scale: float = 0.0) -> list[tuple[float, str]]:
    """Relative differences of numbers in two documents, against the largest of each list."""
    if isinstance(one, dict):
        assert set(one) == set(other), where
        keys = [key for key in one if key != "solver"]
        return [d for key in keys for d in differences(one[key], other[key], f"{where}.{key}")]
    if isinstance(one, list):
        assert len(one) == len(other), where
        size = max([scale, *(abs(p) for p in one if isinstance(p, int | float))])
        pairs = enumerate(zip(one, other, strict=True))
        return [d for k, (p, q) in pairs for d in differences(p, q, f"{where}[{k}]", size)]
    if isinstance(one, float) and isinstance(other, float):
        return [(abs(one - other) / max(scale, abs(one), 1e-300), where)]
    assert one == other, where
    return []


def without_rounding(document: dict[str, Any]) -> dict[str, Any]:
    """The document without reactions, which are compared by themselves, and without places of equal extremes."""
    for part in [document, *document.get("cases", {}).values()]:
        part.pop("reactions")
        for extreme in part["extremes"].values():  # of equal ones any may be the largest
            for key in ("at", "group", "face"):
                extreme.pop(key, None)
        part.pop("warnings")
        part["model"].pop("reasons")
    document.pop("envelope", None)
    return document


@pytest.mark.parametrize(("ranks", "name"), pairs(SCENES))
def test_several_processes_find_what_one_does(several: Callable[[int], Path], ranks: int, name: str) -> None:
    tight, held, bound = LARGE if name in NOT_SMALL else LINEAR
    folder = several(ranks)
    alone = ks.solve(ks.Scene.load(folder / f"{name}.toml"))
    found = json.loads((folder / name / "result.json").read_text(encoding="utf-8"))
    expected = json.loads(json.dumps(alone.to_dict()))
    assert len(found["warnings"]) == len(expected["warnings"])
    assert len(found["path"]) == len(expected["path"])
    np.testing.assert_allclose(reactions_of(found), reactions_of(expected), rtol=0.0, atol=held)
    for difference, where in differences(without_rounding(expected), without_rounding(found)):
        if not any(word in where for word in ROUNDING):
            assert difference <= (tight if where.endswith(("].u", ".u")) else bound), where
    assert found["solver"]["processes"] == ranks
    loaded = ks.Result.load(folder / name)
    own = alone.fields["displacement"]
    assert np.abs(loaded.fields["displacement"] - own).max() <= tight * np.abs(own).max()


@pytest.mark.parametrize(("ranks", "name"), pairs(MODES))
def test_several_processes_find_the_modes_that_one_does(
    several: Callable[[int], Path], ranks: int, name: str
) -> None:
    folder = several(ranks)
    alone = ks.solve(ks.Scene.load(folder / f"{name}.toml"))
    found = json.loads((folder / name / "result.json").read_text(encoding="utf-8"))
    expected = json.loads(json.dumps(alone.to_dict()))
    assert len(found["eigen"]) == len(expected["eigen"])
    for one, other in zip(found["eigen"], expected["eigen"], strict=True):
        assert one["kind"] == other["kind"]
        for key in ("value", "lower", "upper"):
            assert one[key] == pytest.approx(other[key], rel=1e-9, abs=1e-300)
        assert one["effective_mass"] == pytest.approx(other["effective_mass"], rel=1e-7, abs=1e-9)
    assert found["warnings"] == expected["warnings"]
    fields = ks.Result.load(folder / name).fields
    for mode in alone.fields:
        shape = alone.fields[mode]
        assert np.abs(fields[mode] - shape).max() <= 1e-6 * np.abs(shape).max()
