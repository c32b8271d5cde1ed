"""Reactions of Koiter shells along their supports."""

import matplotlib as mpl
import numpy as np
import pytest

import kshell as ks
from kshell.draw.plot import plot
from tests.plate.plates import UNIT, rectangle
from tests.plate.test_along_supports import SIDES, levy

mpl.use("Agg")


def square(order, supports, loads, n=8, **options):
    scene = ks.Scene(
        mesh=rectangle(n, wobble=0.1),
        thickness=1.0,
        material=ks.Isotropic(**UNIT),
        supports=supports,
        loads=loads,
    )
    given = {"model": "shell", "element": "koiter", "order": order, "large_deflection": False}
    return ks.solve(scene, error="off", **{**given, **options})


@pytest.mark.parametrize(("order", "inside", "corner"), [(2, 0.1, 6e-3), (4, 1e-3, 5e-4)])
def test_simply_supported_square(order, inside, corner):
    result = square(order, [ks.SimplySupported(s) for s in SIDES], [ks.Pressure(1.0)])
    for name in SIDES:
        found = result.reaction_along(name)
        for key in ("force", "moment"):
            assert found["resultant"][key] == pytest.approx(result.reactions[name][key], abs=1e-9)
    found = result.reaction_along("left")
    y = found["x"][:, 1]
    error = np.abs(found["force"][:, 2] - levy(y))
    assert error[np.abs(y - 0.5) < 0.3].max() < inside
    at_corner = sum(
        end["force"][2]
        for name in SIDES
        for end in result.reaction_along(name)["ends"]
        if np.allclose(end["at"], 0)
    )
    assert at_corner == pytest.approx(0.06496, abs=corner)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_a_pulled_and_sheared_strip(order):
    loads = [ks.LineForce("right", (3.0, 0.5, 0.0))]
    result = square(order, [ks.Clamped("left"), ks.Elastic("top", 5.0, "y")], loads, n=4)
    for name in ("left", "top"):
        found = result.reaction_along(name)
        for key in ("force", "moment"):
            assert found["resultant"][key] == pytest.approx(result.reactions[name][key], abs=1e-9)
    found = result.reaction_along("top")
    v = result.at(found["x"])["u"][:, 1]
    assert found["force"][:, 1] == pytest.approx(-5.0 * v, abs=1e-6)
    held = [ks.Symmetry("left"), ks.Symmetry("bottom"), ks.Fixed("plate", "z")]
    pulled = square(order, held, [ks.LineForce("right", (3.0, 0, 0))], n=4)
    found = pulled.reaction_along("left")
    assert found["force"] == pytest.approx(np.tile([-3.0, 0, 0], (len(found["s"]), 1)), abs=1e-8)
    assert [end["force"] for end in found["ends"]] == pytest.approx(np.zeros((2, 3)), abs=1e-8)


def test_a_clamped_edge_bears_the_moment_of_the_load():
    result = square(
        2,
        [ks.Clamped("left"), ks.Symmetry("bottom"), ks.Symmetry("top")],
        [ks.LineForce("right", (0, 0, 1.0))],
    )
    found = result.reaction_along("left")
    assert found["force"][:, 2] == pytest.approx(-1.0, abs=1e-6)
    assert found["moment"][:, 1] == pytest.approx(1.0, abs=1e-6)
    picture = plot(result, "reactions")
    words = [axes.get_title() for axes in picture.axes]
    assert "left: force per length" in words
    assert "left: moment per length" in words


def test_large_deflections_keep_the_resultants():
    result = square(
        2, [ks.Clamped("left")], [ks.LineForce("right", (0, 0, 0.02))], n=4, large_deflection=True
    )
    found, whole = result.reaction_along("left"), result.reactions["left"]
    for key in ("force", "moment"):
        assert found["resultant"][key] == pytest.approx(whole[key], abs=1e-9)


def test_argyris_on_a_chart_says_that_it_knows_resultants_only():
    chart = ks.geometry.Cylinder(R=2.0)
    scene = ks.Scene(
        mesh=rectangle(2),
        chart=chart,
        thickness=0.1,
        material=ks.Isotropic(**UNIT),
        supports=[ks.Clamped("left")],
        loads=[ks.Pressure(1.0)],
    )
    result = ks.solve(scene, element="argyris", error="off", large_deflection=False)
    with pytest.raises(ks.SolveError, match="not of Argyris shells"):
        result.reaction_along("left")
