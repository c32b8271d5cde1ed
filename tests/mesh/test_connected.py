"""Parts of graphs and points in balls, against scipy's graphs and trees."""

import numpy as np
import pytest
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from kshell.mesh.connected import connected_parts
from kshell.mesh.near import in_balls


@pytest.mark.parametrize("links", [0, 5, 40, 200])
def test_parts_are_those_of_scipy(links):
    random = np.random.default_rng(links)
    for count in (1, 30, 100):
        first, second = random.integers(0, count, (2, links))
        graph = coo_matrix((np.ones(links), (first, second)), shape=(count, count))
        number, label = connected_components(graph, directed=False)
        found, of = connected_parts(count, first, second)
        assert found == number
        np.testing.assert_array_equal(of, label)


@pytest.mark.parametrize("shuffled", [False, True])
def test_long_chains(shuffled):
    chain = np.arange(2000)
    if shuffled:
        chain = np.random.default_rng(0).permutation(chain)
    number, of = connected_parts(2001, chain[:-1], chain[1:])
    assert number == 2
    np.testing.assert_array_equal(of, [0] * 2000 + [1])


@pytest.mark.parametrize("dimension", [1, 2, 3])
def test_balls_of_all_sizes(dimension):
    random = np.random.default_rng(dimension)
    points, centres = random.uniform(-1, 1, (300, 3)), random.uniform(-1.5, 1.5, (200, 3))
    points[:, dimension:] = centres[:, dimension:] = 0.3
    reach = 10 ** random.uniform(-4, 0, 200)
    reach[:3] = 0.0
    centres[:3] = points[:3]
    ball, point = in_balls(points, centres, reach)
    trees = cKDTree(points).query_ball_point(centres, reach)
    expected = [(k, i) for k, near in enumerate(trees) for i in sorted(near)]
    assert list(zip(ball.tolist(), point.tolist(), strict=True)) == expected


def test_no_points_and_no_balls():
    none, some = np.zeros((0, 3)), np.zeros((2, 3))
    assert [len(x) for x in in_balls(none, some, np.ones(2))] == [0, 0]
    assert [len(x) for x in in_balls(some, none, np.ones(0))] == [0, 0]
    assert [x.tolist() for x in in_balls(some, some, np.zeros(2))] == [[0, 0, 1, 1], [0, 1, 0, 1]]
