"""Prescribed motions that are rigid are followed along their screw: no strain in between, none at the end."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import kshell as ks
from kshell.shell.koiter.rigid_motion import screw_of
from kshell.verify.cases.large_scenes import rectangle

SHIFT = np.array([0.3, 0.1, -0.2])


def turned(rotation, about=(0.0, 0.0, 0.0), shift=(0.0, 0.0, 0.0)):
    """The displacement of a rigid motion as a function of the place."""

    def value(x, y, z):
        p = np.stack([x, y, z], axis=-1) - np.asarray(about)
        return tuple((rotation.apply(p) - p + np.asarray(shift)).T)

    return value


@pytest.mark.parametrize("degrees", [90.0, 180.0, 350.0])
@pytest.mark.parametrize("support", [ks.Clamped, ks.SimplySupported])
def test_a_rigid_turn_of_any_size_ends_without_strain(support, degrees):
    axis = np.array([1.0, 2.0, 3.0]) / np.sqrt(14.0)
    rotation = Rotation.from_rotvec(np.radians(degrees) * axis)
    scene = ks.Scene(
        mesh=rectangle(2.0, 1.0, 4, 2), thickness=0.02, material=ks.Isotropic(1e6, 0.3),
        supports=[support(["x0", "x1"], value=turned(rotation, shift=SHIFT))], probes={"m": (1.0, 0.5, 0.0)},
        solve={"large_deflection": True},
    )  # fmt: skip
    result = ks.solve(scene)
    place = np.array([1.0, 0.5, 0.0])
    assert result.probes["m"]["u"] == pytest.approx(rotation.apply(place) - place + SHIFT, abs=1e-9)
    assert np.abs(result.probes["m"]["N"]).max() <= 1e-10 * 1e6 * 0.02  # against a strain of one
    assert np.abs(result.probes["m"]["M"]).max() <= 1e-10 * 1e6 * 0.02**3 / 12
    assert result.path[-1]["stable"]


def test_a_strip_is_twisted_by_90_degrees():
    """The edge turns on a circle; by symmetry the middle of the strip turns by 45 degrees about the axis."""
    middle = (0.0, 0.5, 0.0)
    end = turned(Rotation.from_rotvec([np.pi / 2, 0.0, 0.0]), about=middle)
    scene = ks.Scene(
        mesh=rectangle(4.0, 1.0, 8, 2), thickness=0.02, material=ks.Isotropic(1e6, 0.3),
        supports=[ks.Clamped("x0"), ks.Clamped("x1", value=end)],
        probes={"m": (2.0, 0.0, 0.0), "axis": (2.0, 0.5, 0.0)}, solve={"large_deflection": True},
    )  # fmt: skip
    result = ks.solve(scene)
    assert len(result.path) - 1 <= 30
    _, y, z = np.array(result.probes["m"]["u"]) + (0.0, -0.5, 0.0)
    assert z == pytest.approx(y, rel=1e-2)
    assert result.probes["axis"]["u"] == pytest.approx([0.0, 0.0, 0.0], abs=1e-3)


def test_the_screw_of_displacements():
    draw = np.random.default_rng(4)
    x = draw.normal(size=(6, 3))
    rotation = Rotation.from_rotvec([0.3, -1.1, 2.0])
    screw = screw_of(x, rotation.apply(x) - x + SHIFT, np.ones(3))
    assert screw.turn == pytest.approx([0.3, -1.1, 2.0], abs=1e-12)
    assert screw.at(x, 1.0) == pytest.approx(rotation.apply(x) - x + SHIFT, abs=1e-12)
    h = 1e-5
    slope = (screw.at(x, 0.4 + h) - screw.at(x, 0.4 - h)) / (2 * h)
    assert screw.rate(x, 0.4) == pytest.approx(slope, abs=1e-8)
    assert screw_of(x, 0.1 * x, np.ones(3)) is None  # stretched
    assert screw_of(x, np.tile(SHIFT, (6, 1)), np.ones(3)) is None  # only moved


def test_a_line_of_nodes_turns_the_shortest_way():
    x = np.linspace(0, 1, 5)[:, None] * np.array([0.0, 1.0, 0.0])
    half = screw_of(x, -2.0 * (x - x.mean(axis=0)), np.array([1.0, 0.0, 0.0]))
    assert half.turn == pytest.approx([np.pi, 0.0, 0.0], abs=1e-12)
    quarter = Rotation.from_rotvec([0.0, 0.0, np.pi / 2])
    assert screw_of(x, quarter.apply(x) - x, np.ones(3)).turn == pytest.approx(quarter.as_rotvec(), abs=1e-12)
