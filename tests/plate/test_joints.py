"""Arcs that run into straight edges and other arcs, told by their nodes."""

import numpy as np
import pytest

from kshell.mesh.mesh import Mesh
from kshell.plate.domain import Domain
from kshell.plate.joints import tangent_joints

ROUNDING = 1e-15


def fan(rim):
    """Triangles between a closed curve of nodes and the origin."""
    k, n = np.arange(len(rim)), len(rim)
    triangles = np.stack([k, (k + 1) % n, np.full(n, n)], axis=1)
    return Mesh.from_arrays(np.concatenate([rim, [[0.0, 0.0]]]), triangles)


def arc(centre, radius, begin, end, edges):
    angles = np.linspace(begin, end, edges + 1)
    return np.array(centre) + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def stadium(edges, between):
    """Half circles of so many edges, and as many nodes inside of the straight sides."""
    right = arc((0.8, 0.0), 0.7, -np.pi / 2, np.pi / 2, edges)
    x = np.linspace(0.8, -0.8, between + 2)[1:-1]
    side = np.stack([x, np.full_like(x, 0.7)], axis=1)
    return np.concatenate([right, side, -right, -side])


def oval(edges):
    """Four arcs of radii 2 and 1/2."""
    a = np.radians(35)
    x = 1.5 * np.sin(a)
    right = arc((x, 0.0), 0.5, a - np.pi / 2, np.pi / 2 - a, edges)
    top = arc((0.0, -1.5 * np.cos(a)), 2.0, np.pi / 2 - a, np.pi / 2 + a, edges)
    return np.concatenate([right[:-1], top[:-1], -right[:-1], -top[:-1]])


@pytest.mark.parametrize("between", [0, 1, 2, 9])
@pytest.mark.parametrize("edges", [4, 12, 48])
def test_half_circles_that_run_into_long_and_short_edges_are_known(edges, between):
    domain = Domain(fan(stadium(edges, between)), curved=True)
    assert domain.area == pytest.approx(0.49 * np.pi + 1.6 * 1.4, rel=1e-12)
    assert domain.curves.arcs.sum() == domain.curves.curved.sum() == 2 * edges


@pytest.mark.parametrize("edges", [2, 3])
def test_fillets_of_few_edges_are_arcs(edges):
    corners = [(1.0, 0.5), (-1.0, 0.5), (-1.0, -0.5), (1.0, -0.5)]
    quarters = [arc(c, 0.3, k * np.pi / 2, (k + 1) * np.pi / 2, edges) for k, c in enumerate(corners)]
    domain = Domain(fan(np.concatenate(quarters)), curved=True)
    assert domain.area == pytest.approx(2.6 * 1.6 - (4 - np.pi) * 0.09, rel=1e-12)


@pytest.mark.parametrize("edges", [3, 6, 24])
def test_arcs_of_two_radii_that_meet_are_known(edges):
    a, x = np.radians(35), 1.5 * np.sin(np.radians(35))
    whole = 2 * (0.25 * (np.pi / 2 - a) + 4.0 * a) - 2 * x * 1.5 * np.cos(
        a
    )  # sectors less the rhombus twice covered
    domain = Domain(fan(oval(edges)), curved=True)
    assert domain.area == pytest.approx(whole, rel=1e-12)
    assert domain.curves.arcs.all()


def test_points_of_inflection_ellipses_and_polygons_have_no_joints():
    x = np.linspace(-2.0, 2.0, 17)
    wave = np.stack([x, np.sin(x)], axis=1)
    t = np.linspace(0, 2 * np.pi, 25)
    ellipse = np.stack([3 * np.cos(t), np.sin(t)], axis=1)
    square = np.array([[0, 0], [1, 0], [2, 0], [2, 1], [2, 2], [1, 2], [0, 2], [0, 1], [0, 0]], dtype=float)
    for nodes, closed in ((wave, False), (ellipse, True), (square, True), (arc((0, 0), 1, 0, 1, 9), False)):
        assert not tangent_joints(nodes, 1, closed, ROUNDING).any()


def test_joints_of_an_open_line_are_at_vertices():
    bend = arc((1.0, 0.0), 1.0, np.pi, np.pi / 2, 4)
    line = np.concatenate([[[0.0, -0.5]], bend, [[1.3, 1.0], [2.5, 1.0]]])
    assert np.flatnonzero(tangent_joints(line, 1, False, ROUNDING)).tolist() == [1, 5]
    assert not tangent_joints(line, 2, False, ROUNDING).any()
