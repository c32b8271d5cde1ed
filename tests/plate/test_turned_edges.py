"""Prescribed rotations of the edges of plates, and the work that supports do when they move."""

from pathlib import Path

import numpy as np
import pytest

import kshell as ks
from tests.plate.plates import UNIT, disk, rectangle

MESHES = Path(__file__).parents[2] / "meshes"
TURN = 0.1
STRIP = ks.Isotropic(E=12, nu=0.0)  # with thickness 1 the bending stiffness D is 1


def strip(freedoms, **changes):
    """Clamped at x = 0 and turned at x = 2, of width 1."""
    data = {
        "mesh": rectangle(4, 2, 2.0, 1.0),
        "thickness": 1.0,
        "material": STRIP,
        "supports": [ks.Clamped("left"), ks.Fixed("right", freedoms, rotation=TURN)],
        "probes": {"end": (2.0, 0.5, 0.0), "middle": (1.0, 0.5, 0.0)},
    }
    return ks.Scene(**{**data, **changes})


@pytest.mark.parametrize("element", ["morley", "argyris", "hhj"])
def test_a_strip_that_is_turned_at_its_end_bends_as_one_under_an_end_moment(element):
    result = ks.solve(strip("r"), element=element, error="off")
    assert result.probes["end"]["u"][2] == pytest.approx(-TURN, rel=1e-9)  # w = - turn x^2 / (2 L)
    assert result.probes["middle"]["M"] == pytest.approx([TURN / 2, 0.0, 0.0], abs=1e-9)
    assert result.reactions["right"]["moment"] == pytest.approx([0.0, TURN / 2, 0.0], abs=1e-9)
    assert result.strain_energy == pytest.approx(TURN**2 / 4, rel=1e-9)
    assert result.external_work == pytest.approx(result.strain_energy, rel=1e-9)
    moment = ks.EdgeMoment("right", TURN / 2)
    loaded = ks.solve(strip("r", supports=[ks.Clamped("left")], loads=[moment]), element=element, error="off")
    assert result.probes["middle"]["u"] == pytest.approx(loaded.probes["middle"]["u"], abs=1e-9)


@pytest.mark.parametrize("element", ["argyris", "hhj"])
def test_the_end_of_a_held_strip_takes_4_D_over_L(element):
    result = ks.solve(strip("zr"), element=element, error="off")
    assert result.reactions["right"]["moment"][1] + 2.0 * result.reactions["right"]["force"][
        2
    ] == pytest.approx(4.0 * TURN / 2, rel=1e-9)
    assert result.external_work == pytest.approx(0.5 * TURN * 4.0 * TURN / 2, rel=1e-9)


def levy(n, **changes):
    """A square, supported all around, its left edge turned by a sine."""
    supports = [ks.SimplySupported(name) for name in ("top", "bottom", "right")]
    data = {
        "mesh": rectangle(n, n),
        "thickness": 1.0,
        "material": ks.Isotropic(**UNIT),
        "supports": [*supports, ks.Fixed("left", "zr", rotation=f"{TURN}*sin(pi*y)")],
        "probes": {"centre": (0.5, 0.5, 0.0)},
    }
    return ks.Scene(**{**data, **changes})


def levy_deflection():
    """w = f(x) sin(pi y) with f(0) = f(1) = f''(1) = 0, f'(0) = turn: Levy's solution, at the centre."""
    x = np.array([0.0, 1.0, 0.5])
    e = np.pi * x
    functions = np.array([np.cosh(e), np.sinh(e), e * np.cosh(e), e * np.sinh(e)])
    slope = np.pi * np.array([0.0, 1.0, 1.0, 0.0])
    second = np.array([functions[0, 1], functions[1, 1], 2 * np.sinh(np.pi), 2 * np.cosh(np.pi)])
    second[2:] += functions[2:, 1]
    rows = np.array([functions[:, 0], functions[:, 1], slope, second])
    return float(np.linalg.solve(rows, [0.0, 0.0, TURN, 0.0]) @ functions[:, 2])


@pytest.mark.parametrize(("element", "close"), [("argyris", 1e-6), ("hhj", 1e-6)])
def test_a_rotation_that_varies_along_the_edge_against_levy(element, close):
    result = ks.solve(levy(8), element=element, error="off")
    assert result.probes["centre"]["u"][2] == pytest.approx(levy_deflection(), rel=close)
    assert result.external_work == pytest.approx(result.strain_energy, rel=1e-9)


def test_morley_converges_to_it():
    error = [
        abs(ks.solve(levy(n), element="morley", error="off").probes["centre"]["u"][2] / levy_deflection() - 1)
        for n in (8, 16)
    ]
    assert error[1] < 0.35 * error[0]


def test_bounds_hold_what_is_right_when_an_edge_is_turned():
    exact = levy(8, supports=levy(8).supports[:3] + (ks.Fixed("left", "zr", rotation="0.1*y*(1 - y)"),))
    fine = ks.solve(exact, element="hhj", order=6, error="off").probes["centre"]["u"][2]
    found = ks.solve(exact, tolerance=0.01)
    assert found.error["kind"] == "guaranteed"
    half = found.error["probes"]["centre"]["u"]["half_width"][2]
    assert abs(found.probes["centre"]["u"][2] - fine) <= half


def test_a_disk_whose_curved_edge_is_turned_bends_to_a_paraboloid():
    scene = ks.Scene(
        mesh=disk(3, order=2),
        thickness=1.0,
        material=ks.Isotropic(**UNIT),
        supports=[ks.Fixed("edge", "zr", rotation=TURN)],
        probes={"centre": (0.0, 0.0)},
    )
    result = ks.solve(scene, error="off", model="plate")
    assert result.probes["centre"]["u"][2] == pytest.approx(TURN / 2, rel=1e-5)
    assert result.probes["centre"]["M"] == pytest.approx([1.3 * TURN, 1.3 * TURN, 0.0], rel=1e-5, abs=1e-7)
    assert result.strain_energy == pytest.approx(np.pi * 1.3 * TURN**2, rel=1e-5)
    assert result.external_work == pytest.approx(result.strain_energy, rel=1e-6)


@pytest.mark.parametrize("lift", [1.0, "1 + 0.3*x"])
def test_a_disk_that_is_lifted_stores_no_energy(lift):
    scene = ks.Scene(
        mesh=disk(3, order=2),
        thickness=1.0,
        material=ks.Isotropic(**UNIT),
        supports=[ks.SimplySupported("edge", value=lift)],
    )
    result = ks.solve(scene, error="off", model="plate", large_deflection=False)
    assert abs(result.strain_energy) < 1e-8
    assert abs(result.external_work) < 1e-8


@pytest.mark.parametrize("element", ["argyris", "morley", "hhj"])
def test_supports_that_move_do_the_work_that_the_plate_stores(element):
    supports = [ks.Clamped("left"), ks.Fixed("right", "z", value=0.1)]
    result = ks.solve(strip("r", supports=supports, loads=[ks.Pressure(0.2)]), element=element, error="off")
    assert result.external_work == pytest.approx(result.strain_energy, rel=1e-9)


def test_modes_say_that_prescribed_motions_do_not_act():
    scene = strip("r", material=ks.Isotropic(E=12, nu=0.0, density=1.0))
    with pytest.warns(ks.KshellWarning, match="prescribed motions do not act"):
        ks.modes(scene, count=1, error="off")


def test_two_rotations_of_one_edge_are_refused():
    supports = [
        ks.Clamped("left"),
        ks.Fixed("right", "r", rotation=0.1),
        ks.Fixed("right", "r", rotation=0.2),
    ]
    with pytest.raises(ks.InputError, match="different"):
        ks.solve(strip("r", supports=supports), element="morley", error="off")


def test_the_shipped_annulus_against_its_exact_solution():
    """w = B (r^2 - 1) + C ln r with w' = -turn at r = 1 and no moment M_r at the free edge r = 0.4."""
    scene = ks.Scene.load(MESHES / "turned_edge.toml")
    turn, nu, inner = scene.supports[0].rotation, 0.3, 0.4
    B, C = np.linalg.solve([[2 * (1 + nu), -(1 - nu) / inner**2], [2.0, 1.0]], [0.0, -turn])
    result = ks.solve(scene, error="off")
    exact = B * (inner**2 - 1) + C * np.log(inner)
    assert result.probes["inner"]["u"][2] == pytest.approx(exact, rel=1e-5)
    assert result.external_work == pytest.approx(result.strain_energy, rel=1e-5)
