"""The command line, in this process where possible and once as a real one."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import kshell as ks
from kshell.cli import commands as cli
from kshell.mesh import write_msh
from tests.scene.fabricated import square_mesh

MESHES = Path(__file__).parents[2] / "meshes"
OPTIONS = ["--thickness", "0.01", "--E", "210e9", "--nu", "0.3"]

SCENE = """
title = "Square"
mesh = "square.msh"
thickness = 0.01
[material]
E = 210e9
nu = 0.3
[[support]]
on = ["left", "right", "bottom", "top"]
kind = "simply_supported"
[[load]]
kind = "pressure"
value = 1000
[[probe]]
name = "centre"
at = [0.5, 0.5, 0]
[solve]
element = "morley"
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    write_msh(square_mesh(8), tmp_path / "square.msh")
    (tmp_path / "scene.toml").write_text(SCENE, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "excepthook", sys.excepthook)  # put back afterwards
    return tmp_path


def run(capsys, *arguments):
    code = cli.run([str(a) for a in arguments])
    out, err = capsys.readouterr()
    return code, out, err


def refused(capsys, code, *arguments):
    """The one message of a run that must fail."""
    got, out, err = run(capsys, *arguments)
    assert got == code, err
    assert out == ""
    assert err.startswith("error: ")
    assert "Traceback" not in err
    return err


def test_solve_prints_the_answer_and_writes_nothing(folder, capsys):
    code, out, err = run(capsys, "solve", "scene.toml")
    assert (code, err) == (0, "")
    for words in (
        "Square",
        "morley",
        "centre",
        "deflection",
        "Reactions",
        "top",
        "equilibrium",
        "nothing written",
    ):
        assert words in out
    assert sorted(os.listdir()) == ["scene.toml", "square.msh"]


def test_solve_writes_results(folder, capsys):
    code, out, _ = run(capsys, "solve", "scene.toml", "-o", "out", "--json", "copy.json")
    assert code == 0
    assert sorted(os.listdir("out")) == ["result.json", "result.vtu"]
    document = json.loads(Path("out/result.json").read_text(encoding="utf-8"))
    assert json.loads(Path("copy.json").read_text(encoding="utf-8")) == document
    assert "out/result.vtu" in out
    D = 210e9 * 0.01**3 / 12 / 0.91
    assert document["probes"]["centre"]["u"][2] == pytest.approx(4.06235e-3 * 1000 / D, rel=0.1)
    total = sum(r["force"][2] for r in document["reactions"].values())
    assert total == pytest.approx(-1000.0, rel=1e-6)


def test_json_on_stdout_is_json_alone(folder, capsys):
    code, out, err = run(capsys, "solve", "scene.toml", "--json", "-", "-o", "out")
    assert (code, err) == (0, "")
    assert json.loads(out)["title"] == "Square"


def test_pictures(folder, capsys):
    assert run(capsys, "solve", "scene.toml", "--plot")[0] == 0
    names = os.listdir("scene-result")
    assert {"deflection.png", "mesh.png", "moment_xx.png", "result.json"} <= set(names)


def test_mesh_and_options_say_the_same_as_a_scene(folder, capsys):
    supports = [part for name in ("left", "right", "bottom", "top") for part in ("--supported", name)]
    by_options = [
        "solve",
        "square.msh",
        *OPTIONS,
        *supports,
        "--pressure",
        "500 + 500",
        "--element",
        "morley",
    ]
    assert run(capsys, *by_options, "--json", "a.json")[0] == 0
    assert run(capsys, "solve", "scene.toml", "--json", "b.json")[0] == 0
    a, b = (json.loads(Path(name).read_text(encoding="utf-8")) for name in ("a.json", "b.json"))
    w, same = (document["extremes"]["deflection"]["value"] for document in (a, b))
    assert w == pytest.approx(same, rel=1e-9)
    mixed = ["solve", "square.msh", *OPTIONS, "--clamped", "left", "--clamped", "top", "--symmetry", "right"]
    code, out, _ = run(capsys, *mixed, "--pressure", "1e3", "--element", "morley", "--density", "7850")
    assert code == 0
    assert "left" in out


def test_overrides(folder, capsys):
    values = []
    for value in (1000, 3000):
        _, out, _ = run(
            capsys, "solve", "scene.toml", "--set", f"load.0.value={value}", "--set", "title=x", "--json", "-"
        )
        document = json.loads(out)
        assert document["title"] == "x"
        values.append(document["probes"]["centre"]["u"][2])
    assert values[1] == pytest.approx(3 * values[0])


def test_check_of_a_scene(folder, capsys):
    code, out, err = run(capsys, "check", "scene.toml")
    assert (code, err) == (0, "")
    for words in (
        "81 vertices",
        "left",
        "curve",
        "length 1",
        "45 degrees",
        "element morley",
        "unknowns",
        "nothing found",
    ):
        assert words in out
    assert sorted(os.listdir()) == ["scene.toml", "square.msh"]


def test_check_of_a_mesh(folder, capsys):
    code, out, _ = run(capsys, "check", "square.msh")
    assert code == 0
    assert "corner" in out


def test_check_names_everything_that_is_wrong(folder, capsys):
    code, out, err = run(
        capsys,
        "check",
        "scene.toml",
        *("--set", "thickness=0.5 - x"),
        *("--set", 'load.0.on="plat"'),
        *("--set", 'support=[{on="lft", kind="clamped"}, {on="left", fix="z", value=[0, 0, "1/x"]}]'),
    )
    assert code == 2
    assert len([line for line in err.splitlines() if line.startswith("error: ")]) == 4
    for words in ("0.5 - x", "'plate'", "'left'", "inf at (0, 0, 0)"):
        assert words in err
    assert "81 vertices" in out


def test_check_says_what_moves_freely(folder, capsys):
    code, _, err = run(
        capsys, "check", "scene.toml", "--set", 'support=[{on="left", kind="simply_supported"}]'
    )
    assert code == 2
    assert "error: " in err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["modus", "scene.toml"], ["modus", "solve, modes"]),
        (["buckling"], ["SCENE"]),
        (["solve"], ["Missing argument"]),
        (["solve", "scene.toml", "--tolerance", "1"], ["tolerance", "percentage"]),
        (["solve", "scene.toml", "--set"], ["--set"]),
        (["solve", "scene.toml", "--set", "load.9.value=1"], ["load.9.value=1", "0 to 0"]),
        (["solve", "scene.toml", "--set", "solve.tolerance=1"], ["tolerance"]),
        (["solve", "scene.toml", "--set", "loads=1"], ['did you mean "load"']),
        (["solve", "scene.toml", "--thickness", "1"], ["--thickness", "--set thickness=0.02"]),
        (["solve", "scene.toml", "--mesh-size", "1"], ["--mesh-size", "--set"]),
        (["solve", "scene.toml", "--element", "kirchhoff"], ["kirchhoff", "koiter"]),
        (["solve", "scene.toml", "--solver", "fast"], ["fast", "multigrid"]),
        (["solve", "square.msh"], ["--thickness, --E, --nu missing"]),
        (["solve", "square.msh", *OPTIONS[:4]], ["--nu missing"]),
        (["solve", "square.msh", *OPTIONS, "--set", "a=1"], ["--set a=1", "scene file"]),
        (["solve", "square.msh", *OPTIONS, "--E", "steel"], ["'--E'", "number"]),
        (["solve", "square.msh", *OPTIONS, "--nu", "0.5", "--clamped", "left"], ["nu = 0.5"]),
        (["solve", "square.msh", *OPTIONS, "--clamped", "lft"], ["'lft'", "'left'"]),
        (["solve", "square.msh", *OPTIONS, "--clamped", "left", "--pressure", "x^2"], ["x^2", "**"]),
        (["solve", "square.msh", *OPTIONS, "--clamped", "left", "--pressure", "1/x"], ["inf at (0, 0"]),
        (
            ["solve", "square.msh", *OPTIONS, "--clamped", "left", "--mesh-order", "2"],
            ["mesh_order", "geometry"],
        ),
        (["solve", "square.msh", *OPTIONS, "--pressure", "1"], ["plate"]),
        (["solve", "nothing.toml"], ["nothing.toml", "no such file"]),
        (["solve", "scen.toml"], ['did you mean "scene.toml"']),
        (["solve", "scene.toml", "--set", "mesh=nothing.msh"], ["nothing.msh"]),
        (["check", "nothing.msh"], ["nothing.msh"]),
        (["check", "square.msh", "--set", "a=1"], ["--set a=1"]),
        (["solve", "scene.toml", "-o", "square.msh"], ["square.msh", "cannot be written"]),
        (["solve", "scene.toml", "--json", "."], ["folder"]),
    ],
)
def test_bad_input_is_one_message_and_code_2(folder, capsys, arguments, words):
    message = refused(capsys, 2, *arguments)
    for word in words:
        assert word in message
    assert sorted(os.listdir()) == ["scene.toml", "square.msh"]


def test_bad_input_leaves_earlier_results(folder, capsys):
    assert run(capsys, "solve", "scene.toml", "-o", "out")[0] == 0
    before = {name: (folder / "out" / name).read_bytes() for name in os.listdir("out")}
    refused(capsys, 2, "solve", "scene.toml", "-o", "out", "--set", "load.0.value=1/(x - 0.5)")
    refused(capsys, 2, "solve", "scene.toml", "-o", "out", "--set", "support=[]")
    assert {name: (folder / "out" / name).read_bytes() for name in os.listdir("out")} == before


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (ks.SolveError("no convergence after 200 steps"), 1, "no convergence"),
        (MemoryError(), 1, "out of memory"),
        (KeyboardInterrupt(), 130, "interrupted"),
        (ks.InputError("bad"), 2, "bad"),
    ],
)
def test_exit_codes(folder, capsys, monkeypatch, error, code, words):
    def fail(*_, **__):
        raise error

    monkeypatch.setattr("kshell.analysis.static.analyse", fail)
    assert words in refused(capsys, code, "solve", "scene.toml", "-o", "out")
    assert not Path("out").exists()
    got, _, err = run(capsys, "solve", "scene.toml", "--debug")
    assert got == code
    assert words in err
    assert "Traceback" in err or code == 130


def test_help_and_version(capsys):
    code, out, _ = run(capsys, "--version")
    assert (code, out) == (0, f"kshell {ks.__version__}\n")
    assert run(capsys, "--help") == run(capsys)
    code, out, _ = run(capsys, "solve", "--help")
    for words in ("--thickness", "--clamped", "--json", "--set", "KEY=VALUE"):
        assert words in out


def test_warnings_of_the_result_are_printed_and_issued(folder, capsys):
    without = ["--set", "load=[]"]
    _, out, err = run(capsys, "solve", "scene.toml", *without)
    assert "warning: there is no load" in out
    assert err == ""
    scene = ks.Scene.load("scene.toml", ["load=[]"])
    with pytest.warns(ks.KshellWarning, match="no load"):
        ks.solve(scene)


def test_solve_is_a_function_after_solving(folder):
    result = ks.solve(ks.Scene.load("scene.toml"))
    assert callable(ks.solve)
    assert ks.solve(ks.Scene.load("scene.toml"), element="argyris").model["element"] == "argyris"
    assert result.probe("centre")["u"].shape == (3,)


# what shipped scenes are warned of, all of it to be expected
KNOWN_WARNINGS = ("moments grow without bound", "stresses grow without bound", "too thick for this theory")


# of these each takes ten seconds or more
LONG = ("kirigami", "pressed_can", "table_corner")
JUMPS = "passes a limit point"  # of the sheet whose bridges buckle


@pytest.mark.parametrize(
    "scene",
    [
        pytest.param(path, id=path.stem, marks=[pytest.mark.full] * (path.stem in LONG))
        for path in sorted(MESHES.glob("*.toml"))
    ],
)
def test_shipped_scenes(scene, tmp_path, capsys):
    analysis = ks.Scene.load(scene).solve.analysis
    if analysis == "dynamic":
        pytest.skip("motions have tests of their own")
    command = analysis if analysis in ("modes", "buckling") else "solve"
    code, _, err = run(capsys, command, scene, "--json", tmp_path / "result.json")
    assert code == 0
    assert [line for line in err.splitlines() if not line.startswith("kshell: ")] == []  # progress
    document = json.loads((tmp_path / "result.json").read_text(encoding="utf-8"))
    known = KNOWN_WARNINGS if scene.stem.startswith("l_shape") else KNOWN_WARNINGS[:2]
    known += (JUMPS,) if scene.stem == "kirigami" else ()
    assert [words for words in document["warnings"] if not any(part in words for part in known)] == []
    assert document["balance"] < 1e-6
    exact = {"disk": 5.3 / 1.3 / 64, "ellipse": 1 / (8 * (3 / 16 + 3 + 2 / 4)), "sector": 1 / 64}
    if scene.stem in exact:
        (probe,) = document["probes"].values()
        assert probe["u"][2] == pytest.approx(1e-3 * exact[scene.stem], rel=1e-5)


def test_a_real_process(folder):
    command = [sys.executable, "-c", "from kshell.cli.commands import main; main()"]
    done = subprocess.run([*command, "solve", "scene.toml", "--json", "-"], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    assert json.loads(done.stdout)["mesh"]["triangles"] == 128
    failed = subprocess.run([*command, "solve", "scene.toml", "--set", "x=1"], capture_output=True, text=True)
    assert failed.returncode == 2
    assert failed.stdout == ""
    assert failed.stderr.count("\n") == 1
    fault = (
        "import kshell.analysis.static as s; s.analyse = None; from kshell.cli.commands import main; main()"
    )
    broken = subprocess.run(
        [sys.executable, "-c", fault, "solve", "scene.toml"], capture_output=True, text=True
    )
    assert broken.returncode == 1
    assert "--debug" in broken.stderr
    assert "Traceback" not in broken.stderr


def test_help_imports_nothing_heavy():
    code = (
        "import sys; from kshell.cli.commands import run; run(['--help']);"
        "heavy = {'numpy', 'scipy', 'matplotlib', 'gmsh', 'meshio', 'skfem', 'pyvista', 'sympy', 'pydantic'};"
        "sys.exit(', '.join(heavy & set(sys.modules)) or 0)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_the_installed_command():
    command = shutil.which("kshell", path=os.path.dirname(sys.executable))
    if command is not None:
        done = subprocess.run([command, "--version"], capture_output=True, text=True)
        assert done.stdout == f"kshell {ks.__version__}\n"
