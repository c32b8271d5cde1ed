"""Gauss-Bonnet with boundary and corners, curves on surfaces."""

import math

import numpy as np
import pytest

import kshell.geometry as g
from kshell.errors import InputError

PI = math.pi
TURN = (0.0, 2 * PI)


@pytest.mark.parametrize(
    ("chart", "ranges", "characteristic", "corners"),
    [
        (g.Torus(2, 1), (), 0, 0),
        (g.Ellipsoid(3, 2, 1), (), 2, 0),
        (g.Sphere(2), (TURN, (0.0, 0.7)), 1, 0),  # a cap
        (g.Ellipsoid(3, 2, 1), (TURN, (0.5, PI)), 1, 0),  # the rest beyond a cap
        (g.Torus(2, 1), (TURN, (-PI / 2, PI / 2)), 0, 0),  # a band
        (g.Torus(2, 1), ((0.2, 1.0), (0.3, 2.0)), 1, 4),  # a patch with corners
        (g.MonkeySaddle(), (), 1, 4),
        (g.Helicoid(), ((0.1, 2.0), (0.0, 1.0)), 1, 4),
        (g.Cylinder(3), (), 0, 0),
    ],
)
def test_gauss_bonnet(chart, ranges, characteristic, corners) -> None:
    terms = g.gauss_bonnet(chart, *ranges)
    assert terms.characteristic == characteristic
    assert len(terms.corners) == corners
    assert abs(terms.residual) < 1e-10


def test_cap_of_a_sphere_term_by_term() -> None:
    cap = g.gauss_bonnet(g.Sphere(3), TURN, (0.0, 0.6))
    assert cap.curvature == pytest.approx(2 * PI * (1 - math.cos(0.6)), rel=1e-12)
    # the normal points inward, so the region lies to the right of outward eyes and the sign stays
    assert cap.boundary == pytest.approx(2 * PI * math.cos(0.6), rel=1e-12)


def test_oblique_parameters_have_corners_of_any_angle() -> None:
    skew = g.Chart.from_expressions("s + t/2", "t", "0", ("s", "t"))
    patch = g.Ellipsoid(3, 2, 1).reparametrised(
        g.Chart.from_expressions("0.3 + s + t/2", "1 + t - s**2/4", "0", ("s", "t"))
    )
    plane = g.gauss_bonnet(skew)
    assert sorted(plane.corners) == pytest.approx(
        [math.atan(2), math.atan(2), PI - math.atan(2), PI - math.atan(2)]
    )
    terms = g.gauss_bonnet(patch)
    assert abs(terms.residual) < 1e-10
    assert max(abs(c - PI / 2) for c in terms.corners) > 0.1


def test_disc_through_polar_parameters() -> None:
    """A disc in the parameters of a saddle: the centre is a pole of the new chart."""
    polar = g.Chart.from_expressions("r*cos(a)", "r*sin(a)", "0", ("a", "r"), domain=(TURN, (0.0, 0.8)))
    terms = g.gauss_bonnet(g.Hypar().reparametrised(polar))
    assert (terms.characteristic, terms.corners) == (1, ())
    assert abs(terms.residual) < 1e-10


def test_a_small_surface_far_away_and_a_chart_that_ends_at_its_range() -> None:
    far = g.Sphere(1e-3).moved(np.eye(3), (1e4, 0, 0))
    patch = g.gauss_bonnet(far, (0.0, 1.0), (0.5, 1.0))  # no pole, nothing glued
    assert (patch.characteristic, len(patch.corners)) == (1, 4)
    assert abs(patch.residual) < 1e-10
    root = g.Chart.from_expressions("u", "v", "sqrt(u - 3) + v**2")
    assert abs(g.gauss_bonnet(root, (3.5, 4.0), (0.0, 1.0)).residual) < 1e-10


def test_a_tip_is_refused_with_its_angle() -> None:
    with pytest.raises(InputError, match=r"v0 is one point.* turns by 4\.44288 instead of 2 pi"):
        g.gauss_bonnet(g.Cone(1, 1))
    assert abs(g.gauss_bonnet(g.Cone(1, 1), v_range=(0.1, 1)).residual) < 1e-10
    with pytest.raises(InputError, match="a side is a pole"):
        g.gauss_bonnet(g.Sphere(), (0.0, 1.0), (0.0, 1.0))


def test_parallels_of_a_torus() -> None:
    torus = g.Torus(2, 1)
    parallel = torus.along(g.Curve.from_expressions("t", "0.9"))
    p = parallel.at(np.linspace(0, 6, 4))
    radius = 2 + math.cos(0.9)
    np.testing.assert_allclose(np.abs(p.geodesic_curvature), math.sin(0.9) / radius, rtol=1e-12)
    np.testing.assert_allclose(p.normal_curvature, math.cos(0.9) / radius, rtol=1e-12)
    np.testing.assert_allclose(p.geodesic_torsion, 0.0, atol=1e-13)  # a line of curvature
    np.testing.assert_allclose(p.space.curvature, 1 / radius, rtol=1e-12)
    assert parallel.length(0, 2) == pytest.approx(2 * radius, rel=1e-12)


def test_curvatures_of_a_curve_on_a_surface_make_up_its_curvature() -> None:
    ellipsoid = g.Ellipsoid(3, 2, 1)
    p = ellipsoid.along(g.Curve.from_expressions("t + t**2/3", "1 + sin(t)/3")).at(np.linspace(-1, 1, 7))
    total = np.hypot(p.geodesic_curvature, p.normal_curvature)
    np.testing.assert_allclose(total, p.space.curvature, rtol=1e-11)
    np.testing.assert_allclose(p.normal_curvature, p.surface.normal_curvature(p.tangent), rtol=1e-10)
    # geodesic torsion = (k1 - k2) sin cos of the angle from d1 (with the sign of N' = -k_n T - t_g U)
    angle = p.surface.angle_between(p.surface.principal_directions[:, 0], p.tangent)
    k1, k2 = p.surface.principal_curvatures.T
    np.testing.assert_allclose(p.geodesic_torsion, -(k1 - k2) * np.sin(angle) * np.cos(angle), atol=1e-10)


def test_helices_are_geodesics_of_the_cylinder() -> None:
    helix = g.Cylinder(2).along(g.Curve.from_expressions("t", "3*t")).at(np.linspace(0, 5, 4))
    np.testing.assert_allclose(helix.geodesic_curvature, 0.0, atol=1e-14)
    np.testing.assert_allclose(helix.geodesic_torsion, helix.space.torsion, rtol=1e-12)
