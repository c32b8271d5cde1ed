"""The comparison with other programs: its meshes, its drivers' protocol, its tables, and what is committed."""

import sys
from dataclasses import replace

import numpy as np
import pytest

from kshell.verify.cases import meshes
from verification.benchmarks import shells
from verification.peers.surfaces import FREEDOMS, SURFACES
from verification.work_precision import measure, nodes, own, table, tables
from verification.work_precision.catalogue import COMPARISONS
from verification.work_precision.draw import chart
from verification.work_precision.methods import BARE, METHODS
from verification.work_precision.problems import mesh_of


@pytest.mark.parametrize("count", [3, 4, 8])
def test_forces_on_nodes_add_up_and_work_as_the_load_does(count):
    st, cells = nodes.lattice(3, 2, count)
    points = np.column_stack([3 * st[:, 0], 2 * st[:, 1] + st[:, 0], 0 * st[:, 0]])
    force = nodes.area_forces(points, cells, (0.0, 0.0, 2.0))
    assert force.sum(axis=0) == pytest.approx([0, 0, 12.0])
    # the moment of the load about y
    assert force[:, 2] @ points[:, 0] == pytest.approx(12.0 * 1.5)


@pytest.mark.parametrize("count", [3, 4, 8])
def test_shape_functions_are_one_at_their_node_and_their_slopes_are_right(count):
    xi = np.array([[0, 0], [1, 0], [0, 1]]) if count == 3 else nodes._PLACES[:count].astype(float)
    values, _ = nodes.shapes(count, xi.astype(float))
    assert values == pytest.approx(np.eye(count), abs=1e-14)
    x, h = np.array([[0.3, 0.2]]), 1e-6
    _, slopes = nodes.shapes(count, x)
    for axis in (0, 1):
        step = h * np.eye(2)[axis]
        change = (nodes.shapes(count, x + step)[0] - nodes.shapes(count, x - step)[0]) / (2 * h)
        assert slopes[..., axis] == pytest.approx(change, abs=1e-9)


def test_triangles_are_those_of_the_other_meshes_and_lines_carry_their_load():
    st, cells = nodes.lattice(4, 3, 3)
    points, triangles = meshes.grid(4, 3)
    assert np.array_equal(st[cells], points[triangles])
    side = np.flatnonzero(st[:, 0] == 1)
    force = nodes.line_forces(np.column_stack([st, 0 * st[:, 0]]), side, (0.0, 1.0, 0.5))
    assert force.sum(axis=0) == pytest.approx([0, 1.0, 0.5])
    assert not force[st[:, 0] < 1].any()


@pytest.mark.parametrize("name", SURFACES)
def test_nodes_of_a_surface_lie_on_its_chart_and_are_held_where_it_says(name):
    surface = SURFACES[name]
    comparison = COMPARISONS[name]
    arrays = comparison.arrays("nodes 4", 4)
    scene = comparison.scene(mesh_of(comparison.arrays("scene", 4)))
    x = scene.chart.derivatives(*scene.mesh.points[:, :2].T, order=0)[0]
    assert np.sort(arrays["points"], axis=0) == pytest.approx(np.sort(x, axis=0))
    node, axis, sign = arrays["read"]
    assert arrays["points"][node] == pytest.approx(surface.place(*surface.read[0]))
    assert (axis, sign) == surface.read[1:]
    held = sum(
        len(FREEDOMS[how]) * (surface.grid(4)[side in ("left", "right")] + 1)
        for side, how in surface.held.items()
    )
    assert len(surface.pinned) < arrays["fixed"].sum() <= held + len(surface.pinned)


@pytest.mark.parametrize("element", ["koiter 2", "koiter 3", "argyris"])
def test_the_bare_shell_is_the_shell(element):
    comparison = COMPARISONS["scordelis_lo"]
    arrays = comparison.arrays("scene", 4)
    job = {"problem": "scordelis_lo", "element": element}
    full = own.solve(arrays, {**job, "solver": "direct"})()
    bare = own.solve(arrays, {**job, "solver": BARE})()
    assert bare["unknowns"] == full["unknowns"]
    assert bare["w"] == pytest.approx(full["w"], rel=1e-9)
    assert bare["compliance"] == pytest.approx(full["compliance"], rel=1e-6)
    assert full["w"] == pytest.approx(comparison.references["w"].value, rel=3e-2)


@pytest.mark.full
def test_a_driver_does_its_job_and_a_missing_program_is_named(tmp_path, monkeypatch):
    square = COMPARISONS["square"]
    small = replace(square, plan={"scikit-fem Argyris": (4, 8), "scikit-fem Morley": (4,)})
    rows = list(measure.rows_of(small, list(small.plan), None, tmp_path))
    assert [row["cells"] for row in rows] == [4, 8, 4]
    assert rows[1]["w error"] < rows[0]["w error"] / 20
    assert rows[0]["seconds"] > 0
    monkeypatch.setitem(measure.NEEDS, "OpenSees", "a_module_that_is_not_there")
    measure.interpreter.cache_clear()
    try:
        (row,) = measure.rows_of(square, ["OpenSees DKGT"], None, tmp_path)
    finally:
        measure.interpreter.cache_clear()
    assert (row["version"], row["unknowns"]) == ("not installed", 0)


@pytest.mark.full
def test_a_driver_that_fails_leaves_its_words_and_those_behind_it_are_measured(tmp_path, monkeypatch):
    broken = replace(METHODS["scikit-fem Morley"], element="an element it does not have")
    monkeypatch.setitem(METHODS, broken.id, broken)
    small = replace(COMPARISONS["square"], plan={broken.id: (4, 8), "scikit-fem Argyris": (4,)})
    failed, good = measure.rows_of(small, list(small.plan), None, tmp_path)
    assert failed["version"].startswith("no answer: KeyError")
    assert good["unknowns"] == 150


def test_drivers_do_not_import_kshell():
    for file in measure.DRIVERS.glob("*.py"):
        assert "import kshell" not in file.read_text(encoding="utf-8"), file


def row(method, cells, error, seconds, unknowns=100):
    return {
        "problem": "square", "method": method, "cells": cells, "unknowns": unknowns, "seconds": seconds,
        "compliance error": np.nan, "w error": error, "M error": np.nan, "version": "1",
    }  # fmt: skip


def test_a_lucky_crossing_does_not_count_and_a_peer_that_is_first_is_called_so():
    rows = [
        row("kshell Morley", 4, 1e-4, 0.01), row("kshell Morley", 8, 5e-3, 0.02), row("kshell Morley", 16, 9e-4, 0.3),
        row("FreeFEM Morley", 8, 2e-3, 0.02), row("FreeFEM Morley", 16, 8e-4, 0.1, 90),
    ]  # fmt: skip
    assert [found["cells"] for found in tables.reaching(rows, "w", 1e-3)] == [16, 16]
    (seconds,) = tables.standings(COMPARISONS["square"], rows)
    assert seconds.ratio == pytest.approx(1 / 3)
    assert "**FreeFEM** | 3.0" in tables.first([COMPARISONS["square"]], rows)
    why = [words for _, words in tables.behind([COMPARISONS["square"]], rows)]
    assert why[0].startswith("more unknowns")
    fixed = [row("kshell Argyris", 4, 1e-5, 0.05), row("NGSolve plate, order 2", 4, 1e-5, 0.01)]
    assert tables.behind([COMPARISONS["square"]], fixed)[0][1].startswith(
        "fixed cost: kshell's smallest mesh takes 0.05"
    )


def test_the_committed_tables_belong_to_the_committed_measurements():
    facts, rows = table.read()
    assert {"processor", "commit", "peers", "numpy"} <= set(facts)
    found = {(row["problem"], row["method"]) for row in rows}
    assert found == {(one.id, method) for one in COMPARISONS.values() for method in one.plan}
    comparisons = list(COMPARISONS.values())
    assert (table.FOLDER / "first.md").read_text(encoding="utf-8") == tables.first(comparisons, rows)
    assert (table.FOLDER / "not_first.md").read_text(encoding="utf-8") == tables.not_first(comparisons, rows)
    assert all((table.FOLDER / f"{name}.png").exists() for name in COMPARISONS)
    figure = chart(COMPARISONS["square"], rows, facts)
    assert "kshell Argyris" in [text.get_text() for text in figure.legends[0].get_texts()]


def test_the_committed_benchmark_of_shells_has_its_summary():
    _, rows = table.read(shells.HERE / "shells.csv")
    assert (shells.HERE / "shells.md").read_text(encoding="utf-8") == shells.summary(rows)
    assert {row["problem"] for row in rows} == {one.id for one in shells.SHELLS}


@pytest.mark.full
def test_the_command_measures_one_problem(tmp_path, monkeypatch):
    import verification.work_precision.__main__ as command

    small = replace(COMPARISONS["square"], plan={"kshell Argyris": (4, 8)})
    monkeypatch.setitem(command.COMPARISONS, "square", small)
    monkeypatch.setattr(sys, "argv", ["work_precision", "--only", "square", "--out", str(tmp_path)])
    assert command.main() == 0
    _, rows = table.read(tmp_path / table.NAME)
    assert [row["cells"] for row in rows] == [4, 8]
    assert (tmp_path / "square.png").stat().st_size > 10_000
