"""Lower bounds of frequencies of plates lie below known values, and not far below."""

import numpy as np
import pytest

import kshell as ks
from kshell.elements import ElementMorley
from kshell.error.frequencies import interpolation_constant, lower_bounds, rounding, softest
from kshell.plate.assembly import assemble
from kshell.plate.inertia import Mass
from kshell.plate.pattern import Pattern
from kshell.plate.problem import PlateProblem
from kshell.scene.structure import resolve
from kshell.solvers.eigen import smallest
from kshell.solvers.pencil import Pencil
from tests.plate.plates import ellipse, rectangle

SQUARE = {
    "CCCC": np.array([35.98519112, 73.39384552, 73.39384552, 108.2165017, 131.5807726, 132.2047902]) ** 2,
    "SSSS": np.pi**4 * np.array([4.0, 25, 25, 64, 100, 100]),
    "CFFF": np.array([3.471002321, 8.506189794, 21.28389531, 27.19868104, 30.95419535, 54.18357005]) ** 2,
    "SSFS": np.array([11.68453676647606, 27.75634474245026, 41.19665143447033, 59.06551080676645]) ** 2,
}
KINDS = {"C": ks.Clamped, "S": ks.SimplySupported, "F": ks.Free}


@pytest.mark.parametrize("sides", list(SQUARE))
@pytest.mark.parametrize("n", [16, 40])
def test_known_values_lie_above(sides, n):
    mesh = rectangle(n)
    material = ks.Isotropic(E=12 * (1 - 0.3**2), nu=0.3, density=1.0)
    held = [KINDS[k](on) for k, on in zip(sides, ("left", "bottom", "right", "top"), strict=True)]
    scene = ks.Scene(mesh=mesh, thickness=1.0, material=material, supports=held, loads=[ks.Pressure(1.0)])
    plate = PlateProblem(resolve(scene, mesh), ElementMorley())
    form = Mass(plate.domain, plate.element, plate.section)
    mass = assemble([form], [], plate.domain, plate.reduction, Pattern(plate.reduction)).matrix
    pencil = Pencil(plate.assembled.matrix, mass, np.zeros((plate.reduction.count, 0)))
    known = SQUARE[sides]
    found = smallest(pencil, len(known))
    assert found.checked
    small = rounding(pencil, found)
    assert np.all(small > 0)
    assert small.max() < 1e-7
    constant = interpolation_constant(
        mesh, plate.section.bending_per_triangle(), np.ones(len(mesh.triangles))
    )
    lower = lower_bounds(found.values, small, constant)
    assert np.all(lower < known)
    assert np.all(lower > known * (1 - 90 / n**2))


def test_softest_bending():
    nu = 0.3
    isotropic = np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])
    assert softest(isotropic[None]) == pytest.approx([1 - nu])
    assert softest(np.diag([25.0, 1.0, 0.25])[None]) == pytest.approx([0.5])


def test_local_weights():
    """A heavy or soft part counts with its own triangles only."""
    mesh = rectangle(4)
    bending = np.tile(np.diag([1.0, 1.0, 0.5]), (len(mesh.triangles), 1, 1))
    mass = np.ones(len(mesh.triangles))
    one = interpolation_constant(mesh, bending, mass)
    assert one == pytest.approx((0.2574 * 2 / 16) ** 2)
    mass[3] = 8.0
    assert interpolation_constant(mesh, bending, mass) == pytest.approx(8 * one)
    bending[3] *= 16.0
    assert interpolation_constant(mesh, bending, mass) == pytest.approx(one)


@pytest.mark.parametrize("element", ["morley", "argyris"])
@pytest.mark.parametrize("stiffness", [0.3, 30.0])
@pytest.mark.parametrize("long", [1.1, 1.4])
def test_frequencies_of_few_triangles_on_springs_lie_inside(long, stiffness, element):
    """An ellipse of six: on springs Morley values lie above the true ones as those of Argyris elements do."""
    material = ks.Isotropic(E=12 * (1 - 0.3**2), nu=0.3, density=1.0)
    coarse, fine = (
        ks.modes(
            ks.Scene(
                mesh=ellipse(rings, 2, long), thickness=1.0, material=material,
                supports=[ks.Elastic("edge", stiffness, "z")],
            ),
            count=3, model="plate", element=kind,
        )
        for rings, kind in ((1, element), (4, "argyris"))
    )  # fmt: skip
    for found, true in zip(coarse.eigen, fine.eigen, strict=True):
        assert found["lower"] <= true["value"] <= found["upper"]
