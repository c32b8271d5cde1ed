"""Whatever a scene file or an option says, kshell answers or says in words what is wrong."""

from __future__ import annotations

import json
import os
import sys
import threading
from pathlib import Path

import pytest

from kshell.cli.commands import run
from kshell.errors import InputError
from kshell.result.saving import UNFINISHED, _machine, write_text, write_together

MESHES = Path(__file__).parents[2] / "meshes"
PLATE = f"""
mesh = "{(MESHES / "unit_square.msh").as_posix()}"
thickness = 0.01
material = {{E = 1e9, nu = 0.3}}
support = [{{on = "left", kind = "clamped"}}]
load = [{{kind = "pressure", value = 1.0}}]
"""
LONGEST = 1500  # characters of any message


@pytest.fixture
def solve(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(sys, "excepthook", sys.excepthook)  # put back what `run` sets
    monkeypatch.chdir(tmp_path)

    def run_on(text: str | bytes, *options: str) -> tuple[int, str]:
        path = tmp_path / "scene.toml"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        code = run(["solve", str(path), *options])
        return code, capsys.readouterr().err

    return run_on


DAMAGED = {
    "kind a list": PLATE.replace('kind = "pressure"', "kind = []"),
    "kind a table": PLATE.replace('kind = "clamped"', "kind = {}"),
    "nested lists": PLATE + "title = " + "[" * 3000 + "]" * 3000,
    "thousands of digits": PLATE.replace("value = 1.0", "value = " + "9" * 5000),
    "a long path": PLATE.replace(f'mesh = "{MESHES.as_posix()}', 'mesh = "' + "a" * 5000),
    "a long kind": PLATE.replace('kind = "clamped"', f'kind = "{"c" * 3000}"'),
    "a long group": PLATE.replace('on = "left"', f'on = "{"g" * 100_000}"'),
    "a long key": PLATE + "k" * 5000 + " = 1",
    "a long list": PLATE.replace("thickness = 0.01", f"thickness = {list(range(5000))}"),
    "moduli apart": PLATE.replace("E = 1e9, nu = 0.3", "E1 = 1e11, E2 = 1e-10, nu12 = 0.3, G12 = 5e9"),
}


@pytest.mark.parametrize("name", DAMAGED)
def test_is_said_in_words(solve, name):
    code, words = solve(DAMAGED[name])
    assert code == 2
    assert words.startswith("error: ")
    assert "fault of kshell" not in words
    assert len(words) < LONGEST


@pytest.mark.parametrize(
    "override", ["load.².value=2", "load." + "9" * 5000 + ".value=2", "thickness=" + "9" * 5000]
)
def test_overrides_are_checked(solve, override):
    code, words = solve(PLATE, "--set", override)
    assert code == 2
    assert words.startswith("error: ")
    assert len(words) < LONGEST


def test_numbers_of_options_are_checked(solve):
    assert solve(PLATE, "--order", "²")[0] == 2


def test_a_mark_of_byte_order_is_skipped(solve):
    assert solve(b"\xef\xbb\xbf" + PLATE.encode())[0] == 0


def test_a_shell_held_in_every_unknown_is_answered(solve):
    hook = PLATE.replace("unit_square", "raasch_hook").replace(
        '{on = "left", kind = "clamped"}', '{on = "hook", fix = "xyzr"}'
    )
    for override in ((), ("--set", "load=[]")):
        code, words = solve(hook, "--large-deflection", "false", *override)
        assert code == 0, words


def test_json_goes_through_links(solve, tmp_path):
    real = tmp_path / "elsewhere.json"
    real.write_text("old", encoding="utf-8")
    link = tmp_path / "link.json"
    link.symlink_to(real)
    assert solve(PLATE, "--json", str(link))[0] == 0
    assert link.is_symlink()
    assert json.loads(real.read_text(encoding="utf-8"))["analysis"] == "static"


def test_json_goes_into_devices(solve):
    assert solve(PLATE, "--json", os.devnull)[0] == 0
    assert Path(os.devnull).is_char_device()


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no named pipes here")
def test_text_goes_into_pipes(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    read: list[str] = []
    reader = threading.Thread(target=lambda: read.append(pipe.read_text(encoding="utf-8")))
    reader.start()
    write_text("{}", pipe)
    reader.join()
    assert read == ["{}"]
    assert pipe.is_fifo()


def test_what_killed_runs_left_is_removed(tmp_path):
    most = 2**22 + 1  # no process has a larger number
    left = tmp_path / f"{UNFINISHED}{_machine()}-{most}-x"
    running = tmp_path / f"{UNFINISHED}{_machine()}-{os.getpid()}-x"
    for folder in (left, running):
        folder.mkdir()
    write_together(tmp_path, {"a.txt": lambda path: path.write_text("a", encoding="utf-8")})
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted(["a.txt", running.name])


def test_long_names_of_files_are_refused(tmp_path):
    with pytest.raises(InputError, match="cannot be written"):
        write_text("{}", tmp_path / ("a" * 300))
