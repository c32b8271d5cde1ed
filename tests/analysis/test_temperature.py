"""Temperatures of plates and shells whose materials have an expansion."""

from pathlib import Path

import numpy as np
import pytest

import kshell as ks
from tests.plate.plates import rectangle

PLY = ks.Orthotropic(E1=140e9, E2=10e9, nu12=0.3, G12=5e9, expansion=[-0.3e-6, 28e-6])
SIZE = 0.1
MESHES = Path(__file__).parents[2] / "meshes"
FREE = [ks.Fixed((0, 0, 0), "xyz"), ks.Fixed((SIZE, 0, 0), "yz"), ks.Fixed((0, SIZE, 0), "z")]


def square(**changes):
    data = {
        "mesh": rectangle(4, 4, SIZE, SIZE),
        "thickness": 1e-3,
        "material": PLY,
        "supports": FREE,
        "loads": [ks.Temperature(mean=-100)],
        "probes": {"centre": (SIZE / 2, SIZE / 2, 0), "side": (SIZE, SIZE / 2, 0)},
    }
    return ks.Scene(**{**data, **changes})


def layered(*angles, **changes):
    layers = [ks.Layer(PLY, 1e-3 / len(angles), angle) for angle in angles]
    return square(thickness=None, material=None, layers=layers, **changes)


def by_hand(angles, temperature):
    """Strain, curvature, and the stress at the bottom of the lowest layer, of free layers of 0 and 90 degrees."""
    swap = np.array([[0, 1, 0], [1, 0, 0], [0, 0, 1.0]])
    Q0, a0 = PLY.plane_stress(), np.array([*PLY.expansion, 0.0])
    Q = [Q0 if angle == 0 else swap @ Q0 @ swap for angle in angles]
    a = [a0 if angle == 0 else swap @ a0 for angle in angles]
    z = np.linspace(-0.5e-3, 0.5e-3, len(angles) + 1)
    integrals = [np.diff(z**n) / n for n in (1, 2, 3)]
    A, B, D = (sum(w * q for w, q in zip(each, Q, strict=True)) for each in integrals)
    N, M = (sum(w * q @ b for w, q, b in zip(each, Q, a, strict=True)) for each in integrals[:2])
    both = temperature * np.linalg.solve(np.block([[A, B], [B, D]]), np.append(N, M))
    bottom = Q[0] @ (both[:3] + z[0] * both[3:] - a[0] * temperature)
    return both[:3], both[3:], bottom


def test_a_plate_of_two_crossed_layers_warps_to_a_saddle():
    result = ks.solve(layered(0, 90), large_deflection=False, error="off")
    strain, curvature, bottom = by_hand((0, 90), -100.0)
    x, y = SIZE, SIZE / 2  # w = - (kappa_x (x^2 - L x) + kappa_y (y^2 - L y)) / 2 on three corners
    w = -0.5 * (curvature[0] * (x * x - SIZE * x) + curvature[1] * (y * y - SIZE * y))
    assert result.probes["side"]["u"] == pytest.approx([strain[0] * x, strain[1] * y, w], rel=1e-6)
    assert np.abs(result.probes["centre"]["M"]).max() < 1e-8
    assert result.probes["centre"]["stress_bottom"] == pytest.approx(bottom, rel=1e-6, abs=1e2)
    assert result.probes["centre"]["layers"][0]["stress_bottom"] == pytest.approx(bottom, rel=1e-6, abs=1e2)
    assert result.balance < 1e-6


def test_the_offset_moves_the_strain_to_the_meshed_surface():
    result = ks.solve(layered(0, 90, offset=2e-4), large_deflection=False, error="off")
    strain, curvature, bottom = by_hand((0, 90), -100.0)
    assert result.probes["side"]["u"][0] == pytest.approx((strain[0] - 2e-4 * curvature[0]) * SIZE, rel=1e-6)
    assert result.probes["centre"]["stress_bottom"] == pytest.approx(bottom, rel=1e-6, abs=1e2)


@pytest.mark.parametrize("element", ["argyris", "morley", "hhj"])
def test_a_gradient_bends_an_orthotropic_plate_by_its_own_expansions(element):
    scene = square(loads=[ks.Temperature(gradient=1e4)])
    result = ks.solve(scene, element=element, large_deflection=False, error="off")
    kx, ky = (1e4 * a for a in PLY.expansion)
    centre = -0.5 * (kx + ky) * (SIZE**2 / 4 - SIZE**2 / 2)
    assert result.probes["centre"]["u"][2] == pytest.approx(centre, rel=1e-6)
    assert np.abs(result.probes["centre"]["stress_top"]).max() < 1.0


@pytest.mark.parametrize("element", ["argyris", "hhj"])
def test_plates_have_the_stresses_that_layers_keep(element):
    loads = [ks.Temperature(gradient=1e4)]
    plate = ks.solve(layered(0, 90, 90, 0, loads=loads), element=element, large_deflection=False, error="off")
    shell = ks.solve(layered(0, 90, 90, 0, loads=loads), model="shell", large_deflection=False, error="off")
    assert plate.model["kind"] == "plate"
    for name in ("stress_top", "stress_bottom"):
        assert np.abs(plate.probes["centre"][name]).max() > 5e5
        assert plate.probes["centre"][name] == pytest.approx(shell.probes["centre"][name], rel=1e-5, abs=10.0)
        assert plate.at([SIZE / 3, SIZE / 3, 0.0])[name][0] == pytest.approx(
            plate.probes["centre"][name], rel=1e-5, abs=10
        )


@pytest.mark.parametrize("element", ["argyris", "hhj"])
def test_values_anywhere_on_a_plate_are_those_of_a_shell(element):
    """Also what a plate does not carry, and the stress that layers keep in the middle."""
    scene = layered(0, 90, 0, loads=[ks.Temperature(mean=20.0, gradient=1e4)])
    plate, shell = (
        ks.solve(scene, large_deflection=False, error="off", **how)
        for how in ({"element": element, "model": "plate"}, {"model": "shell"})
    )
    here, there = (result.at([SIZE / 3, SIZE / 3, 0.0]) for result in (plate, shell))
    assert np.abs(here["stress_middle"]).max() > 1e5
    for key in ("stress_top", "stress_middle", "stress_bottom", "N"):
        assert here[key] == pytest.approx(there[key], rel=1e-5, abs=10.0)


def test_the_expansion_of_the_load_goes_before_that_of_the_material():
    given = ks.solve(
        square(loads=[ks.Temperature(mean=10, expansion=1e-5)]), large_deflection=False, error="off"
    )
    assert given.probes["side"]["u"][0] == pytest.approx(10 * 1e-5 * SIZE, rel=1e-9)
    alike = layered(0, 90, loads=[ks.Temperature(mean=10, expansion=1e-5)])
    layers = ks.solve(alike, large_deflection=False, error="off").probes["centre"]["layers"]
    assert max(np.abs(layer["stress_top"]).max() for layer in layers) < 1.0
    pair = [ks.Temperature(mean=10, expansion=["1e-5 + 0*x", 3e-5])]
    along = ks.solve(square(loads=pair), large_deflection=False, error="off")
    assert along.probes["side"]["u"][:2] == pytest.approx([1e-4 * SIZE, 3e-4 * SIZE / 2], rel=1e-9)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"material": ks.Isotropic(E=1e9, nu=0.3)}, "no expansion: give it beside E, or in the load"),
        (
            {"thickness": None, "material": None, "section": ks.Section(A=np.eye(3), D=np.eye(3))},
            "given by its stiffness has no expansion",
        ),
    ],
)
def test_without_an_expansion_anywhere_it_is_refused(changes, words):
    with pytest.raises(ks.InputError, match=words):
        ks.solve(square(**changes), error="off")


def test_layers_that_relax_against_each_other_are_refused():
    def layers(*expansions):
        return [
            ks.Layer(ks.Isotropic(E=1e9, nu=0.3, expansion=a, relaxation=[[0.5, 1.0]]), 1e-3)
            for a in expansions
        ]

    with pytest.raises(ks.InputError, match="expand differently and relax"):
        ks.solve(square(thickness=None, material=None, layers=layers(1e-5, 2e-5)), error="off")
    alike = square(thickness=None, material=None, layers=layers(1e-5, 1e-5))
    assert ks.solve(alike, large_deflection=False, error="off").strain_energy < 1e-12


@pytest.mark.parametrize("element", ["argyris", "morley"])
def test_groups_that_expand_differently_bend_a_line_between_them(element):
    """The lower half bends freely by a gradient, the upper one does not."""
    lower, upper = (ks.Isotropic(E=1e9, nu=0.0, expansion=a) for a in (1e-5, 0.0))
    scene = square(
        material={"lower": lower, "upper": upper},
        loads=[ks.Temperature(gradient=1e3)],
        supports=[ks.Clamped("top")],
        probes={"end": (SIZE / 2, 0.0, 0.0)},
    )
    result = ks.solve(scene, element=element, large_deflection=False, error="off")
    assert result.probes["end"]["u"][2] < -0.5e-5
    named = ks.solve(
        square(
            material=ks.Isotropic(E=1e9, nu=0.0),
            loads=[ks.Temperature(gradient=1e3, expansion=1e-5, on="lower")],
            supports=[ks.Clamped("top")],
            probes={"end": (SIZE / 2, 0.0, 0.0)},
        ),
        element=element,
        large_deflection=False,
        error="off",
    )
    assert result.probes["end"]["u"][2] == pytest.approx(named.probes["end"]["u"][2], rel=1e-9)


@pytest.mark.parametrize("chart", [None, ks.geometry.Cylinder(R=1.0)])
def test_a_tube_that_expands_along_and_around_by_its_axes_stays_free_of_stress(chart):
    """Axis 1 runs along the tube: direction = z. The quintics of the chart have a sector of one radian."""
    if chart is None:
        mesh, options = ks.geometry.Cylinder(R=1.0).mesh(16, 3, order=2), {}
        supports = [ks.Fixed((1, 0, 0), "xyz"), ks.Fixed((-1, 0, 0), "yz"), ks.Fixed((0, 1, 0), "z")]
    else:
        mesh, options = ks.geometry.Plane().mesh(4, 3, order=1), {"element": "argyris"}
        chord = np.array([np.cos(1) - 1, np.sin(1), 0.0])
        axes = [chord, np.cross([0, 0, 1], chord), [0, 0, 1]]
        supports = [
            ks.Fixed((1, 0, 0), "xyz"),
            ks.Fixed((np.cos(1), np.sin(1), 0), "yz", axes=axes),
            ks.Fixed((1, 0, 1), "y", axes=axes),
        ]
    scene = ks.Scene(
        mesh=mesh,
        chart=chart,
        direction=(0, 0, 1),
        thickness=0.05,
        material=ks.Orthotropic(E1=140e9, E2=10e9, nu12=0.3, G12=5e9, expansion=[1e-5, 3e-5]),
        supports=supports,
        loads=[ks.Temperature(mean=100)],
        probes={"upper": (1.0, 0.0, 1.0)},
    )
    result = ks.solve(scene, large_deflection=False, error="off", **options)
    assert result.probes["upper"]["u"][2] == pytest.approx(1e-3, rel=1e-4)
    held_back = 140e9 * 1e-3
    assert np.abs(result.fields["von_mises_top"]).max() < 1e-3 * held_back


def test_cases_and_paths_scale_the_stresses_that_are_left():
    scene = layered(0, 90, 90, 0, loads=[ks.Temperature(mean=50, name="warm")])
    cases = ks.Scene(
        **{
            **{key: getattr(scene, key) for key in ("mesh", "layers", "supports", "loads", "probes")},
            "cases": [ks.Case("cold", ["warm"], [-2.0])],
        }
    )
    found = ks.solve(cases, large_deflection=False, error="off").cases["cold"]
    _, _, bottom = by_hand((0, 90, 90, 0), -100.0)
    assert found.probes["centre"]["stress_bottom"] == pytest.approx(bottom, rel=1e-5, abs=1e3)
    assert found.probes["centre"]["layers"][0]["stress_bottom"] == pytest.approx(bottom, rel=1e-5, abs=1e3)
    large = ks.solve(layered(0, 90, 90, 0), large_deflection=True, error="off")
    assert large.probes["centre"]["stress_bottom"] == pytest.approx(bottom, rel=2e-2, abs=1e3)


def test_scene_files_have_expansions_of_layers(tmp_path):
    ply = {"E1": 140e9, "E2": 10e9, "nu12": 0.3, "G12": 5e9, "expansion": [-0.3e-6, 28e-6], "thickness": 5e-4}
    scene = ks.Scene.from_dict(
        {
            "mesh": rectangle(2),
            "layer": [ply, {**ply, "angle": 90, "expansion": 1e-5}],
            "support": [{"on": "left", "kind": "clamped"}],
            "load": [{"kind": "temperature", "mean": 20}],
        }
    )
    scene.save(tmp_path / "warm.toml")
    again = ks.Scene.load(tmp_path / "warm.toml")
    assert again.layers[0].material.expansion == (-0.3e-6, 28e-6)
    assert again.layers[1].material.expansion == 1e-5


def test_the_shipped_cross_ply_warps_as_laminate_theory_says():
    result = ks.solve(ks.Scene.load(MESHES / "cross_ply.toml"), error="off")
    strain, curvature, bottom = by_hand(
        (0, 90), -100.0
    )  # 0.5 mm: strains are the same, curvatures twice those
    w = -0.5 * 0.5 * (curvature[0] * 0.0 + curvature[1] * (0.25 - 0.5))
    assert result.probes["side"]["u"] == pytest.approx([strain[0], 0.5 * strain[1], w], rel=1e-6)
    assert result.probes["centre"]["stress_bottom"] == pytest.approx(bottom, rel=1e-6, abs=1e3)
