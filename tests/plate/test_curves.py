"""True shapes of curved edges, rebuilt from mesh nodes."""

from math import comb

import numpy as np
import pytest

import kshell as ks
from kshell.mesh.mesh import Mesh
from kshell.plate import rims
from kshell.plate.conics import arc_of
from kshell.plate.domain import Domain
from kshell.plate.rims import edge_curves
from tests.plate.plates import disk, egg, ellipse, rectangle


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


@pytest.mark.parametrize("degree", range(8))
def test_polynomials_are_integrated_over_a_disk_of_six_triangles(degree):
    """Rays from the corner opposite the arc: exact along them, and spectral across."""
    domain = Domain(disk(1), curved=True)
    direction = np.array([0.6, 0.8])
    found = sum(float(((p.xy @ direction) ** degree * p.weights).sum()) for p in domain.patches(degree))
    # int r^(n + 1) dr times int cos^n
    cosine = np.pi * 2.0 ** (1 - degree) * comb(degree, degree // 2) if degree % 2 == 0 else 0.0
    assert found == pytest.approx(cosine / (degree + 2), abs=1e-11)


def test_triangles_with_two_and_three_curved_edges():
    """A circle of three triangles around one, beside one of a single triangle."""
    angle = 2 * np.pi * np.arange(6) / 6
    points = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    four = Mesh.from_arrays(points, np.array([(0, 1, 2), (2, 3, 4), (4, 5, 0), (0, 2, 4)]))
    assert Domain(four, curved=True).area == pytest.approx(np.pi, rel=1e-10)


def test_four_nodes_on_a_circle_may_be_on_an_ellipse_too():
    angles = 0.5 * np.pi * np.arange(4) + 0.25 * np.pi
    mesh = fan(angles, stretch=(1.2, 1.0))
    assert not edge_curves(mesh, mesh.boundary_edges).arcs.any()


@pytest.mark.parametrize("order", [1, 2])
def test_an_ellipse_is_known_by_seven_nodes(order):
    for mesh in (ellipse(2, order), ellipse(3, order, long=3.0)):
        domain = Domain(mesh, curved=True)
        long = mesh.points[:, 0].max()
        assert domain.curves.arcs.all()
        assert domain.area == pytest.approx(np.pi * long, rel=1e-12)
        s = np.linspace(0, 1, 9)
        x, y = domain.edge_points(domain.curves.edges, s, s).xy.reshape(-1, 2).T
        assert np.hypot(x / long, y) == pytest.approx(np.ones(len(x)), abs=1e-12)


def test_an_arc_of_an_ellipse_and_nodes_that_are_on_none():
    angles = np.linspace(0.2, 2.0, 8)
    turn = np.array([[0.6, 0.8], [-0.8, 0.6]])
    nodes = np.stack([3 * np.cos(angles), np.sin(angles)], axis=1) @ turn
    known = arc_of(nodes, 1, 1e-15)
    assert known.theta == pytest.approx(np.diff(angles), abs=1e-9)
    chord = np.diff(nodes, axis=0)
    speed = known.derivatives(chord)[:, 0, 0] @ turn.T
    ends = np.stack([-3 * np.sin(angles), np.cos(angles)], axis=1)[:-1] * np.diff(angles)[:, None]
    assert speed == pytest.approx(ends, abs=1e-9)
    off = nodes.copy()
    off[3] *= 1 + 1e-9
    assert arc_of(off, 1, 1e-15) is None
    t = np.linspace(0.5, 2.0, 9)
    assert arc_of(np.stack([t, t**2], axis=1), 1, 1e-15) is None  # a parabola
    assert arc_of(np.stack([t, 1 / t], axis=1), 1, 1e-15) is None  # a hyperbola


def test_splines_of_other_curves_have_the_degree_that_the_nodes_tell():
    """An egg: area by order eight and more, where quintics had order six (3e-8, 5e-9 at these)."""
    angle = 2 * np.pi * np.arange(400) / 400
    on = np.ones(400)
    cube = np.sin(angle) ** 2 * np.cos(angle) / 3
    for _ in range(60):
        on -= (on**2 + cube * on**3 - 1) / (2 * on + 3 * cube * on**2)
    area = np.pi * (on**2).mean()
    for rings, order, error in ((3, 1, 3e-6), (6, 1, 2e-10), (8, 1, 6e-12), (4, 2, 1e-10)):
        domain = Domain(egg(rings, order), curved=True)
        assert not domain.curves.arcs.any()
        assert domain.area == pytest.approx(area, rel=error)


def test_rough_nodes_keep_to_quintics():
    """On a curve of five waves 18 nodes are too few for more."""
    angles = 2 * np.pi * np.arange(18) / 18
    mesh = fan(angles, radius=lambda a: 1 + 0.2 * np.cos(5 * a))
    assert edge_curves(mesh, mesh.boundary_edges).shape.shape[1] == 4
    fine = 2 * np.pi * np.arange(72) / 72
    smooth = fan(fine, radius=lambda a: 1 + 0.05 * np.sin(a) ** 3)
    assert edge_curves(smooth, smooth.boundary_edges).shape.shape[1] == 8


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


def divided_polygon(rim, divided):
    """A triangle from the middle to each of the equal parts of the sides of a polygon."""
    s = np.arange(divided) / divided
    after = np.roll(rim, -1, axis=0)
    points = (rim[:, None] + s[:, None] * (after - rim)[:, None]).reshape(-1, 2)
    n = len(points)
    k = np.arange(n)
    return Mesh.from_arrays(
        np.concatenate([points, [points.mean(axis=0)]]), np.stack([k, (k + 1) % n, np.full(n, n)], axis=1)
    )


@pytest.mark.parametrize("turn", [11.0, 3.0, 0.1])
@pytest.mark.parametrize("divided", [2, 3])
def test_a_vertex_that_turns_alone_between_straight_sides_is_a_corner(turn, divided):
    """However little: to each side of it, and into the plate as well as out of it, on closed lines and open ones."""
    rise = 0.5 * np.tan(np.radians(0.5 * turn))
    for up in (rise, -rise):
        mesh = divided_polygon(np.array([[0, 0], [1, 0], [1, 1.0], [0.5, 1 + up], [0, 1.0]]), divided)
        top = mesh.boundary_edges[mesh.points[mesh.edges[mesh.boundary_edges], 1].min(axis=1) > 0.99]
        for edges in (mesh.boundary_edges, top):
            curves = edge_curves(mesh, edges)
            assert not curves.curved.any()
            assert curves.sharpest == 0.0


@pytest.mark.parametrize("n", [36, 48])
def test_divided_chords_of_a_curve_have_no_corners(n):
    """They turn alike at both ends of each side."""
    angle = 2 * np.pi * np.arange(n) / n
    mesh = divided_polygon(np.stack([1.2 * np.cos(angle), np.sin(angle)], axis=1), 2)
    assert edge_curves(mesh, mesh.boundary_edges).curved.all()


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
        quick = rims._edge_curves(mesh, edges)
        assert not quick.curved.any()
        with monkeypatch.context() as patch:
            patch.setattr(rims, "polygon", lambda *_: None)
            general = rims._edge_curves(mesh, edges)
        np.testing.assert_allclose(quick.tangent, general.tangent, atol=1e-14)
        np.testing.assert_array_equal(quick.shape, general.shape)
        if len(edges) == len(mesh.boundary_edges):
            assert len(np.unique(np.abs(quick.tangent).reshape(-1, 2), axis=0)) <= 4
