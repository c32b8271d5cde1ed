"""Reactions at vertices that several supports hold go to those that hold the direction."""

import numpy as np
import pytest

import kshell as ks
from tests.plate.plates import rectangle


def slab(column, chart=None, **options):
    """A quarter of a panel of a flat slab under a unit pressure: planes of symmetry around, a column in a corner."""
    planes = [ks.Symmetry(name) for name in ("left", "right", "bottom", "top")]
    scene = ks.Scene(
        mesh=rectangle(4, a=0.5, b=0.5),
        chart=chart,
        thickness=0.05,
        material=ks.Isotropic(E=1e9, nu=0.2),
        supports=[*planes, column],
        loads=[ks.Pressure(1.0)],
    )
    return ks.solve(scene, large_deflection=False, error="off", **options).reactions


@pytest.mark.parametrize(
    ("chart", "options"),
    [
        (None, {"model": "plate"}),
        (None, {"model": "shell", "order": 1}),
        (None, {"model": "shell", "order": 3}),
        (ks.geometry.Plane(), {"element": "argyris"}),
        (ks.geometry.Plane(), {"element": "koiter"}),
    ],
    ids=["plate", "order 1", "order 3", "argyris on a chart", "koiter on a chart"],
)
def test_a_column_under_planes_of_symmetry_carries_all_of_the_slab(chart, options):
    found = slab(ks.Fixed((0, 0, 0), "z"), chart, **options)
    assert found["(0, 0)"]["force"] == pytest.approx([0.0, 0.0, -0.25], abs=1e-9)
    for name in ("left", "right", "bottom", "top"):
        assert found[name]["force"] == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)


@pytest.mark.parametrize("column", [ks.SimplySupported((0, 0, 0)), ks.Elastic((0, 0, 0), 1e3)])
def test_so_does_one_that_holds_more_or_gives_way(column):
    found = slab(column, model="shell", order=2)
    assert found["(0, 0)"]["force"] == pytest.approx([0.0, 0.0, -0.25], abs=1e-9)


def test_directions_that_are_not_at_right_angles_are_shared_so_that_each_gets_what_it_holds():
    """One support holds z, the other an axis at 45 degrees to it: forces along their own axes add up."""
    slanted = [[0, 1, 1], [0, -1, 1], [1, 0, 0]]
    scene = ks.Scene(
        mesh=rectangle(2),
        thickness=0.1,
        material=ks.Isotropic(E=1e9, nu=0.2),
        supports=[
            ks.Clamped("left"),
            ks.Fixed((1, 0, 0), "z"),
            ks.Fixed((1, 0, 0), "x", axes=slanted),
            ks.Fixed("right", "x"),
        ],
        loads=[ks.PointForce((1, 0, 0), (0.0, 3.0, 1.0)), ks.Pressure(1.0)],
    )
    found = ks.solve(scene, model="shell", large_deflection=False, error="off").reactions
    total = found["(1, 0)"]["force"]
    assert total[0] == pytest.approx(0.0, abs=1e-9)
    assert abs(total[1]) > 1.0
    assert np.sum([each["force"] for each in found.values()], axis=0) == pytest.approx([0, -3, -2], abs=1e-6)
