"""Triangle meshes of charts: closed properly, named sides, orientation, order."""

import math

import numpy as np
import pytest

import kshell.geometry as g
from kshell.errors import InputError
from kshell.geometry.chart_mesh import PATTERNS
from kshell.geometry.charts import READY
from kshell.geometry.discrete import euler_characteristic

CHARTS = [make() for make in READY.values()]
CHARACTERISTIC = {"sphere": 2, "ellipsoid": 2, "torus": 0, "cylinder": 0, "hyperboloid": 0, "catenoid": 0}


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("pattern", PATTERNS)
@pytest.mark.parametrize("chart", CHARTS, ids=repr)
def test_every_chart_gives_a_sound_mesh(chart: g.Chart, pattern: str, order: int) -> None:
    mesh = chart.mesh(20, 18, order=order, pattern=pattern)
    assert mesh.order == order
    assert euler_characteristic(mesh) == CHARACTERISTIC.get(chart.name, 1)
    assert len(mesh.boundary_edges) == sum(
        len(group.members) for group in mesh.groups.values() if group.dimension == 1
    )
    normals = g.discrete.vertex_normals(mesh)  # also checks that the mesh is an oriented surface
    smooth = ~np.isin(
        np.arange(len(mesh.points)), [i for x in mesh.groups.values() if x.dimension == 0 for i in x.members]
    )
    exact = nearest_normals(chart, mesh.points[smooth])
    assert np.sum(normals[smooth] * exact, axis=1).min() > 0.7
    assert mesh.areas.sum() == pytest.approx(chart.area(), rel=0.15)
    assert np.unique(mesh.points.round(9), axis=0).shape == mesh.points.shape  # no vertex twice
    if order == 2:
        middle = mesh.points[mesh.edges].mean(axis=1)
        sag = np.linalg.norm(mesh.midpoints - middle, axis=1)
        assert (sag < 0.5 * mesh.edge_lengths).all()  # no node across a seam


def nearest_normals(chart: g.Chart, points: np.ndarray) -> np.ndarray:
    (a, b), (c, d) = chart.domain
    u, v = np.meshgrid(np.linspace(a, b, 181), np.linspace(c + 1e-3, d - 1e-3, 181))
    from scipy.spatial import KDTree

    index = KDTree(chart(u, v).reshape(-1, 3)).query(points)[1]
    return chart.at(u.ravel()[index], v.ravel()[index]).normal


def test_midpoints_lie_on_the_surface_halfway() -> None:
    sphere = g.Sphere(2).mesh(12, 8)
    np.testing.assert_allclose(np.linalg.norm(sphere.midpoints, axis=1), 2.0, rtol=1e-14)
    ends = sphere.points[sphere.edges]
    half = np.linalg.norm(sphere.midpoints - ends[:, 0], axis=1) / np.linalg.norm(
        sphere.midpoints - ends[:, 1], axis=1
    )
    assert half.min() > 0.8
    assert half.max() < 1.25


def test_sides_are_named_groups() -> None:
    mesh = g.Hypar().mesh(4, 3, names=("left", "right", "front", "back"))
    assert {name: (x.dimension, len(x.members)) for name, x in mesh.groups.items()} == {
        "surface": (2, 24), "left": (1, 3), "right": (1, 3), "front": (1, 4), "back": (1, 4),
    }  # fmt: skip
    right = mesh.points[mesh.edges[mesh.groups["right"].members]]
    assert (right[..., 0] == 0.5).all()
    joined = g.Plane().mesh(4, 3, names=("clamped", "clamped", None, "back"))
    assert {name: len(x.members) for name, x in joined.groups.items()} == {
        "surface": 24,
        "clamped": 6,
        "back": 4,
    }


def test_glued_and_collapsed_sides() -> None:
    cylinder = g.Cylinder(25).mesh(16, 4)
    assert set(cylinder.groups) == {"surface", "v0", "v1"}
    assert cylinder.notes == ("cylinder: the sides u0 and u1 coincide and were glued",)
    sphere = g.Sphere().mesh(8, 6)
    assert sphere.groups["v0"].dimension == 0
    np.testing.assert_allclose(sphere.points[sphere.groups["v0"].members], [[0, 0, 1]], atol=1e-15)
    assert len(sphere.points) == 8 * 5 + 2
    half = g.Cylinder(25).mesh(8, 4, u_range=(-0.7, 0.7))
    assert set(half.groups) == {"surface", "u0", "u1", "v0", "v1"}


def test_parameter_mesh_is_flat_and_matches() -> None:
    flat = g.Cylinder(25).parameter_mesh(6, 3, u_range=(-0.7, 0.7), v_range=(0, 50))
    curved = g.Cylinder(25).mesh(6, 3, order=1, u_range=(-0.7, 0.7), v_range=(0, 50))
    np.testing.assert_array_equal(flat.points[:, 2], 0.0)
    np.testing.assert_array_equal(flat.triangles, curved.triangles)
    np.testing.assert_allclose(
        g.Cylinder(25)(flat.points[:, 0], flat.points[:, 1]), curved.points, atol=1e-13
    )


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"n_u": 0}, "n_u = 0"),
        ({"n_v": 2.5}, "n_v = 2.5"),
        ({"n_u": 2}, "closes up along u: it needs at least 3"),
        ({"n_v": 1}, "pole on both sides of v"),
        ({"order": 3}, "order = 3"),
        ({"names": ("a", "b")}, "four sides"),
        ({"names": ("a", "b", "surface", "c")}, "whole surface"),
        ({"pattern": "random"}, "pattern"),
        ({"u_range": (1.0, 0.0)}, "empty"),
        ({"n_u": 10**6, "n_v": 10**6}, "take fewer"),
        ({"u_range": (0.0, 1.0), "names": ("a", "b", "a", "b")}, "two names"),
    ],
)
def test_bad_requests_are_refused(arguments, message) -> None:
    with pytest.raises(InputError, match=message):
        g.Sphere().mesh(**{"n_u": 8, "n_v": 6} | arguments)


def test_a_chart_that_is_singular_inside_is_refused_with_the_place() -> None:
    folded = g.Chart.from_expressions("u", "0", "v", domain=((-1, 1), (-1, 1)))
    assert folded.mesh(4, 4, order=1).areas.min() > 0
    flat = g.Chart.from_expressions("u", "u", "u**2", domain=((0.5, 1), (0, 1)))
    with pytest.raises(InputError, match=r"have no area, the first near u = 0.5"):
        flat.mesh(4, 4)
    with pytest.raises(InputError, match="one point"):
        g.Chart.from_expressions("1", "2", "3").mesh(3, 3)
    assert math.isfinite(folded.area())
