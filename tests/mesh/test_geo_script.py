"""Geometry files run no programs and write no files, unless that is allowed."""

from __future__ import annotations

from pathlib import Path

import pytest

from kshell.errors import InputError
from kshell.mesh import read_mesh
from kshell.mesh.geo_script import require_harmless

PLATE = 'SetFactory("OpenCASCADE");\nRectangle(1) = {0, 0, 0, 1, 1};\n'
RUNS = {
    "SystemCall": 'SystemCall "touch HIT";\n',
    "System": "System 'touch HIT';\n",
    "in the background": 'NonBlockingSystemCall "touch HIT";\n',
    "put together": 'System StrCat("touch", " HIT");\n',
    "after a comment": 'SystemCall /* nothing */ "touch HIT";\n',
    "over lines": 'SystemCall\n  "touch HIT"\n;\n',
    "in a macro": 'Macro Run\nSystemCall "touch HIT";\nReturn\nCall Run;\n',
    "under a condition": 'If (1 > 0)\nSystemCall "touch HIT";\nEndIf\n',
    "a made up word": 'StringToName["SystemCall"] "touch HIT";\n',
    "a program": 'OnelabRun("touch", "HIT");\n',
    "a field": 'Field[1] = ExternalProcess;\nField[1].CommandLine = "touch HIT";\n',
    "a mesh written": 'Save "HIT";\n',
    "a picture written": 'Print "HIT";\n',
    "text written": 'Printf("%g", 1) > "HIT";\n',
    "text added": 'Printf("hello") >> "HIT";\n',
    "a view written": 'Save View[0] "HIT";\n',
    "a folder made": 'CreateDir "HIT";\n',
    "the end": "Exit;\n",
    "a file of a plugin": 'Plugin(Particles).OutputFile = "HIT";\n',
    "options written": 'General.OptionsFileName = "HIT";\nGeneral.SaveOptions = 1;\n',
    "a solver": 'Solver.Executable0 = "touch HIT";\n',
}


@pytest.fixture(autouse=True)
def _in_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def write(name: str, text: str) -> Path:
    path = Path(name)
    path.parent.mkdir(exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("name", RUNS)
def test_refused(name):
    with pytest.raises(InputError, match=r"plate\.geo, line [3-5]: \w+.*--allow-system"):
        read_mesh(write("plate.geo", PLATE + RUNS[name]))
    assert not Path("HIT").exists()


@pytest.mark.parametrize("opens", ["Include", "Merge"])
@pytest.mark.parametrize(
    "how", ['"parts/more.geo"', 'StrCat(CurrentDirectory, "parts/more.geo")', "'parts/more.geo'"]
)
def test_refused_in_files_it_opens(opens, how):
    write("parts/more.geo", 'Include "last.txt";\n')
    write("parts/last.txt", RUNS["SystemCall"])
    with pytest.raises(InputError, match=r"last\.txt, line 1: SystemCall runs a command of the system"):
        read_mesh(write("plate.geo", PLATE + f"{opens} {how};\n"))
    assert not Path("HIT").exists()


@pytest.mark.parametrize("suffix", [".opt", ".geo.opt"])
def test_refused_in_options_beside_it(suffix):
    """gmsh reads plate.geo.opt after plate.geo; plate.opt it does not read."""
    write(f"plate{suffix}", RUNS["SystemCall"])
    path = write("plate.geo", PLATE)
    if suffix == ".opt":
        assert read_mesh(path).areas.sum() == pytest.approx(1.0)
    else:
        with pytest.raises(InputError, match=r"plate\.geo\.opt, line 1: SystemCall"):
            read_mesh(path)
    assert not Path("HIT").exists()


def test_refused_in_options_beside_a_cad_file():
    write("plate.step.opt", RUNS["SystemCall"])
    path = write("plate.step", "ISO-10303-21;")
    with pytest.raises(InputError, match=r"plate\.step\.opt, line 1: SystemCall"):
        read_mesh(path)


def test_names_that_are_made_up():
    with pytest.raises(InputError, match=r"line 3: Merge of a file whose name is made up on the way"):
        read_mesh(write("plate.geo", PLATE + 'Merge Sprintf("%g.geo", 1);\n'))
    write("run.py", "print(1)")
    with pytest.raises(InputError, match=r"run\.py: .*is opened by gmsh as a program"):
        read_mesh(write("plate.geo", PLATE + 'Merge "run.py";\n'))


def test_files_that_include_each_other_end():
    require_harmless(write("a.geo", 'Include "b.geo";\n'))
    write("b.geo", 'Include "a.geo";\n')
    require_harmless(Path("a.geo"))


HARMLESS = {
    "comments": '// SystemCall "x";\n/* Save "x";\n Print "y"; */\n',
    "strings": 'Physical Surface("System; Save") = {1};\nPrintf("SystemCall > %g", 1);\n',
    "options": "Mesh.SaveAll = 1; Print.Text = 0; Mesh.MshFileVersion = 4.1;\n",
    "names": "SystemSize = 2; MySave = 1; Exits = 3;\n",
    "a warning": 'Warning("thin");\nIf (2 > 1)\nPrintf("larger");\nEndIf\n',
    "a crack": "Plugin(Crack).Dimension = 1;\n",
}


@pytest.mark.parametrize("name", HARMLESS)
def test_not_refused(name):
    assert read_mesh(write("plate.geo", PLATE + HARMLESS[name])).areas.sum() == pytest.approx(1.0)


def test_allowed():
    mesh = read_mesh(write("plate.geo", PLATE + 'SystemCall "touch HIT";\n'), allow_system=True)
    assert mesh.areas.sum() == pytest.approx(1.0)
    assert Path("HIT").exists()


def test_from_the_command_line(capsys):
    from kshell.cli.commands import run

    write(
        "plate.geo",
        PLATE + 'Physical Curve("edge") = {1:4};\nPhysical Surface("p") = {1};\n' + RUNS["SystemCall"],
    )
    scene = 'mesh = "plate.geo"\nmesh_size = 0.5\nthickness = 0.01\n[material]\nE = 2e11\nnu = 0.3\n'
    scene += '[[support]]\non = "edge"\nkind = "clamped"\n[[load]]\nkind = "pressure"\nvalue = 1.0\n'
    write("plate.toml", scene)
    for words in (
        ["check", "plate.geo"],
        ["check", "plate.toml"],
        ["solve", "plate.toml"],
        ["trace", "plate.toml"],
    ):
        assert run(words) == 2
        assert "SystemCall runs a command of the system" in capsys.readouterr().err
        assert not Path("HIT").exists()
    for words in (["check", "plate.geo"], ["check", "plate.toml"], ["solve", "plate.toml"]):
        assert run([*words, "--allow-system"]) == 0
        Path("HIT").unlink()


def test_of_a_mesh_put_on_its_geometry():
    mesh = read_mesh(write("plate.geo", PLATE))
    write("evil.geo", PLATE + RUNS["SystemCall"])
    with pytest.raises(InputError, match="SystemCall runs a command"):
        read_mesh(mesh, geometry="evil.geo")
    assert not Path("HIT").exists()
