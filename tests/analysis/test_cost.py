"""What a solve is said to take, beside what it takes."""

import itertools
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import pytest

import kshell as ks
from kshell.analysis import cost
from kshell.analysis.models import model_of
from kshell.cli.commands import run
from kshell.equilibrium.model import Model
from kshell.solvers import frontal

MESHES = Path(__file__).parents[2] / "meshes"


def roof(cells: int, **options: object) -> ks.Scene:
    mesh = ks.geometry.Cylinder(1.0).mesh(cells, cells, 2, ("a", "b", "c", "d"), (0.5, 1.4), (0.0, 1.0))
    return ks.Scene(
        mesh=mesh,
        thickness=0.01,
        material=ks.Isotropic(E=1.0, nu=0.3),
        supports=[ks.Clamped("a")],
        loads=[ks.Pressure(1e-9)],
        solve={"large_deflection": False, **options},
    )


def test_cost_grows_with_unknowns_and_falls_with_processes() -> None:
    few, many = model_of(roof(4)), model_of(roof(8))
    one = cost.cost_of(few)
    more = cost.cost_of(many)
    assert one is not None
    assert more is not None
    assert more.seconds > 3.0 * one.seconds
    assert more.memory > one.memory
    for model, processes in ((many, 2), (many, 16)):
        several = cost.cost_of(model, processes)
        assert several is not None
        assert several.processes == processes
    memory = [found.memory for p in (1, 2, 4) if (found := cost.cost_of(many, p)) is not None]
    assert memory == sorted(memory, reverse=True)
    large = cost.FIGURES["koiter", 2]
    # a solve of 304,720 unknowns with its estimate on 1, 2 and 4 processes: bytes of the one that takes most
    for processes, taken in ((1, 1168e6), (2, 810e6), (4, 535e6)):
        said = cost.BASE_PETSC + large.beside_factors(304_720, processes)
        said += large.factor_bytes(304_720) / processes
        assert said == pytest.approx(taken, rel=0.15)
    plate = cost.FIGURES["morley", 2]
    assert plate.beside_factors(1000, 2) == pytest.approx(1000 * (500.0 + 450.0))
    assert large.factor_bytes(1_000_000) == pytest.approx(8 * 213e6, rel=0.05)  # as MUMPS counts at 1,003,472
    assert large.factor_flops(1_003_472) == pytest.approx(1.61e11, rel=0.15)


@pytest.mark.parametrize(
    ("unknowns", "processes", "taken"),
    [(304_720, 1, 10.0), (304_720, 2, 7.9), (304_720, 4, 6.3), (1_003_472, 1, 29.0), (3_995_022, 1, 186.0)],
)
def test_seconds_are_those_of_a_quiet_machine(unknowns: int, processes: int, taken: float) -> None:
    """Of verification/scale.md, where other programs lengthened what was measured, two to three times."""
    model = SimpleNamespace(element="koiter", order=2, unknowns=unknowns)
    said = cost.cost_of(cast("Model", model), processes)
    assert said is not None
    assert taken / 3.0 < said.seconds < taken


@pytest.mark.parametrize(
    ("order", "unknowns", "operations", "numbers", "memory", "seconds"),
    [
        (1, 135_300, 4.165e9, 19.56e6, 488e6, 1.85),
        (1, 406_120, 2.181e10, 65.5e6, 1196e6, 6.32),
        (2, 104_272, 4.289e9, 18.5e6, 397e6, 0.86),
        (2, 304_720, 2.160e10, 60.2e6, 902e6, 2.73),
        (2, 1_003_472, 1.302e11, 222.5e6, 2778e6, 11.44),
        (2, 73_728, 3.068e9, 14.02e6, 303e6, 0.69),
        (3, 69_960, 2.742e9, 12.3e6, 323e6, 0.71),
        (3, 230_880, 1.685e10, 47.3e6, 881e6, 2.44),
        (3, 390_000, 3.708e10, 84.1e6, 1327e6, 4.52),
    ],
)
def test_what_shells_took(
    order: int, unknowns: int, operations: float, numbers: float, memory: float, seconds: float
) -> None:
    """What whole solves took on the machine of the figures, by the operations and numbers that were counted."""
    said = cost.COUNTED["koiter", order].cost(unknowns, operations, numbers)
    assert said.memory == pytest.approx(memory, rel=0.1)
    assert seconds / 1.5 < said.seconds < 1.5 * seconds


@pytest.mark.skipif(not frontal.installed(), reason="kshell was installed without a C compiler")
@pytest.mark.parametrize("order", [1, 2, 3])
def test_fronts_are_counted_as_they_are_made(order: int, monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[frontal.Fronts] = []
    factorise = frontal.Frontal.factorise

    def noted(self: frontal.Frontal, entries: frontal.Floats) -> frontal.Factor:
        made.append(self.fronts)
        return factorise(self, entries)

    monkeypatch.setattr(frontal.Frontal, "factorise", noted)
    model = model_of(roof(18, order=order, model="shell"))
    counted = cost.fronts_of_model(model)
    model.solve("direct")
    assert counted is not None
    assert (counted.entries, counted.stacked) == (made[0].entries, made[0].stacked)
    assert counted.operations == made[0].operations
    said = cost.cost_of(model, 1, 2.0, counted)
    assert said is not None
    figures = cost.COUNTED["koiter", order]
    numbers = made[0].entries + made[0].stacked
    assert said.memory == figures.base + figures.held * model.unknowns + 8.0 * numbers
    assert said.seconds == pytest.approx(
        0.5 * (figures.seconds * model.unknowns + made[0].operations / cost.FRONT_FLOPS)
    )
    assert "memory within a tenth" in cost.cost_lines(model)[0]


@pytest.mark.parametrize("slower", [0.5, 1.0, 3.0])
def test_seconds_follow_the_speed_of_the_machine(slower: float, monkeypatch: pytest.MonkeyPatch) -> None:
    # the reference takes so long, but for the first time, when libraries are made ready
    clock = itertools.accumulate([0.0, 1.0, 0.0, slower * cost.REFERENCE, 0.0, slower * cost.REFERENCE])
    model = model_of(roof(4))
    on_that_of_the_figures = cost.cost_of(model)
    monkeypatch.setattr(cost.time, "process_time", lambda: next(clock))
    said = cost.cost_of(model, 1, cost.speed_of_machine())
    assert said is not None
    assert on_that_of_the_figures is not None
    assert said.seconds == pytest.approx(slower * on_that_of_the_figures.seconds)


def test_the_command_says_it_of_scenes_only(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["check", str(MESHES / "plate.toml"), "--cost"]) == 0
    assert "2 processes (mpiexec -n 2)" in capsys.readouterr().out
    assert run(["check", str(MESHES / "plate.msh"), "--cost"]) == 2
    assert "--cost is for scenes" in capsys.readouterr().err


def test_what_is_said() -> None:
    lines = cost.cost_lines(model_of(roof(4)))
    assert "unknowns" in lines[0]
    assert any("mpiexec -n 4" in line for line in lines)
    hhj = ks.geometry.Plane().mesh(2, 2, 1, ("a", "b", "c", "d"), (0.0, 1.0), (0.0, 1.0))
    scene = ks.Scene(
        mesh=hhj,
        thickness=0.1,
        material=ks.Isotropic(E=1.0, nu=0.3),
        supports=[ks.Clamped("a")],
        loads=[ks.Pressure(1e-3)],
        solve={"element": "hhj", "model": "plate"},
    )
    (line,) = cost.cost_lines(model_of(scene))
    assert "no figures" in line
