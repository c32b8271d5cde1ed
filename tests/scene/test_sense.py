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
    ],
)
def test_what_makes_sense_stays(supports, loads):
    assert structure_of(supports, loads).supports


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
