"""Sweeps: rows in order, points that fail, the same rows from one process and from two, files, and bad input."""

import csv
import os
import sys

import numpy as np
import pytest

import kshell as ks


def plate(**changes):
    mesh = ks.geometry.Plane().mesh(4, 4, 1, ("left", "right", "bottom", "top"), (0, 1), (0, 1), "alternate")
    given = {
        "mesh": mesh,
        "thickness": 0.01,
        "material": ks.Isotropic(E=210e9, nu=0.3, density=7850),
        "supports": [ks.Clamped("left")],
        "loads": [ks.Pressure(-100.0), ks.Gravity((0, 0, -9.81))],
        "probes": {"tip": (1.0, 0.5, 0.0)},
        "solve": {"large_deflection": False},
    }
    return ks.Scene(**given | changes)


def test_rows_are_those_of_single_solves():
    rows = ks.sweep(
        plate(), {"thickness": [0.01, 0.02], "load.0.value": np.array([-100.0, -200.0])}, workers=1
    )
    assert [(row["thickness"], row["load.0.value"]) for row in rows] == [
        (0.01, -100.0),
        (0.01, -200.0),
        (0.02, -100.0),
        (0.02, -200.0),
    ]
    alone = ks.solve(plate(thickness=0.02, loads=[ks.Pressure(-200.0), ks.Gravity((0, 0, -9.81))]))
    assert rows[3]["tip.uz"] == pytest.approx(alone.probe("tip")["u"][2], rel=1e-12)
    assert rows[3]["deflection"] == pytest.approx(alone.extremes["deflection"]["value"], rel=1e-12)
    assert rows[3]["error"] == ""
    assert rows.columns[:2] == rows.parameters == ["thickness", "load.0.value"]
    assert rows.columns[-1] == "error"


def test_two_processes_give_the_same_rows():
    """Functions go along to the other processes."""
    scene = plate(loads=[ks.Pressure(lambda x, y, z: -100.0 * x)])
    values = {"thickness": [0.008, 0.01, 0.012]}
    one, two = (ks.sweep(scene, values, workers=n) for n in (1, 2))
    assert [row["tip.uz"] for row in two] == pytest.approx([row["tip.uz"] for row in one], rel=1e-12)


def test_relative_files_are_found_where_the_sweep_is_begun(tmp_path, monkeypatch):
    """Processes are used again, wherever the earlier sweep stood."""
    for number in (1, 2):
        folder = tmp_path / str(number)
        scene = plate()
        scene.save(folder / "plate.toml")
        monkeypatch.chdir(folder)
        rows = ks.sweep(ks.Scene.load("plate.toml"), {"thickness": [0.01, 0.02]}, workers=2)
        assert [row["error"] for row in rows] == ["", ""]


def test_a_failed_point_is_a_row_with_its_reason():
    rows = ks.sweep(plate(), {"material.nu": [0.3, 0.7]}, workers=1)
    assert [bool(row["error"]) for row in rows] == [False, True]
    assert "nu" in rows[1]["error"]
    assert "tip.uz" not in rows[1]


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="processes are forked on Linux")
def test_a_point_whose_process_dies_is_a_row_with_its_reason(monkeypatch):
    monkeypatch.setattr("kshell.analysis.sweep.can_fork", lambda: True)
    here = os.getpid()

    def deadly(x, y, z):
        if os.getpid() != here:
            os._exit(9)
        return -100.0 + 0 * x

    rows = ks.sweep(plate(), {"load.0.value": [-100.0, deadly, -200.0]}, workers=2)
    assert [bool(row["error"]) for row in rows] == [False, True, False]
    assert "ended with the code 9" in rows[1]["error"]
    assert rows[2]["tip.uz"] < rows[0]["tip.uz"] < 0.0


def test_cases_have_a_row_each(tmp_path):
    scene = plate(cases=[ks.Case("p", [0]), ks.Case("g", [1])])
    rows = ks.sweep(scene, {"thickness": [0.01, 0.02]}, workers=1)
    assert [(row["thickness"], row["case"]) for row in rows] == [
        (0.01, "p"),
        (0.01, "g"),
        (0.02, "p"),
        (0.02, "g"),
    ]
    path = rows.save(tmp_path / "rows.csv")
    with open(path, newline="", encoding="utf-8") as stream:
        read = list(csv.DictReader(stream))
    assert [float(row["tip.uz"]) for row in read] == pytest.approx([row["tip.uz"] for row in rows], rel=1e-15)


def test_frequencies():
    rows = ks.sweep(plate(), {"thickness": [0.01, 0.02]}, workers=1, analysis="modes", count=2, error="off")
    assert rows[1]["frequency_1"] == pytest.approx(2 * rows[0]["frequency_1"], rel=1e-6)


@pytest.mark.parametrize(
    ("parameters", "options", "words"),
    [
        ({}, {}, "needs parameters"),
        ({"thickness": []}, {}, "at least one"),
        ({"thickness": 0.01}, {}, "list of values"),
        ({"thikness": [0.01]}, {}, "thickness"),
        ({"load.7.value": [1.0]}, {}, "list of 2"),
        ({"title.x": ["a"]}, {}, "no keys"),
        ({"thickness": [0.01]}, {"workers": 0}, "workers"),
        ({"thickness": [0.01]}, {"elemnt": "morley"}, "element"),
    ],
)
def test_bad_sweeps(parameters, options, words):
    with pytest.raises(ks.InputError, match=words):
        ks.sweep(plate(title="x"), parameters, **{"workers": 1, **options})
