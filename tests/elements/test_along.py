"""Line forces from nodal forces along chains of edges."""

import numpy as np
import pytest

from kshell.elements.along import ChainFunctions, chains, turns
from kshell.elements.quadrature import interval_rule
from tests.plate.plates import rectangle

MESH = rectangle(4, 3)


@pytest.fixture
def boundary():
    edges = MESH.boundary_edges.astype(np.int64)
    ends = MESH.points[MESH.edges[edges]]
    t = ends[:, 1] - ends[:, 0]
    t /= np.linalg.norm(t, axis=1, keepdims=True)
    return edges, turns(MESH, edges, np.repeat(t[:, None], 2, axis=1), np.cos(0.1))


def test_a_boundary_is_divided_at_its_corners(boundary):
    edges, stops = boundary
    assert stops.sum() == 4
    found = chains(MESH, edges, stops)
    assert sorted(len(c.edges) for c in found) == [3, 3, 4, 4]
    for chain in found:
        assert {tuple(sorted(p)) for p in zip(chain.vertices[:-1], chain.vertices[1:], strict=True)} == {
            tuple(sorted(MESH.edges[e])) for e in chain.edges
        }
    (whole,) = chains(MESH, edges, np.zeros_like(stops))
    assert whole.closed
    assert len(whole.edges) == 14


@pytest.mark.parametrize("degree", [1, 2, 3, 4])
@pytest.mark.parametrize("closed", [False, True])
def test_there_are_as_many_functions_as_nodes_that_are_no_ends(boundary, degree, closed):
    edges, stops = boundary
    stops = stops & (not closed)
    found = chains(MESH, edges, stops)
    functions = ChainFunctions(MESH, found, degree, stops)
    assert functions.count == 14 * degree - (0 if closed else 4)
    # constants are among them
    s = interval_rule(6)[0]
    one = np.linalg.lstsq(
        functions.at(np.eye(functions.count), s).reshape(-1, functions.count), np.ones(14 * 6), rcond=None
    )[0]
    assert functions.at(one, s) == pytest.approx(1.0)


def test_a_single_edge_between_ends_of_degree_one_has_no_function():
    edges = MESH.boundary_edges[:1].astype(np.int64)
    stops = np.zeros(len(MESH.points), dtype=bool)
    for degree, count in ((1, 0), (2, 1), (3, 2), (4, 3)):
        functions = ChainFunctions(MESH, chains(MESH, edges, stops), degree, stops)
        assert functions.count == count
