import io
import sys

import numpy as np
import pytest

import kshell as ks
from kshell.draw.canvas import edge_lines
from kshell.draw.pictures import PICTURES
from kshell.draw.plot import save_picture
from kshell.draw.png import png
from kshell.draw.scene_plot import plot_scene
from tests.scene.fabricated import fabricated_result, scene_on, square_mesh


@pytest.fixture(scope="module", params=[1, 2], ids=["order 1", "order 2"])
def result(request):
    return fabricated_result(square_mesh(4, order=request.param))


@pytest.mark.parametrize("what", PICTURES)
def test_pictures(result, what, tmp_path):
    figure = result.plot(what)
    figure.savefig(tmp_path / "picture.png", dpi=60)
    assert (tmp_path / "picture.png").stat().st_size > 4000
    axes = figure.axes[0]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x", "y")
    assert axes.get_aspect() == 1.0
    assert axes.get_title() == "Steel plate"
    if what != "mesh":
        assert "from" in figure.axes[1].get_ylabel()  # the colour bar says what and its range


def test_colours_of_both_signs_have_white_at_zero():
    image = fabricated_result().plot("moment_xy").axes[0].collections[0]
    assert image.norm.vmin == -image.norm.vmax


def test_all_supports_and_loads_are_drawn_and_named():
    mesh = square_mesh(6)
    scene = scene_on(
        mesh,
        supports=[
            ks.Clamped("left"),
            ks.SimplySupported(["bottom", "top"]),
            ks.Free("right"),
            ks.Symmetry("top"),
            ks.Fixed((0.5, 0.5, 0), "z"),
            ks.Elastic("west", 1e5),
            ks.Elastic("right", 1e5),
        ],
        loads=[
            ks.Pressure("x - 0.5"),
            ks.Traction((1, 0, 0), "east"),
            ks.Gravity((0, 0, 0)),
            ks.EdgeMoment("right", 3.0),
            ks.PointMoment((1, 1, 0), (1, 1, 0)),
            ks.Temperature(gradient=2, expansion=1e-5),
            ks.InitialCurvature((1, 0, 0), "east"),
        ],
    )
    figure = plot_scene(mesh, scene, "All")
    words = [text.get_text() for text in figure.legends[0].get_texts()]
    assert 'clamped on "left"' in words
    assert 'simply supported on "bottom", "top"' in words
    assert "fixed on (0.5, 0.5, 0) (z)" in words
    assert 'pressure everywhere: "x - 0.5" (+z, toward you)' in words
    assert 'pressure everywhere: "x - 0.5" (-z, away from you)' in words
    assert 'traction on "east": [1, 0, 0]' in words
    assert "gravity everywhere: [0, 0, 0] (zero)" in words
    assert len(words) == 7 + 8
    figure.canvas.draw()
    # nothing is cut off: the legend lies inside the picture
    box = figure.legends[0].get_window_extent()
    assert box.x0 >= 0
    assert box.y0 >= 0
    assert box.x1 <= figure.bbox.x1


def test_material_axes_are_drawn():
    mesh = square_mesh(3)
    carbon = ks.Orthotropic(E1=140.0, E2=10.0, nu12=0.3, G12=5.0, angle=30)
    alone = plot_scene(mesh, scene_on(mesh, material=carbon))
    assert "material axis 1: 30 degrees" in [t.get_text() for t in alone.legends[0].get_texts()]
    layers = [ks.Layer(carbon, 1.0, a) for a in (0, 60, 60, 0)] + [ks.Layer(ks.Isotropic(E=1, nu=0), 1)]
    stack = plot_scene(mesh, scene_on(mesh, material=None, thickness=None, layers=layers))
    words = [t.get_text() for t in stack.legends[0].get_texts()]
    assert "material axis 1 of layer 1, 4: 30 degrees" in words
    assert "material axis 1 of layer 2, 3: 90 degrees" in words


def test_a_mesh_alone():
    assert plot_scene(square_mesh(3), None).axes[0].get_xlabel() == "x"


def test_constant_fields_and_missing_ones():
    mesh = square_mesh(2)
    result = fabricated_result(mesh, fields={"displacement": np.zeros((9, 3))})
    result.plot("deflection").canvas.draw()
    with pytest.raises(ks.InputError, match="no picture"):
        result.plot("moment_xx")
    with pytest.raises(ks.InputError, match='did you mean "deflection"'):
        result.plot("deflexion")


def test_pyplot_is_left_alone():
    assert "matplotlib.pyplot" not in sys.modules or not sys.modules["matplotlib.pyplot"].get_fignums()


@pytest.mark.parametrize("shape", [(1, 1, 3), (5, 7, 3), (40, 3, 3)])
def test_png_is_read_back(shape):
    image = pytest.importorskip("PIL.Image")
    pixels = np.random.default_rng(0).integers(0, 256, shape, dtype=np.uint8)
    for level in (1, 6):
        read = image.open(io.BytesIO(png(pixels, 150, level)))
        np.testing.assert_array_equal(np.asarray(read), pixels)
        assert read.info["dpi"][0] == pytest.approx(150, abs=0.1)


def test_saved_pictures_are_those_of_plot(tmp_path):
    """One figure is used for all fields; nothing of the one before stays in it."""
    image = pytest.importorskip("PIL.Image")
    result = fabricated_result()
    result.fields["displacement"] = np.abs(
        result.fields["displacement"]
    )  # another scale of colours than moments
    result.save(tmp_path, plots=True)
    for name in ("moment_xx", "deflection", "von_mises_top"):
        alone = io.BytesIO()
        save_picture(result, name, alone)
        shared = np.asarray(image.open(tmp_path / f"{name}.png"), dtype=int)
        np.testing.assert_array_equal(shared, np.asarray(image.open(alone), dtype=int))


def test_long_titles_are_wrapped():
    title = "A very long title of a plate that nobody would read to its end, " * 3
    figure = fabricated_result(title=title.strip()).plot("deflection")
    figure.canvas.draw()
    axes = figure.axes[0]
    assert axes.get_title().replace("\n", " ") == title.strip()
    box = axes.title.get_window_extent()
    assert box.x0 > 0
    assert box.x1 < figure.bbox.x1
    assert box.y1 < figure.bbox.y1


def test_curved_edges_of_order_2_are_drawn_as_curves():
    plain = square_mesh(2, order=2)
    at = plain.edges[plain.boundary_edges]
    assert edge_lines(plain, plain.boundary_edges).shape == (len(at), 2, 2)
    middles = plain.midpoints.copy()
    radius = np.sqrt(0.5)
    points = plain.points - [0.5, 0.5, 0.0]
    square = np.maximum(np.abs(points[:, :2]).max(axis=1), 1e-300)
    points[:, :2] *= (radius * square / np.maximum(np.linalg.norm(points[:, :2], axis=1), 1e-300))[
        :, None
    ] * 2
    middles = points[plain.edges].mean(axis=1)
    rim = plain.boundary_edges
    middles[rim] *= 2 * radius * 0.5 / np.linalg.norm(middles[rim], axis=1)[:, None]
    disk = ks.Mesh.from_arrays(points, plain.triangles, {}, middles)
    lines = edge_lines(disk, disk.boundary_edges)
    assert np.linalg.norm(lines, axis=2) == pytest.approx(radius, rel=1.5e-3)  # two chords: 2 % inside
