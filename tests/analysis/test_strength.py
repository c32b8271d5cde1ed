"""Stresses of layers, shear between them, and utilisation."""

from itertools import pairwise

import numpy as np
import pytest

import kshell as ks
from kshell.material.laminate import laminate
from kshell.material.plies import ply_stresses
from kshell.material.tensors import von_mises
from tests.scene.fabricated import square_mesh
from tests.shell.shapes import joined, panel

CARBON = ks.Orthotropic(E1=140e3, E2=10e3, nu12=0.3, G12=5e3, G13=5e3, G23=3e3, yield_stress=500.0)
ANGLES = (0, 45, -45, 90)
LOPSIDED = [ks.Layer(CARBON, 0.1 + 0.05 * k, angle) for k, angle in enumerate(ANGLES)]


def test_layers_carry_the_forces_of_the_section():
    """Their stresses add up to N, M and Q, are those of one strain, and no shear is left at the faces."""
    stack = laminate(LOPSIDED)
    N, M, Q = np.array([3.0, -1.0, 0.5]), np.array([0.2, 0.4, -0.1]), np.array([0.7, -0.3])
    offset = 0.2
    plies = ply_stresses(stack, N, M, Q, offset)
    force, moment = np.zeros(3), np.zeros(3)
    for ply in plies:
        (low, high), a, b = ply["z"], ply["stress_bottom"], ply["stress_top"]
        force += (high - low) * (a + b) / 2
        z = [low + offset, high + offset]
        moment += (
            (high - low) / 6 * (2 * a * z[0] + 2 * b * z[1] + a * z[1] + b * z[0])
        )  # linear times linear
    np.testing.assert_allclose(force, N, rtol=1e-9)
    np.testing.assert_allclose(moment, M, rtol=1e-9)
    np.testing.assert_allclose(plies[0]["shear_bottom"], 0.0, atol=1e-12)
    np.testing.assert_allclose(plies[-1]["shear_top"], 0.0, atol=1e-12)
    for below, above in pairwise(plies):
        np.testing.assert_allclose(below["shear_top"], above["shear_bottom"], rtol=1e-9, atol=1e-12)


def test_stresses_along_the_fibres():
    """A layer at 90 degrees has along its fibres what it has along y."""
    plies = ply_stresses(laminate(LOPSIDED), np.array([1.0, 2.0, 0.3]), np.zeros(3))
    np.testing.assert_allclose(plies[3]["material_top"][:2], plies[3]["stress_top"][1::-1], rtol=1e-9)
    np.testing.assert_allclose(plies[0]["material_top"], plies[0]["stress_top"], rtol=1e-12)
    # invariants of a turn by 45 degrees
    turned, own = plies[1]["material_top"], plies[1]["stress_top"]
    assert turned[0] + turned[1] == pytest.approx(own[0] + own[1], rel=1e-9)
    assert turned[0] * turned[1] - turned[2] ** 2 == pytest.approx(own[0] * own[1] - own[2] ** 2, rel=1e-9)


def test_shear_of_one_material_is_the_parabola():
    plies = ply_stresses(
        laminate([ks.Layer(CARBON, 0.5), ks.Layer(CARBON, 0.5)]), *np.zeros((2, 3)), np.array([2.0, 1.0])
    )
    np.testing.assert_allclose(plies[0]["shear_top"], [3.0, 1.5], rtol=1e-9)


def strip(**section):
    return ks.Scene(
        mesh=square_mesh(4),
        supports=[ks.Clamped("left")],
        loads=[ks.Pressure(-1e-4)],
        probes={"middle": (0.5, 0.4, 0)},
        **section,
    )


def test_probes_on_laminates_have_layers():
    layers = [ks.Layer(CARBON, 0.01, angle) for angle in (0, 45, 45, 0)]
    probe = ks.solve(strip(layers=layers)).probe("middle")
    plies = probe["layers"]
    assert len(plies) == 4
    np.testing.assert_allclose(plies[-1]["stress_top"], probe["stress_top"], rtol=1e-9)
    np.testing.assert_allclose(plies[0]["stress_bottom"], probe["stress_bottom"], rtol=1e-9)
    mean = sum(np.diff(ply["z"])[0] * (ply["shear_bottom"] + ply["shear_top"]) / 2 for ply in plies)
    assert 0.4 < mean[0] / probe["Q"][0] < 1.0  # trapezoids under parabolas


@pytest.mark.parametrize("model", ["plate", "shell"])
def test_utilisation_is_stress_over_yield_stress(model):
    steel = ks.Isotropic(E=2e5, nu=0.3, yield_stress=250.0)
    result = ks.solve(strip(thickness=0.02, material=steel), model=model, large_deflection=False)
    largest = max(result.fields[f"von_mises_{face}"].max() for face in ("top", "bottom"))
    assert result.extremes["utilisation"]["value"] == pytest.approx(largest / 250, rel=1e-12)
    probe = result.probe("middle")
    own = max(probe["von_mises_top"], probe["von_mises_bottom"])
    assert probe["utilisation"] == pytest.approx(own / 250, rel=1e-9)
    assert "utilisation" in result.to_dict()["extremes"]
    half = ks.solve(
        strip(thickness=0.02, material={"west": steel, "east": ks.Isotropic(E=2e5, nu=0.3)}),
        model=model,
        large_deflection=False,
    )
    assert half.fields["utilisation"][half.points[:, 0] > 0.6].max() == 0.0
    without = ks.solve(
        strip(thickness=0.02, material=ks.Isotropic(E=2e5, nu=0.3)), model=model, large_deflection=False
    )
    assert "utilisation" not in without.fields


def test_a_yield_stress_is_positive():
    with pytest.raises(ks.InputError, match=r"yield_stress = -1 must be > 0"):
        ks.Isotropic(E=1.0, nu=0.3, yield_stress=-1.0)


def stiffened(**changes):
    """A plating of four layers with a stiffener of three, of other layers, across its middle."""
    sheets = joined(panel((0, 0, 0), (1, 0, 0), (0, 1, 0), 4), panel((0, 0.5, 0), (1, 0, 0), (0, 0, 0.3), 4))
    height = sheets.points[sheets.triangles].mean(axis=1)[:, 2]
    ends = sheets.points[sheets.edges]
    groups = {
        "plating": sheets.triangles[height < 1e-9],
        "stiffener": sheets.triangles[height > 1e-9],
        "left": sheets.edges[(np.abs(ends[:, :, 0]) < 1e-9).all(axis=1)],
    }
    strong, weak = (
        ks.Orthotropic(E1=140e9, E2=10e9, nu12=0.3, G12=5e9, expansion=[0, 1e-5], yield_stress=limit)
        for limit in (1e8, 5e7)
    )
    data = {
        "mesh": ks.Mesh.from_arrays(sheets.points, sheets.triangles, groups),
        "layers": {
            "plating": [ks.Layer(strong, 0.002, angle) for angle in (0, 90, 90, 0)],
            "stiffener": [ks.Layer(weak, 0.002, angle) for angle in (0, 90, 30)],
        },
        "supports": [ks.Clamped("left")],
        "loads": [
            ks.Pressure(1e3, on="plating", name="p"),
            ks.Traction((0, 1e2, 0), on="stiffener", name="t"),
            ks.Temperature(mean=50, name="warm"),
        ],
        "cases": [ks.Case("a", ["p"]), ks.Case("b", ["t", "warm"])],
        "combinations": [ks.Combination("ab", {"a": 1.35, "b": -1.5})],
        "probes": {
            "joint": (0.5, 0.5, 0),
            "plating": {"at": (0.5, 0.5, 0), "on": "plating"},
            "stiffener": {"at": (0.5, 0.5, 0), "on": "stiffener"},
        },
    }
    return ks.Scene(**{**data, **changes})


def test_where_laminates_meet_every_sheet_has_its_own_layers_in_every_case():
    cases = ks.solve(stiffened(), large_deflection=False, error="off").cases
    assert set(cases) == {"a", "b", "ab"}
    for found in cases.values():
        assert any("probe joint" in warning and "`sheets`" in warning for warning in found.warnings)
        sheets = found.sheets["joint"]
        everything = {"plating": found.probes["plating"], "stiffener": found.probes["stiffener"], **sheets}
        assert {name.split(" ")[0] for name in sheets} == {"plating", "stiffener"}
        for name, probe in everything.items():
            assert len(probe["layers"]) == (3 if name == "stiffener" else 4)
            size = np.abs(probe["stress_top"]).max()
            top, bottom = probe["layers"][-1]["stress_top"], probe["layers"][0]["stress_bottom"]
            assert top == pytest.approx(probe["stress_top"], abs=1e-3 * size)
            assert bottom == pytest.approx(probe["stress_bottom"], abs=1e-3 * size)
            limit = 5e7 if name == "stiffener" else 1e8
            stresses = [layer[f"stress_{face}"] for layer in probe["layers"] for face in ("top", "bottom")]
            assert probe["utilisation"] == pytest.approx(max(von_mises(np.array(stresses))) / limit)
        worst = max(np.max(found.fields[f"von_mises_{face}"]) for face in ("top", "middle", "bottom"))
        assert found.extremes["von_mises"]["value"] == pytest.approx(worst)
        assert found.extremes["utilisation"]["value"] == pytest.approx(np.max(found.fields["utilisation"]))
        assert found.extremes["utilisation"]["group"] in ("plating", "stiffener")


@pytest.mark.parametrize("model", ["plate", "shell"])
def test_the_largest_stress_of_a_laminate_may_be_inside(model):
    """A stiff core between soft skins, clamped: the outer faces have a hundredth of the largest stress."""
    soft, stiff = (ks.Isotropic(E=E, nu=0.3, yield_stress=1e6) for E in (1e9, 2e11))
    scene = ks.Scene(
        mesh=square_mesh(8),
        layers=[ks.Layer(soft, 0.001), ks.Layer(stiff, 0.008), ks.Layer(soft, 0.001)],
        supports=[ks.Clamped("left")],
        loads=[ks.Pressure(1.0)],
        probes={"p": (0.3, 0.5, 0.0)},
    )
    result = ks.solve(scene, model=model, large_deflection=False, error="off")
    inside, outside = result.extremes["von_mises_layers"], result.extremes["von_mises"]
    assert inside["face"] in ("bottom of layer 2 of 3", "top of layer 2 of 3")
    assert inside["value"] > 100 * outside["value"]
    assert result.extremes["utilisation"]["value"] == pytest.approx(inside["value"] / 1e6)
    assert result.extremes["utilisation"]["face"] == "layer 2 of 3"
    probe = result.probes["p"]
    core = max(von_mises(np.array([probe["layers"][1]["stress_top"], probe["layers"][1]["stress_bottom"]])))
    assert probe["utilisation"] == pytest.approx(core / 1e6)
