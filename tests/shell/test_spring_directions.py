"""Springs along own axes and along the normal: what they carry on spheres, cylinders and inclined plates."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import kshell as ks
from tests.shell.shapes import box

E, NU, T, R, K, P = 1000.0, 0.3, 0.05, 2.0, 7.0, 1.5


@pytest.mark.parametrize("element", ["koiter", "argyris"])
def test_a_bedding_along_the_normal_carries_a_cylinder_under_pressure(element):
    """A panel of a cylinder between planes of symmetry grows by w (k + A / R^2 + D / R^4) = p."""
    chart = ks.geometry.Cylinder(R=R)
    mesh = chart.parameter_mesh(4, 4, ("start", "end", "foot", "top"), (0, 0.8), (0, 1))
    whole = next(name for name, group in mesh.groups.items() if group.dimension == 2)
    scene = ks.Scene(
        mesh=mesh,
        chart=chart,
        thickness=T,
        material=ks.Isotropic(E=E, nu=NU),
        supports=[
            *(ks.Symmetry(side) for side in ("start", "end", "foot", "top")),
            ks.Elastic(whole, K, "n"),
        ],
        loads=[ks.Pressure(P)],
        probes={"middle": (R * np.cos(0.4), R * np.sin(0.4), 0.5)},
    )
    result = ks.solve(scene, element=element, large_deflection=False)
    u = result.probe("middle")["u"]
    outwards = np.array([np.cos(0.4), np.sin(0.4), 0.0])
    ring = E * T / (1 - NU**2) * (1 / R**2 + T**2 / 12 / R**4)
    assert u @ outwards == pytest.approx(P / (K + ring), rel=1e-5)
    assert result.balance < 1e-8


def square(supports, loads, **solve):
    mesh = "meshes/unit_square.msh"
    scene = ks.Scene(
        mesh=mesh,
        thickness=0.1,
        material=ks.Isotropic(E=1e4, nu=0.0, density=1.0),
        supports=supports,
        loads=loads,
        probes={"centre": (0.5, 0.5, 0.0)},
    )
    return ks.solve(scene, large_deflection=False, **solve)


def test_own_axes_lean(monkeypatch, request):
    """A plate on beddings along leaning axes moves by f_i / k along each of them."""
    monkeypatch.chdir(request.config.rootpath)
    axes = np.array([[1, 0, 1], [0, 1, 0], [-1, 0, 1]]) / np.sqrt([[2], [1], [2]])
    force = np.array([1.0, 2.0, 3.0])
    stiff = (2.0, 3.0, 5.0)
    supports = [
        ks.Elastic("plate", k, letter, axes=axes.tolist()) for k, letter in zip(stiff, "xyz", strict=True)
    ]
    result = square(supports, [ks.Traction(tuple(force))])
    assert result.model["kind"] == "shell"
    expected = sum((axis @ force) / k * axis for k, axis in zip(stiff, axes, strict=True))
    np.testing.assert_allclose(result.probe("centre")["u"], expected, rtol=1e-8)


@pytest.mark.parametrize("element", ["morley", "argyris"])
def test_the_normal_of_a_plate_is_z(element, monkeypatch, request):
    monkeypatch.chdir(request.config.rootpath)
    by_n = square([ks.Elastic("plate", 4.0, "n")], [ks.Pressure(1.0)], element=element)
    assert by_n.probe("centre")["u"][2] == pytest.approx(0.25, rel=1e-8)


def test_leaning_springs_are_not_of_plates(monkeypatch, request):
    monkeypatch.chdir(request.config.rootpath)
    lean = [[1, 0, 1], [0, 1, 0], [-1, 0, 1]]
    with pytest.raises(ks.InputError, match="couples bending with motion in the plane"):
        square([ks.Elastic("plate", 4.0, "x", axes=lean)], [ks.Pressure(1.0)], model="plate")


@pytest.mark.parametrize(("stiffness", "said"), [(1e-9, True), (1.0, False)])
def test_springs_too_soft_against_rounding_are_said(stiffness, said):
    """A closed box under pressure of its walls: their forces balance, what is left of them is rounding."""
    mesh = box()
    scene = ks.Scene(
        mesh=ks.Mesh.from_arrays(mesh.points, mesh.triangles, {"box": mesh.triangles}),
        thickness=0.01,
        material=ks.Isotropic(E=2e11, nu=0.3),
        supports=[ks.Elastic("box", stiffness, "xyz")],
        loads=[ks.Pressure(1e5)],
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = ks.solve(scene, large_deflection=False)
    assert (
        bool([words for words in result.warnings if "springs alone keep the shell in place" in words]) == said
    )
