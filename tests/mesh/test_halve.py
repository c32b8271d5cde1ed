"""Halving a mesh: the same region and the same groups, four triangles for each."""

import numpy as np
import pytest

from kshell.mesh.halve import halved
from tests.plate.plates import rectangle


def test_region_groups_and_sense_are_kept():
    mesh = rectangle(3, 4, wobble=0.2)
    fine = halved(mesh)
    assert len(fine.triangles) == 4 * len(mesh.triangles)
    assert fine.areas == pytest.approx(np.repeat(mesh.areas, 4) / 4)
    corners = fine.points[fine.triangles][:, :, :2]
    twice = np.linalg.det(np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=1))
    assert twice.min() > 0
    assert set(fine.groups) == set(mesh.groups)
    for name, group in mesh.groups.items():
        measure = {1: "edge_lengths", 2: "areas"}[group.dimension]
        whole, parts = (getattr(m, measure)[m.groups[name].members].sum() for m in (mesh, fine))
        assert parts == pytest.approx(whole), name
    assert fine.groups["left"].members.min() >= 0
    assert fine.points[fine.edges[fine.groups["left"].members]][:, :, 0] == pytest.approx(0.0)


def test_children_share_edges():
    fine = halved(rectangle(2))
    assert len(fine.boundary_edges) == 16
    assert set(fine.edge_counts.tolist()) == {1, 2}
