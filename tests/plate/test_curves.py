"""True shapes of curved edges, rebuilt from mesh nodes."""

import numpy as np
import pytest

import kshell as ks
from kshell.mesh.mesh import Mesh
from kshell.plate import curves
from kshell.plate.curves import edge_curves
from kshell.plate.domain import Domain
from tests.plate.plates import disk, ellipse, rectangle


def fan(angles, radius=lambda a: 1.0, centre=(5.0, -2.0), stretch=(2.0, 1.0)):
    """Triangles between a closed curve and its centre."""
    r = np.array([radius(a) for a in angles])[:, None]
    rim = r * np.stack([stretch[0] * np.cos(angles), stretch[1] * np.sin(angles)], axis=1)
    n = len(angles)
    k = np.arange(n)
    triangles = np.stack([k, (k + 1) % n, np.full(n, n)], axis=1)
    return Mesh.from_arrays(np.concatenate([rim, [[0.0, 0.0]]]) + np.array(centre), triangles)


@pytest.mark.parametrize("order", [1, 2])
def test_a_disk_is_known_by_its_nodes(order):
    for rings in (1, 3):
        domain = Domain(disk(rings, order), curved=True)
        assert domain.area == pytest.approx(np.pi, rel=1e-11)
        assert domain.curves.arcs.all()
        s = np.linspace(0, 1, 9)
        on = domain.edge_points(domain.curves.edges, s, s)
        assert np.hypot(*on.xy.reshape(-1, 2).T) == pytest.approx(np.ones(9 * 6 * rings), abs=1e-11)
        assert np.linalg.norm(on.curvature, axis=2) == pytest.approx(1.0, abs=1e-8)


def test_four_nodes_on_a_circle_may_be_on_an_ellipse_too():
    angles = 0.5 * np.pi * np.arange(4) + 0.25 * np.pi
    mesh = fan(angles, stretch=(1.2, 1.0))
    assert not edge_curves(mesh, mesh.boundary_edges).arcs.any()


@pytest.mark.parametrize("order", [1, 2])
def test_area_of_an_ellipse_converges_with_order_six(order):
    errors = [abs(Domain(ellipse(rings, order), curved=True).area / (1.5 * np.pi) - 1) for rings in (3, 6)]
    assert errors[0] < 1e-3
    assert errors[1] < errors[0] / 50


def test_tangent_and_curvature_of_an_ellipse():
    angles = np.linspace(0, 2 * np.pi, 64, endpoint=False)
    mesh = fan(angles)
    curves = edge_curves(mesh, mesh.boundary_edges)
    a = angles[mesh.edges[curves.edges]]
    speed = np.hypot(-2 * np.sin(a), np.cos(a))
    exact = np.stack([-2 * np.sin(a), np.cos(a)], -1) / speed[..., None]
    cosine = np.abs((exact * curves.tangent).sum(-1))
    assert np.arccos(np.minimum(cosine, 1)).max() < 1e-5
    assert np.allclose(np.linalg.norm(curves.curvature, axis=-1), 2 / speed**3, rtol=3e-3)


def test_polygons_keep_their_corners_and_straight_sides():
    mesh = rectangle(4, skew=0.5)
    curves = edge_curves(mesh, mesh.boundary_edges)
    assert not curves.curved.any()
    assert curves.sharpest < 1e-6
    ends = mesh.points[mesh.edges[curves.edges], :2]
    chord = ends[:, 1] - ends[:, 0]
    chord /= np.linalg.norm(chord, axis=1, keepdims=True)
    assert np.allclose(curves.tangent, chord[:, None])


def test_a_blunt_corner_of_straight_sides_is_a_corner():
    """The obtuse corner of a rhombus turns by 30 degrees only."""
    mesh = rectangle(4, a=1.0, b=np.sin(np.pi / 6), skew=1 / np.tan(np.pi / 6))
    curves = edge_curves(mesh, mesh.boundary_edges)
    assert not curves.curved.any()


def test_an_arc_that_runs_into_straight_lines():
    """A half disk: two corners, a straight side that stays straight, an arc with curvature 1."""
    arc = np.linspace(0, np.pi, 25)
    rim = np.stack([np.cos(arc), np.sin(arc)], axis=1)
    base = np.stack([np.linspace(-1, 1, 13)[1:-1], np.zeros(11)], axis=1)
    points = np.concatenate([rim, base, [[0.0, 0.4]]])
    n = len(points) - 1
    k = np.arange(n)
    mesh = Mesh.from_arrays(points, np.stack([k, (k + 1) % n, np.full(n, n)], axis=1))
    curves = edge_curves(mesh, mesh.boundary_edges)
    on_base = np.abs(mesh.points[mesh.edges[curves.edges], 1]).max(axis=1) < 1e-12
    assert not curves.curved[on_base].any()
    assert curves.curved[~on_base].all()
    assert np.allclose(np.linalg.norm(curves.curvature[~on_base], axis=-1), 1.0, atol=1e-3)
    assert Domain(mesh, curved=True).area == pytest.approx(np.pi / 2, rel=1e-7)


@pytest.mark.parametrize("n", [8, 30, 120])
def test_edges_beside_a_corner_are_as_curved_as_the_others(n):
    """A quarter disk, fanned from its centre: the turn at the ends of the arc is no curvature of the arc."""
    angle = np.linspace(0, np.pi / 2, n + 1)
    points = np.concatenate([[[0.0, 0.0]], np.stack([np.cos(angle), np.sin(angle)], axis=1)])
    k = np.arange(1, n + 1)
    mesh = Mesh.from_arrays(points, np.stack([np.zeros(n, dtype=int), k, k + 1], axis=1))
    curves = edge_curves(mesh, mesh.boundary_edges)
    on_arc = (mesh.edges[curves.edges] > 0).all(axis=1)
    assert curves.curved.tolist() == on_arc.tolist()
    assert np.allclose(np.linalg.norm(curves.curvature[on_arc], axis=-1), 1.0, atol=10 / n**3)


def test_a_smooth_join_of_arc_and_line_has_one_tangent():
    """A stadium: straight sides, half circles; the curvature jumps, the tangent does not."""
    turn = np.linspace(-np.pi / 2, np.pi / 2, 17)
    right = np.stack([1 + np.cos(turn), np.sin(turn)], axis=1)
    top = np.stack([np.linspace(1, -1, 11)[1:-1], np.ones(9)], axis=1)
    points = np.concatenate([right, top, -right, -top, [[0.0, 0.0]]])
    n = len(points) - 1
    k = np.arange(n)
    mesh = Mesh.from_arrays(points, np.stack([k, (k + 1) % n, np.full(n, n)], axis=1))
    curves = edge_curves(mesh, mesh.boundary_edges)
    ends = mesh.edges[curves.edges]
    for v in range(n):
        at = [curves.tangent[k, e] for k in range(len(ends)) for e in (0, 1) if ends[k, e] == v]
        assert abs(abs(at[0] @ at[1]) - 1) < 1e-12
    assert Domain(mesh, curved=True).area == pytest.approx(4 + np.pi, rel=1e-5)


def test_edge_quadrature_follows_the_curve():
    mesh = disk(4)
    domain = Domain(mesh, curved=True)
    patch = domain.edge_patch(mesh.boundary_edges.astype(int), 6)
    assert patch.weights.sum() == pytest.approx(2 * np.pi, rel=1e-6)
    assert np.allclose(patch.normal, patch.xy / np.linalg.norm(patch.xy, axis=-1, keepdims=True), atol=1e-4)
    divergence = (patch.normal * patch.xy).sum(-1) * patch.weights
    assert divergence.sum() / 2 == pytest.approx(domain.area, rel=1e-10)


def test_slanted_edges_graded_down_to_rounding_are_straight():
    """Coordinates are known to 1e-16, which is a large turn between edges of length 1e-12."""
    distance = np.concatenate([[0.0], 2.0 ** -np.arange(38.0, -1.0, -1.0)])
    direction = np.array([np.cos(np.pi / 6), np.sin(np.pi / 6)])
    along = np.array([1.0, 0.0]) + distance[:, None] * direction
    points = np.concatenate([along, [[0.5, 1.0]]])
    n = len(along)
    triangles = np.array([(k, k + 1, n) for k in range(n - 1)])
    flat = np.concatenate([points, np.zeros((n + 1, 1))], axis=1)
    mesh = Mesh(flat, triangles.astype(np.int32))
    curves = edge_curves(mesh, mesh.boundary_edges)
    assert not curves.curved.any()
    slanted = (mesh.edges[curves.edges] < n).all(axis=1)
    assert np.abs(np.abs(curves.tangent[slanted] @ direction) - 1.0).max() < 1e-15


@pytest.mark.parametrize("turn", [0.0, 0.3])
@pytest.mark.parametrize("order", [1, 2])
def test_sides_of_polygons_are_those_of_the_general_way(turn, order, monkeypatch):
    """Wherever a line begins, and with all edges of a side along the same direction."""
    c, s = np.cos(turn), np.sin(turn)
    turned = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    flat = ks.geometry.Plane().mesh(3, 4, order=order)
    middles = None if flat.midpoints is None else flat.midpoints @ turned
    mesh = ks.Mesh.from_arrays(flat.points @ turned, flat.triangles, midpoints=middles)
    for edges in (mesh.boundary_edges, mesh.boundary_edges[2:]):
        quick = curves._edge_curves(mesh, edges)
        assert not quick.curved.any()
        with monkeypatch.context() as patch:
            patch.setattr(curves, "_polygon", lambda *_: None)
            general = curves._edge_curves(mesh, edges)
        np.testing.assert_allclose(quick.tangent, general.tangent, atol=1e-14)
        np.testing.assert_array_equal(quick.shape, general.shape)
        if len(edges) == len(mesh.boundary_edges):
            assert len(np.unique(np.abs(quick.tangent).reshape(-1, 2), axis=0)) <= 4
