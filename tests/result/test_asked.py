"""Values along lines, section forces across cuts, principal stresses, utilisation, CSV tables, short words."""

import csv

import numpy as np
import pytest

import kshell as ks

LENGTH, WIDTH, LOAD = 2.0, 1.0, 100.0


def strip(nu=0.3, n=8, **changes):
    mesh = ks.geometry.Plane().mesh(
        n, n, 1, ("left", "right", "bottom", "top"), (0, LENGTH), (0, WIDTH), "alternate"
    )
    given = {
        "mesh": mesh,
        "thickness": 0.01,
        "material": ks.Isotropic(E=210e9, nu=nu, yield_stress=235e6),
        "supports": [ks.Clamped("left")],
        "loads": [ks.Pressure(-LOAD)],
        "probes": {"middle": (1.0, 0.5, 0.0)},
        "solve": {"large_deflection": False},
    }
    return ks.Scene(**given | changes)


@pytest.mark.parametrize("options", [{"element": "argyris"}, {"model": "shell"}], ids=["plate", "shell"])
@pytest.mark.parametrize("x", [0.6, 1.0, 1.7])
@pytest.mark.parametrize("nu", [0.0, 0.3])
def test_cut_of_a_cantilever(options, x, nu):
    """Shear p b (l - x) and moment p b (l - x)^2 / 2, whether the cut runs along edges of the mesh or not."""
    found = ks.solve(strip(nu), **options).cut((x, 0.5, 0.0), (1.0, 0.0, 0.0))
    rest = LENGTH - x
    assert found["M"][1] == pytest.approx(LOAD * rest**2 / 2, rel=2e-3)
    assert found["V"][2] == pytest.approx(-LOAD * rest, rel=1e-5 if nu == 0.0 else 0.03)
    assert found["N"] == pytest.approx(0.0, abs=1e-6)
    assert found["T"] == pytest.approx(0.0, abs=1e-2)
    assert found["length"] == pytest.approx(WIDTH)
    assert found["at"] == pytest.approx([x, 0.5, 0.0], abs=1e-6)


def test_both_sides_of_a_cut_are_in_balance():
    result = ks.solve(strip(), element="argyris")
    one, other = (result.cut((0.9, 0.5, 0.0), (s * 1.0, s * 0.4, 0.0)) for s in (1, -1))
    assert one["force"] == pytest.approx(-other["force"], rel=1e-9)
    assert one["moment"] == pytest.approx(-other["moment"], rel=1e-9)
    assert one["V"][2] == pytest.approx(-LOAD * 1.1 * WIDTH, rel=1e-2)


def test_cut_of_a_pulled_tube():
    """A closed line: the force along the axis is that on the end, and the line has no ends with forces of their own."""
    R, force = 1.0, 3e4
    mesh = ks.geometry.Cylinder(R=R).mesh(
        12, 6, 2, ("a", "b", "low", "high"), (0, np.pi / 2), (0, 2.0), "alternate"
    )
    scene = ks.Scene(
        mesh=mesh,
        thickness=0.01,
        material=ks.Isotropic(E=210e9, nu=0.0),
        supports=[ks.Symmetry("a"), ks.Symmetry("b"), ks.Fixed("low", "z")],
        loads=[ks.LineForce("high", (0, 0, force / (np.pi * R / 2)))],
        solve={"large_deflection": False},
    )
    found = ks.solve(scene).cut((0.0, 0.0, 0.7), (0, 0, 1))
    assert found["N"] == pytest.approx(force, rel=2e-3)
    assert found["length"] == pytest.approx(np.pi * R / 2, rel=1e-4)
    assert np.abs(found["V"]).max() < 1e-3 * force


@pytest.mark.parametrize(
    ("point", "normal", "words"),
    [
        ((9, 0, 0), (1, 0, 0), "does not meet"),
        ((0, 0, 0), (0, 0, 0), "normal = 0"),
        ("here", (1, 0, 0), "three finite numbers"),
        ((0, 0, np.nan), (1, 0, 0), "three finite numbers"),
    ],
)
def test_bad_cuts(point, normal, words):
    with pytest.raises(ks.InputError, match=words):
        ks.solve(strip(), element="morley").cut(point, normal)


def test_along():
    result = ks.solve(strip())
    found = result.along((0, 0.5, 0), (2, 0.5, 0), 5)
    assert found["s"] == pytest.approx([0.0, 0.5, 1.0, 1.5, 2.0])
    assert found["u"][2] == pytest.approx(result.probe("middle")["u"])
    with pytest.raises(ks.InputError, match="same point"):
        result.along((0, 0, 0), (0, 0, 0))
    with pytest.raises(ks.InputError, match="whole number"):
        result.along((0, 0, 0), (1, 0, 0), 1)


def test_lines_of_a_scene():
    lines = [ks.Line("axis", (0, 0.5, 0), (2, 0.5, 0), 5), ks.Line("above", (0, 0.5, 3), (2, 0.5, 3), 3)]
    result = ks.solve(strip(lines=lines))
    assert result.to_dict()["lines"]["axis"]["s"] == [0.0, 0.5, 1.0, 1.5, 2.0]
    assert result.lines["axis"]["u"][2] == pytest.approx(result.probe("middle")["u"])
    assert [words for words in result.warnings if 'line "above"' in words]
    assert not [words for words in result.warnings if 'line "axis"' in words]


@pytest.mark.parametrize(
    ("block", "words"),
    [
        ({"name": "a", "from": [0, 0, 0], "to": [0, 0, 0]}, "same point"),
        ({"name": "a", "from": [0, 0, 0]}, "missing"),
        ({"name": "a", "from": [0, 0, 0], "to": [1, 0, 0], "n": 1}, "whole number"),
        ({"name": "a", "from": "left", "to": [1, 0, 0]}, "point"),
        ({"name": "a", "start": [0, 0, 0], "to": [1, 0, 0]}, 'unknown key "start"'),
    ],
)
def test_bad_lines(block, words):
    data = {"mesh": "x.msh", "thickness": 1.0, "material": {"E": 1.0, "nu": 0.3}, "line": [block]}
    with pytest.raises(ks.InputError, match=words):
        ks.Scene.from_dict(data)


def test_principal_stresses_have_directions():
    probe = ks.solve(strip(0.0, loads=[ks.EdgeMoment("right", 10.0)]), model="shell").probe("middle")
    assert probe["principal_top"] == pytest.approx([6 * 10.0 / 0.01**2, 0.0], rel=1e-6, abs=1e-3)
    first, second = probe["principal_directions_top"]
    assert np.abs(first) == pytest.approx([1.0, 0.0, 0.0], abs=1e-6)
    assert np.abs(second) == pytest.approx([0.0, 1.0, 0.0], abs=1e-6)
    turned = ks.solve(strip(), element="argyris").probe("middle")
    (xx, yy, xy), v = turned["stress_top"], turned["principal_directions_top"]
    tensor = np.array([[xx, xy, 0.0], [xy, yy, 0.0], [0.0, 0.0, 0.0]])
    assert tensor @ v[0] == pytest.approx(turned["principal_top"][0] * v[0], abs=1e-9 * abs(xx))


def test_utilisation():
    result = ks.solve(strip(), element="argyris")
    most = result.extremes["von_mises"]["value"] / 235e6
    assert result.extremes["utilisation"]["value"] == pytest.approx(most)
    assert result.fields["utilisation"].max() == pytest.approx(most)
    probe = result.probe("middle")
    worst = max(probe["von_mises_top"], probe["von_mises_bottom"])
    assert probe["utilisation"] == pytest.approx(worst / 235e6)
    without = ks.solve(strip(material=ks.Isotropic(E=210e9, nu=0.3)), element="argyris")
    assert "utilisation" not in without.fields
    with pytest.raises(ks.InputError, match="yield_stress"):
        ks.Isotropic(E=1.0, nu=0.3, yield_stress=0.0)


def test_tables(tmp_path):
    scene = strip(
        lines=[ks.Line("mid line", (0, 0.5, 0), (2, 0.5, 0), 3)],
        cases=[ks.Case("a", [0]), ks.Case("b", [0], [2.0])],
    )
    result = ks.solve(scene)
    result.save(tmp_path, tables=True)
    names = {path.stem for path in tmp_path.glob("*.csv")}
    along = {"reactions_along", "reactions_at_ends"}
    assert names == {"probes", "extremes", "reactions", "line-mid-line", "envelope", *along}

    def rows(name):
        with open(tmp_path / f"{name}.csv", newline="", encoding="utf-8") as stream:
            return list(csv.DictReader(stream))

    assert [row["case"] for row in rows("reactions")] == ["a", "b"]
    assert float(rows("reactions")[1]["force.z"]) == result.cases["b"].reactions["left"]["force"][2]
    assert float(rows("probes")[0]["M.xx"]) == result.cases["a"].probe("middle")["M"][0]
    assert len(rows("line-mid-line")) == 6
    found = next(row for row in rows("envelope") if row["quantity"] == "u.z")
    assert (found["min_case"], found["max_case"]) == ("b", "a")


def test_short_words():
    scene = strip(title="Strip")
    result = ks.solve(scene)
    for thing, words in ((scene, "1 loads"), (result, "plate"), (scene.mesh, "128 triangles")):
        assert words in repr(thing)
        assert len(repr(thing)) < 200
        assert "<table>" in thing._repr_html_()
    assert "data:image/png;base64," in result._repr_html_()
