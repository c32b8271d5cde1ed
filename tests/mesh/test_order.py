"""Renumbering along Morton's curve: the same mesh, with near numbers for near vertices."""

import numpy as np

from kshell.mesh.mesh import Group, Mesh
from kshell.mesh.order import in_spatial_order, spatial_order


def shuffled(n: int) -> Mesh:
    """Square of n x n cells with vertices and triangles in random order, and groups of each dimension."""
    x, y = np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0), indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1)
    i = np.arange(x.size).reshape(x.shape)
    a, b, c, d = i[:-1, :-1].ravel(), i[1:, :-1].ravel(), i[1:, 1:].ravel(), i[:-1, 1:].ravel()
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    rng = np.random.default_rng(0)
    number = rng.permutation(len(points))
    moved = np.empty_like(points)
    moved[number] = points
    plain = Mesh(moved, number[rng.permutation(triangles)].astype(np.int32))
    ends = plain.points[plain.edges]
    groups = {
        "corner": Group(0, number[[0]].astype(np.int32)),
        "left": Group(1, np.flatnonzero((ends[..., 0] == 0).all(axis=1)).astype(np.int32)),
        "low": Group(
            2, np.flatnonzero(plain.points[plain.triangles][..., 1].mean(axis=1) < 1).astype(np.int32)
        ),
    }
    return Mesh(plain.points, plain.triangles, ends.mean(axis=1), groups)


def test_same_mesh():
    old = shuffled(12)
    new, order = in_spatial_order(old)
    assert np.array_equal(new.points, old.points[order])

    def corners(mesh):
        at = mesh.points[mesh.triangles][..., :2]
        return sorted(map(str, at[np.arange(len(at))[:, None], np.lexsort(at.T, axis=0).T].tolist()))

    assert corners(new) == corners(old)
    assert np.allclose(new.midpoints, new.points[new.edges].mean(axis=1))
    assert np.allclose(new.areas, 0.5)
    assert np.array_equal(new.points[new.groups["corner"].members], [[0, 0, 0]])
    left = new.points[new.edges[new.groups["left"].members]]
    assert len(left) == 12
    assert not left[..., 0].any()
    low = new.points[new.triangles[new.groups["low"].members]][..., 1].mean(axis=1)
    assert len(low) == 24
    assert low.max() < 1


def test_orientation_is_kept():
    old = shuffled(6)
    new, _ = in_spatial_order(old)
    for mesh in (old, new):
        a, b, c = (mesh.points[mesh.triangles[:, k]] for k in range(3))
        assert (np.cross(b - a, c - a)[:, 2] > 0).all()


def test_neighbours_are_near():
    old = shuffled(40)
    new, _ = in_spatial_order(old)
    assert np.abs(np.diff(new.edges)).mean() < 0.1 * np.abs(np.diff(old.edges)).mean()


def test_no_points():
    assert len(spatial_order(np.zeros((0, 2)))) == 0


def test_large_files_are_read_in_spatial_order_and_small_ones_as_they_are(tmp_path, monkeypatch):
    from kshell.mesh import read
    from kshell.mesh.write import write_msh

    old = shuffled(6)
    write_msh(old, tmp_path / "plate.msh")
    small = read.read_mesh(tmp_path / "plate.msh")
    monkeypatch.setattr(read, "LARGE", 10)
    large = read.read_mesh(tmp_path / "plate.msh")
    assert np.array_equal(large.points[:, :2][spatial_order(large.points)], large.points[:, :2])
    assert not np.array_equal(large.points, small.points)
    assert {name: len(group.members) for name, group in large.groups.items()} == {
        name: len(group.members) for name, group in small.groups.items()
    }
