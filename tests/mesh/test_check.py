"""Each fault of a mesh is named with its place and its mending."""

from __future__ import annotations

import numpy as np
import pytest

from kshell.errors import InputError
from kshell.mesh import Mesh, check, read_mesh, select
from tests.mesh.mesh_samples import msh2_text, square

TWO = [[0, 1, 2], [1, 3, 2]]
UNIT = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]
# two unit squares side by side that share no vertices
APART = [*UNIT, [1, 0, 0], [2, 0, 0], [1, 1, 0], [2, 1, 0]]
APART_CELLS = [*TWO, [4, 5, 6], [5, 7, 6]]

CELLS = {
    "order 3 of four sides": (
        ["36 1 " + " ".join("1234" * 4)],
        "1 quadrilaterals of order 3 or higher.*ElementOrder = 2",
    ),
    "tetrahedra": (["4 1 1 2 3 5", "2 1 1 2 3"], "1 solid cells.*midsurface"),
    "lines only": (["1 1 1 2", "1 1 2 4"], "2 line cells but no triangles.*Physical Surface"),
    "points only": (["15 1 1"], "no triangles"),
    "order 5": (["25 1 " + " ".join("123" * 7)], "order 5 or higher.*ElementOrder = 2"),
}


@pytest.mark.parametrize("case", CELLS)
def test_cells_that_are_no_triangles(tmp_path, case):
    cells, message = CELLS[case]
    path = tmp_path / "cells.msh"
    path.write_text(msh2_text([*map(tuple, UNIT), (0, 0, 1)], cells), encoding="utf-8")
    with pytest.raises(InputError, match=message):
        read_mesh(path)


FAULTS = {
    "no area": (
        [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0]],
        [[0, 1, 2], [0, 1, 3]],
        r"without area, e\.g\. triangle 0 at \(1, 0\)",
    ),
    "corner twice": (UNIT, [[0, 1, 1], *TWO], r"same corner twice, e\.g\. triangle 0 at \(0, 0\)"),
    "not a number": ([*UNIT[:3], [1, np.nan, 0]], TWO, "not finite numbers, e.g. node 3"),
    "infinite": ([*UNIT[:3], [1, np.inf, 0]], TWO, "not finite numbers"),
    "unmerged parts": (APART, APART_CELLS, r"2 pairs of vertices at the same place.*\(1, 0\).*Coherence"),
    "torn": (
        [*UNIT, [0.5, 0.5, 0], [0.5, 0.5, 0]],
        [[0, 1, 4], [1, 3, 4], [3, 2, 4], [2, 0, 5]],
        r"1 pair of vertices at the same place.*\(0\.5, 0\.5\)",
    ),
    "hanging node": (
        [*UNIT, [1, 0.5, 0], [2, 0, 0], [2, 1, 0]],
        [*TWO, [1, 5, 4], [5, 6, 4], [4, 6, 3]],
        r"hanging node: the vertex at \(1, 0\.5\).*from \(1, 0\) to \(1, 1\)",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", FAULTS)
def test_faults(case):
    points, triangles, message = FAULTS[case]
    with pytest.raises(InputError, match=message):
        Mesh.from_arrays(points, triangles)


def test_a_slit_with_named_sides_is_meant():
    """The annulus cut open: its two ends lie at the same place and are named."""
    n = 8
    turn = np.linspace(0, 2 * np.pi, n + 1)
    ring = np.column_stack([np.cos(turn), np.sin(turn)])
    points = np.concatenate([ring, 2 * ring])
    k = np.arange(n)
    cells = np.concatenate(
        [np.column_stack([k, n + 1 + k, k + 1]), np.column_stack([k + 1, n + 1 + k, n + 2 + k])]
    )
    ends = {"start": [[0, n + 1]], "end": [[n, 2 * n + 1]]}
    mesh = Mesh.from_arrays(points, cells, ends)
    assert mesh.notes[0].startswith("slit: 2 pairs of vertices")
    assert len(mesh.points) == 2 * (n + 1)
    with pytest.raises(InputError, match="give each of its two sides a named physical curve"):
        Mesh.from_arrays(points, cells, {"start": ends["start"]})


@pytest.mark.parametrize("height", [1e-3, 1e-5, 1e-7])
def test_thin_triangles_are_no_hanging_nodes(height):
    mesh = Mesh.from_arrays([[0, 0], [1, 0], [0.5, height], [0.5, 1]], [[0, 1, 2], [0, 2, 3], [1, 3, 2]])
    assert mesh.notes == ()
    alone = Mesh.from_arrays([[0, 0], [1, 0], [0.5, height]], [[0, 1, 2]])  # all vertices on the boundary
    assert alone.notes == ()


def test_the_two_sides_of_a_slit_may_be_meshed_differently():
    points = [[0, 0], [2, 0], [1, -1], [0, 0], [1, 0], [1, 1], [3, 0]]
    cells = [[0, 2, 1], [3, 4, 5], [4, 1, 5], [1, 2, 6], [1, 6, 5]]
    sides = {"below": [[0, 1]], "above": [[3, 4], [4, 1]]}
    assert Mesh.from_arrays(points, cells, sides).notes == (
        "slit: 1 pair of vertices at the same place, e.g. at (0, 0)",
    )
    points[3] = [-0.5, 0]  # now only the middle of the upper side touches the lower one
    Mesh.from_arrays(points, cells, sides)
    with pytest.raises(InputError, match=r"2 hanging nodes: the vertex at \(1, 0\)"):
        Mesh.from_arrays(points, cells, {"below": sides["below"]})


def test_parts_that_are_not_connected_are_said():
    far = np.array(APART, dtype=float)
    far[4:, 0] += 1
    mesh = Mesh.from_arrays(far, APART_CELLS)
    assert any("2 parts that are not connected" in note for note in mesh.notes)


def test_parts_joined_by_one_vertex_are_said():
    mesh = Mesh.from_arrays([*UNIT, [2, 1, 0], [1, 2, 0]], [*TWO, [3, 4, 5]])
    assert any("single vertices only, e.g. at (1, 1)" in note for note in mesh.notes)


def order_2(middle_of_diagonal=(0.5, 0.5, 0.0)):
    middles = [(0.5, 0, 0), middle_of_diagonal, (0, 0.5, 0), (1, 0.5, 0), (0.5, 1, 0)]
    return [*UNIT, *middles], [[0, 1, 2, 4, 5, 6], [1, 3, 2, 7, 8, 5]]


def test_order_2_is_kept():
    points, cells = order_2((0.55, 0.55, 0))
    mesh = Mesh.from_arrays(points, cells)
    assert mesh.order == 2
    np.testing.assert_allclose(mesh.midpoints[mesh.edge_index([[1, 2]])[0]], [0.55, 0.55, 0])


def test_order_2_turned_inside_out():
    points, cells = order_2((0.1, 0.1, 0))
    with pytest.raises(InputError, match=r"turned inside out.*HighOrderOptimize"):
        Mesh.from_arrays(points, cells)


def test_order_2_torn_at_an_edge():
    points, cells = order_2()
    cells[1][5] = 9
    with pytest.raises(InputError, match=r"different mid-edge nodes, 0\.1.* apart"):
        Mesh.from_arrays([*points, [0.6, 0.6, 0]], cells)


def test_order_2_hanging_on_a_mid_edge_node():
    points, cells = order_2()
    points += [[2, 0, 0], [1.5, 0, 0], [1.5, 0.25, 0], [1, 0.25, 0]]
    cells.append([1, 9, 7, 10, 11, 12])
    with pytest.raises(
        InputError, match=r"node at \(1, 0\.5\) is a corner of one triangle and a mid-edge node"
    ):
        Mesh.from_arrays(points, cells)


def test_group_that_lies_off_the_surface(tmp_path):
    """A curve that is not embedded would act on a part of itself only: using it is an error, reading is "
    "not."""
    names = '$PhysicalNames\n2\n0 8 "hub"\n1 7 "rib"\n$EndPhysicalNames\n'
    points = [*map(tuple, UNIT), (2, 2, 0)]
    path = tmp_path / "lost.msh"
    path.write_text(
        msh2_text(points, ["2 1 1 2 3", "2 1 2 4 3", "1 7 1 2", "1 7 1 4", "15 8 5"], names), encoding="utf-8"
    )
    mesh = read_mesh(path)
    assert any("group 'rib': 1 of its 2 curve cells" in note for note in mesh.notes)
    with pytest.raises(InputError, match=r"1 cell of group 'rib'.*`Curve.5. In Surface"):
        select(mesh, "rib")
    with pytest.raises(InputError, match=r"1 cell of group 'hub'.*`Point.5. In Surface"):
        select(mesh, "hub")


PLATES = {
    "curved": (lambda x, y: (x, y, 0.1 * x * y), r"not planar.*up to 0\.\d+ off the best plane.*\(.*shell"),
    "vertical": (
        lambda x, y: (0 * x + 2, x, y),
        r"plane x = 2, but a plate lies in a plane z = const.*Rotate",
    ),
    "tilted": (lambda x, y: (x, y, x), r"lies in the plane -?0\.7071 x"),
}


@pytest.mark.parametrize("case", PLATES)
def test_what_is_no_plate(case):
    place, message = PLATES[case]
    flat = square(3)
    mesh = Mesh.from_arrays(np.column_stack(place(flat.points[:, 0], flat.points[:, 1])), flat.triangles)
    with pytest.raises(InputError, match=message):
        check.plate_problems(mesh)


@pytest.mark.parametrize("normal", [(1, 0, 0), (0, 1, 0), (1, 2, 3), (-2, 1, 0.1)])
def test_the_rotation_that_is_advised_makes_a_plate(normal):
    import re

    from scipy.spatial.transform import Rotation

    flat = square(3)
    tilt = Rotation.align_vectors([np.array(normal) / np.linalg.norm(normal)], [[0, 0, 1]])[0]
    points = tilt.apply(flat.points) + np.array([3.0, -1.0, 2.0])
    with pytest.raises(InputError) as caught:
        check.plate_problems(Mesh.from_arrays(points, flat.triangles))
    axis, about, angle = re.search(r"Rotate \{\{(.*?)\}, \{(.*?)\}, (.*?)\}", str(caught.value)).groups()
    axis, about = (np.array([float(c) for c in text.split(",")]) for text in (axis, about))
    turned = Rotation.from_rotvec(axis / np.linalg.norm(axis) * float(angle)).apply(points - about) + about
    assert np.ptp(turned[:, 2]) < 1e-4


def test_branches_are_for_shells_only():
    points = [[0, 0, 0], [0, 1, 0], [1, 0, 0], [-1, 0, 0], [1, 1, 0]]
    mesh = Mesh.from_arrays(points, [[0, 1, 2], [0, 1, 3], [0, 1, 4]])
    with pytest.raises(InputError, match=r"shared by more than two triangles, e\.g\. at \(0, 0\.5\)"):
        check.plate_problems(mesh)


def test_a_plate_anywhere_along_z():
    flat = square(3, order=2)
    check.plate_problems(flat)
    check.plate_problems(Mesh.from_arrays(flat.points + np.array([0, 0, 5.0]), flat.triangles))


WRONG_ARRAYS = {
    "points": (([0, 1, 2], [[0, 1, 2]]), "points must be an array"),
    "triangles": ((UNIT, [[0, 1]]), "triangles must be an array"),
    "floats": ((UNIT, [[0.0, 1.0, 2.0]]), "must be integer"),
    "index": ((UNIT, [[0, 1, 7]]), "names vertex 7, but there are vertices 0 to 3"),
    "negative": ((UNIT, [[0, 1, -2]]), "names vertex -2"),
    "none": ((UNIT, []), "has no triangles"),
    "group edge": ((UNIT, TWO, {"a": [[0, 3]]}), "group 'a': 1 entry are no edges|group 'a': 1 entry"),
    "group triangle": ((UNIT, TWO, {"a": [[0, 1, 3]]}), r"\[0, 1, 3\] is no triangle"),
    "group index": ((UNIT, TWO, {"a": [9]}), "group 'a' names a vertex outside"),
    "group shape": ((UNIT, TWO, {"a": [[0, 1, 2, 3]]}), "group 'a' must be an array"),
    "midpoints": ((UNIT, TWO, None, [[0, 0, 0]]), r"of shape \(5, 3\)"),
}


@pytest.mark.parametrize("case", WRONG_ARRAYS)
def test_wrong_arrays(case):
    arguments, message = WRONG_ARRAYS[case]
    with pytest.raises(InputError, match=message):
        Mesh.from_arrays(*arguments)


def test_midpoints_by_edge_or_by_triangle():
    points, cells = order_2((0.55, 0.55, 0))
    by_triangle = Mesh.from_arrays(points, cells)
    by_edge = Mesh.from_arrays(UNIT, TWO, midpoints=by_triangle.midpoints)
    np.testing.assert_array_equal(by_edge.midpoints, by_triangle.midpoints)
    np.testing.assert_array_equal(by_edge.triangles, by_triangle.triangles)
