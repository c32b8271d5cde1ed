"""Smooth surfaces through the vertices of flat triangles: how far their nodes lie off the true surface."""

import numpy as np
import pytest

import kshell as ks
from kshell.mesh.curving.decision import curve
from kshell.mesh.curving.rebuild import rebuild
from tests.mesh import curved_shapes as shapes

EXACT = 1e-14


def rebuilt(points, triangles, off, crease=30.0):
    """What was rebuilt, and the distances of its nodes."""
    found = rebuild(ks.Mesh.from_arrays(points, triangles), crease)
    return found, np.abs(off(found.midpoints))


@pytest.mark.parametrize("n", [5, 8, 16])
def test_sphere_is_exact(n):
    found, off = rebuilt(*shapes.sphere(n), shapes.off_sphere)
    assert off.max() < EXACT
    assert found.estimate.max() < EXACT
    assert found.curved.all()


@pytest.mark.parametrize(("n", "m"), [(16, 1), (32, 1), (32, 2), (64, 1), (32, 20)])
def test_structured_cylinder_is_exact(n, m):
    """Slivers, and strips of coplanar triangles, which are facets and no flats."""
    found, off = rebuilt(*shapes.cylinder(n, m), shapes.off_cylinder)
    assert off.max() < EXACT
    assert not found.sheets.flat.any()


@pytest.mark.parametrize("n", [4, 8])
def test_open_roof_is_exact(n):
    """All triangles at the vertices of a straight border lie in the plane of the last strip, which is no flat."""
    angles = np.radians(np.linspace(-40, 40, n + 1))
    points, triangles = shapes.sheet(angles, np.linspace(0, 2, 6), np.cos)
    points[:, 0] = np.sin(points[:, 0])
    _, off = rebuilt(points, triangles, lambda x: shapes.off_cylinder(x[:, [0, 2, 1]]))
    assert off.max() < EXACT


def test_ellipsoid_and_elliptic_tube_are_exact():
    """Surfaces of second degree; the rims of the tube are no circles, and their nodes lie on it all the same."""
    axes = np.array([1, 0.7, 0.5])
    points, triangles = shapes.sphere(12)
    _, off = rebuilt(points * axes, triangles, lambda x: shapes.off_sphere(x / axes))
    assert off.max() < 1e-12
    points, triangles = shapes.cylinder(64, 20)
    _, off = rebuilt(points * [1, 0.6, 1], triangles, lambda x: shapes.off_cylinder(x / [1, 0.6, 1]))
    assert off.max() < 1e-12


def test_oblique_ends_stay_in_their_planes():
    points, triangles = shapes.cylinder(64, 20)
    points[:, 2] += 0.3 * points[:, 0]
    found, off = rebuilt(points, triangles, shapes.off_cylinder)
    border = found.midpoints[found.sheets.kept]
    height = border[:, 2] - 0.3 * border[:, 0]
    assert off.max() < EXACT
    assert np.abs(height - 2 * (height > 1)).max() < EXACT


COMPOSITES = {
    "can": (shapes.can, shapes.off_can, 0.1, EXACT),
    "capsule": (shapes.capsule, shapes.off_capsule, 0.1, 1e-8),
    "tee": (shapes.tee, shapes.off_tee, 0.1, 1e-6),
    "cone on a tube": (shapes.cone, shapes.off_cone, 0.1, EXACT),
    "rounded box": (shapes.rounded_box, shapes.off_rounded_box, 0.05, 1e-6),
}


@pytest.mark.parametrize("name", COMPOSITES)
def test_composites(name):
    """Flat ends, jumps of curvature, a sharp junction, a gentle crease: chords are off by 2e-3 to 3e-3."""
    build, off, size, allowed = COMPOSITES[name]
    points, triangles = shapes.by_gmsh(build, size)
    mesh = ks.Mesh.from_arrays(points, triangles)
    assert np.abs(off(mesh.points[mesh.edges].mean(axis=1))).max() > 1e-3
    found = rebuild(mesh)
    assert np.abs(off(found.midpoints)).max() < allowed
    ks.Mesh.from_arrays(points, triangles, midpoints=found.midpoints)


@pytest.mark.parametrize("over_flat", [1, 2, 3])
@pytest.mark.parametrize("along", [1, 4])
def test_dented_plate(over_flat, along):
    _, off = rebuilt(*shapes.dented_plate(over_flat, along), shapes.off_dented_plate)
    assert off.max() < EXACT


@pytest.mark.parametrize("over_flat", [1, 2, 3, 6])
@pytest.mark.parametrize("over_arc", [8, 16])
def test_stadium_tube(over_flat, over_arc):
    """A tangent flat one cell wide has no inner vertex and looks like a facet, but a wide one."""
    found, off = rebuilt(*shapes.stadium(over_flat, over_arc, 4), shapes.off_stadium)
    assert off.max() < EXACT
    assert found.sheets.flat.sum() == 4 * 4 * over_flat


def test_coarse_fillets_are_told():
    """Three cells over a fillet: nodes are off by much, and the estimate says so."""
    mesh = ks.Mesh.from_arrays(*shapes.by_gmsh(shapes.rounded_box, 0.1))
    found = rebuild(mesh)
    off = np.abs(shapes.off_rounded_box(found.midpoints))[found.curved]
    assert off.max() > 1e-4
    assert found.estimate[found.curved].max() > 0.5 * off.max()
    curving = curve(mesh, np.full(len(mesh.triangles), 0.01)).curving
    assert any("stress" in words for words in curving.warnings)


@pytest.mark.parametrize("size", [0.2, 0.1])
def test_torus_is_no_quadric(size):
    """Quartic jets: below 2 % of the height of the arcs, and the estimate holds the error."""
    n = round(2 * np.pi / size)
    u, v = np.meshgrid(np.arange(2 * n) * np.pi / n, np.arange(n) * 2 * np.pi / n)
    u = u + 0.2 * np.sin(v)
    points = np.stack([(2 + np.cos(v)) * np.cos(u), (2 + np.cos(v)) * np.sin(u), np.sin(v)], axis=-1)
    i, j = np.meshgrid(np.arange(2 * n), np.arange(n))
    a, b = (j * 2 * n + i).ravel(), (j * 2 * n + (i + 1) % (2 * n)).ravel()
    c, d = ((j + 1) % n * 2 * n + i).ravel(), ((j + 1) % n * 2 * n + (i + 1) % (2 * n)).ravel()
    triangles = np.concatenate([np.stack([a, b, d], 1), np.stack([a, d, c], 1)])

    def off(x):
        return np.hypot(np.hypot(x[:, 0], x[:, 1]) - 2, x[:, 2]) - 1

    found, distance = rebuilt(points.reshape(-1, 3), triangles, off)
    assert distance.max() < 0.08 * size**2 / 8 * (size / 0.2) ** 2
    assert found.estimate.max() > distance.max()


def test_prism_meant_as_such():
    """A mast of 18 sides, one cell each, becomes round by itself, which is said; two keys keep its folds."""
    points, triangles = shapes.cylinder(18, 6)
    mesh, thickness = ks.Mesh.from_arrays(points, triangles), np.full(len(triangles), 0.01)
    round_one = curve(mesh, thickness)
    assert np.abs(shapes.off_cylinder(round_one.midpoints)).max() < EXACT
    assert any("20 degrees" in words and 'facets = "flat"' in words for words in round_one.curving.warnings)
    assert "moved" in round_one.notes[-1]
    assert curve(mesh, thickness, facets="flat").midpoints is None
    assert curve(mesh, thickness, crease=19.0).midpoints is None


def test_sides_at_the_angle_of_a_crease_stay():
    """A tube of 12 sides stays one, with a word about it; crease = 35 makes it round."""
    points, triangles = shapes.cylinder(10, 6)
    mesh, thickness = ks.Mesh.from_arrays(points, triangles), np.full(len(triangles), 0.01)
    kept = curve(mesh, thickness)
    assert kept.midpoints is None
    assert any("taken as folds" in words for words in kept.curving.warnings)
    assert np.abs(shapes.off_cylinder(curve(mesh, thickness, crease=40.0).midpoints)).max() < EXACT


def test_flat_sheets_and_boxes_stay_as_they_are():
    fold = shapes.sheet(np.linspace(-1, 1, 9), np.linspace(0, 1, 5), np.abs)
    for points, triangles in (fold, shapes.by_gmsh(lambda occ: occ.addBox(0, 0, 0, 1, 1, 1), 0.3)):
        mesh = ks.Mesh.from_arrays(points, triangles)
        kept = curve(mesh, np.full(len(triangles), 0.01))
        assert kept.midpoints is None
        assert kept.curving.order == 3
        assert not kept.curving.warnings


@pytest.mark.parametrize(("part", "order"), [(1e-5, 3), (1e-4, 2), (1e-2, 1)])
def test_noise_decides(part, order):
    """Vertices of a sphere of R / t = 500 moved by a part of the size of the triangles."""
    points, triangles = shapes.sphere(16)
    noise = np.random.default_rng(1).uniform(-1, 1, points.shape) * part * 0.1
    mesh = ks.Mesh.from_arrays(points + noise, triangles)
    taken = curve(mesh, np.full(len(triangles), 0.002))
    assert taken.curving.order == order
    assert (taken.midpoints is None) == (order == 1)
    assert bool(taken.curving.warnings) == (order < 3)
    assert curve(mesh, np.full(len(triangles), 0.002), facets="curved").midpoints is not None


def test_estimate_holds_the_error_of_noise():
    points, triangles = shapes.sphere(16)
    noise = np.random.default_rng(2).uniform(-1, 1, points.shape) * 1e-4
    found, off = rebuilt(points + noise, triangles, shapes.off_sphere)
    ratio = np.sqrt((found.estimate**2).mean()) / np.sqrt((off**2).mean())
    assert 0.5 < ratio < 4


def test_answer_turns_and_grows_with_the_mesh():
    points, triangles = shapes.stadium(2, 8, 4)
    turn = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    one = rebuild(ks.Mesh.from_arrays(points, triangles)).midpoints
    for scale in (1e-9, 1.0, 1e6):
        moved = rebuild(ks.Mesh.from_arrays(scale * points @ turn, triangles)).midpoints
        assert np.abs(moved - scale * one @ turn).max() < 1e-12 * scale
