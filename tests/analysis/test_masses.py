"""Added masses: in modes, responses and motions, under gravity, in scene files, and what is refused."""

from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

import kshell as ks
from tests.analysis.test_modes import square, values
from tests.plate.plates import rectangle

STRIP = {
    "thickness": 0.01,
    "material": ks.Isotropic(E=1e9, nu=0.0),
    "supports": [ks.Clamped("left")],
    "mesh": rectangle(8, 2, 2.0, 0.2),
}
EI = 1e9 * 0.2 * 0.01**3 / 12
MESHES = Path(__file__).parents[2] / "meshes"


def with_mass(scene, *masses):
    return scene.changed(masses=list(masses))


@pytest.mark.parametrize("options", [{"element": "argyris"}, {"element": "morley"}, {"model": "shell"}])
def test_massless_cantilever_with_a_mass_at_its_end(options):
    """omega^2 = 3 E I / (m L^3)."""
    scene = ks.Scene(**STRIP, masses=[ks.Mass("right", 4.0 / 0.2)])
    result = ks.modes(scene, count=1, **options)
    exact = 3 * EI / (4.0 * 2.0**3)
    assert values(result)[0] == pytest.approx(exact, rel=2e-2 if "morley" in options.values() else 1e-3)
    assert result.modal["total_mass"][2] == pytest.approx(4.0)


def test_a_mass_in_the_middle_of_a_supported_square():
    """1 = lambda m sum_k phi_k(c)^2 / (lambda_k - lambda), phi_k = 2 sin sin of unit mass."""
    m = 0.5
    odd = np.arange(1, 400, 2)
    lambdas = np.pi**4 * (odd[:, None] ** 2 + odd**2) ** 2

    def miss(value):
        return 1.0 - value * m * (4.0 / (lambdas - value)).sum()

    first = brentq(miss, 1.0, lambdas[0, 0] * 0.999)
    result = ks.modes(with_mass(square("SSSS", n=8), ks.Mass((0.5, 0.5), m)), count=1)
    assert values(result)[0] == pytest.approx(first, rel=1e-3)
    entry = result.eigen[0]
    assert entry["kind"] == "estimated"
    assert entry["lower"] < first < entry["upper"]
    assert any("masses are added" in words for words in result.model["reasons"])


@pytest.mark.parametrize("options", [{}, {"model": "shell", "order": 2}])
def test_mass_on_the_whole_surface_is_a_density(options):
    scene = square("FFFF", n=4)
    mesh = rectangle(4)
    added = ks.modes(
        scene.changed(mesh=mesh, supports=[], masses=[ks.Mass("lower", 2.0), ks.Mass("upper", "2 + 0*x")]),
        count=2, error="off", **options,
    )  # fmt: skip
    plain = ks.modes(
        square("FFFF", density=3.0).changed(mesh=mesh, supports=[]), count=2, error="off", **options
    )
    assert values(added) == pytest.approx(values(plain), rel=1e-10)
    assert added.modal["total_mass"] == pytest.approx(plain.modal["total_mass"], abs=1e-12)


@pytest.mark.parametrize("options", [{}, {"model": "shell", "order": 1}])
def test_rigid_motions_turn_about_the_centre_of_all_mass(options):
    """A point mass at a corner: moments of inertia by Steiner; effective masses add up to the total."""
    scene = with_mass(square("FFFF", n=4), ks.Mass((1.0, 1.0), 1.0))
    result = ks.modes(scene, count=1, error="off", **options)
    total = np.array(result.modal["total_mass"])
    # square about its own middle 1/12, both masses a quarter of a side off the common centre
    assert total[2:5] == pytest.approx([2.0, 1 / 12 + 2 * 0.25**2, 1 / 12 + 2 * 0.25**2])
    rigid = [e for e in result.eigen if "name" in e]
    effective = np.sum([e["effective_mass"] for e in rigid], axis=0)
    assert effective[2:5] == pytest.approx(total[2:5])


@pytest.mark.parametrize(
    "options", [{"element": "argyris"}, {"element": "hhj"}, {"model": "shell", "order": 2}]
)
def test_weight(options):
    """Of a mass at a point, along a line and on an area; those outside the place of the gravity weigh nothing there."""
    masses = [ks.Mass((0.5, 0.5), 3.0), ks.Mass("middle", 2.0), ks.Mass("upper", 4.0)]
    scene = ks.Scene(
        mesh=rectangle(4), thickness=0.1, material=ks.Isotropic(E=1e6, nu=0.3, density=10.0),
        supports=[ks.Clamped("left"), ks.Clamped("right")], masses=masses, loads=[ks.Gravity((0, 0, -10.0))],
    )  # fmt: skip

    def lifted(scene):
        result = ks.solve(scene, error="off", large_deflection=False, **options)
        return sum(part["force"][2] for part in result.reactions.values())

    assert lifted(scene) == pytest.approx(10.0 * (1.0 + 3.0 + 2.0 + 2.0))
    upper = scene.changed(loads=[ks.Gravity((0, 0, -10.0), on="upper")])
    assert lifted(upper) == pytest.approx(10.0 * (0.5 + 3.0 + 1.0 + 2.0))


def test_weight_on_a_chart():
    """Of masses alone: the material has none. The angle 1 around a cylinder of radius 2, of height 1."""
    mesh = ks.geometry.Plane().mesh(3, 2, 1, ("left", "right", "bottom", "top"), (0, 1), (0, 1))
    scene = ks.Scene(
        mesh=mesh, chart=ks.geometry.Cylinder(R=2.0), thickness=0.1, material=ks.Isotropic(E=1e6, nu=0.3),
        supports=[ks.Clamped("left")], masses=[ks.Mass("right", 4.0)], loads=[ks.Gravity((0, 0, -10.0))],
    )  # fmt: skip
    result = ks.solve(scene, element="argyris", error="off", large_deflection=False)
    x = result.points[result.points[:, 0] == result.points[:, 0].max()]
    length = np.linalg.norm(np.ptp(x, axis=0))
    assert result.reactions["left"]["force"][2] == pytest.approx(40.0 * length, rel=1e-3)


def test_motion_has_the_energy_of_added_masses():
    scene = ks.Scene(
        **{**STRIP, "supports": []}, masses=[ks.Mass((2.0, 0.1), 4.0)], initial_velocity=(0, 0, 3.0),
    ).changed(material=ks.Isotropic(E=1e9, nu=0.0, density=100.0))  # fmt: skip
    result = ks.simulate(scene, time=0.01, step=0.005, order=1)
    assert result.history["kinetic_energy"] == pytest.approx(np.full(3, 0.5 * (4.0 + 0.4) * 9.0), rel=1e-6)


def test_scene_file(tmp_path):
    scene = ks.Scene.load(MESHES / "plate_motor.toml")
    assert [mass.value for mass in scene.masses] == [2.0, 5.0]
    scene.save(tmp_path / "again.toml")
    again = ks.Scene.load(tmp_path / "again.toml")
    assert again.masses == scene.masses
    result = ks.modes(again, error="off")
    bare = ks.modes(again.changed(masses=[]), error="off")
    area = 1.0
    assert result.modal["total_mass"][2] == pytest.approx(7850 * 0.01 * area + 2.0 + 4 * 5.0)
    assert values(result)[0] < values(bare)[0]


@pytest.mark.parametrize(
    ("masses", "message"),
    [
        ([ks.Mass("nowhere", 1.0)], "nowhere"),
        ([ks.Mass("plate", "x - 0.5")], "must not be negative"),
        ([ks.Clamped("left")], r"must be .*ks.Mass"),
    ],
)
def test_refused(masses, message):
    with pytest.raises(ks.InputError, match=message):
        ks.modes(ks.Scene(**STRIP, masses=masses))


def test_refused_values():
    with pytest.raises(ks.InputError, match="must be > 0"):
        ks.Mass("left", 0.0)
    with pytest.raises(ks.InputError, match="value is missing"):
        ks.Mass("left")
