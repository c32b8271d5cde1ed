"""Bisection: conforming, of few shapes, groups of all dimensions and curves kept."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from kshell import geometry
from kshell.mesh.mesh import Mesh
from kshell.mesh.refine import FINEST, bisect, bisect_around, cuttable, longest_first


def l_shape() -> Mesh:
    """(-1, 1)^2 less a quadrant, six triangles, with groups of all dimensions."""
    points = [(-1, -1), (0, -1), (-1, 0), (0, 0), (1, 0), (-1, 1), (0, 1), (1, 1)]
    triangles = [(0, 1, 3), (0, 3, 2), (2, 3, 6), (2, 6, 5), (3, 4, 7), (3, 7, 6)]
    groups = {
        "corner": np.array([3]),
        "right": np.array([(4, 7)]),
        "inside": np.array([(3, 6)]),
        "lower": np.array([(0, 1, 3), (0, 3, 2)]),
    }
    return longest_first(Mesh.from_arrays(points, triangles, groups))


def smallest_angle(mesh: Mesh) -> float:
    x = mesh.points[mesh.triangles]
    out = np.pi
    for k in range(3):
        a, b = x[:, (k + 1) % 3] - x[:, k], x[:, (k + 2) % 3] - x[:, k]
        out = min(out, np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), (a * b).sum(axis=1)).min())
    return float(np.degrees(out))


def require_conforming(mesh: Mesh) -> None:
    """No vertex lies inside an edge: the boundary is as long as it was, and no edge belongs to three triangles."""
    assert mesh.edge_counts.max() <= 2
    assert mesh.edge_lengths[mesh.boundary_edges].sum() == pytest.approx(8.0, rel=1e-12)
    assert mesh.areas.sum() == pytest.approx(3.0, rel=1e-12)
    assert mesh.areas.min() > 0.0


def test_random_marks_keep_the_mesh_conforming_and_of_few_shapes() -> None:
    mesh = l_shape()
    rng = np.random.default_rng(3)
    for _ in range(12):
        mesh = bisect(mesh, rng.random(len(mesh.triangles)) < 0.2).mesh
        require_conforming(mesh)
    assert len(mesh.triangles) > 1000
    assert smallest_angle(mesh) == pytest.approx(45.0, abs=1e-6)


def test_groups_keep_their_size_and_place() -> None:
    coarse = l_shape()
    mesh = bisect_around(coarse, coarse.groups["corner"].members, 6)
    assert mesh.groups["corner"].members.tolist() == [3]
    for name, length in (("right", 1.0), ("inside", 1.0)):
        assert mesh.edge_lengths[mesh.groups[name].members].sum() == pytest.approx(length, rel=1e-12)
    assert np.allclose(mesh.points[mesh.edges[mesh.groups["right"].members]][..., 0], 1.0)
    lower = mesh.groups["lower"].members
    assert mesh.areas[lower].sum() == pytest.approx(1.0, rel=1e-12)
    assert (mesh.points[mesh.triangles[lower]].mean(axis=1)[:, 1] < 0).all()


def test_grading_reaches_deep_with_few_triangles() -> None:
    mesh = bisect_around(l_shape(), np.array([3]), 30)
    at_corner = np.isin(mesh.triangles, [3]).any(axis=1)
    assert mesh.areas[at_corner].max() < 1e-16
    assert len(mesh.triangles) < 30 * 40
    assert smallest_angle(mesh) == pytest.approx(45.0, abs=1e-3)


def test_marked_triangles_are_quartered_and_know_their_parents() -> None:
    mesh = l_shape()
    found = bisect(mesh, np.array([0]))
    assert np.count_nonzero(found.parent == 0) == 4
    area = np.bincount(found.parent, found.mesh.areas, len(mesh.triangles))
    assert area == pytest.approx(mesh.areas, rel=1e-12)
    assert (np.diff(found.parent) >= 0).all()
    assert (found.mesh.points[: len(mesh.points)] == mesh.points).all()


@pytest.mark.parametrize("marks", ["all", "some"])
def test_order_two_keeps_the_surface_of_its_nodes(marks: str) -> None:
    """The area of quadratic triangles does not change when they are cut, and theirs are the same places."""
    cylinder = geometry.Cylinder(2.0)
    mesh = longest_first(cylinder.mesh(3, 2, order=2))
    chosen = np.arange(len(mesh.triangles)) if marks == "all" else np.array([1, 4])
    fine = bisect(mesh, chosen).mesh
    assert fine.order == 2
    assert fine.midpoints is not None
    assert fine.edge_counts.max() <= 2
    old = np.isin(np.round(fine.points, 12), np.round(mesh.points, 12)).all(axis=1)
    radius = np.hypot(fine.points[~old, 0], fine.points[~old, 1])
    assert radius == pytest.approx(2.0, abs=1e-12)  # new vertices are the mid-edge nodes before
    off = np.abs(np.hypot(*fine.midpoints[:, :2].T) - 2.0)
    coarse = 2.0 * (np.pi / 6) ** 3
    assert 1e-6 < off.max() < coarse  # mid-edge nodes lie on the quadratic triangles, not on the cylinder
    for name, group in mesh.groups.items():
        assert fine.groups[name].dimension == group.dimension
        if group.dimension == 1:
            assert len(fine.groups[name].members) >= len(group.members)


def test_middles_may_be_given() -> None:
    mesh = l_shape()
    middles = mesh.points[mesh.edges].mean(axis=1)
    middles[mesh.groups["right"].members, 0] += 0.1
    fine = bisect(mesh, np.arange(len(mesh.triangles)), middles).mesh
    assert fine.points[:, 0].max() == pytest.approx(1.1)


def test_refinement_ends_where_coordinates_end():
    """Triangles far from the origin are left 128 spacings large; their height above the plane counts for nothing."""
    unit = [(0, 0), (1, 0), (1, 1), (0, 1)]
    square = longest_first(Mesh.from_arrays(unit, [(0, 1, 2), (0, 2, 3)]))
    for shift, lift in ((0.0, 0.0), (1e6, 0.0), (0.0, 1e9)):
        mesh = dataclasses.replace(square, points=square.points + np.array([shift, 0.0, lift]))
        assert cuttable(mesh).all()
        found = bisect_around(mesh, np.array([1]), 60)
        shortest = found.edge_lengths.min() / np.spacing(1.0 + shift)
        assert FINEST <= shortest <= 4 * FINEST
        assert found.areas.min() > 0.0
        assert not cuttable(found).all()
