"""Options declared once, and what help and completion say of them."""

import json
import os
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import pytest
import typer

from kshell.cli.commands import run
from kshell.cli.grouping import flat


@dataclass(frozen=True)
class Base:
    debug: Annotated[bool, typer.Option("--debug")] = False


@dataclass(frozen=True)
class Derived(Base):
    size: Annotated[float | None, typer.Option()] = None


def test_fields_of_a_group_become_options_and_come_back_as_one():
    got = []

    def command(first: int, group: Derived) -> None:
        got.append((first, group))

    flattened = flat(command)
    assert list(flattened.__annotations__)[:-1] == ["first", "size", "debug"]
    flattened(first=3, size=0.5, debug=True)
    assert got == [(3, Derived(debug=True, size=0.5))]


def test_an_option_cannot_be_declared_twice():
    def command(size: int, group: Derived) -> None:
        pass

    with pytest.raises(TypeError, match="same name"):
        flat(command)


def test_help_is_whole_in_80_columns(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    run(["--help"])
    text = capsys.readouterr().out
    commands = [line.split()[0] for line in text.split("Commands:\n")[1].splitlines() if line[2:3].strip()]
    assert {"solve", "modes", "check", "verify"} <= set(commands)
    for name in commands:
        assert run([name, "--help"]) == 0
        text += capsys.readouterr().out
    assert "..." not in text.replace("[ARGS]...", "")
    assert "…" not in text
    assert max(map(len, text.splitlines())) <= 80


@pytest.mark.full
def test_completion_knows_commands_and_options():
    for words, expected in (("kshell mo", "modes"), ("kshell modes --pre", "--prestress")):
        done = subprocess.run(
            [sys.executable, "-c", "from kshell.cli.commands import main; main()"],
            capture_output=True,
            text=True,
            env={
                **os.environ,
                "_KSHELL_COMPLETE": "complete_bash",
                "COMP_WORDS": words,
                "COMP_CWORD": str(words.count(" ")),
            },
        )
        assert expected in done.stdout.split()


@pytest.mark.parametrize(
    ("key", "words"),
    [
        ("load.line_force", ["[[load]]", "force / length", "expressions", "on:"]),
        ("support.kind", ["support.clamped", "support.fix"]),
        ("solve.tolerance", ["Relative", '"1%"', "unit: 1"]),
        ("load.0.value", ["load.pressure.value", "load.gravity.value"]),
    ],
)
def test_explain(key, words, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    assert run(["explain", key]) == 0
    text = capsys.readouterr().out
    for word in words:
        assert word in text
    assert "…" not in text


def test_explain_without_a_key_lists_all_blocks(capsys):
    assert run(["explain"]) == 0
    text = capsys.readouterr().out
    assert all(name in text for name in ("[[load]]", "[solve]", "line_force", "top_towards"))


def test_explain_of_an_unknown_key(capsys):
    assert run(["explain", "load.presure"]) == 2
    assert "did you mean load.pressure" in capsys.readouterr().err


def test_the_schema_is_printed(capsys):
    assert run(["explain", "--schema"]) == 0
    assert json.loads(capsys.readouterr().out)["properties"]["load"]["type"] == "array"
    assert run(["explain", "--schema", "load"]) == 2


def test_one_key_is_set_once(capsys):
    code = run(["check", "meshes/plate.toml", "--set", "thickness=0.01", "--set", "thickness=0.02"])
    assert code == 2
    assert "thickness is given twice, before with thickness=0.01" in " ".join(capsys.readouterr().err.split())


def test_what_is_required_has_no_words_for_its_absence():
    """In all blocks of scene files, also where the words are those of what a block derives from."""

    def required(part):
        if isinstance(part, dict):
            keys = part.get("required", [])
            for name, key in part.get("properties", {}).items():
                if name in keys:
                    yield name, key.get("description", "")
            for inner in part.values():
                yield from required(inner)
        elif isinstance(part, list):
            for inner in part:
                yield from required(inner)

    found = list(required(json.loads(Path("docs/scene.schema.json").read_text(encoding="utf-8"))))
    assert len(found) > 50
    assert [(name, words) for name, words in found if "absent" in words] == []


def test_seconds_of_stages_add_up_to_the_whole(tmp_path, capsys):
    for more in ([], ["-o", str(tmp_path / "out"), "--plot"]):
        assert run(["solve", "meshes/disk.toml", *more]) == 0
        line = re.search(r"^solver [^;]*; (.*?\))$", capsys.readouterr().out, re.DOTALL | re.MULTILINE)[1]
        whole, *parts = (float(number) for number in re.findall(r"\d+\.\d\d", line))
        assert sum(parts) == pytest.approx(whole, abs=0.01 * len(parts))
        assert ("write" in line) == bool(more)
        assert "other" in line
