"""Pressures on discs and rectangles, at rest and moving."""

import numpy as np
import pytest

import kshell as ks
from kshell.errors import InputError
from kshell.scene.structure import resolve
from tests.plate.plates import UNIT, rectangle

DISC = ks.Disc(pressure=2.0, centre=(0.4, 0.45, 0), radius=0.2)
TURNED = ks.Rectangle(pressure=2.0, centre=(0.5, 0.5, 0), size=(0.4, 0.3), angle=30)


def scene(load, n=16, **more):
    return ks.Scene(
        mesh=rectangle(n),
        thickness=1.0,
        material=ks.Isotropic(**UNIT, density=1.0),
        supports=[ks.Clamped("left")],
        loads=[load],
        **more,
    )


@pytest.mark.parametrize("model", ["plate", "shell"])
@pytest.mark.parametrize(("load", "force"), [(DISC, 2 * np.pi * 0.04), (TURNED, 0.24)])
def test_the_resultant_is_that_of_the_patch(load, force, model):
    result = ks.solve(scene(load), model=model, large_deflection=False, error="off")
    reaction = result.reactions["left"]
    assert reaction["force"][2] == pytest.approx(-force, rel=0.02)
    x, y, _ = load.centre
    assert reaction["moment"][:2] == pytest.approx([-force * y, force * x], rel=0.02)
    assert any("changes faster inside triangles" in words for words in result.warnings)


def test_values_in_and_out():
    points = np.array([[0.4, 0.64, 0], [0.4, 0.66, 0], [0.55, 0.55, 0], [0.59, 0.62, 0.1]])
    assert DISC.at(points).tolist() == [2.0, 0.0, 2.0, 0.0]
    corner = np.array([0.5, 0.5, 0]) + 0.99 * np.array([[0.2 * np.cos(np.pi / 6), 0.2 * 0.5, 7.0]])
    assert TURNED.at(corner).tolist() == [2.0]
    assert TURNED.at(np.array([0.5, 0.5, 0]) + (corner - [0.5, 0.5, 0]) * 1.03).tolist() == [0.0]
    assert DISC.times(3.0).at(points)[0] == 6.0


def test_a_disc_moves_in_time():
    load = ks.Disc(pressure="5 + t", centre=("2*t", 0.5, 0), radius=0.2)
    moving = resolve(scene(load), rectangle(16), True)
    (placed,) = moving.loads
    now = placed.at_time(0.25).item
    assert now.at(np.array([[0.5, 0.5, 0], [0.2, 0.5, 0]])).tolist() == [5.25, 0.0]
    with pytest.raises(InputError, match="t is the time of a motion"):
        ks.solve(scene(load))


def test_a_scene_file_keeps_them():
    again = ks.Scene.from_dict(
        {
            "mesh": rectangle(8),
            "thickness": 1.0,
            "material": {"E": 1.0, "nu": 0.3},
            "load": [
                {"kind": "disc", "pressure": 2.0, "centre": ["2*t", 0.5, 0], "radius": 0.1},
                {"kind": "rectangle", "pressure": "x", "centre": [0, 0, 0], "size": [1, 2], "follower": True},
            ],
        }
    )
    assert again.loads[0].centre == ("2*t", 0.5, 0.0)
    assert again.loads[1].follower


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: ks.Disc(pressure=1, centre=("x", 0, 0), radius=1), "not in x, y, z"),
        (lambda: ks.Disc(pressure=1, centre=(0, 0, 0), radius=0), "positive number"),
        (lambda: ks.Rectangle(pressure=1, centre=(0, 0, 0), size=(1, -1)), "positive number"),
        (
            lambda: ks.Rectangle(pressure=1, centre=lambda x, y, z: (x, y, z), size=(1, 1)),
            "two or three numbers",
        ),
        (
            lambda: ks.solve(scene(ks.Disc(pressure=1, centre=(0.5, 0.53, 0), radius=0.03), 8)),
            "cannot tell where it presses",
        ),
    ],
)
def test_refused(make, words):
    with pytest.raises(InputError, match=words):
        make()


def test_before_the_wheel_comes_nothing_presses():
    away = ks.Disc(pressure=1.0, centre=(-3, 0.5, 0), radius=0.01)
    result = ks.solve(scene(away, 4), large_deflection=False, error="off")
    assert np.abs(result.fields["displacement"]).max() == 0.0
    assert any("zero wherever it is integrated" in words for words in result.warnings)


def test_only_loads_that_act_nowhere_are_told():
    above = ks.Disc(pressure=1.0, centre=(0.5, 0.5, 0.3), radius=0.2)
    for load, told in ((ks.Pressure("1 if x > 2 else 0"), True), (above, True), (DISC, False)):
        words = ks.solve(scene(load, 8), large_deflection=False, error="off").warnings
        assert any("zero wherever" in w for w in words) == told
    passing = ks.Disc(pressure=1.0, centre=("t - 3", 0.5, 0), radius=0.3)
    moving = resolve(scene(passing, 4), rectangle(4), True)
    assert not any("zero wherever" in placed.warning for placed in moving.loads)


def rolling(speed="8*t"):
    """A wheel of 2 kN on a deck in squares of 0.05."""
    return ks.Scene.load("meshes/bridge_wheel.toml", [f'load.0.centre=["{speed} - 0.1", 0.25]'])


def missed_of(scene):
    (placed,) = resolve(scene, scene.read_mesh(), True, scene.solve.looks).loads
    return placed


def test_a_wheel_that_moves_from_edges_to_edges_is_exact():
    assert missed_of(rolling()).missed == 0.0
    assert missed_of(rolling()).warning == ""


def test_a_wheel_that_stops_inside_triangles_is_told_though_it_is_beside_the_deck_at_first():
    placed = missed_of(rolling("7*t"))
    assert 0.003 < placed.missed < 0.2
    assert "on its way" in placed.warning
    assert "follow its jumps" not in placed.warning
    assert '"7*t - 0.1", 0.25, 0' in placed.warning  # as it was given


def test_the_whole_wheel_presses_at_every_step():
    scene = rolling()
    (placed,) = resolve(scene, scene.read_mesh(), True).loads
    mesh = scene.read_mesh()
    for k in range(4, 41, 4):  # all of it on the deck
        load = placed.at_time(k * 0.00625).item
        assert load.centre == pytest.approx((8 * k * 0.00625 - 0.1, 0.25, 0.0))
        corners = mesh.points[mesh.triangles]
        pressed = load.at(corners.mean(axis=1))
        area = 0.5 * np.linalg.norm(
            np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
        )
        assert pressed @ area == pytest.approx(-2000.0, rel=1e-9)


def test_a_centre_of_two_numbers_lies_at_z_0():
    for kind, extent in ((ks.Disc, {"radius": 0.2}), (ks.Rectangle, {"size": (0.4, 0.3)})):
        two, three = (kind(pressure=2.0, centre=at, **extent) for at in ((0.4, 0.45), (0.4, 0.45, 0)))
        assert two == three
    with pytest.raises(InputError, match="vector of three"):
        ks.Disc(pressure=2.0, centre=(0.4,), radius=0.2)
