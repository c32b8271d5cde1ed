"""Planes of symmetry through straight lines on charts: by the formulas of the chart, however coarse the mesh is."""

import numpy as np
import pytest

import kshell as ks
from kshell.scene.on_chart import ChartLift
from kshell.shell.koiter.conormal import across_line
from kshell.shell.koiter.surface import Surface

# a cylinder whose profile is of no second degree: upright at u = 1.5, where the surface goes along (1, 0, 0)
PROFILE = ks.geometry.Chart.from_expressions("u", "v", "cos(2*(u-1.5)) + (u-1.5)**3")


def line(chart, lift, order):
    """A strip of two by two cells, and its edges on u = 1.5."""
    u, v = np.meshgrid([0.5, 1.0, 1.5], [0.0, 0.7, 1.0], indexing="ij")
    points = np.column_stack([u.ravel(), v.ravel(), np.zeros(9)])
    cells = [(3 * i + j, 3 * (i + 1) + j, 3 * (i + 1) + j + 1, 3 * i + j + 1) for i in (0, 1) for j in (0, 1)]
    triangles = [three for a, b, c, d in cells for three in ((a, b, c), (a, c, d))]
    mesh = ks.Mesh.from_arrays(points, np.array(triangles))
    on = np.flatnonzero((mesh.points[mesh.edges][..., 0] == 1.5).all(axis=1))
    return Surface(mesh, order, lift), on


@pytest.mark.parametrize("order", [1, 2, 5])
def test_a_line_on_a_chart_has_the_direction_of_the_chart(order):
    surface, edges = line(PROFILE, ChartLift(PROFILE), order)
    assert abs(across_line(surface, edges)[0]) == pytest.approx(1.0, abs=1e-14)
    assert np.abs(across_line(surface, edges)[1:]).max() < 1e-14
    # its nodes alone do not say it
    surface, edges = line(PROFILE, lambda points: PROFILE(*points[:, :2].T), order)
    assert np.abs(across_line(surface, edges)[1:]).max() > 1e-8


def test_a_chart_without_normals_or_derivatives_gives_none():
    tip = ChartLift(ks.geometry.Cone(R=1.0, height=1.0))
    places = np.array([[0.3, 0.5, 0.0], [0.3, 0.0, 0.0]])
    assert tip.normals(places) is None
    np.testing.assert_allclose(
        tip.normals(places[:1]), [np.array([np.cos(0.3), np.sin(0.3), -1.0]) / np.sqrt(2)]
    )
