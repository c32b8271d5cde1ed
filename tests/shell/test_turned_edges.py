"""Prescribed rotations of the edges of shells."""

import numpy as np
import pytest

import kshell as ks
from tests.shell.shapes import rectangle


def strip(turn, n=8, thickness=0.1, **changes):
    """A strip of length 10 and width 1, EI = 1, clamped at one end, its other end turned."""
    mesh = rectangle(n, 1, 0, 10, 0, 1)
    x = mesh.points[mesh.edges][:, :, 0]
    groups = {name: mesh.edges[(x == at).all(axis=1)] for name, at in (("left", 0.0), ("right", 10.0))}
    data = {
        "mesh": ks.Mesh.from_arrays(mesh.points, mesh.triangles, groups),
        "thickness": thickness,
        "material": ks.Isotropic(E=12 / thickness**3, nu=0.0),
        "supports": [ks.Clamped("left"), ks.Fixed("right", "r", rotation=turn)],
        "probes": {"end": (10.0, 0.5, 0.0), "middle": (5.0, 0.5, 0.0)},
    }
    return ks.Scene(**{**data, **changes})


def test_a_small_turn_bends_the_strip_as_an_end_moment_does():
    result = ks.solve(strip(0.01), model="shell", large_deflection=False, error="off")
    assert result.probes["end"]["u"] == pytest.approx([0.0, 0.0, -0.05], abs=1e-8)
    assert result.reactions["right"]["moment"] == pytest.approx([0.0, 0.001, 0.0], abs=1e-9)
    assert result.strain_energy == pytest.approx(0.5 * 0.01**2 / 10, rel=1e-6)
    assert result.external_work == pytest.approx(result.strain_energy, rel=1e-6)
    assert result.balance < 1e-8  # moments alone act


@pytest.mark.parametrize("turn", [0.5, np.pi])
def test_a_strip_is_rolled_up_by_turning_its_end(turn):
    result = ks.solve(strip(turn), large_deflection=True, error="off")
    radius = 10 / turn
    expected = [radius * np.sin(turn) - 10, 0.0, -radius * (1 - np.cos(turn))]
    assert result.probes["end"]["u"] == pytest.approx(expected, abs=3e-2)
    assert result.probes["middle"]["M"][0] == pytest.approx(turn / 10, rel=2e-3)
    assert result.reactions["right"]["moment"][1] == pytest.approx(turn / 10, rel=2e-3)
    assert result.strain_energy == pytest.approx(0.5 * turn**2 / 10, rel=2e-3)
    assert result.external_work == pytest.approx(result.strain_energy, rel=1e-3)
    assert result.balance < 1e-6


def tube(**changes):
    """Of radius 1 and length 0.6; the edge at v = 0 is held and turned, the other one free."""
    data = {
        "mesh": ks.geometry.Cylinder(R=1.0).mesh(12, 16, order=2, v_range=(0, 0.6)),
        "thickness": 0.01,
        "material": ks.Isotropic(E=1e6, nu=0.3),
        "supports": [ks.Fixed("v0", "xyzr", rotation=1e-4)],
    }
    return ks.Scene(**{**data, **changes})


def test_the_edge_of_a_tube_takes_the_moment_of_a_beam_on_an_elastic_foundation():
    """The edge is held and turned: per length it takes 2 beta D turn, beta^4 = 3 (1 - nu^2) / (R t)^2."""
    result = ks.solve(tube(), large_deflection=False, error="off")
    stiffness = 1e6 * 0.01**3 / (12 * (1 - 0.3**2))
    beta = (3 * (1 - 0.3**2) / 0.01**2) ** 0.25
    moment = 2 * beta * stiffness * 1e-4
    assert result.strain_energy == pytest.approx(0.5 * moment * 1e-4 * 2 * np.pi, rel=1e-2)
    assert result.external_work == pytest.approx(result.strain_energy, rel=1e-6)
    point = result.at([[1.0, 0.0, 0.0]])
    normal_side = point["M"][0, 1]  # tension on the outer side, as a positive edge moment has it
    assert normal_side == pytest.approx(moment, rel=2e-2)


def test_clamped_and_turned_is_a_contradiction():
    supports = [ks.Fixed("left", "r", rotation=0.1), ks.Clamped("left")]
    with pytest.raises(ks.InputError, match="different rotations"):
        ks.solve(strip(0.1, supports=supports), model="shell", large_deflection=False, error="off")


def test_charts_take_koiter_elements_for_it_and_argyris_ones_refuse_it():
    chart = ks.geometry.Plane()
    scene = strip(0.01, n=4, thickness=0.5, chart=chart)
    assert ks.solve(scene, large_deflection=False, error="off").model["element"] == "koiter"
    with pytest.raises(ks.InputError, match="koiter"):
        ks.solve(scene, element="argyris", large_deflection=False, error="off")


def test_a_motion_follows_a_rotation_that_grows_with_time():
    scene = strip("0.2*t", n=2, material=ks.Isotropic(E=12e3, nu=0.0, density=1e-6))
    result = ks.simulate(scene, time=1.0, step=0.25, error="off")
    assert result.history["probes"]["end"]["u"][-1] == pytest.approx([-0.066, 0.0, -1.0], abs=0.02)
