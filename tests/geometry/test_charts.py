"""Ready charts: exact values, closed-form derivatives against sympy, and values of the literature."""

import math

import numpy as np
import pytest

import kshell.geometry as g
from kshell.errors import InputError
from kshell.geometry.charts import READY

PI = math.pi

FORMULAS = [
    (g.Plane(), ("u", "v", "0")),
    (g.Cylinder(R=2.5), ("2.5*cos(u)", "2.5*sin(u)", "v")),
    (g.Cone(R=2, height=3), ("2*v*cos(u)", "2*v*sin(u)", "3*v")),
    (g.Sphere(R=1.5), ("1.5*cos(u)*sin(v)", "1.5*sin(u)*sin(v)", "1.5*cos(v)")),
    (g.Torus(R=2, r=0.75), ("(2 + 0.75*cos(v))*cos(u)", "(2 + 0.75*cos(v))*sin(u)", "-0.75*sin(v)")),
    (g.Ellipsoid(3, 2, 1), ("3*cos(u)*sin(v)", "2*sin(u)*sin(v)", "cos(v)")),
    (g.Hypar(a=2, b=0.5), ("u", "v", "u**2/4 - 4*v**2")),
    (g.Hyperboloid(a=2, c=3), ("2*cosh(v)*cos(u)", "2*cosh(v)*sin(u)", "3*sinh(v)")),
    (g.Catenoid(c=1.5), ("1.5*cosh(v/1.5)*cos(u)", "1.5*cosh(v/1.5)*sin(u)", "v")),
    (g.Helicoid(c=2), ("u*cos(v)", "u*sin(v)", "2*v")),
    (g.MonkeySaddle(a=2), ("u", "v", "(u**3 - 3*u*v**2)/4")),
]
KINDS = [type(chart).__name__.lower() for chart, _ in FORMULAS]


def test_every_ready_chart_is_checked_here() -> None:
    assert sorted(KINDS) == sorted(READY)


@pytest.mark.parametrize(("chart", "formulas"), FORMULAS, ids=KINDS)
def test_closed_form_derivatives_agree_with_sympy(chart: g.Chart, formulas: tuple[str, str, str]) -> None:
    rng = np.random.default_rng(1)
    u, v = rng.uniform(0.2, 1.4, (2, 3, 5))
    exact = g.Chart.from_expressions(*formulas).derivatives(u, v, order=4)
    for n, (mine, theirs) in enumerate(zip(chart.derivatives(u, v, order=4), exact, strict=True)):
        assert mine.shape == (3, 5, *(2,) * n, 3)
        np.testing.assert_allclose(mine, theirs, rtol=0, atol=1e-12 * max(1.0, np.abs(theirs).max()))


def along_axis(t: np.ndarray) -> np.ndarray:
    return np.full_like(t, 0.3)


def test_torus_of_the_references() -> None:
    s = g.Torus(2, 1).at(0.7, np.array([0.0, PI / 2, PI]))  # outer, top, inner
    np.testing.assert_allclose(s.gaussian_curvature, [1 / 3, 0.0, -1.0], rtol=0, atol=1e-12)
    np.testing.assert_allclose(s.mean_curvature, [2 / 3, 1 / 2, 0.0], rtol=0, atol=1e-12)
    np.testing.assert_allclose(s.principal_curvatures[:, 0], 1.0, rtol=1e-12)
    assert list(s.kind) == ["elliptic", "parabolic", "hyperbolic"]
    torus = g.Torus(2, 1)
    assert torus.area() == pytest.approx(78.95683520871487, rel=1e-12)
    willmore = torus.integrate(lambda s: s.mean_curvature**2)
    assert willmore == pytest.approx(22.79287503105623, rel=1e-12)
    clifford = g.Torus(math.sqrt(2), 1).integrate(lambda s: s.mean_curvature**2)
    assert clifford == pytest.approx(19.73920880217872, rel=1e-12)
    assert torus.integrate(lambda s: s.gaussian_curvature) == pytest.approx(0.0, abs=1e-11)
    outer = torus.integrate(lambda s: s.gaussian_curvature, v_range=(-PI / 2, PI / 2))
    assert outer == pytest.approx(4 * PI, rel=1e-12)


def test_catenoid_of_the_references() -> None:
    catenoid = g.Catenoid(1)
    s = catenoid.at(along_axis(np.zeros(2)), np.array([0.0, 1.0]))
    np.testing.assert_allclose(s.gaussian_curvature, [-1.0, -0.1763784476141347], rtol=1e-12)
    np.testing.assert_allclose(s.mean_curvature, 0.0, atol=1e-13)
    assert catenoid.integrate(lambda s: s.gaussian_curvature) == pytest.approx(-9.570474421470201, rel=1e-12)
    assert catenoid.area() == pytest.approx(17.67730332006746, rel=1e-12)


@pytest.mark.parametrize("v", [0.4, 1.3, 2.9])
def test_sphere_has_positive_curvature_and_inward_normal(v: float) -> None:
    s = g.Sphere(R=4).at(np.linspace(0, 6, 7), v)
    np.testing.assert_allclose(s.normal, -s.point / 4, atol=1e-15)
    np.testing.assert_allclose(s.principal_curvatures, 0.25, rtol=1e-12)
    assert set(s.kind) == {"elliptic"}


def test_ellipsoid_gaussian_curvature() -> None:
    a, b, c = 3.0, 2.0, 1.0
    s = g.Ellipsoid(a, b, c).at(*np.meshgrid(np.linspace(0, 6, 9), np.linspace(0.1, 3, 8)))
    x, y, z = np.moveaxis(s.point, -1, 0)
    exact = 1 / (a * b * c * (x**2 / a**4 + y**2 / b**4 + z**2 / c**4)) ** 2
    np.testing.assert_allclose(s.gaussian_curvature, exact, rtol=1e-12)


def test_minimal_surfaces_have_no_mean_curvature() -> None:
    for chart in (g.Catenoid(2.0), g.Helicoid(0.5)):
        s = chart.at(*np.meshgrid(np.linspace(-2, 2, 9), np.linspace(-2, 2, 9)))
        np.testing.assert_allclose(s.mean_curvature, 0.0, atol=1e-12)
    s = g.Helicoid(2.0).at(0.75, 0.3)
    assert s.gaussian_curvature == pytest.approx(-(2.0**2) / (2.0**2 + 0.75**2) ** 2, rel=1e-12)


def test_planar_needs_the_whole_differential_to_vanish() -> None:
    assert g.Plane().at(0.2, 0.3).kind == "planar"
    cylinder = g.Cylinder(R=3).at(0.2, 0.3)
    assert np.linalg.det(cylinder.weingarten) == pytest.approx(0.0, abs=1e-15)
    assert cylinder.kind == "parabolic"  # det dN = 0 but dN is not
    assert g.Cone(1, 1).at(0.2, 0.3).kind == "parabolic"
    saddle = g.MonkeySaddle().at(np.array([0.0, 0.5]), 0.0)
    assert list(saddle.kind) == ["planar", "hyperbolic"]
    tilted = g.Plane().moved(np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0])
    bent_lines = g.Chart.from_expressions("sinh(u) + v**2", "v + u*v/5", "0", domain=((0.1, 1), (0.1, 1)))
    assert tilted.reparametrised(bent_lines).at(0.3, 0.4).kind == "planar"


def test_ready_chart_by_kind() -> None:
    assert g.ready_chart("cylinder", R=25.0) == g.Cylinder(R=25.0)
    assert g.ready_chart("Torus") == g.Torus()
    with pytest.raises(InputError, match=r'no ready chart "tube"'):
        g.ready_chart("tube")
    with pytest.raises(InputError, match=r'no constant "r".*R'):
        g.ready_chart("cylinder", r=1.0)


@pytest.mark.parametrize("R", [0.0, -1.0, math.nan, math.inf, "25"])
def test_constants_must_be_positive(R: float) -> None:
    with pytest.raises(InputError, match=r"R = .* must be a positive number"):
        g.Cylinder(R=R)


def test_spindle_torus_is_refused() -> None:
    with pytest.raises(InputError, match="cuts itself"):
        g.Torus(1, 2)
