"""What meets what: the table of docs/matrix.md, cell by cell."""

from __future__ import annotations

import re
import warnings
from pathlib import Path
from typing import Any

import pytest

import kshell as ks
from tests.plate.plates import rectangle

PAGE = Path(__file__).parents[2] / "docs" / "matrix.md"
STEEL = ks.Isotropic(E=1e6, nu=0.3, density=1.0)
PLATE: dict[str, Any] = {
    "thickness": 0.05,
    "material": STEEL,
    "supports": [ks.Clamped("left"), ks.Fixed("right", "zr")],
    "loads": [ks.LineForce("right", (-1.0, 0, 0), name="push"), ks.Pressure(0.1, name="press")],
    "probes": {"middle": (0.5, 0.5, 0.0)},
}
BENT = {"loads": [ks.Pressure(1e-3, name="press")], "supports": [ks.Clamped(["left", "right"])]}
LAYERS = [ks.Layer(STEEL, 0.025, 0.0), ks.Layer(STEEL, 0.025, 90.0)]
CASES = [ks.Case("one", [0]), ks.Case("two", [0], [2.0])]
# what a feature adds to a scene, and the options that ask for it
ROWS: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "path": ({}, {"analysis": "path", "steps": 2}),
    "imperfection": ({"imperfection": ks.Imperfection(amplitude=1e-3)}, {"model": "shell"}),
    "chart": ({"chart": ks.geometry.Cylinder(R=2.0), "probes": {}}, {}),
    "laminate": ({"layers": LAYERS, "thickness": None, "material": None}, {}),
    "large deflection": ({}, {"large_deflection": True}),
    "small deflection": ({}, {"large_deflection": False}),
    "cases": ({"cases": CASES}, {}),
    "tolerance": ({}, {"tolerance": 0.3, "limit": "2 s"}),
}
COLUMNS: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "modes": ({}, {"analysis": "modes", "count": 2}),
    "buckling": ({}, {"analysis": "buckling", "count": 1}),
    "dynamic": ({}, {"analysis": "dynamic", "time": 0.01, "step": 0.005}),
    "tolerance": ({}, {"tolerance": 0.3, "limit": "2 s"}),
    "cases": ({"cases": CASES}, {}),
}


def meet(row: str, column: str) -> ks.Result:
    """The answer to a plate with both features."""
    (given, options), (more, further) = ROWS[row], COLUMNS[column]
    options = {**options, **further}
    if (
        row == "path" and "analysis" in further
    ):  # both are analyses: what the second asks for is asked of the first
        options["analysis"] = "path"
    bent = {} if column in ("modes", "buckling") else BENT
    scene = ks.Scene(mesh=rectangle(2), **{**PLATE, **bent, **given, **more})
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ks.KshellWarning)
        return ks.solve(scene, **options)


def cells() -> list[tuple[str, str, str]]:
    """(row, column, what the page says) of the first table."""
    table = re.search(r"^\|.*?\n\n", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    assert table is not None
    rows = [
        [cell.strip() for cell in line.strip().strip("|").split("|")]
        for line in table[0].strip().splitlines()
        if not re.match(r"\|\s*-", line)
    ]
    head, *rest = rows
    return [(row[0], column, cell) for row in rest for column, cell in zip(head[1:], row[1:], strict=True)]


def test_the_page_has_every_cell():
    assert {(row, column) for row, column, _ in cells()} == {(r, c) for r in ROWS for c in COLUMNS}


@pytest.mark.parametrize(("row", "column", "cell"), cells())
def test_each_cell_is_as_the_page_says(row, column, cell):
    if cell == "works":
        result = meet(row, column)
        assert result.fields or result.cases
    else:
        with pytest.raises(ks.InputError, match=re.escape(cell.removeprefix("refused: "))):
            meet(row, column)
