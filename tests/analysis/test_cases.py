"""Load cases: superposition, envelopes with the case that governs, one factorisation, files, and what is refused."""

import json
import os
from itertools import pairwise

import meshio
import numpy as np
import pytest

import kshell as ks
from kshell.analysis.models import model_of
from kshell.plate.model import PlateModel
from kshell.shell.model import ShellModel
from tests.plate.plates import UNIT, rectangle

STEEL = {"E": 210e9, "nu": 0.3, "density": 7850}


def plate(**changes):
    mesh = ks.geometry.Plane().mesh(8, 8, 1, ("left", "right", "bottom", "top"), (0, 1), (0, 1), "alternate")
    given = {
        "mesh": mesh,
        "thickness": 0.01,
        "material": ks.Isotropic(**STEEL),
        "supports": [ks.Clamped("left"), ks.SimplySupported("right")],
        "loads": [
            ks.Pressure(-1000, name="snow"),
            ks.Gravity((0, 0, -9.81), name="dead"),
            ks.Pressure("500 + 500 * x", name="wind"),
        ],
        "cases": [ks.Case("dead", ["dead"]), ks.Case("snow", [0]), ks.Case("wind", ["wind"], [2.0])],
        "combinations": [ks.Combination("all", {"dead": 1.35, "snow": 1.5, "wind": -0.6})],
        "probes": {"centre": (0.5, 0.5, 0.0), "free": (0.5, 0.0, 0.0)},
        "solve": {"large_deflection": False},
    }
    return ks.Scene(**given | changes)


def roof(**changes):
    mesh = ks.geometry.Cylinder(R=25.0).mesh(4, 6, 2, ("a", "b", "c", "d"), (0, 0.7), (0, 25), "alternate")
    loads = [
        ks.Pressure(-90.0, name="p"),
        ks.Traction((0, 0, -50.0), name="q"),
        ks.Temperature(mean=10.0, gradient=5.0, expansion=1e-5, name="warm"),
    ]
    given = {
        "mesh": mesh,
        "loads": loads,
        "thickness": 0.25,
        "material": ks.Isotropic(E=4.32e8, nu=0.2),
        "supports": [ks.Clamped("a"), ks.Fixed("c", "xz")],
        "cases": [ks.Case("p", ["p"]), ks.Case("q", ["q"]), ks.Case("warm", ["warm"])],
        "combinations": [ks.Combination("sum", {"p": 2.0, "q": -1.0, "warm": 0.5})],
        "probes": {"middle": (25 * np.cos(0.35), 25 * np.sin(0.35), 12.5)},
        "solve": {"large_deflection": False},
    }
    return ks.Scene(**given | changes)


def superposed(result, factors, name, what):
    return sum(f * result.cases[case].fields[what] for case, f in factors.items()), result.cases[name].fields[
        what
    ]


@pytest.mark.parametrize("element", ["morley", "argyris", "hhj"])
def test_combinations_of_plates_are_sums(element):
    result = ks.solve(plate(), element=element)
    for what in ("displacement", "moment"):
        expected, found = superposed(result, result.combinations["all"], "all", what)
        assert found == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())
    total = sum(1.35 * r["force"] for r in result.cases["dead"].reactions.values())
    assert total[2] == pytest.approx(1.35 * 7850 * 9.81 * 0.01, rel=1e-8)


def test_combinations_of_shells_are_sums():
    result = ks.solve(roof())
    for what in ("displacement", "membrane_force", "moment", "stress_top"):
        expected, found = superposed(result, result.combinations["sum"], "sum", what)
        assert found == pytest.approx(expected, abs=1e-8 * np.abs(expected).max())


def test_each_case_is_the_answer_to_its_loads_alone():
    scene = plate()
    result = ks.solve(scene)
    alone = ks.solve(scene.changed(loads=[ks.Pressure("2 * (500 + 500 * x)")], cases=(), combinations=()))
    assert result.cases["wind"].probe("centre")["u"] == pytest.approx(alone.probe("centre")["u"], rel=1e-10)
    assert ks.solve(scene.of_case("wind")).strain_energy == pytest.approx(alone.strain_energy, rel=1e-10)
    assert result.case == "dead"
    assert result.probe("centre") is result.cases["dead"].probe("centre")


@pytest.mark.parametrize("scene", [plate(), roof()], ids=["plate", "shell"])
def test_loads_of_a_case_grow_as_their_factors(scene):
    first = scene.of_case(scene.cases[0].name)
    doubled = scene.changed(cases=[ks.Case("x", scene.cases[0].loads, [2.0])], combinations=()).of_case("x")
    a, b = ks.solve(first), ks.solve(doubled)
    assert b.fields["displacement"] == pytest.approx(2 * a.fields["displacement"], rel=1e-8, abs=1e-15)


def test_intervals_of_a_case_know_nothing_of_loads_that_do_not_act():
    jump = ks.Pressure("500 * (x > 0.43)", name="jump")
    scene = plate(
        loads=[ks.Pressure(-1000, name="snow"), jump],
        cases=[ks.Case("snow", ["snow"]), ks.Case("jump", ["jump"])],
        combinations=(),
    )
    cases = ks.solve(scene).cases
    for name, case in cases.items():
        alone = ks.solve(scene.of_case(name))
        assert case.error["estimate"] == pytest.approx(alone.error["estimate"], rel=1e-6)
        assert ("loads" in case.error["budget"]) == (name == "jump")


def test_loads_that_are_functions_grow_too():
    load = ks.Traction(lambda x, y, z: (0.0 * x, 0.0 * x, 3.0 + x))
    at = np.array([[0.0, 0.0, 0.0], [1.0, 2.0, 0.0]])
    assert load.times(2.0).at(at) == pytest.approx(2 * load.at(at))
    warm = ks.Temperature(mean="1 + x", gradient=2.0, expansion=1e-5).times(-3.0)
    assert warm.values("mean", at) == pytest.approx([-3.0, -6.0])
    assert warm.values("gradient", at) == pytest.approx([-6.0, -6.0])
    assert warm.expansion == 1e-5


def test_one_factorisation_serves_all_cases(monkeypatch):
    from kshell.equilibrium import linear
    from kshell.plate import model as plate_model

    made = []
    prepare, factoriser = plate_model.prepare, linear.LinearSolver.__init__
    monkeypatch.setattr(plate_model, "prepare", lambda *a, **k: made.append("plate") or prepare(*a, **k))
    monkeypatch.setattr(
        linear.LinearSolver, "__init__", lambda *a, **k: made.append("shell") or factoriser(*a, **k)
    )
    mesh = ks.geometry.Plane().mesh(
        20, 20, 1, ("left", "right", "bottom", "top"), (0, 1), (0, 1), "alternate"
    )
    ks.solve(plate(mesh=mesh), element="argyris")
    ks.solve(roof())
    assert made == ["plate", "shell"]
    assert isinstance(model_of(plate()), PlateModel)
    assert isinstance(model_of(roof()), ShellModel)


def test_envelope():
    result = ks.solve(plate())
    names = list(result.cases)
    w = np.array([result.cases[name].fields["displacement"][:, 2] for name in names])
    found = result.envelope.fields["displacement"]
    assert found["min"][:, 2] == pytest.approx(w.min(axis=0))
    assert found["max"][:, 2] == pytest.approx(w.max(axis=0))
    free = np.abs(w).max(axis=0) > 0
    assert np.array_equal(found["min_case"][free, 2], w.argmin(axis=0)[free])
    document = result.to_dict()
    assert document["case"] == "dead"
    assert list(document["cases"]) == names == ["dead", "snow", "wind", "all"]
    u = document["envelope"]["probes"]["centre"]["u"]
    assert not [key for key in document["envelope"]["probes"]["centre"] if "directions" in key]
    values = {name: document["cases"][name]["probes"]["centre"]["u"][2] for name in names}
    assert (u["min"][2], u["max"][2]) == (min(values.values()), max(values.values()))
    assert (u["min_case"][2], u["max_case"][2]) == (min(values, key=values.get), max(values, key=values.get))
    largest = max(names, key=lambda name: abs(document["cases"][name]["extremes"]["deflection"]["value"]))
    assert document["envelope"]["extremes"]["deflection"]["case"] == largest
    assert document["cases"]["all"]["combination"] == {"dead": 1.35, "snow": 1.5, "wind": -0.6}
    assert document["cases"]["dead"]["probes"] == document["probes"]


def test_files_of_cases(tmp_path):
    result = ks.solve(plate(cases=[ks.Case("dead", [1]), ks.Case("snow / 2", [0], [0.5])], combinations=()))
    result.save(tmp_path)
    assert sorted(os.listdir(tmp_path)) == [
        "case-dead.vtu",
        "case-snow-2.vtu",
        "envelope.vtu",
        "result.json",
        "result.vtu",
    ]
    read = meshio.read(tmp_path / "envelope.vtu").point_data
    assert read["max_displacement"] == pytest.approx(result.envelope.fields["displacement"]["max"])
    snow = meshio.read(tmp_path / "case-snow-2.vtu").point_data["displacement"]
    assert snow == pytest.approx(result.cases["snow / 2"].fields["displacement"])
    assert json.loads((tmp_path / "result.json").read_text(encoding="utf-8"))["case"] == "dead"


def test_large_deflections_one_by_one():
    """A clamped strip: under large deflections the combination is no sum, and agrees with its loads at once."""
    scene = plate(
        supports=[ks.Clamped("left"), ks.Clamped("right")],
        loads=[ks.Pressure(-40e3, name="a"), ks.Pressure(-20e3, name="b")],
        cases=[ks.Case("a", ["a"]), ks.Case("b", ["b"])],
        combinations=[ks.Combination("both", {"a": 1.0, "b": 1.0})],
        solve={"model": "shell", "large_deflection": True},
    )
    result = ks.solve(scene)
    a, b, both = (result.cases[name].probe("centre")["u"][2] for name in ("a", "b", "both"))
    assert abs(both) < 0.95 * abs(a + b)
    at_once = ks.solve(scene.changed(loads=[ks.Pressure(-60e3)], cases=(), combinations=()))
    assert both == pytest.approx(at_once.probe("centre")["u"][2], rel=1e-6)
    assert all(len(result.cases[name].path) > 1 for name in result.cases)


def test_a_plate_that_bends_too_far_is_a_shell_under_the_loads_of_its_case():
    """The switch from plate to shell keeps to the factors of the case."""
    scene = plate(
        supports=[ks.Clamped("left"), ks.Clamped("right")],
        loads=[ks.Pressure(-30e3, name="a")],
        cases=[ks.Case("little", ["a"], [1e-3]), ks.Case("much", ["a"])],
        combinations=(),
        solve={},
    )
    result = ks.solve(scene)
    assert [result.cases[name].model["kind"] for name in ("little", "much")] == ["plate", "shell"]
    alone = ks.solve(scene.of_case("much"))
    assert result.cases["much"].probe("centre")["u"] == pytest.approx(alone.probe("centre")["u"], rel=1e-6)
    assert any("not all are of the same model" in words for words in result.warnings)


def test_paths_of_cases(tmp_path):
    scene = plate(
        supports=[ks.Clamped("left"), ks.Clamped("right")],
        cases=[ks.Case("snow", ["snow"], [20.0]), ks.Case("wind", ["wind"], [20.0])],
        combinations=(),
        solve={"steps": 3},
    )
    result = ks.trace(scene, folder=tmp_path / "steps")
    assert {path.name for path in (tmp_path / "steps").iterdir()} == {"snow", "wind"}
    for case in result.cases.values():
        factors = [entry["factor"] for entry in case.path]
        assert factors[0] == 0.0
        assert factors[-1] == pytest.approx(1.0)
        assert all(a < b for a, b in pairwise(factors))
    result.save(tmp_path / "out")
    assert {"path.pvd", "case-wind-path.pvd"} <= set(os.listdir(tmp_path / "out"))
    again = ks.trace(scene, folder=tmp_path / "steps", resume=True)
    assert again.cases["wind"].probe("centre")["u"] == pytest.approx(
        result.cases["wind"].probe("centre")["u"]
    )


def test_buckling_of_cases():
    loads = [ks.LineForce("right", (-1e4, 0, 0), name="a"), ks.LineForce("top", (0, -1e4, 0), name="b")]
    supports = [ks.SimplySupported(n) for n in ("left", "right", "bottom", "top")]
    supports += [ks.Fixed("left", "x"), ks.Fixed("bottom", "y")]
    cases = [ks.Case("along", ["a"]), ks.Case("twice", ["a"], [2.0]), ks.Case("across", ["b"])]
    scene = plate(supports=supports, loads=loads, cases=cases, combinations=())
    result = ks.buckling(scene, count=1)
    factor = {name: result.cases[name].eigen[0]["value"] for name in result.cases}
    D = 210e9 * 0.01**3 / 12 / 0.91
    assert factor["along"] == pytest.approx(4 * np.pi**2 * D / 1e4, rel=1e-2)
    assert factor["twice"] == pytest.approx(factor["along"] / 2, rel=1e-6)
    assert factor["across"] == pytest.approx(factor["along"], rel=1e-6)


def test_modes_without_prestress_know_no_cases():
    result = ks.modes(plate(), count=2)
    assert result.cases == {}
    assert any("cases" in words for words in result.warnings)


def test_warnings_of_cases():
    scene = plate(
        cases=[ks.Case("dead", ["dead"]), ks.Case("snow", ["snow"])],
        combinations=(),
        supports=[ks.Clamped("left"), ks.Fixed("right", "z", (0, 0, 0.001))],
    )
    result = ks.solve(scene)
    assert any('"wind"' in words and "in no case" in words for words in result.warnings)
    assert any("prescribed motion" in words for words in result.warnings)
    right = np.unique(scene.mesh.edges[scene.mesh.groups["right"].members])
    moved = [case.fields["displacement"][right, 2].max() for case in result.cases.values()]
    assert moved == pytest.approx([0.001, 0.001])


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"cases": [ks.Case("a", ["ice"])]}, 'no load "ice"'),
        ({"cases": [ks.Case("a", [7])]}, "no load 7"),
        ({"cases": [ks.Case("a", ["snow", 0])]}, "named twice"),
        ({"cases": [ks.Case("a", [0]), ks.Case("a", [1])]}, "is taken"),
        (
            {"cases": [ks.Case("a", [0])], "combinations": [ks.Combination("a", {"a": 1})]},
            "is taken",
        ),
        ({"cases": [], "combinations": [ks.Combination("c", {"dead": 1})]}, 'no case "dead"'),
        ({"combinations": [ks.Combination("c", {"snwo": 1})]}, "snow"),
        ({"cases": [1]}, "ks.Case"),
    ],
)
def test_bad_cases(changes, words):
    with pytest.raises(ks.InputError, match=words):
        plate(**{"combinations": (), **changes})


@pytest.mark.parametrize(
    ("block", "words"),
    [
        ({"name": "a"}, "loads is missing"),
        ({"name": "", "loads": [0]}, "name"),
        ({"name": "a", "loads": []}, "loads"),
        ({"name": "a", "loads": [True]}, "loads"),
        ({"name": "a", "loads": [0], "factors": [1, 2]}, "2 factors for 1"),
        ({"name": "a", "loads": [0], "factors": [float("nan")]}, "finite"),
        ({"name": "a", "load": [0], "loads": [0]}, 'unknown key "load"'),
    ],
)
def test_bad_blocks(block, words):
    with pytest.raises(ks.InputError, match=words):
        ks.Scene.from_dict({"mesh": "x.msh", "thickness": 1.0, "material": STEEL, "case": [block]})


def test_refused_with_a_reason():
    with pytest.raises(ks.InputError, match="mesh of its own"):
        ks.solve(plate(), tolerance=0.01)
    with pytest.raises(ks.InputError, match="no load cases"):
        ks.solve(plate(cases=(), combinations=())).envelope  # noqa: B018
    with pytest.raises(ks.InputError, match="the cases are"):
        plate().of_case("rain")


@pytest.mark.parametrize("element", ["morley", "argyris"])
@pytest.mark.parametrize("n", [2, 8])
def test_solved_together_as_alone(element, n):
    """Cases whose loads are solved for at once answer as each alone does: dense and sparse, moved supports, too."""
    mesh = ks.geometry.Plane().mesh(n, n, order=1, u_range=(0, 1), v_range=(0, 1))
    scene = ks.Scene(
        mesh=mesh,
        thickness=0.01,
        material=ks.Isotropic(E=210e9, nu=0.3, density=7850),
        supports=[
            ks.Clamped("u0"),
            ks.SimplySupported("u1", value=(0, 0, -1e-6)),
            ks.Elastic("v1", 1e5, "z"),
        ],
        loads=[
            ks.Pressure("1+x", name="a"),
            ks.Pressure(3.0, name="b"),
            ks.Gravity((0, 0, -1.0), name="c"),
        ],
        cases=[ks.Case("A", ["a"]), ks.Case("B", ["b", "c"]), ks.Case("C", ["a", "c"])],
        probes={"p": (0.7, 0.6, 0.0)},
        solve={"large_deflection": False, "element": element, "error": "off"},
    )
    together = ks.solve(scene)
    for name, case in together.cases.items():
        alone = ks.solve(scene.of_case(name))
        for key in ("u", "M"):
            size = np.abs(alone.probes["p"][key]).max()
            assert case.probes["p"][key] == pytest.approx(alone.probes["p"][key], rel=1e-8, abs=1e-8 * size)
        assert case.strain_energy == pytest.approx(alone.strain_energy, rel=1e-8)
        assert case.external_work == pytest.approx(alone.external_work, rel=1e-8)
        for group, found in alone.reactions.items():
            size = np.abs(found["force"]).max()
            assert case.reactions[group]["force"] == pytest.approx(found["force"], rel=1e-7, abs=1e-7 * size)
    assert together.cases["A"].probes["p"]["u"][2] != pytest.approx(
        together.cases["C"].probes["p"]["u"][2], rel=1e-3
    )
    model = model_of(scene)
    motions = np.random.default_rng(0).standard_normal((model.unknowns, 3))
    forces = model.product()(motions)
    assert forces[:, 1] == pytest.approx(
        model.product()(motions[:, 1]), rel=1e-12, abs=1e-12 * np.abs(forces).max()
    )


@pytest.mark.parametrize("place", [(0.5, 0.5, 0.0), (0.3, 0.41, 0.0), (0.7, 0.2, 0.5)])
@pytest.mark.parametrize("element", ["morley", "argyris", "hhj"])
def test_motion_of_a_probe_of_a_plate_is_that_of_its_values(element, place):
    result = ks.solve(plate(cases=(), combinations=(), probes={"p": place}), element=element, error="off")
    found = result.motion_at_probe("p")
    assert np.abs(found).max() > 0
    assert found == pytest.approx(result.probe("p")["u"], rel=1e-12)
    assert found == pytest.approx(result.at(place)["u"][0], rel=1e-12)


@pytest.mark.parametrize("angle", [0.35, 0.3])
def test_motion_of_probes_of_a_shell_is_that_of_their_values_in_each_case(angle):
    place = (25 * np.cos(angle), 25 * np.sin(angle), 12.5)
    result = ks.solve(roof(probes={"p": place}))
    for case in result.cases.values():
        found = case.motion_at_probe("p")
        assert np.abs(found).max() > 0
        assert found == pytest.approx(case.probe("p")["u"], rel=1e-9)
        alone = ks.solve(case.scene)
        assert alone.probe("p")["u"] == pytest.approx(case.probe("p")["u"], rel=1e-9)
        for part in ("half_width", "expected"):
            mine, its = (r.error["probes"]["p"]["u"][part] for r in (case, alone))
            assert mine == pytest.approx(its, rel=1e-6)


def test_scene_of_a_case_is_as_one_made_anew(tmp_path):
    scene = plate()
    mine = scene.of_case("all")
    anew = scene.changed(loads=list(mine.loads), cases=(), combinations=())
    for key in ("loads", "cases", "combinations"):
        assert type(getattr(mine, key)) is type(getattr(anew, key))
        assert len(getattr(mine, key)) == len(getattr(anew, key))
    assert len(mine.loads) == 3
    assert len(scene.cases) == 3  # the scene itself is as it was
    mine.save(tmp_path / "mine.toml"), anew.save(tmp_path / "anew.toml")
    assert (tmp_path / "mine.toml").read_text(encoding="utf-8").replace("mine", "anew") == (
        tmp_path / "anew.toml"
    ).read_text(encoding="utf-8")


def every_kind_of_load():
    """Cases of all kinds of loads of a plate: formulas and numbers, on parts, edges and points, and warm."""
    mesh = ks.geometry.Plane().mesh(6, 6, 1, ("left", "right", "bottom", "top"), (0, 1), (0, 1), "alternate")
    inside = np.flatnonzero(mesh.points[mesh.triangles].mean(axis=1)[:, 0] > 0.5)
    mesh = ks.mesh.Mesh(mesh.points, mesh.triangles, groups={**mesh.groups, "half": ks.mesh.Group(2, inside)})
    loads = [
        ks.Pressure(-100, name="number"),
        ks.Pressure("-50 - 30 * x * y", name="formula"),
        ks.Pressure("-100 * exp(-y)", on="half", name="part"),
        ks.Traction((0, 0, -70.0), name="traction"),
        ks.Gravity((0, 0, -1.0), name="dead"),
        ks.LineForce("top", (0, 0, "-20 * x"), name="edge"),
        ks.EdgeMoment("right", "5 + y", name="moment"),
        ks.PointForce((0.5, 0.5, 0.0), (0, 0, -10.0), name="point"),
        ks.Temperature(gradient=30.0, expansion=1e-5, name="warm"),
    ]
    return plate(
        mesh=mesh,
        loads=loads,
        cases=[
            *(ks.Case(load.name, [load.name]) for load in loads),
            ks.Case("two", ["edge", "formula"], [-2.0, 0.5]),
        ],
        combinations=[ks.Combination("some", {"formula": 1.5, "dead": -0.3, "point": 2.0})],
        solve={},
    )


def every_kind_on_a_shell():
    loads = [
        ks.Pressure(-0.9, name="number"),
        ks.Traction((0, 0, "-0.02 * x"), name="formula"),
        ks.LineForce("b", (0, 0, -1.0), name="edge"),
        ks.Temperature(mean=0.1, gradient=0.5, expansion=1e-5, name="warm"),
    ]
    cases = [ks.Case(load.name, [load.name]) for load in loads]
    both = ks.Combination("both", {"number": 2.0, "formula": -1.0})
    return roof(loads=loads, cases=cases, combinations=[both], solve={})


@pytest.mark.parametrize(
    ("scene", "options"),
    [
        (every_kind_of_load, {"element": "argyris"}),
        (every_kind_of_load, {"element": "morley"}),
        (every_kind_of_load, {"element": "hhj"}),
        (every_kind_on_a_shell, {}),
    ],
)
def test_a_case_among_others_is_as_alone(scene, options):
    """Values, intervals, reactions and words: nothing of a case depends on which others are solved with it."""
    scene = scene()
    for name, case in ks.solve(scene, **options).cases.items():
        alone = ks.solve(scene.of_case(name), **options)
        for key, of in (("u", "displacement"), ("rotation", "rotation"), ("M", "moment")):
            for probe, values in alone.probes.items():
                size = np.abs(alone.fields[of]).max()
                assert case.probes[probe][key] == pytest.approx(values[key], rel=1e-9, abs=1e-9 * size)
        largest = max(np.abs(found["force"]).max() for found in alone.reactions.values())
        for group, found in alone.reactions.items():
            assert case.reactions[group]["force"] == pytest.approx(found["force"], abs=1e-9 * largest + 1e-12)
        mine, its = case.error, alone.error
        assert mine["estimate"] == pytest.approx(its["estimate"], rel=1e-6)
        assert mine["probes"].keys() == its["probes"].keys()
        for probe in its["probes"]:
            for part in ("half_width", "expected"):
                found, expected = (e["probes"][probe]["u"][part] for e in (mine, its))
                assert found == pytest.approx(expected, rel=1e-6)
        for entry, share in its["budget"].items():
            if entry != "algebra":
                assert (mine["budget"][entry] or 0.0) == pytest.approx(share or 0.0, rel=1e-6)
        assert case.model["reasons"] == alone.model["reasons"]
        assert case.warnings == alone.warnings
        assert case.strain_energy == pytest.approx(alone.strain_energy, rel=1e-9)


@pytest.mark.parametrize("options", [{"model": "plate"}, {"element": "hhj"}, {"model": "shell"}])
def test_a_case_has_the_warnings_of_its_own_loads(options):
    """Of a disc whose rim goes through triangles in the cases that have it, and in no other."""
    scene = ks.Scene(
        mesh=rectangle(8),
        thickness=0.05,
        material=ks.Isotropic(**UNIT),
        supports=[ks.Clamped("left")],
        loads=[ks.Pressure(1.0, name="p"), ks.Disc(pressure=1.0, centre=(0.5, 0.5), radius=0.3, name="d")],
        cases=[ks.Case("without", ["p"]), ks.Case("with", ["p", "d"])],
        combinations=[ks.Combination("both", {"without": 1.0, "with": 2.0})],
    )
    result = ks.solve(scene, large_deflection=False, error="off", **options)
    told = {name: any("changes faster" in w for w in case.warnings) for name, case in result.cases.items()}
    assert told == {"without": False, "with": True, "both": True}
    assert any(words.startswith('cases "with", "both": load disc') for words in result.warnings)


@pytest.mark.filterwarnings("ignore::kshell.KshellWarning")
@pytest.mark.parametrize("model", ["plate", "shell"])
def test_cases_say_what_their_loads_alone_say(model):
    """Stresses grow at a point force in its own case; in the other one its place has a stress as any."""
    at = (0.5, 1.0, 0.0)  # where the snow bends the plate most
    loads = [ks.Pressure("-1000 * y", name="snow"), ks.PointForce(at, (0, 0, -500.0), name="crane")]
    cases = [ks.Case("snow", ["snow"]), ks.Case("crane", ["crane"])]
    supports = [ks.SimplySupported("left"), ks.SimplySupported("right")]
    scene = plate(loads=loads, cases=cases, combinations=[], supports=supports)
    result = ks.solve(scene, model=model)
    for name in ("snow", "crane"):
        alone, case = ks.solve(scene.of_case(name), model=model), result.cases[name]
        assert case.warnings == alone.warnings
        peak, known = case.extremes["von_mises"]["peak"], alone.extremes["von_mises"]["peak"]
        assert (peak is None) == (known is None)
        assert case.extremes["von_mises"]["value"] == pytest.approx(alone.extremes["von_mises"]["value"])
    assert result.cases["crane"].extremes["von_mises"]["peak"]["why"].startswith("a point force")
    assert result.cases["snow"].extremes["von_mises"]["peak"] is None
