"""kshell modes and kshell buckling: tables, files, exit codes."""

import json

import numpy as np
import pytest

import kshell as ks
from kshell.cli.commands import run
from kshell.mesh.write import write_msh

SCENE = """
mesh = "plate.msh"
thickness = 1.0
[material]
E = 10.92
nu = 0.3
density = {density}
[[support]]
on = ["x0", "x1", "y0", "y1"]
kind = "simply_supported"
[[load]]
kind = "line_force"
on = "x0"
value = [1, 0, 0]
[[load]]
kind = "line_force"
on = "x1"
value = [-1, 0, 0]
"""


@pytest.fixture
def scene(tmp_path):
    mesh = ks.geometry.Plane().mesh(4, 4, 1, ("x0", "x1", "y0", "y1"), (0, 1), (0, 1))
    write_msh(mesh, tmp_path / "plate.msh")
    path = tmp_path / "plate.toml"
    path.write_text(SCENE.format(density=1.0), encoding="utf-8")
    return path


def test_modes_with_table_and_files(scene, tmp_path, capsys):
    assert run(["modes", str(scene), "--count", "3", "-o", str(tmp_path / "out"), "--plot"]) == 0
    out = capsys.readouterr().out
    assert "Hz" in out
    assert "proven" in out
    written = {path.name for path in (tmp_path / "out").iterdir()}
    assert {"result.json", "result.vtu", "modes.pvd", "modes.png", "mode-003-11.vtu"} <= written
    document = json.loads((tmp_path / "out" / "result.json").read_text(encoding="utf-8"))
    assert document["analysis"] == "modes"
    first = document["eigen"][0]
    assert first["lower"] < 4 * np.pi**4 < first["upper"]
    assert document["modal"]["total_mass"][2] == pytest.approx(1.0)


def test_buckling_to_a_tolerance(scene, capsys):
    assert run(["buckling", str(scene), "--count", "1", "--tolerance", "1e-5", "--json", "-"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["error"]["estimate"] <= 1e-5
    assert all(level["seconds"] > 0 for level in document["error"]["levels"])
    assert not any("as asked for" in words for words in document["model"]["reasons"])


def test_buckling_as_json(scene, capsys):
    assert run(["buckling", str(scene), "--count", "2", "--json", "-"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert [e["value"] for e in document["eigen"]] == pytest.approx([4 * np.pi**2, 6.25 * np.pi**2], rel=1e-3)


def test_prestress_and_range(scene, capsys):
    arguments = ["--prestress", "--range", "0,20", "--json", "-"]
    assert run(["modes", str(scene), *arguments]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["eigen"][0]["value"] == pytest.approx(4 * np.pi**4 - np.pi**2, rel=1e-3)
    assert max(e["frequency"] for e in document["eigen"]) < 20


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--range", "low"], "two frequencies"),
        (["--count", "0"], "whole number > 0"),
        (["--count", "900"], "there are only"),
    ],
)
def test_bad_options(scene, capsys, arguments, words):
    assert run(["modes", str(scene), *arguments]) == 2
    assert words in capsys.readouterr().err


def test_no_density(scene, capsys):
    scene.write_text(SCENE.format(density=0.0), encoding="utf-8")
    assert run(["modes", str(scene)]) == 2
    assert "no density" in capsys.readouterr().err


def test_a_mesh_is_not_enough(tmp_path, capsys):
    assert run(["modes", str(tmp_path / "plate.msh")]) == 2
    assert "needs a scene file" in capsys.readouterr().err


def test_response_and_check(scene, capsys):
    load = '[[load]]\nkind = "pressure"\nvalue = 1\n[[probe]]\nname = "centre"\nat = [0.5, 0.5, 0]\n'
    text = SCENE.format(density=1.0).split("[[load]]")[0] + load
    scene.write_text(
        text + '[damping]\nratio = 0.05\n[solve]\nanalysis = "response"\nrange = [0, 6]\n', encoding="utf-8"
    )
    assert run(["solve", str(scene)]) == 0
    out = capsys.readouterr().out
    assert "Response from 0 to 6 Hz" in out
    assert "equilibrium" not in out


def test_check_of_a_free_plate(scene, capsys):
    """A body without supports may vibrate."""
    text = SCENE.format(density=1.0).split("[[support]]")[0]
    scene.write_text(text + '[solve]\nanalysis = "modes"\n', encoding="utf-8")
    assert run(["check", str(scene)]) == 0, capsys.readouterr().err
    assert run(["modes", str(scene), "--count", "2"]) == 0
    assert "translation along z" in capsys.readouterr().out


@pytest.mark.parametrize(("analysis", "head"), [("buckling", "factor 1"), ("modes", "Hz 1")])
def test_cases_have_a_row_each_with_their_first_values(scene, capsys, analysis, head):
    cases = "[[case]]\nname = 'once'\nloads = [0, 1]\n[[case]]\nname = 'twice'\nloads = [0, 1]\nfactors = [2, 2]\n"
    prestress = "[solve]\nprestress = true\n" if analysis == "modes" else ""
    scene.write_text(scene.read_text(encoding="utf-8") + cases + prestress, encoding="utf-8")
    assert run([analysis, str(scene)]) == 0
    said = capsys.readouterr().out
    for words in ("Load cases, ", head, 'case "once"'):
        assert words in said
    assert "Envelope" not in said
    rows = {
        line.split()[0]: float(line.split()[1])
        for line in said.splitlines()
        if line.split()[:1] in (["once"], ["twice"])
    }
    if analysis == "buckling":
        assert rows["once"] == pytest.approx(2 * rows["twice"], rel=1e-6)
    else:
        assert rows["once"] > rows["twice"] > 0
