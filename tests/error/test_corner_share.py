"""Intervals hold beside corners where moments grow without bound, however slowly these are resolved."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import kshell as ks
from kshell.mesh.mesh import Mesh
from tests.plate.plates import disk, rectangle

NU = 0.3
UNIT = ks.Isotropic(E=12e6 * (1 - NU**2), nu=NU)
ORTHOTROPIC: dict[str, Any] = {"E1": 24e6, "E2": 1e6, "nu12": 0.2, "G12": 0.7e6}


def turned(on: str) -> ks.Fixed:
    return ks.Fixed(on, "r")


def solved(mesh: Mesh, supports: list[Any], material: Any = UNIT, **options: Any) -> ks.Result:
    scene = ks.Scene(mesh, thickness=0.01, material=material, supports=supports, loads=[ks.Pressure(1.0)])
    return ks.solve(scene, model="plate", large_deflection=False, **options)


def energy(result: ks.Result) -> tuple[float, float]:
    found = result.error["energy"]
    return found["lower"], found["upper"]


PAIRS: dict[str, tuple[Any, Any, Any]] = {  # of bottom, of left and right, of top
    "supported beside symmetry": (ks.SimplySupported, turned, ks.Clamped),
    "supported": (ks.SimplySupported, ks.SimplySupported, ks.SimplySupported),
    "clamped beside symmetry": (ks.Clamped, turned, ks.Clamped),
    "supported beside free": (ks.SimplySupported, ks.Free, ks.Clamped),
}


@pytest.mark.filterwarnings("ignore::kshell.KshellWarning")
@pytest.mark.parametrize("skew", [0.05, 0.4])
@pytest.mark.parametrize("pair", PAIRS)
def test_energies_of_parallelograms_are_held(pair: str, skew: float) -> None:
    """The exact energies lie between those of conforming elements and the guaranteed bounds of graded meshes."""
    bottom, sides, top = PAIRS[pair]
    supports = [bottom("bottom"), sides("left"), sides("right"), top("top")]
    low, high = energy(solved(rectangle(4, 3, skew=skew), supports, tolerance=1e-2, quantity="energy"))
    for n in ((2, 1), (6, 4)):
        mesh = rectangle(*n, skew=skew)
        for options in ({"order": 3}, {"order": 4}, {"element": "argyris"}):
            element = {"element": "hhj", **options}
            lower, upper = energy(solved(mesh, supports, **element))
            assert lower <= high, (n, options)
            assert low <= upper, (n, options)


@pytest.mark.filterwarnings("ignore::kshell.KshellWarning")
@pytest.mark.parametrize("rings", [2, 3])
def test_a_disk_with_one_half_clamped(rings: int) -> None:
    mesh = disk(rings)
    upper_half = (mesh.points[mesh.edges[mesh.boundary_edges], 1] > -1e-9).all(axis=1)
    edges = mesh.edges[mesh.boundary_edges[upper_half]]
    mesh = Mesh.from_arrays(mesh.points, mesh.triangles, {"half": edges})
    low, high = energy(
        solved(mesh, [ks.Clamped("half")], element="hhj", order=5, tolerance=1e-3, quantity="energy")
    )
    lower, upper = energy(solved(mesh, [ks.Clamped("half")], element="argyris"))
    assert lower <= high
    assert low <= upper


def test_turning_a_plate_of_wood_changes_no_interval() -> None:
    """The least stiffness is sought along all directions, not along x and y."""
    found = []
    for angle in (0.0, 45.0, 60.0):
        mesh = rectangle(4, 3)
        c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        points = mesh.points @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        plate = Mesh(points, mesh.triangles, None, mesh.groups)
        wood = ks.Orthotropic(**ORTHOTROPIC, angle=angle)
        result = solved(plate, [ks.Clamped("left"), ks.SimplySupported("bottom")], wood, element="argyris")
        low, high = energy(result)
        found.append((high - low) / result.strain_energy)
    assert found == pytest.approx([found[0]] * 3, rel=1e-6)
