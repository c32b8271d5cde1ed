"""`kshell verify`: what it prints and writes, and that it fails when a case does."""

import csv
import os
from dataclasses import replace
from pathlib import Path

import pytest

import kshell.verify.run as running
from kshell.cli.commands import run as kshell
from kshell.errors import InputError, SolveError
from kshell.verify import verify
from kshell.verify.cases import all_cases, find
from kshell.verify.cases.rates import RATES
from kshell.verify.command import not_run
from kshell.verify.machine import machine
from kshell.verify.run import run_blocks
from verification import summary

FEW = ("ssss.uniform.ba1", "disk.ss.uniform")


@pytest.fixture
def few(monkeypatch):
    chosen = tuple(find(id) for id in FEW)
    monkeypatch.setattr(running, "all_cases", lambda: chosen)
    monkeypatch.setattr(running, "RATES", tuple(row for row in RATES if row.case == FEW[0])[:1])
    return chosen


def with_allowance(case, factor):
    return replace(
        case,
        allowed={
            run: {name: factor * x for name, x in errors.items()} for run, errors in case.allowed.items()
        },
    )


def test_quick_solves_every_case_once_with_each_element():
    for case in all_cases():
        methods = [run.method for run in case.quick_runs]
        assert len(set(methods)) == len(methods)
        expected = {run.method for run in case.runs}
        assert set(methods) == (expected if case.quick is None else expected & set(case.quick))
        assert set(case.quick_runs) <= set(case.runs)


def test_quick_run_prints_a_table_and_succeeds(few, capsys):
    assert kshell(["verify", "--quick"]) == 0
    printed = capsys.readouterr().out
    head, *lines = printed.splitlines()
    assert head.split() == [
        "case", "mesh", "unknowns", "quantity", "value", "reference", "error", "allowed", "seconds", "verdict",
    ]  # fmt: skip
    assert sum(line.startswith(FEW) and line.endswith("passed") for line in lines) == 38
    assert "2 cases, 38 values" in lines[-1]
    assert "all within what is allowed; worst ratio" in lines[-1]
    assert any(line.startswith("not run: ") for line in lines)
    assert any("B.skew.note" in line for line in lines)


def test_full_run_writes_page_table_and_charts(few, tmp_path, capsys):
    assert kshell(["verify", "--out", str(tmp_path / "new" / "report")]) == 0
    folder = tmp_path / "new" / "report"
    names = ["errors.png", "margins.png", "rates.png", "times.png", "verification.csv", "verification.html"]
    assert sorted(path.name for path in folder.iterdir()) == names
    for name in names[:4]:
        assert (folder / name).read_bytes().startswith(b"\x89PNG")
    text = (folder / "verification.csv").read_text(encoding="utf-8")
    facts = dict(line[2:].split(": ", 1) for line in text.splitlines() if line.startswith("#"))
    assert set(facts) >= {"processor", "kshell", "numpy", "commit"}
    table = list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
    assert {row["case"] for row in table} == set(FEW)
    assert {row["mesh"] for row in table} > {"argyris-4-order2"}
    assert any(row["quantity"].startswith("rate ") for row in table)
    page = (folder / "verification.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,") == 4
    assert page.count("<tr><td>") > len(table)
    assert "Timoshenko" in page
    assert "B.skew.note" in page
    assert "written: " in capsys.readouterr().out
    words = summary.table(*summary.read(folder))
    assert f"2: 2 plates, 0 {next(iter(summary.KINDS))}" in words
    assert "and 1 rates of convergence" in words
    assert "failed | none" in words


def test_what_takes_long_is_said_to_be_left_to_the_full_suite():
    words = not_run(quick=True)
    assert words[0].startswith("left to the full suite")
    assert "large.roof.isotropic" in words[0]
    assert not any("left to" in line for line in not_run(quick=False))


def test_a_case_that_loses_digits_fails(few, monkeypatch, capsys):
    monkeypatch.setattr(running, "all_cases", lambda: (with_allowance(few[0], 0.1), few[1]))
    assert kshell(["verify", "--quick"]) == 1
    printed = capsys.readouterr().out
    assert "values FAILED" in printed.splitlines()[-1]
    assert "  FAILED" in printed


def test_a_case_that_needs_more_unknowns_fails(few):
    case = replace(few[0], most_unknowns={name: n - 1 for name, n in few[0].most_unknowns.items()})
    assert not any(one.passed for block in run_blocks(True, [case]) for one in block.outcomes)


def test_a_case_without_an_answer_fails_in_the_table(few, capsys):
    def build(refinement, order):
        raise SolveError("the matrix is singular")

    report = verify(quick=True, cases=[replace(few[0], build=build)])
    assert len(report.failed) == len(report.outcomes) == 13
    assert "no answer: the matrix is singular" in capsys.readouterr().out


def test_a_folder_that_cannot_be_is_found_before_anything_is_solved(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("", encoding="utf-8")
    monkeypatch.setattr(running, "all_cases", lambda: pytest.fail("solved"))
    with pytest.raises(InputError, match="is a file"):
        verify(out=tmp_path / "file" / "report")
    assert kshell(["verify", "--out", str(tmp_path / "file" / "report")]) == 2


def test_what_was_measured_on_is_told():
    facts = machine()
    assert facts["commit"]
    assert str(os.cpu_count()) in facts["processor"]


def test_a_wheel_has_what_verify_needs(tmp_path):
    """The packages and data that setup.py names are those the cases read."""
    import runpy
    import sys

    import setuptools

    root = Path(running.__file__).parents[2]
    given = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(root)
        patch.setattr(setuptools, "setup", given.update)
        patch.setattr(sys, "argv", ["setup.py"])
        runpy.run_path("setup.py")
    packages = set(given["packages"])
    assert {"kshell.plate", "kshell.verify.cases", "kshell.verify", "kshell.verify.meshes"} <= packages
    assert {name.split(".")[0] for name in packages} == {"kshell"}
    for name in packages - {"kshell.verify.meshes"}:
        assert (root / name.replace(".", "/")).is_dir()
    assert given["package_dir"] == {"kshell.verify.meshes": "meshes"}


def test_the_readme_has_the_place_of_the_summary():
    text = (summary.HERE / "README.md").read_text(encoding="utf-8")
    assert text.count(summary.BEGIN) == text.count(summary.END) == 1
    for chart in ("margins.png", "rates.png", "errors.png"):
        assert f"pictures/suite/{chart}" in text
