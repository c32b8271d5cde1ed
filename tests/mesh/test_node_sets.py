"""What sets of nodes are taken as: points, lines along the border or inside, regions."""

from __future__ import annotations

import meshio
import numpy as np
import pytest

from kshell.errors import InputError
from kshell.mesh import check, read_mesh, select
from tests.mesh.mesh_samples import square

N = 6  # cells of the square along each side


def kinds(where, cell="triangle"):
    """Kind and measure (number of points) of the group made of the nodes at which `where(x, y)` holds."""
    mesh = square(N)
    x, y = np.round(N * mesh.points[:, :2].T).astype(int)
    nodes = np.flatnonzero(where(x, y))
    corner = (np.arange(N)[:, None] * (N + 1) + np.arange(N)).ravel()
    cells = mesh.triangles if cell == "triangle" else corner[:, None] + np.array([0, 1, N + 2, N + 1])
    read = read_mesh(meshio.Mesh(mesh.points, [(cell, cells)], point_sets={"set": nodes}))
    measures = {group.name: group.measure for group in check.summary(read).groups}
    return {
        name: (group.kind, len(group.members) if group.dimension == 0 else pytest.approx(measures[name]))
        for name, group in read.groups.items()
    }


@pytest.mark.parametrize("cell", ["triangle", "quad"])
def test_lines_and_points(cell):
    assert kinds(lambda x, y: x == 0, cell) == {"set": ("curve", 1.0)}
    assert kinds(lambda x, y: (x == 0) | (x == N), cell) == {"set": ("curve", 2.0)}
    assert kinds(lambda x, y: (x == 3) & (y == 2), cell) == {"set": ("point", 1)}
    assert kinds(lambda x, y: x == 3, cell) == {"set": ("curve", 1.0)}  # as a stiffener
    assert kinds(lambda x, y: (x == 3) & (y > 0) & (y < N), cell) == {"set": ("curve", 4 / 6)}
    assert kinds(lambda x, y: (x % N == 0) & (y % N == 0), cell) == {"set": ("point", 4)}


@pytest.mark.parametrize("cell", ["triangle", "quad"])
def test_border_and_inside_at_once(cell):
    assert kinds(lambda x, y: (x == 0) | (y == 3), cell) == {"set": ("curve", 2.0)}
    assert kinds(lambda x, y: (x == 0) | ((x == 3) & (y == 3)), cell) == {
        "set (curve)": ("curve", 1.0), "set (point)": ("point", 1),
    }  # fmt: skip


def test_corners_of_lines_keep_no_chord():
    # at (3, 3) the triangles have an edge from (2, 2) to (3, 3): the line from (3, 3) turns over (2, 3) or (3, 2)
    assert kinds(lambda x, y: ((x == 3) & (y <= 3)) | ((y == 3) & (x >= 3))) == {"set": ("curve", 1.0)}
    assert kinds(lambda x, y: ((x == 3) & (y >= 3)) | ((y == 3) & (x >= 3))) == {"set": ("curve", 1.0)}
    assert kinds(lambda x, y: ((x == 3) & (y <= 3)) | ((y == 3) & (x <= 3))) == {"set": ("curve", 1.0)}


@pytest.mark.parametrize("cell", ["triangle", "quad"])
def test_regions(cell):
    assert kinds(lambda x, y: x >= 0, cell) == {"set": ("surface", 1.0)}
    assert kinds(lambda x, y: x <= 2, cell) == {"set": ("surface", 1 / 3)}
    assert kinds(lambda x, y: (x >= 2) & (x <= 3) & (y >= 2) & (y <= 4), cell) == {"set": ("surface", 2 / 36)}
    # a patch with a line that leaves it and a point beside
    patch = kinds(
        lambda x, y: ((x >= 1) & (x <= 3) & (y >= 1) & (y <= 3)) | ((y == 2) & (x > 2) & (x < 6)), cell
    )
    assert patch["set (surface)"] == ("surface", 4 / 36)
    assert patch["set (curve)"] == ("curve", 2 / 6)


def test_the_diagonal_of_a_quadrilateral_is_no_line():
    assert kinds(lambda x, y: (x == y) & (x >= 2) & (x <= 3), "quad") == {"set": ("point", 2)}
    assert kinds(lambda x, y: (x == y) & (x >= 2) & (x <= 3)) == {
        "set": ("curve", pytest.approx(np.sqrt(2) / 6))
    }


def test_nodes_of_no_cell_make_the_group_unusable():
    mesh = square(2)
    points = np.concatenate([mesh.points, [[5.0, 5.0, 0.0]]])
    read = read_mesh(meshio.Mesh(points, [("triangle", mesh.triangles)], point_sets={"left": [0, 3, 6, 9]}))
    assert read.groups["left"].kind == "curve"
    assert read.groups["left"].lost == 1
    with pytest.raises(InputError, match=r"1 cell of group 'left'.*belong to no triangle"):
        select(read, "left")


def test_names_lose_their_padding():
    mesh = square(2)
    read = read_mesh(
        meshio.Mesh(mesh.points, [("triangle", mesh.triangles)], point_sets={" left   ": [0, 3, 6]})
    )
    assert list(read.groups) == ["left"]
