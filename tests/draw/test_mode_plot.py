"""Pictures of modes: one picture each with its caption, nodal lines where the deflection changes its sign."""

import numpy as np
import pytest

import kshell as ks
from tests.analysis.test_modes import square


def test_grid_of_plate_modes():
    result = ks.modes(square("CCCC", n=4), count=5, error="off")
    figure = result.plot()
    titles = [axes.get_title() for axes in figure.axes]
    assert len(titles) == 5
    for number, (title, entry) in enumerate(zip(titles, result.eigen, strict=True), 1):
        assert title == f"{number}: {entry['frequency']:.5g} Hz"
    # the first keeps its sign, the second has a nodal line of its own
    drawn = [len(axes.collections) for axes in figure.axes]
    assert drawn[1] == drawn[0] + 1


def test_rigid_motions_are_named_under_their_pictures():
    result = ks.modes(square("FFFF", n=3), count=1, error="off")
    assert [axes.get_title() for axes in result.plot("modes").axes][:2] == [
        "1: translation along z", "2: rotation about x"
    ]  # fmt: skip


def test_shells_are_drawn_deformed():
    mesh = ks.geometry.Cylinder(R=1.0).mesh(6, 3, 2, ("a", "b", "c", "d"), (0, 1.0), (0, 1.0))
    scene = ks.Scene(
        mesh=mesh,
        thickness=0.01,
        material=ks.Isotropic(E=1.0, nu=0.3, density=1.0),
        supports=[ks.Clamped("c")],
    )
    result = ks.modes(scene, count=2, order=2, error="off")
    axes = result.plot("mode_2").axes
    assert len(axes) == 1
    assert axes[0].name == "3d"
    assert np.isfinite(result.fields["mode_2"]).all()


def test_unknown_pictures_are_refused():
    result = ks.modes(square("CCCC", n=2), count=1, error="off")
    with pytest.raises(ks.InputError, match="the pictures are"):
        result.plot("mode_7")
