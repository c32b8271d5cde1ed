"""Reactions of plates along their supports, against series and closed forms."""

import numpy as np
import pytest

import kshell as ks
from kshell.errors import InputError, SolveError
from tests.plate.plates import UNIT, disk, rectangle

SIDES = ("left", "right", "bottom", "top")
ELEMENTS = {
    "argyris": {"element": "argyris"},
    "morley": {"element": "morley"},
    "hhj": {"element": "hhj", "order": 4},
}


def solved(mesh, supports, loads=(), **options):
    scene = ks.Scene(
        mesh=mesh,
        thickness=1.0,
        material=ks.Isotropic(**UNIT),
        supports=supports,
        loads=loads or [ks.Pressure(1.0)],
    )
    return ks.solve(scene, **{"model": "plate", "large_deflection": False, "error": "off", **options})


def levy(y, nu=0.3, terms=4000):
    """V of the supports of a simply supported unit square under unit pressure, at x = 0.

    M. Levy's series in the form of S. Timoshenko & S. Woinowsky-Krieger, Theory of Plates and Shells, section 30.
    """
    m = np.arange(1, terms, 2)
    half = 0.5 * np.pi * m
    t = np.tanh(half)
    a, b = -0.5 * (half * t + 2.0), 0.5
    first, third = -a * t - b * (t + half), -a * t - b * (3.0 * t + half)
    return -np.sin(np.multiply.outer(y, np.pi * m)) @ (4.0 / (np.pi * m) ** 2 * (1.7 * first - third))


@pytest.mark.parametrize(
    ("element", "inside", "near", "corner"),
    [("argyris", 0.02, 0.03, 3e-4), ("hhj", 1e-3, 0.03, 5e-4), ("morley", 0.2, 0.35, 0.04)],
)
def test_simply_supported_square(element, inside, near, corner):
    result = solved(rectangle(8, wobble=0.1), [ks.SimplySupported(s) for s in SIDES], **ELEMENTS[element])
    assert levy(np.array([0.5]))[0] == pytest.approx(-0.4205, abs=1e-4)
    found = result.reaction_along("left")
    force, y = found["force"][:, 2], found["x"][:, 1]
    error = np.abs(force - levy(y))
    assert error[np.abs(y - 0.5) < 0.3].max() < inside
    assert error.max() < near
    assert not found["force"][:, :2].any()
    # the force at a corner is shared by both edges; 0.0650 q a^2
    for end in found["ends"]:
        assert 2 * end["force"][2] == pytest.approx(0.06496, abs=corner)
    total = np.sum([result.reaction_along(s)["resultant"]["force"] for s in SIDES], axis=0)
    assert total == pytest.approx([0, 0, -1.0], abs=1e-9)


@pytest.mark.parametrize("element", list(ELEMENTS))
@pytest.mark.parametrize("support", [ks.Clamped, ks.SimplySupported])
def test_disk(element, support):
    result = solved(disk(4), [support("edge")], **ELEMENTS[element])
    found, coarse = result.reaction_along("edge"), 0.3 if element == "morley" else 2e-3
    assert found["ends"] == []
    assert found["force"][:, 2] == pytest.approx(-0.5, abs=0.5 * coarse)
    size = np.linalg.norm(found["moment"], axis=1)
    assert size == pytest.approx(0.125 if support is ks.Clamped else 0.0, abs=0.1 * coarse)
    if (
        support is ks.Clamped
    ):  # the moment bends the edge so that the top, where the pressure lifts, is pressed
        outward = found["x"][:, :2]
        assert (found["moment"][:, 0] * -outward[:, 1] + found["moment"][:, 1] * outward[:, 0] < -0.1).all()
    for key in ("force", "moment"):
        assert found["resultant"][key] == pytest.approx(result.reactions["edge"][key], abs=1e-8)


@pytest.mark.parametrize("element", list(ELEMENTS))
def test_opposite_edges_springs_and_points_add_up(element):
    supports = [ks.Clamped("left"), ks.Elastic("right", 20.0), ks.SimplySupported((0.5, 0.5))]
    loads = [ks.Pressure("1 + x*y"), ks.LineForce("top", (0, 0, 2.0))]
    result = solved(rectangle(4), supports, loads, **ELEMENTS[element])
    assert set(result.along_supports) == set(result.reactions)
    for name, reaction in result.reactions.items():
        found = result.reaction_along(name)
        for key in ("force", "moment"):
            assert found["resultant"][key] == pytest.approx(reaction[key], abs=2e-3), (name, key)
    spring = result.reaction_along("right")
    assert spring["ends"] == []
    w = result.at(spring["x"])["u"][:, 2]
    assert spring["force"][:, 2] == pytest.approx(-20.0 * w, abs=1e-6 + 0.02 * (element == "morley"))
    point = next(name for name in result.reactions if name not in ("left", "right"))
    assert len(result.reaction_along(point)["s"]) == 0


def test_a_line_inside_and_a_strip_are_beams():
    # a strip in cylindrical bending over three supports: reactions 3/16, 10/8 of 1/2, 3/16 per width
    sides = [ks.Symmetry("bottom"), ks.Symmetry("top")]
    supports = [*sides, *(ks.SimplySupported(s) for s in ("left", "middle", "right"))]
    result = solved(rectangle(4, 2), supports)
    for name, value in (("left", -0.1875), ("middle", -0.625), ("right", -0.1875)):
        assert result.reaction_along(name)["force"][:, 2] == pytest.approx(value, abs=1e-7)
    # the moment that symmetry exerts is that of the strip across, nu times the one along
    moment = result.reaction_along("bottom")["moment"]
    m = result.at(result.reaction_along("bottom")["x"])["M"]
    assert np.abs(moment[:, 0]) == pytest.approx(np.abs(m[:, 1]), abs=2e-3)


def test_tables_and_what_is_not_known(tmp_path):
    result = solved(rectangle(4), [ks.Clamped("left"), ks.Elastic("plate", 1.0)])
    rows = result.tables()["reactions_along"]
    assert {row["support"] for row in rows} == {"left"}
    assert len(rows) == 4 * 5
    assert {"s", "x.y", "force.z", "moment.y"} <= set(rows[0])
    assert len(result.tables()["reactions_at_ends"]) == 2
    with pytest.raises(InputError, match="not along a line"):
        result.reaction_along("plate")
    with pytest.raises(InputError, match='did you mean "left"'):
        result.reaction_along("lft")
    result.save(tmp_path)
    with pytest.raises(SolveError, match="resultants of its supports only"):
        ks.Result.load(tmp_path).reaction_along("left")
