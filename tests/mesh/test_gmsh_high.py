"""Triangles of order 3 and 4 in files of gmsh."""

from __future__ import annotations

import numpy as np
import pytest

from kshell.mesh.read import read_mesh
from tests.mesh.mesh_samples import msh2_text

SQUARE = np.array([[0, 0], [1, 0], [0, 1], [1, 1]], dtype=float)
TRIANGLES = [(0, 1, 2), (1, 3, 2)]


def along(corners, degree):
    """Vertices, then edge by edge, then inside, as gmsh has them."""
    a, b, c = corners
    out = [a, b, c]
    for start, end in ((a, b), (b, c), (c, a)):
        out += [start + (end - start) * k / degree for k in range(1, degree)]
    return out


def height(x):
    """A cubic in space."""
    return 0.2 * x[0] ** 3 - 0.3 * x[0] * x[1] ** 2 + 0.1 * x[0] * x[1]


def written(order, kind, line, inside):
    """Two triangles on a cubic surface, and a line of the same order."""
    number, points = {}, []

    def tag(x):
        key = tuple(np.round(x, 9))
        if key not in number:
            points.append((*x, height(x)))
            number[key] = len(points)
        return number[key]

    cells = []
    for corners in TRIANGLES:
        x = SQUARE[list(corners)]
        places = along(x, order) + [x.mean(axis=0) + 0.01 * k for k in range(inside)]
        cells.append(f"{kind} 1 " + " ".join(str(tag(place)) for place in places))
    side = [SQUARE[0], SQUARE[1], *(SQUARE[0] + (SQUARE[1] - SQUARE[0]) * k / order for k in range(1, order))]
    cells.append(f"{line} 2 " + " ".join(str(tag(place)) for place in side))
    return msh2_text(points, cells)


@pytest.mark.parametrize(
    ("order", "kind", "line", "inside"), [(3, 21, 26, 1), (3, 20, 26, 0), (4, 23, 27, 3), (4, 22, 27, 0)]
)
def test_middles_of_edges_lie_on_the_surface(tmp_path, order, kind, line, inside):
    path = tmp_path / "high.msh"
    path.write_text(written(order, kind, line, inside), encoding="utf-8")
    mesh = read_mesh(path)
    assert (len(mesh.points), len(mesh.triangles), len(mesh.edges), mesh.order) == (4, 2, 5, 2)
    middle = mesh.points[mesh.edges].mean(axis=1)[:, :2]
    assert mesh.midpoints[:, :2] == pytest.approx(middle, abs=1e-14)
    assert mesh.midpoints[:, 2] == pytest.approx(height(middle.T), abs=1e-14)
    assert any(f"order {order}" in note for note in mesh.notes)
    assert sorted(len(group.members) for group in mesh.groups.values()) == [1, 2]
