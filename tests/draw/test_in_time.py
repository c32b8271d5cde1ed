"""Pictures of scenes whose loads depend on the time: drawn as they are when they are largest."""

import numpy as np
import pytest

import kshell as ks
from kshell.draw.in_time import largest_values
from kshell.draw.scene_plot import plot_scene
from kshell.draw.surface_scene_plot import plot_surface_scene
from tests.scene.fabricated import square_mesh


@pytest.mark.parametrize("draw", [plot_scene, plot_surface_scene])
def test_a_load_that_is_zero_at_first_is_drawn(draw):
    loads = [ks.Pressure("2000*(t > 0.4)*(t < 0.6)"), ks.PointForce((0, 0, 0), (0, 0, "-3*t"))]
    scene = ks.Scene(
        mesh=square_mesh(2),
        thickness=0.01,
        material=ks.Isotropic(E=1, nu=0.3, density=1),
        supports=[ks.Clamped("left")],
        loads=loads,
        solve={"analysis": "dynamic", "time": 1.0},
    )
    figure = draw(scene.read_mesh(), scene, "")
    words = " ".join(text.get_text() for text in figure.findobj(lambda a: hasattr(a, "get_text")))
    assert "2000" in words
    assert "(zero)" not in words


def test_values_at_the_largest_time():
    points = np.zeros((2, 3))
    assert largest_values(ks.Pressure("5*sin(pi*t)"), points, 2.0) == pytest.approx([5.0, 5.0])
    assert largest_values(ks.Traction((0, "-7*t", 1)), points, 3.0)[0] == pytest.approx([0, -21, 1])
    assert largest_values(ks.Pressure(4), points, None) == pytest.approx([4, 4])


@pytest.mark.parametrize("draw", [plot_scene, plot_surface_scene])
@pytest.mark.parametrize("centre", [(0.3, 0.6, 0), ("0.3 + 10*t", 0.6, 0)])
def test_patches_are_drawn_where_they_press(draw, centre):
    loads = [
        ks.Disc(-5.0, centre=centre, radius=0.11),
        ks.Rectangle(-3.0, centre=(0.71, 0.3, 0), size=(0.3, 0.2), angle=20),
        ks.Disc(-1.0, centre=(7, 7, 0), radius=0.2),
    ]
    scene = ks.Scene(
        mesh=square_mesh(16),
        thickness=0.01,
        material=ks.Isotropic(E=1, nu=0.3, density=1),
        supports=[ks.Clamped("left")],
        loads=loads,
    )
    mesh = scene.read_mesh()
    figure = draw(mesh, scene, "")
    words = [text.get_text() for text in figure.legends[0].get_texts()]
    assert len(words) == 4
    assert "disc around [" in words[1]
    assert "pressure -5, radius 0.11" in words[1]
    assert "size [0.3, 0.2], angle 20" in words[2]
    assert not any("zero" in label or "everywhere" in label for label in words)
    assert words[3].endswith("(presses on nothing)")


def test_the_rim_of_a_patch_bounds_what_it_presses_on():
    for load in (
        ks.Disc(1.0, centre=(1, 2, 0), radius=0.5),
        ks.Rectangle(1.0, centre=(1, 2, 0), size=(2, 1), angle=30),
    ):
        rim, centre = load.outline(), np.array([1.0, 2.0, 0.0])
        assert load.at(centre + 0.999 * (rim - centre)) == pytest.approx(1.0)
        assert load.at(centre + 1.001 * (rim - centre)) == pytest.approx(0.0)
        assert rim[0] == pytest.approx(rim[-1])
