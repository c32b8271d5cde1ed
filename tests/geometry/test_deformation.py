"""Strain and change of curvature of a chart."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import kshell.geometry as g
from kshell.errors import InputError

FIELD = ("sin(u)*v", "u**2 - v/2", "cos(v)*u + v**2")
CHART = g.Ellipsoid(3, 2, 1)
U, V = np.meshgrid(np.linspace(0.3, 1.3, 4), np.linspace(0.5, 2.0, 3))


def scaled(factor: float) -> g.Deformation:
    return g.Deformation(CHART, tuple(f"{factor!r}*({c})" for c in FIELD))


def test_exact_strains_are_the_changes_of_the_forms() -> None:
    s = scaled(0.3).at(U, V)
    np.testing.assert_allclose(s.green_strain, 0.5 * (s.after.first_form - s.before.first_form), atol=1e-13)
    np.testing.assert_allclose(s.curvature_change, s.after.second_form - s.before.second_form, atol=1e-13)


@pytest.mark.parametrize(
    ("exact", "linear"), [("green_strain", "linear_strain"), ("curvature_change", "linear_curvature_change")]
)
def test_linearised_strains_are_the_derivatives_of_the_exact_ones(exact: str, linear: str) -> None:
    """The remainder is of second order, down to where differences of forms would have no digit left."""
    ratios = []
    for size in (1e-2, 1e-4, 1e-7):
        s = scaled(size).at(U, V)
        ratios.append(np.abs(getattr(s, exact) - getattr(s, linear)).max() / size**2)
    assert ratios[1] == pytest.approx(ratios[0], rel=0.2)
    assert ratios[2] == pytest.approx(ratios[1], rel=0.05)


def test_a_rigid_motion_strains_nothing() -> None:
    rotation = Rotation.from_rotvec([0.3, -0.8, 0.5]).as_matrix()
    displacement = CHART.moved(rotation - np.eye(3), (5.0, 6.0, 7.0))
    s = g.Deformation(CHART, displacement).at(U, V)
    np.testing.assert_allclose(s.green_strain, 0.0, atol=1e-13)
    np.testing.assert_allclose(s.curvature_change, 0.0, atol=1e-13)
    spin = np.array([[0, -0.5, 0.2], [0.5, 0, -0.3], [-0.2, 0.3, 0]])
    s = g.Deformation(CHART, CHART.moved(spin)).at(U, V)  # an infinitesimal one: the linear strains vanish
    np.testing.assert_allclose(s.linear_strain, 0.0, atol=1e-13)
    np.testing.assert_allclose(s.linear_curvature_change, 0.0, atol=1e-13)
    assert np.abs(s.green_strain).max() > 0.1


def test_sphere_blown_up() -> None:
    sphere = g.Sphere(2.0)
    s = g.Deformation(sphere, sphere.moved(0.5 * np.eye(3))).at(U, V)  # radius 3
    A = s.before.first_form
    np.testing.assert_allclose(s.green_strain, 0.5 * (9 / 4 - 1) * A, rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(s.curvature_change, (9 / 4 / 3 - 1 / 2) * A, rtol=1e-12, atol=1e-14)
    expected = np.broadcast_to(0.5 * (9 / 4 - 1) * np.eye(2), (*U.shape, 2, 2))
    np.testing.assert_allclose(s.in_frame(s.green_strain), expected, rtol=1e-12, atol=1e-14)


def test_plate_rolled_to_a_cylinder() -> None:
    """Bending without stretching: curvature 1/R along u, no strain."""
    rolled = g.Deformation(g.Plane(), ("2*sin(u/2) - u", "0", "2 - 2*cos(u/2)")).at(0.7, 0.2)
    np.testing.assert_allclose(rolled.green_strain, 0.0, atol=1e-15)
    np.testing.assert_allclose(rolled.curvature_change, [[0.5, 0.0], [0.0, 0.0]], atol=1e-15)


def test_a_deformation_that_tears_the_chart_is_refused() -> None:
    with pytest.raises(InputError, match="deformed plane has a singular"):
        g.Deformation(g.Plane(), ("-u", "0", "0")).at(0.5, 0.5)
    with pytest.raises(InputError, match="3 components"):
        g.Deformation(g.Plane(), ("u", "v"))
