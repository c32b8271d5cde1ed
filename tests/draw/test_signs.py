"""Signs of vectors across the picture, and panels whose places are set and not found."""

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

import kshell as ks
from kshell.draw.signs import RING, away, toward


@pytest.mark.parametrize(("sign", "inside"), [(toward, {"middle"}), (away, {"middle", "diagonal"})])
def test_signs_are_rings_with_a_dot_or_a_cross(sign, inside):
    figure = Figure(figsize=(1, 1), dpi=200)
    canvas = FigureCanvasAgg(figure)
    axes = figure.add_axes((0, 0, 1, 1), xlim=(-1, 1), ylim=(-1, 1))
    axes.set_axis_off()
    axes.plot(0, 0, marker=sign(), markersize=72, color="black", markeredgewidth=0)
    canvas.draw()
    light = np.asarray(canvas.buffer_rgba())[..., 0]

    def dark(x, y):
        return bool(light[round(99.5 - 99 * y), round(99.5 + 99 * x)] < 128)

    places = {"middle": (0.0, 0.0), "diagonal": (0.4, 0.4), "beside": (0.5, 0.0), "ring": (0.0, 1 - RING / 2)}
    assert {name for name, place in places.items() if dark(*place)} == inside | {"ring"}


def plate(names):
    """A plate whose edges carry, and name corners in several lines below their panels."""
    mesh = ks.geometry.Plane().mesh(6, 4, 1, ("a", "b", "c", "d"), (0, 3), (0, 2), "alternate")
    held = [ks.Clamped("a"), *(ks.SimplySupported(name) for name in names)]
    return ks.Scene(
        mesh=mesh,
        thickness=0.02,
        material=ks.Isotropic(E=70e9, nu=0.33),
        supports=held,
        loads=[ks.Pressure(-1e6)],
        title="Plate on its edges",
    )


@pytest.mark.parametrize("names", [(), ("c",), ("b", "c", "d")])
def test_panels_of_reactions_lie_beside_each_other(names):
    figure = ks.solve(plate(names), large_deflection=False, error="off").plot("reactions")
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    renderer = canvas.get_renderer()
    whole = figure.bbox
    boxes = [figure.axes[k].get_tightbbox(renderer) for k in range(len(figure.axes))]
    boxes.append(figure._suptitle.get_window_extent(renderer))
    assert len(boxes) > 1 + len(names)
    for box in boxes:
        assert box.x0 >= whole.x0
        assert box.y0 >= whole.y0
        assert box.x1 <= whole.x1
        assert box.y1 <= whole.y1
    for k, one in enumerate(boxes):
        for other in boxes[:k]:
            apart = np.array([one.x0 - other.x1, other.x0 - one.x1, one.y0 - other.y1, other.y0 - one.y1])
            assert apart.max() >= 0.0
