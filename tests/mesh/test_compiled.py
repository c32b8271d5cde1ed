"""The compiled loops of meshes make what those of numpy make, number by number."""

import numpy as np
import pytest

from kshell.mesh import kernels
from kshell.mesh.connected import connected_parts
from kshell.mesh.triangulation import Triangulation
from kshell.verify.cases import meshes

built = pytest.mark.skipif(kernels.compiled is None, reason="kshell was installed without a C compiler")


def scattered(count, vertices, seed=0):
    """Triangles between any vertices: edges of many triangles, vertices of none."""
    random = np.random.default_rng(seed)
    return np.array([random.permutation(vertices)[:3] for _ in range(count)], dtype=np.int32).reshape(-1, 3)


def fan(count):
    """Triangles around one vertex that has the highest number, or the lowest."""
    rim = np.arange(count)
    turned = np.stack([np.full(count, count), rim, (rim + 1) % count], axis=1)
    return np.concatenate([turned, 2 * count - turned]).astype(np.int32)


SETS = {
    "none": (scattered(0, 4), 4),
    "one": (scattered(1, 9), 9),
    "square": (np.asarray(meshes.grid(3, 4)[1], dtype=np.int32), 20),
    "scattered": (scattered(300, 40), 45),
    "fans": (fan(50), 101),
}


def table(triangles, vertices):
    found = Triangulation(np.zeros((vertices, 3)), triangles).edge_table
    return found.edges, found.of_triangles, found.counts, found.sides


@built
@pytest.mark.parametrize("name", SETS)
def test_edges(monkeypatch, name):
    fast = table(*SETS[name])
    monkeypatch.setattr(kernels, "compiled", None)
    for one, other in zip(fast, table(*SETS[name]), strict=True):
        np.testing.assert_array_equal(one, other)
        assert one.dtype == other.dtype


@pytest.mark.parametrize("compiled", [False, pytest.param(True, marks=built)])
@pytest.mark.parametrize("name", [name for name in SETS if name != "none"])
def test_the_table_is_that_of_its_triangles(monkeypatch, name, compiled):
    if not compiled:
        monkeypatch.setattr(kernels, "compiled", None)
    triangles, vertices = SETS[name]
    edges, of_triangles, counts, sides = table(triangles, vertices)
    ends = np.sort(triangles[:, [[0, 1], [1, 2], [0, 2]]], axis=2)
    np.testing.assert_array_equal(edges[of_triangles], ends)
    np.testing.assert_array_equal(edges, np.unique(ends.reshape(-1, 2), axis=0))
    places = [np.flatnonzero(of_triangles.ravel() == edge) for edge in range(len(edges))]
    np.testing.assert_array_equal(counts, [len(at) for at in places])
    np.testing.assert_array_equal(sides.T, [(at[0], at[-1]) for at in places])


@built
@pytest.mark.parametrize("links", [0, 5, 40, 200])
def test_parts(monkeypatch, links):
    random = np.random.default_rng(links)
    pairs = random.integers(0, 90, (2, links)).astype(np.int32)
    number, part = connected_parts(90, *pairs)
    monkeypatch.setattr(kernels, "compiled", None)
    expected, label = connected_parts(90, *pairs)
    assert number == expected
    np.testing.assert_array_equal(part, label)
    assert part.dtype == label.dtype


@built
@pytest.mark.parametrize("wrong", [-1, 4])
def test_numbers_that_are_none_are_refused(wrong):
    with pytest.raises(IndexError, match="none of 0 to 3"):
        table(np.array([[0, 1, wrong]], dtype=np.int32), 4)
    with pytest.raises(IndexError, match="none of 0 to 3"):
        connected_parts(4, np.array([0]), np.array([wrong]))
