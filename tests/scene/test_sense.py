"""Supports and loads that contradict each other, and points that are nowhere near, are errors in words."""

from __future__ import annotations

from pathlib import Path

import pytest

import kshell as ks

MESHES = Path(__file__).parents[2] / "meshes"
STEEL = ks.Isotropic(E=2e11, nu=0.3, density=7800)


def structure_of(supports, loads, mesh="unit_square"):
    from kshell.scene.structure import resolve

    scene = ks.Scene(
        mesh=MESHES / f"{mesh}.msh", thickness=0.01, material=STEEL, supports=supports, loads=loads
    )
    return resolve(scene, scene.read_mesh())


@pytest.mark.parametrize(
    ("supports", "loads", "words"),
    [
        ([ks.Clamped("left"), ks.Free("left")], [], "holds what support free"),
        ([ks.Free("left"), ks.Elastic("left", 1e6)], [], "holds what support free"),
        ([ks.Clamped("left")], [ks.LineForce("left", (0, 0, 1))], "acts along z, which support clamped"),
        ([ks.Clamped(["left", "right"])], [ks.LineForce("left", (1, 0, 0))], "acts along x, which"),
        (
            [ks.Clamped("left")],
            [ks.EdgeMoment("left", 1.0)],
            "turns the edge, whose rotation support clamped",
        ),
        ([ks.SimplySupported("left")], [ks.LineForce("left", (0, 0, 1))], "acts along z"),
        (
            [ks.Clamped("left"), ks.SimplySupported((2000, 500, 0))],
            [],
            "off the surface, more than a mesh size",
        ),
        ([ks.Clamped("left")], [ks.PointForce((2000, 500, 0), (0, 0, 1))], "look at the coordinates"),
    ],
)
def test_contradictions_are_refused(supports, loads, words):
    with pytest.raises(ks.InputError, match=words):
        structure_of(supports, loads)


@pytest.mark.parametrize(
    ("supports", "loads"),
    [
        ([ks.Clamped("left"), ks.Free("right")], []),
        ([ks.Fixed("left", "zr")], [ks.LineForce("left", (1, 0, 0))]),
        ([ks.SimplySupported("left")], [ks.LineForce("left", (1, 0, 0))]),  # free in the plane of a plate
        ([ks.SimplySupported("left")], [ks.EdgeMoment("left", 1.0)]),
        ([ks.Clamped("left")], [ks.LineForce(["left", "right"], (0, 0, 1))]),  # a part goes into the plate
        ([ks.Elastic("left", 1e6), ks.Clamped("right")], [ks.LineForce("left", (0, 0, 1))]),
        ([ks.Clamped("left")], [ks.Gravity((0, 0, -9.81))]),
        ([ks.Clamped("left")], [ks.PointForce((0, 0, 0), (0, 0, 1))]),  # its reaction is asked for, perhaps
        ([ks.Clamped("plate")], [ks.Temperature(mean=1.0, expansion=1e-5)]),
    ],
)
def test_what_makes_sense_stays(supports, loads):
    assert structure_of(supports, loads).supports


@pytest.mark.parametrize(
    ("supports", "load", "lost"),
    [
        ([ks.Clamped("left")], ks.PointForce((0, 0.5, 0), (0, 0, 1)), "acts along z"),
        (
            [ks.SimplySupported((0, 0, 0)), ks.Clamped("right")],
            ks.PointForce((0, 0, 0), (0, 0, 1)),
            "along z",
        ),
        ([ks.Clamped("left")], ks.PointMoment((0, 0.5, 0), (1, 0, 0)), "turns a place, whose rotation"),
        ([ks.Fixed("left", "xyz")], ks.PointForce((0, 0.5, 0), (1, 0, 0)), "acts along x"),
        ([ks.SimplySupported("left")], ks.PointMoment((0, 0.5, 0), (1, 0, 0)), ""),
        ([ks.Fixed("left", "zr")], ks.PointForce((0, 0.5, 0), (1, 0, 0)), ""),
        ([ks.Elastic((0, 0.5, 0), 1e6)], ks.PointForce((0, 0.5, 0), (0, 0, 1)), ""),
        ([ks.Clamped("left")], ks.PointForce((0.5, 0.5, 0), (0, 0, 1)), ""),
    ],
)
def test_loads_at_held_points_and_on_held_surfaces_go_on_with_a_word(supports, load, lost):
    (placed,) = structure_of(supports, [load]).loads
    assert lost in placed.warning
    assert ("deform nothing" in placed.warning) == bool(lost)


def test_a_load_on_the_held_point_of_a_rigid_link_goes_on_with_a_word():
    link = ks.RigidLink("right", to=(1.2, 0.5, 0), name="hub")
    supports = [ks.Clamped("left"), link, ks.Fixed("hub", "z")]
    for force, lost in (((0, 0, 1), True), ((1, 0, 0), False)):
        (placed,) = structure_of(supports, [ks.PointForce("hub", force)]).loads
        assert ("acts along z" in placed.warning) == lost


def test_the_warning_is_in_the_result():
    scene = ks.Scene(
        mesh=MESHES / "unit_square.msh",
        thickness=0.01,
        material=STEEL,
        supports=[ks.Clamped("left")],
        loads=[ks.PointForce((0, 0.5, 0), (0, 0, 1))],
    )
    for model in ("plate", "shell"):
        with pytest.warns(ks.KshellWarning, match="go straight into the support"):
            result = ks.solve(scene, model=model, large_deflection=False, error="off")
        assert result.reactions["left"]["force"][2] == pytest.approx(-1.0)


def test_own_axes_are_looked_along():
    along = [[1, 1, 0], [-1, 1, 0], [0, 0, 1]]
    with pytest.raises(ks.InputError, match="acts along"):
        structure_of([ks.Fixed("left", "x", axes=along)], [ks.LineForce("left", (1, 1, 0))])


def test_check_says_so():
    from kshell.scene.structure import problems

    scene = ks.Scene(
        mesh=MESHES / "unit_square.msh",
        thickness=0.01,
        material=STEEL,
        supports=[ks.Clamped("left"), ks.Free("left")],
    )
    assert any("leave one of them out" in words for words in problems(scene, scene.read_mesh()))
