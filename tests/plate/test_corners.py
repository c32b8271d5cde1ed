"""Corners with infinite moments are named."""

import numpy as np
import pytest

import kshell as ks
from kshell.plate.corners import corner_angles
from tests.plate.plates import disk, rectangle, solve

RHOMBUS = {"b": np.sin(np.pi / 6), "skew": 1 / np.tan(np.pi / 6)}


def l_shape(n):
    full = rectangle(2 * n)
    centre = full.points[full.triangles].mean(axis=1)
    keep = (centre[:, 0] < 0.5) | (centre[:, 1] < 0.5)
    mesh = ks.Mesh.from_arrays(full.points, full.triangles[keep])
    return ks.Mesh.from_arrays(mesh.points, mesh.triangles, {"edge": mesh.edges[mesh.boundary_edges]})


def test_angles_of_corners():
    angles = np.degrees(sorted(corner_angles(rectangle(4, **RHOMBUS)).values()))
    assert np.allclose(angles, [30, 30, 150, 150])
    assert np.allclose(np.degrees(max(corner_angles(l_shape(2)).values())), 270)
    assert corner_angles(disk(4)) == {}


@pytest.mark.parametrize("element", ["morley", "argyris"])
def test_obtuse_supported_corners_are_named_and_clamped_ones_are_not(element):
    mesh = rectangle(4, **RHOMBUS)
    words = solve(mesh, [ks.SimplySupported("edge")], [ks.Pressure(1.0)], element).warnings
    assert len(words) == 1
    assert "2 obtuse supported corners" in words[0]
    assert "150 degrees" in words[0]
    assert solve(mesh, [ks.Clamped("edge")], [ks.Pressure(1.0)], element).warnings == []


def test_a_re_entrant_corner_is_named_with_its_place():
    words = solve(l_shape(2), [ks.Clamped("edge")], [ks.Pressure(1.0)]).warnings
    assert len(words) == 1
    assert "re-entrant corner: at (0.5, 0.5) the edges meet at 270 degrees" in words[0]
