"""Which way surfaces face, in words, and turned by top_towards."""

import dataclasses

import numpy as np
import pytest

import kshell as ks
from kshell.mesh.facing import top_words, towards
from tests.mesh import curved_shapes as shapes


def normals(mesh):
    a, b, c = (mesh.points[mesh.triangles[:, k]] for k in range(3))
    return np.cross(b - a, c - a), (a + b + c) / 3


def roof(sign=1):
    points, triangles = shapes.sheet(np.linspace(-1, 1, 9), np.linspace(0, 1, 5), lambda x: -0.1 * x**2)
    triangles = triangles[:, ::sign]
    return ks.Mesh.from_arrays(points, triangles, {"roof": triangles})


def test_words():
    closed = ks.Mesh.from_arrays(*shapes.sphere(4))
    assert top_words(closed) == ["the surface: positive pressure pushes outwards of the closed surface"]
    inside = towards(closed, point=(0.1, 0, 0))
    assert top_words(inside) == ["the surface: positive pressure pushes inwards of the closed surface"]
    assert top_words(roof()) == ["surface 'roof': positive pressure pushes towards +z"]
    assert top_words(roof(-1)) == ["surface 'roof': positive pressure pushes towards -z"]
    tube = ks.Mesh.from_arrays(*shapes.cylinder(24, 8))
    assert "away from the middle" in top_words(tube)[0]


@pytest.mark.parametrize("sign", [1, -1])
def test_tops_are_turned(sign):
    for direction in ((0, 0, 1), (0.2, 0, -3)):
        n, _ = normals(towards(roof(sign), direction))
        assert (n @ direction > 0).all()
    n, x = normals(towards(roof(sign), point=(0, 0, -50)))
    assert (((0, 0, -50) - x) * n).sum(axis=1).min() > 0


def test_each_sheet_by_itself_and_middle_nodes_stay():
    one, two = ks.geometry.Cylinder(R=1).mesh(8, 2, u_range=(0, 1), v_range=(0, 1)), roof(-1)
    n = len(one.points)
    points = np.concatenate([one.points, two.points + [0, 0, 9]])
    mesh = ks.Mesh.from_arrays(points, np.concatenate([one.triangles, two.triangles + n]))
    turned = towards(mesh, (1, 1, 1))
    sides, _ = normals(turned)
    assert (sides[len(one.triangles) :, 2] > 0).all()
    curved = towards(one, point=(0, 0, 0.5))
    assert np.array_equal(curved.midpoints, one.midpoints)
    assert np.array_equal(curved.edges, one.edges)


def scene(mesh, **keys):
    return ks.Scene(
        mesh=mesh,
        thickness=0.02,
        material=ks.Isotropic(E=1e9, nu=0.3),
        supports=[ks.Clamped("border")],
        loads=[ks.Pressure(1.0)],
        solve={"large_deflection": False},
        **keys,
    )


def test_key_turns_the_pressure_and_the_reasons_say_so():
    mesh = roof(-1)
    border = mesh.edges[mesh.boundary_edges]
    mesh = ks.Mesh.from_arrays(mesh.points, mesh.triangles, {"border": border})
    down, up = ks.solve(scene(mesh)), ks.solve(scene(mesh, top_towards=(0, 0, 1)))
    assert down.external_work == pytest.approx(up.external_work, rel=1e-6)
    u, v = (result.at([[0.0, 0.5, 0.0]])["u"][0, 2] for result in (up, down))
    assert u == pytest.approx(-v, rel=1e-6)
    assert u > 0
    assert "top: the surface: positive pressure pushes towards +z" in up.model["reasons"]
    assert "top: the surface: positive pressure pushes towards -z" in down.model["reasons"]


def test_what_cannot_be_turned():
    closed = scene(ks.Mesh.from_arrays(*shapes.sphere(4)), top_towards=[0, 0, 1])
    with pytest.raises(ks.InputError, match="of a closed surface give a point inside"):
        closed.read_mesh()
    with pytest.raises(ks.InputError, match="of a closed surface give a point inside"):
        dataclasses.replace(closed, top_towards={"point": (5, 0, 0)}).read_mesh()
    points, triangles = shapes.sheet(np.linspace(0, 1, 3), np.linspace(0, 1, 3), np.zeros_like)
    flat = scene(ks.Mesh.from_arrays(points, triangles), top_towards=[0, 0, -1])
    with pytest.raises(ks.InputError, match="top_towards is for shells in space"):
        flat.read_mesh()
    for wrong in ([0, 0, 0], "up", {"place": [0, 0, 1]}):
        with pytest.raises(ks.InputError, match="top_towards"):
            dataclasses.replace(closed, top_towards=wrong)
