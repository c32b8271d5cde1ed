"""The shipped scenes of motion and contact do what their first lines say."""

import warnings
from pathlib import Path

import numpy as np
import pytest

import kshell as ks

FOLDER = Path(__file__).parents[2] / "meshes"


def scene(name, **changes):
    return ks.Scene.load(FOLDER / f"{name}.toml", [f"{key}={value}" for key, value in changes.items()])


@pytest.mark.full
def test_the_drum_swings_with_the_frequency_of_a_membrane():
    rest = scene("drum")
    tension = 5e9 * 2e-4 * 1e-3 / 0.7
    expected = 2.404826 / (2 * np.pi) * np.sqrt(tension / (1400 * 2e-4))
    assert expected == pytest.approx(27.3, abs=0.1)
    small = ks.Scene.load(FOLDER / "drum.toml", ['initial.displacement=[0, 0, "5e-5*(1 - x*x - y*y)"]'])
    assert rest.initial_displacement.value[2] == "5e-4*(1 - x*x - y*y)"
    history = ks.simulate(small, time=1.1 / expected).history
    t, z = history["time"], history["probes"]["centre"]["u"][:, 2]
    down = next(k for k in range(len(z) - 1) if z[k] > 0 >= z[k + 1])
    up = next(k for k in range(down, len(z) - 1) if z[k] < 0 <= z[k + 1])
    first, second = (t[k] - z[k] * (t[k + 1] - t[k]) / (z[k + 1] - z[k]) for k in (down, up))
    assert 1 / (2 * (second - first)) == pytest.approx(expected, rel=0.05)


@pytest.mark.full
def test_the_roof_ends_on_the_static_branch():
    found = ks.simulate(scene("roof_snap"), time=0.16)
    still = ks.Scene.load(FOLDER / "roof_snap.toml", ["load.0.value=[0, 0, -600]"])
    path = ks.trace(still, time=None, step="auto", scheme="auto")
    assert found.probe("crown")["u"][2] < -25
    assert found.probe("crown")["u"][2] == pytest.approx(path.probe("crown")["u"][2], rel=1e-5)
    assert found.history["kinetic_energy"].max() > 100 * found.history["kinetic_energy"][-1]


@pytest.mark.full
def test_the_strip_lies_on_the_floor():
    pytest.importorskip("ipctk")
    found = ks.simulate(scene("folding_strip"))
    weight = 0.4 * 0.05 * 1e-3 * 1100 * 9.81
    assert -found.history["contact_force"]["floor"][-5:, 2].mean() == pytest.approx(weight, rel=0.05)
    assert found.history["smallest_gap"].min() > 0
    top = (found.points + found.fields["displacement"])[:, 2].max()
    assert top < 0.1  # of 0.4


@pytest.mark.full
def test_the_sheet_on_the_table_rests():
    pytest.importorskip("ipctk")
    found = ks.solve(scene("table_corner"))
    assert found.history["contact_force"]["table"][-1] == pytest.approx([0, 0, -2e-3 * 1100 * 9.81], abs=1e-5)
    assert found.balance < 1e-6
    assert found.history["smallest_gap"].min() > 0
    assert found.probe("corner")["u"][2] < -0.3


@pytest.mark.full
def test_the_can_carries_less_after_it_buckles():
    pytest.importorskip("ipctk")
    found = ks.solve(scene("pressed_can"))
    force = found.history["contact_force"]["plate"][:, 2]
    assert force.max() > 1.2 * force[-1]
    assert found.reactions["bottom"]["force"][2] == pytest.approx(force[-1], rel=1e-6)
    assert found.history["smallest_gap"].min() > 0


@pytest.mark.full
def test_the_slits_open():
    """Pulled the sheet leaves its plane, and needs far less force than one without slits."""
    found = ks.solve(scene("kirigami"))
    whole = 3e9 * 3e-4 * 0.1 * 0.006 / 0.3
    assert found.path[-1]["factor"] == 1.0
    assert abs(found.fields["displacement"][:, 2]).max() > 0.003
    assert found.reactions["right"]["force"][0] < 0.4 * whole
    assert found.path[-1]["stable"]


def test_the_plate_under_a_blast_swings_about_zero():
    """The impulse of a short blast over the modal mass, against the first mode's frequency."""
    found = ks.simulate(scene("plate_shock"), time=0.012)
    assert found.model["kind"] == "plate"
    z = found.history["probes"]["centre"]["u"][:, 2]
    stiffness, mass = 210e9 * 0.02**3 / 12 / (1 - 0.3**2), 7850 * 0.02
    first = 2 * np.pi**2 * np.sqrt(stiffness / mass)
    static = 20e3 * 16 / np.pi**2 / mass / first**2
    assert np.abs(z).max() == pytest.approx(1.51 * static, rel=0.03)  # 2 under a load that stays


@pytest.mark.full
def test_a_wheel_that_rolls_over_a_bridge_moves_it_as_a_beam():
    """A moving force on a supported beam by its first modes (L. Fryba, Vibration of Solids and Structures, 1.1).

    The beam is not damped, its force acts in one place, and it bends across freely: the plate moves some percent less.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("error", ks.KshellWarning)
        found = ks.simulate(scene("bridge_wheel"), time=0.25)
    time, w = found.history["time"] - 0.1 / 8, found.history["probes"]["middle"]["u"][:, 2]
    length, speed, force = 2.0, 8.0, 2000.0
    stiffness, mass = 210e9 * 0.5 * 0.02**3 / 12, 7850 * 0.5 * 0.02
    beam = np.zeros_like(time)
    for j in (1, 3, 5, 7):
        omega, passing = (j * np.pi / length) ** 2 * np.sqrt(stiffness / mass), j * np.pi * speed / length
        swing = np.sin(passing * time) - passing / omega * np.sin(omega * time)
        beam -= 2 * force / (mass * length) * np.sin(j * np.pi / 2) * swing / (omega**2 - passing**2)
    on = (time > 0.0) & (time < length / speed - 0.02)
    assert np.abs(w - beam)[on].max() < 0.08 * np.abs(beam).max()
    assert 0.92 < w.min() / beam[on].min() < 1.0
    assert w.min() < 1.05 * -force * length**3 / (48 * stiffness)  # more than at rest
