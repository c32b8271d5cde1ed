"""Sheets, branches, folds, loops and averages."""

import numpy as np
import pytest

from kshell.mesh.mesh import Mesh
from kshell.shell.koiter import topology
from kshell.shell.koiter.surface import Surface
from kshell.shell.vertex_fields import patch_means
from tests.shell.shapes import box, cylinder, fold, patch, rectangle, strip, tee


@pytest.mark.parametrize(
    ("mesh", "sheets", "characteristics", "orientable", "branches", "loops"),
    [
        (patch(), 1, [1], [True], 0, 1),
        (fold(), 1, [1], [True], 0, 1),
        (tee(), 3, [1, 1, 1], [True] * 3, 2, 1),
        (box(), 1, [2], [True], 0, 0),
        (strip(0), 1, [0], [True], 0, 2),
        (strip(1), 1, [0], [False], 0, 1),
    ],
    ids=["patch", "fold", "tee", "box", "tube", "moebius"],
)
def test_sheets(mesh, sheets, characteristics, orientable, branches, loops):
    found = topology.sheets(mesh)
    assert [s.characteristic for s in found] == characteristics
    assert [s.orientable for s in found] == orientable
    assert len(topology.branch_edges(mesh)) == branches
    assert len(topology.boundary_loops(mesh)) == loops
    assert topology.parts(mesh).max() == 0


def test_a_boundary_loop_is_walked():
    mesh = patch()
    (loop,) = topology.boundary_loops(mesh)
    around = np.stack([loop, np.roll(loop, -1)], axis=1)
    assert np.all(np.isin(mesh.edge_index(around), mesh.boundary_edges))


def test_opposed_triangles_are_found():
    mesh = patch()
    turned = mesh.triangles.copy()
    turned[0] = turned[0, ::-1]
    assert len(topology.opposed_edges(mesh)) == 0
    found = topology.opposed_edges(Mesh(mesh.points, turned))
    inner = mesh.triangle_edges[0][mesh.edge_counts[mesh.triangle_edges[0]] == 2]
    assert set(found) == set(inner)


def test_fold_angles_and_patches():
    surface = Surface(fold(), 2)
    angles = topology.fold_angles(surface)
    exact = np.pi - np.arccos(np.dot([1, 0, 0], [-0.3, 0, 1]) / np.hypot(0.3, 1))
    folded = angles[angles > 0.1]
    assert np.allclose(folded, exact)
    assert len(folded) == 2
    patches = topology.smooth_patches(surface)
    assert patches.max() == 1
    # a curved surface of order 2 is smooth, its facets are not
    lift = cylinder(1.0)
    mesh = rectangle(4, 2, 0, np.pi / 2, 0, 1)
    smooth = topology.fold_angles(Surface(mesh, 3, lift))
    facets = topology.fold_angles(Surface(mesh, 1, lift))
    assert np.nanmax(smooth) < 0.01 < np.nanmax(facets)


def test_averages_stay_within_patches():
    surface = Surface(fold(), 1)
    patches = topology.smooth_patches(surface)
    values = np.repeat(patches[:, None, None].astype(float), 3, axis=1)
    assert np.allclose(patch_means(surface.mesh.triangles, surface.corner_angles, values, patches), values)


def test_largest_curvature():
    surface = Surface(rectangle(6, 2, 0, np.pi / 2, 0, 1), 3, cylinder(2.0))
    assert np.allclose(topology.largest_curvature(surface), 0.5, rtol=1e-2)
