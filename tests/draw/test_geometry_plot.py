"""Pictures of curves and surfaces: they are drawn, labelled and refuse nonsense."""

import matplotlib as mpl
import numpy as np
import pytest

import kshell.geometry as g
from kshell.draw import geometry_plot as plot
from kshell.errors import InputError

mpl.use("Agg")


@pytest.fixture(autouse=True)
def close_figures():
    import matplotlib.pyplot as plt

    yield
    plt.close("all")


def test_curvature_is_drawn_with_zero_in_the_middle_of_the_colours() -> None:
    figure = plot.curvature(g.Torus(), "gaussian_curvature", n=12)
    axes, bar = figure.axes
    assert axes.get_title() == "Gaussian curvature K of the torus"
    assert bar.get_ylabel() == "Gaussian curvature K"
    low, high = bar.get_ylim()
    assert low == pytest.approx(-high)
    with pytest.raises(InputError, match="there are gaussian_curvature"):
        plot.curvature(g.Torus(), "colour")


def test_classification_names_the_kinds_that_are_there() -> None:
    for chart, kinds in (
        (g.Torus(), ["elliptic", "hyperbolic"]),
        (g.Cylinder(), ["parabolic"]),
        (g.Plane(), ["planar"]),
    ):
        (legend,) = plot.classification(chart, n=12).legends
        assert [text.get_text() for text in legend.get_texts()] == kinds


def test_gauss_map_lies_on_the_unit_sphere() -> None:
    _, right, *_ = plot.gauss_map(g.Ellipsoid(3, 2, 1), n=8).axes
    for limits in (right.get_xlim(), right.get_ylim(), right.get_zlim()):
        assert limits[1] == pytest.approx(1.0, abs=0.12)
        assert limits[0] == pytest.approx(-1.0, abs=0.12)


def test_principal_directions_show_what_is_in_front_and_no_umbilics() -> None:
    crosses = plot.principal_directions(g.Ellipsoid(3, 2, 1), n=12).axes[0].collections[1:]
    assert [c.get_label() for c in crosses] == ["direction of k1", "direction of k2"]
    for collection in crosses:
        middles = np.mean(collection._segments3d, axis=1)
        assert 0.35 * 144 < len(middles) < 0.75 * 144  # about one half is on the far side
        assert middles[:, 2].mean() > 0.1  # seen from above
    (axes,) = plot.principal_directions(g.Sphere(), n=6).axes
    assert axes.get_title() == "sphere: every point is an umbilic, every direction principal"
    assert len(axes.collections) == 1


def test_frames() -> None:
    helix = g.Curve.from_expressions("cos(t)", "sin(t)", "t/4")
    (legend,) = plot.frames(helix, np.linspace(0, 6, 7)).legends
    assert [t.get_text() for t in legend.get_texts()] == ["tangent T", "normal N", "binormal B"]
    cubic = g.Curve.from_expressions("t", "t**3")
    with pytest.raises(InputError, match="inflection"):
        plot.frames(cubic, np.linspace(-1, 1, 5))
    (axes,) = plot.frames(cubic, np.linspace(-1, 1, 5), rotation_minimising=True).axes
    assert axes.get_title() == "Rotation-minimising frames"


def test_values_on_a_mesh_with_a_boundary() -> None:
    mesh = g.Hypar().mesh(6, 6, order=1)
    figure = plot.on_mesh(mesh, g.discrete.gaussian_curvature(mesh), "K", "angle defect")
    assert figure.axes[1].get_ylabel() == "K"
    with pytest.raises(InputError, match="neither one per vertex"):
        plot.on_mesh(mesh, np.zeros(3), "K")
