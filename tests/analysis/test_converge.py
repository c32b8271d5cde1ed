"""The study of convergence: rates of known elements, limits near known values, tables and files."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import kshell as ks
from kshell.analysis.converge import Series
from kshell.cli.commands import run
from tests.analysis.test_tolerance import SUPPORTED_CENTRE, plate
from tests.plate.hhj_cases import square


def test_morley_converges_with_two_and_argyris_faster() -> None:
    scene = plate(square(4), ks.SimplySupported("edge"), centre=(0.5, 0.5, 0))
    study = ks.converge(scene, 3)
    assert [(s.element, s.order) for s in study.series] == [("morley", 2), ("argyris", 5)]
    morley, argyris = study.series
    name = "centre u_z"
    assert morley.rates(name)[:2] == [None, None]
    assert morley.rates(name)[2] == pytest.approx(2.0, abs=0.2)
    assert morley.limit(name) == pytest.approx(SUPPORTED_CENTRE, rel=2e-3)
    assert argyris.values[name][-1] == pytest.approx(SUPPORTED_CENTRE, rel=1e-8)
    assert morley.size[0] == pytest.approx(4 * morley.size[2])
    assert set(morley.values) == {"energy", name}


def test_rates_where_there_are_none() -> None:
    series = Series("koiter", 2, values={"up and down": [1.0, 1.1, 1.05], "rounding": [2.0, 2.0, 2.0]})
    for name in series.values:
        assert series.rates(name) == [None, None, None]
        assert series.limit(name) is None
    halving = Series("koiter", 2, values={"v": [1 + 4.0**-k for k in range(4)]})
    assert halving.rates("v")[2:] == pytest.approx([2.0, 2.0])
    assert halving.limit("v") == pytest.approx(1.0)


def test_an_element_asked_for_is_the_only_one() -> None:
    scene = plate(square(2), ks.Clamped("edge"))
    assert [s.element for s in ks.converge(scene, 3, element="argyris").series] == ["argyris"]


@pytest.mark.parametrize(("levels", "options"), [(2, {}), (True, {}), (3, {"analysis": "modes"})])
def test_bad_studies_are_refused(levels: int, options: dict[str, str]) -> None:
    with pytest.raises(ks.InputError):
        ks.converge(plate(square(2), ks.Clamped("edge")), levels, **options)


def test_the_command_writes_its_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = Path(__file__).parents[2] / "meshes" / "unit_square.toml"
    arguments = [
        "converge",
        str(scene),
        "--levels",
        "3",
        "-o",
        str(tmp_path),
        "--set",
        'solve.element="morley"',
    ]
    assert run(arguments) == 0
    out = capsys.readouterr().out
    assert "morley, order 2" in out
    assert max(len(line) for line in out.splitlines() if "written" not in line) <= 80
    study = json.loads((tmp_path / "convergence.json").read_text(encoding="utf-8"))
    assert len(study["series"][0]["unknowns"]) == 3
    assert (tmp_path / "convergence.png").stat().st_size > 5000
    assert run([*arguments[:3], "2"]) == 2


def test_pictures_of_a_refined_result(tmp_path: Path) -> None:
    result = ks.solve(plate(square(2), ks.Clamped("edge"), centre=(0.5, 0.5, 0)), tolerance=1e-3)
    for name in ("error", "convergence"):
        path = tmp_path / f"{name}.png"
        result.plot(name).savefig(path)
        assert path.stat().st_size > 5000
    plain = ks.solve(plate(square(2), ks.Clamped("edge")))
    with pytest.raises(ks.InputError, match="no picture"):
        plain.plot("convergence")
