"""The table of frequencies and buckling factors to a tolerance: complete, and measured as it says."""

import csv

import pytest

from kshell.verify.cases import modal
from verification.benchmarks.modes import HERE, TOLERANCE, measured, sets, table

WRONG = {"vibration.rhombus.SSSS.30", "vibration.rhombus.CFFF.30"}  # collected values, see modes.md


def rows():
    with (HERE / "modes.csv").open(encoding="utf-8", newline="") as file:
        return {row["set"]: row for row in csv.DictReader(file)}


def test_the_table_is_complete_and_every_interval_narrow():
    found = rows()
    assert set(found) == {case.id for case in modal.cases()} | {
        "vibration.L.clamped",
        "vibration.L.supported",
    }
    for name, row in found.items():
        assert bool(row["outside"]) == (name in WRONG)
        assert row["kind"] in ("guaranteed", "estimated")
        assert row["note"] == ""
        assert float(row["width"]) <= (1e-4 if "vibration.L" in name else TOLERANCE)


def test_the_page_is_that_of_the_table():
    page = (HERE / "modes.md").read_text(encoding="utf-8")
    assert page.splitlines()[:-2] == table(list(rows().values())).splitlines()[:-2]  # but for the machine


def test_a_set_is_measured():
    (one,) = sets(["buckling.SSSS.x.ab0.5"])
    row = measured(one)
    assert row["kind"] == "guaranteed"
    assert row["outside"] == ""
    assert row["distance"] == pytest.approx(0.0, abs=TOLERANCE)
    assert 0.0 < row["width"] <= TOLERANCE
