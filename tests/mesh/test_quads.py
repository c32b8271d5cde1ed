"""Quadrilaterals become triangles on reading; area, groups and curved sides stay."""

from __future__ import annotations

import meshio
import numpy as np
import pytest

from kshell.errors import InputError
from kshell.mesh import check, quads, read_mesh

SQUARE = """
SetFactory("OpenCASCADE");
Rectangle(1) = {0, 0, 0, 2, 1};
Physical Surface("plate") = {1}; Physical Surface("again") = {1}; Physical Curve("left") = {4};
Mesh.MeshSizeMax = 0.3; Mesh.RecombineAll = 1;
"""


def read_cell(corners, kind="quad"):
    points = np.array([[*p, 0.0][:3] for p in corners], dtype=float)
    return read_mesh(meshio.Mesh(points, [(kind, np.arange(len(points))[None])]))


@pytest.mark.parametrize("version", ["2.2", "4.1"])
@pytest.mark.parametrize("order", [1, 2])
def test_of_gmsh(tmp_path, version, order):
    import gmsh

    (tmp_path / "square.geo").write_text(SQUARE, encoding="utf-8")
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(tmp_path / "square.geo"))
        gmsh.model.mesh.generate(2)
        gmsh.model.mesh.setOrder(order)
        gmsh.option.setNumber("Mesh.MshFileVersion", float(version))
        gmsh.write(str(tmp_path / "square.msh"))
        number = len(gmsh.model.mesh.getElementsByType(3 if order == 1 else 10)[0])
        triangles = len(gmsh.model.mesh.getElementsByType(2 if order == 1 else 9)[0])
    finally:
        gmsh.finalize()
    mesh = read_mesh(tmp_path / "square.msh")
    assert mesh.order == order
    assert len(mesh.triangles) == 2 * number + triangles
    groups = {group.name: group.measure for group in check.summary(mesh).groups}
    assert groups == pytest.approx({"plate": 2.0, "again": 2.0, "left": 1.0})
    assert mesh.notes[0].startswith(
        f"{number} quadrilaterals split into triangles along the shorter diagonal"
    )
    assert read_mesh(tmp_path / "square.geo").areas.sum() == pytest.approx(2.0)


def test_the_shorter_diagonal():
    mesh = read_cell([(0, 0), (1, 0), (2, 1), (0.2, 0.9)])
    assert sorted(sorted(t) for t in mesh.triangles.tolist()) == [[0, 1, 3], [1, 2, 3]]


def test_one_that_is_not_convex_is_split_inside():
    dart = [(0, 0), (2, 2), (0, 1.0), (-2, 2)]  # the diagonal (1, 3) lies outside
    mesh = read_cell(dart)
    assert mesh.areas.sum() == pytest.approx(2.0)
    x = np.array(dart, dtype=float)  # shoelace
    area = 0.5 * np.sum(x[:, 0] * np.roll(x[:, 1], -1) - np.roll(x[:, 0], -1) * x[:, 1])
    assert mesh.areas.sum() == pytest.approx(area)


def test_crossed_sides_are_refused():
    with pytest.raises(
        InputError, match=r"1 quadrilateral without area or with sides that cross.*\(0\.5, 0\.5\)"
    ):
        read_cell([(0, 0), (1, 1), (1, 0), (0, 1)])


def test_two_equal_corners_are_a_triangle():
    points = [[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [2, 0, 0]]
    mesh = read_mesh(meshio.Mesh(points, [("quad", [[0, 1, 2, 2], [1, 1, 3, 2]])]))
    assert (len(mesh.triangles), mesh.areas.sum()) == (2, pytest.approx(1.0))
    with pytest.raises(InputError, match="fewer than three different corners"):
        read_mesh(meshio.Mesh(points, [("quad", [[0, 1, 0, 2]])]))


def test_warped_ones_are_counted():
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0.1], [0, 1, 0], [2, 0, 0.1], [2, 1, 0.2]], dtype=float)
    note = read_mesh(meshio.Mesh(points, [("quad", [[0, 1, 2, 3], [1, 4, 5, 2]])])).notes[0]
    # the diagonals of the first are 0.05 apart
    mean = 0.5 * (np.sqrt(2.01) + np.sqrt(2))
    assert (
        f"1 of them is warped, their diagonals up to {0.05 / mean / np.sqrt(1 + 0.05**2 * 2):.1%}"[:45]
        in note
    )


@pytest.mark.parametrize("kind", ["quad8", "quad9"])
def test_curved_sides(kind):
    """A quarter of a cylinder in 4 x 2 cells of order 2: the area is that of arcs through 3 points."""
    n, m = 4, 2
    angle, height = np.meshgrid(np.linspace(0, np.pi / 2, 2 * n + 1), np.linspace(0, 2, 2 * m + 1))
    points = np.column_stack([np.cos(angle).ravel(), np.sin(angle).ravel(), height.ravel()])
    number = np.arange(len(points)).reshape(2 * m + 1, 2 * n + 1)
    cells = []
    for i in range(0, 2 * m, 2):
        for j in range(0, 2 * n, 2):
            block = number[i : i + 3, j : j + 3]
            cells.append(
                [*block[0, [0, 2]], *block[2, [2, 0]], block[0, 1], block[1, 2], block[2, 1], block[1, 0]]
            )
            if kind == "quad9":
                cells[-1].append(block[1, 1])
    mesh = read_mesh(meshio.Mesh(points, [(kind, cells)]))
    assert mesh.order == 2
    assert len(mesh.triangles) == 2 * n * m
    assert check.summary(mesh).area == pytest.approx(np.pi, rel=1e-4)
    radius = np.hypot(mesh.midpoints[:, 0], mesh.midpoints[:, 1])
    np.testing.assert_allclose(radius, 1.0, atol=1e-2 if kind == "quad8" else 1e-12)


def test_the_centre_of_eight_nodes_is_that_of_their_functions():
    x = np.random.default_rng(3).normal(size=(8, 3)) * 0.05
    x[:4] += [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
    x[4:] += [[0, -1, 0], [1, 0, 0], [0, 1, 0], [-1, 0, 0]]
    split = quads.split(x, np.arange(8)[None], "cell")
    np.testing.assert_allclose(split.points[0], 0.5 * x[4:].sum(axis=0) - 0.25 * x[:4].sum(axis=0))
    assert split.triangles.shape == (2, 6)
