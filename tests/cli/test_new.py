"""kshell new: what it writes, what it refuses, and that what it writes is a scene that solves."""

import os
from pathlib import Path

import pytest

import kshell as ks
from kshell.cli.commands import run
from kshell.cli.starting import STARTS


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("kind", STARTS)
def test_a_scene_its_geometry_and_the_schema_that_it_names(kind, capsys):
    assert run(["new", kind]) == 0
    out = capsys.readouterr().out
    assert sorted(os.listdir(kind)) == sorted([f"{kind}.geo", f"{kind}.toml", "scene.schema.json"])
    text = Path(kind, f"{kind}.toml").read_text(encoding="utf-8")
    assert text.startswith("#:schema scene.schema.json\n")
    assert f"next: kshell check {Path(kind, kind)}.toml" in out
    scene = ks.Scene.load(Path(kind, f"{kind}.toml"))
    groups = set(scene.read_mesh().groups)
    named = {scene.supports[0].on} if isinstance(scene.supports[0].on, str) else set(scene.supports[0].on)
    assert named <= groups


@pytest.mark.full
@pytest.mark.parametrize("kind", STARTS)
def test_what_is_written_solves(kind):
    assert run(["new", kind, "-o", "a/b"]) == 0
    result = ks.solve(ks.Scene.load(Path("a/b", f"{kind}.toml")))
    assert result.balance < 1e-8
    assert result.warnings == []
    half = max(max(part["u"]["half_width"]) for part in result.error["probes"].values())
    assert half < 0.02 * abs(result.extremes["deflection"]["value"])


def test_a_folder_that_is_not_empty_is_refused(capsys):
    Path("taken").mkdir()
    Path("taken/mine.txt").write_text("mine", encoding="utf-8")
    assert run(["new", "plate", "-o", "taken"]) == 2
    assert "not empty" in capsys.readouterr().err
    assert os.listdir("taken") == ["mine.txt"]
    Path("empty").mkdir()
    assert run(["new", "plate", "-o", "empty"]) == 0
    assert run(["new", "plate", "-o", "taken/mine.txt"]) == 2


def test_an_unknown_start_is_refused(capsys):
    assert run(["new", "plat"]) == 2
    assert 'did you mean "plate"' in capsys.readouterr().err
    assert os.listdir() == []
