"""Names of units are labels: shown wherever results are, and no number changes by them."""

import json
from dataclasses import replace

import pytest

import kshell as ks
from kshell.cli.terminal import print_result
from kshell.draw.pictures import picture_values
from kshell.report import page
from kshell.report.images import Image
from kshell.report.page import content
from kshell.values.units import labelled, unit


def plate(**more):
    return ks.Scene(
        mesh=ks.geometry.Plane().mesh(3, 3, order=1, u_range=(0, 100), v_range=(0, 100)),
        thickness=2.0,
        material=ks.Isotropic(E=210e3, nu=0.3),
        supports=[ks.Clamped(["u0", "u1", "v0", "v1"])],
        loads=[ks.Pressure(1e-3)],
        probes={"p": (50.0, 50.0, 0.0)},
        solve={"large_deflection": False, "error": "off"},
        **more,
    )


def test_shown_and_never_converted(tmp_path, capsys, monkeypatch):
    # the words beside pictures need none of them
    monkeypatch.setattr(page, "image", lambda result, what: Image(what, "data:,"))
    monkeypatch.setattr(page, "images", lambda result, few=False: [])
    named, bare = ks.solve(plate(units="N,mm")), ks.solve(plate())
    assert named.units == "N, mm"
    assert bare.units == ""
    assert named.probes["p"]["u"] == pytest.approx(bare.probes["p"]["u"], rel=1e-12)
    assert named.strain_energy == pytest.approx(bare.strain_energy, rel=1e-12)
    named.save(tmp_path / "named"), bare.save(tmp_path / "bare")
    assert json.loads((tmp_path / "named" / "result.json").read_text(encoding="utf-8"))["units"] == "N, mm"
    assert "units" not in json.loads((tmp_path / "bare" / "result.json").read_text(encoding="utf-8"))
    assert ks.Result.load(tmp_path / "named").units == "N, mm"
    print_result(named, [], 0.0)
    assert "units: N, mm" in capsys.readouterr().out
    print_result(bare, [], 0.0)
    assert "units" not in capsys.readouterr().out
    assert "N, mm" in content(named)["subtitle"]
    assert "units" not in content(bare)["subtitle"]


def test_colour_bars_have_the_unit_of_their_field():
    named, bare = ks.solve(plate(units="N, mm")), ks.solve(plate())
    expected = {"deflection": "[mm]", "moment_xx": "[N]", "von_mises_top": "[N/mm^2]"}
    for what, words in expected.items():
        assert picture_values(named, what)[1] == f"{picture_values(bare, what)[1]} {words}"


def test_units_of_cases_and_files(tmp_path):
    scene = plate(units="kN, m")
    scene = replace_loads(scene)
    result = ks.solve(scene)
    assert {case.units for case in result.cases.values()} == {"kN, m"} == {result.units}
    result.save(tmp_path / "out")
    assert ks.Result.load(tmp_path / "out").cases["A"].units == "kN, m"
    scene.save(tmp_path / "s.toml")
    assert ks.Scene.load(tmp_path / "s.toml").units == "kN, m"


def replace_loads(scene):
    return replace(scene, loads=[ks.Pressure(1e-3, name="a")], cases=[ks.Case("A", ["a"])])


@pytest.mark.parametrize("value", ["N", "N, ", "a,b,c,d,e,f", 3, None, ["N", "mm"]])
def test_units_that_are_none(value):
    with pytest.raises(ks.InputError, match="units"):
        plate(units=value)


def test_powers():
    assert unit("N, mm", 1, -2) == "N/mm^2"
    assert unit("N, mm, t", 0, 1) == "mm"
    assert unit("kN, m", 1, 1) == "kN m"
    assert unit("kN, m", 0, -1) == "1/m"
    assert labelled("stress", "", 1, -2) == "stress"
