"""Sizes and shapes of meshes whose measures are known."""

from __future__ import annotations

import numpy as np
import pytest

from kshell.mesh import Mesh, check
from tests.mesh.mesh_samples import square


def test_summary_of_a_square():
    found = check.summary(square(4))
    assert (found.vertices, found.triangles, found.edges, found.order) == (25, 32, 56, 1)
    assert found.area == pytest.approx(1.0)
    assert found.boundary_length == pytest.approx(4.0)
    assert (found.lower, found.upper) == ((0.0, 0.0, 0.0), (1.0, 1.0, 0.0))
    measures = {group.name: (group.kind, group.members, group.measure) for group in found.groups}
    assert measures["plate"] == ("surface", 32, pytest.approx(1.0))
    assert measures["lower"] == ("surface", 16, pytest.approx(0.5))
    assert measures["two sides"] == ("curve", 8, pytest.approx(2.0))
    assert measures["origin"] == ("point", 1, 0.0)


def test_curved_measures_are_those_of_the_parabola():
    """One triangle whose lowest side is the parabola y = -c (1 - x^2)."""
    c = 0.3
    mesh = Mesh.from_arrays(
        [[-1, 0, 0], [1, 0, 0], [0, 2, 0], [0, -c, 0], [0.5, 1, 0], [-0.5, 1, 0]], [[0, 1, 2, 3, 4, 5]]
    )
    length = np.sqrt(1 + 4 * c**2) + np.arcsinh(2 * c) / (2 * c)
    edge = mesh.edge_index([[0, 1]])[0]
    assert check.quality(mesh).longest_edge == pytest.approx(np.sqrt(5))
    from kshell.mesh.quality import edge_lengths, triangle_areas

    assert edge_lengths(mesh)[edge] == pytest.approx(length, rel=1e-5)
    assert triangle_areas(mesh)[0] == pytest.approx(2 + 4 * c / 3, rel=1e-12)


def test_shape_of_an_equilateral_triangle():
    found = check.quality(Mesh.from_arrays([[0, 0], [1, 0], [0.5, np.sqrt(0.75)]], [[0, 1, 2]]))
    assert found.min_angle == pytest.approx(60.0)
    assert found.max_aspect == pytest.approx(1.0)
    assert found.shortest_edge == pytest.approx(found.longest_edge)


def test_the_worst_triangle_is_found():
    points = square(3).points.copy()
    points[5] = [0.3, 0.01, 0.0]  # a vertex of the inside close to the lower edge
    found = check.quality(Mesh.from_arrays(points, square(3).triangles))
    assert found.min_angle < 6
    assert found.min_angle_at[1] < 0.02
    assert found.max_aspect > 5
    assert found.max_aspect_at[1] < 0.02
    assert found.shortest_edge == pytest.approx(np.hypot(1 / 3 - 0.3, 0.01))
    assert found.shortest_edge_at == pytest.approx(((1 / 3 + 0.3) / 2, 0.005, 0.0))


def test_quality_of_a_needle_is_accurate():
    h = 1e-4
    found = check.quality(Mesh.from_arrays([[0, 0], [1, 0], [0.5, h]], [[0, 1, 2]]))
    assert found.min_angle == pytest.approx(np.degrees(np.arctan(2 * h)), rel=1e-12)
