"""Orientation, numbering and groups do not depend on how the source numbers its nodes and cells."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kshell.errors import InputError
from kshell.mesh import Mesh
from tests.mesh.mesh_samples import group_places, square, triangle_set

FIXED = settings(max_examples=25, derandomize=True, deadline=None)


def as_arrays(mesh: Mesh) -> tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]:
    cells = (np.arange(len(mesh.points)), mesh.edges, mesh.triangles)
    groups = {name: cells[group.dimension][group.members] for name, group in mesh.groups.items()}
    triangles = mesh.triangles.copy()
    points = mesh.points.copy()
    if mesh.midpoints is not None:
        triangles = np.concatenate([triangles, len(points) + mesh.triangle_edges], axis=1)
        points = np.concatenate([points, mesh.midpoints])
    return points, triangles, groups


def bent(mesh: Mesh) -> Mesh:
    """The square rolled into a third of a cylinder, so that it is not planar."""
    points, triangles, groups = as_arrays(mesh)
    angle = 2 * points[:, 0]
    return Mesh.from_arrays(np.column_stack([np.sin(angle), points[:, 1], np.cos(angle)]), triangles, groups)


@FIXED
@given(seed=st.integers(0, 10**6), order=st.sampled_from([1, 2]), roll=st.booleans())
def test_renumbering_changes_nothing(seed, order, roll):
    mesh = bent(square(3, order)) if roll else square(3, order)
    points, triangles, groups = as_arrays(mesh)
    rng = np.random.default_rng(seed)
    new_number = rng.permutation(len(points))
    shuffled = np.empty_like(points)
    shuffled[new_number] = points
    cells = new_number[triangles][rng.permutation(len(triangles))]
    turns = rng.integers(0, 3, len(cells))  # which corner comes first
    for k in (1, 2):
        cells[turns == k, :3] = np.roll(cells[turns == k, :3], k, axis=1)
        cells[turns == k, 3:] = np.roll(cells[turns == k, 3:], k, axis=1)
    other = Mesh.from_arrays(shuffled, cells, {name: new_number[nodes] for name, nodes in groups.items()})
    assert group_places(other) == group_places(mesh)
    assert other.areas.sum() == pytest.approx(mesh.areas.sum(), rel=1e-13)
    if order == 2:
        places = {tuple(row) for row in np.round(mesh.midpoints, 9).tolist()}
        assert {tuple(row) for row in np.round(other.midpoints, 9).tolist()} == places


def normals(mesh: Mesh) -> np.ndarray:
    a, b, c = (mesh.points[mesh.triangles[:, k]] for k in range(3))
    return np.cross(b - a, c - a)


@FIXED
@given(seed=st.integers(0, 10**6), order=st.sampled_from([1, 2]))
def test_reversed_triangles_of_a_plane_are_turned_up(seed, order):
    mesh = square(4, order)
    points, triangles, groups = as_arrays(mesh)
    which = np.random.default_rng(seed).random(len(triangles)) < 0.5
    swapped = [0, 2, 1] if order == 1 else [0, 2, 1, 5, 4, 3]
    triangles[which] = triangles[which][:, swapped]
    other = Mesh.from_arrays(points, triangles, groups)
    assert (normals(other)[:, 2] > 0).all()
    if which.any():
        assert f"{which.sum()} of 32 triangles reversed" in other.notes[0]
    np.testing.assert_array_equal(other.triangle_edges, mesh_edges_anew(other))
    if order == 2:
        np.testing.assert_array_equal(other.midpoints, mesh.midpoints)


def mesh_edges_anew(mesh: Mesh) -> np.ndarray:
    """Edge numbers computed from the triangles alone."""
    return Mesh(mesh.points, mesh.triangles).triangle_edges


@FIXED
@given(seed=st.integers(0, 10**6), share=st.floats(0.0, 0.4))
def test_neighbours_agree_on_a_curved_surface(seed, share):
    """The minority is turned: the sheet keeps the side it had."""
    mesh = bent(square(4))
    points, triangles, _ = as_arrays(mesh)
    which = np.zeros(len(triangles), dtype=bool)
    which[np.random.default_rng(seed).permutation(len(triangles))[: int(share * len(triangles))]] = True
    triangles[which] = triangles[which][:, [0, 2, 1]]
    other = Mesh.from_arrays(points, triangles)
    assert (np.sum(normals(other) * normals(mesh), axis=1) > 0).all()
    assert len(other.notes) == int(which.any())


def test_sheets_are_oriented_one_by_one():
    """Three sheets at one edge: each keeps its own side, none can agree with both others."""
    points = [[0, 0, 0], [0, 1, 0], [1, 0, 0], [-1, 0, 0], [0, 0, 1], [1, 1, 0]]
    mesh = Mesh.from_arrays(points, [[0, 1, 2], [0, 1, 3], [0, 1, 4], [5, 1, 2]])
    assert any("more than two triangles" in note for note in mesh.notes)
    np.testing.assert_array_equal(mesh.triangles[:3], [[0, 1, 2], [0, 1, 3], [0, 1, 4]])
    np.testing.assert_array_equal(mesh.triangles[3], [5, 2, 1])


def test_one_sided_surface():
    n = 12
    turn = np.arange(n) * 2 * np.pi / n
    middle = np.column_stack([np.cos(turn), np.sin(turn), 0 * turn])
    out = 0.3 * np.column_stack(
        [np.cos(turn) * np.cos(turn / 2), np.sin(turn) * np.cos(turn / 2), np.sin(turn / 2)]
    )
    points = np.concatenate([middle - out, middle + out])
    low, high = np.arange(n), np.arange(n) + n
    low_next, high_next = np.append(low[1:], high[0]), np.append(high[1:], low[0])  # closed with a half turn
    strip = np.concatenate(
        [np.column_stack([low, low_next, high]), np.column_stack([low_next, high_next, high])]
    )
    with pytest.raises(InputError, match=r"one-sided.*Cut it there"):
        Mesh.from_arrays(points, strip)


def test_folded_plane_names_the_place():
    mesh = square(2)
    points, triangles, _ = as_arrays(mesh)
    points[4] = [0.9, -0.4, 0.0]  # the middle vertex pulled past its neighbours
    with pytest.raises(InputError, match=r"folded over itself at \d+ of its edges, e\.g\. at \("):
        Mesh.from_arrays(points, triangles)


def test_copies_and_idle_nodes():
    points = [[0, 0], [5, 5], [1, 0], [0, 1], [1, 1]]
    mesh = Mesh.from_arrays(points, [[0, 2, 3], [3, 0, 2], [2, 4, 3]], {"part": [[2, 3, 0]]})
    assert len(mesh.triangles) == 2
    assert mesh.notes == (
        "1 copy of a triangle left out",
        "1 node of no triangle left out",
    )
    np.testing.assert_array_equal(mesh.points[:, :2], [[0, 0], [1, 0], [0, 1], [1, 1]])
    np.testing.assert_array_equal(mesh.groups["part"].members, [0])


def test_edges_are_the_facets_of_scikit_fem():
    import skfem
    from skfem.models.poisson import mass

    rng = np.random.default_rng(1)
    mesh = square(5)
    points, triangles, groups = as_arrays(mesh)
    number = rng.permutation(len(points))
    shuffled = np.empty_like(points)
    shuffled[number] = points
    mesh = Mesh.from_arrays(
        shuffled, number[triangles], {name: number[nodes] for name, nodes in groups.items()}
    )
    other = mesh.to_skfem()
    assert isinstance(other, skfem.MeshTri)
    np.testing.assert_array_equal(other.t.T, mesh.triangles)
    np.testing.assert_array_equal(other.facets.T, mesh.edges)
    np.testing.assert_array_equal(other.t2f.T, mesh.triangle_edges)
    np.testing.assert_array_equal(np.sort(other.boundary_facets()), mesh.boundary_edges)
    np.testing.assert_array_equal(other.boundaries["bottom"], mesh.groups["bottom"].members)
    np.testing.assert_array_equal(other.subdomains["lower"], mesh.groups["lower"].members)
    basis = skfem.Basis(other, skfem.ElementTriP1())
    assert mass.assemble(basis).sum() == pytest.approx(1.0, rel=1e-12)


def test_to_skfem_refuses_to_drop_z():
    with pytest.raises(InputError, match="not planar"):
        bent(square()).to_skfem()


def test_edge_owner_and_index():
    mesh = square(3)
    triangle, local = mesh.edge_owner.T
    np.testing.assert_array_equal(mesh.triangle_edges[triangle, local], np.arange(len(mesh.edges)))
    np.testing.assert_array_equal(mesh.edge_index(mesh.edges[:, ::-1]), np.arange(len(mesh.edges)))
    assert mesh.edge_index([[0, 15]]).tolist() == [-1]
    assert triangle_set(mesh) == triangle_set(Mesh.from_arrays(*as_arrays(mesh)[:2]))
