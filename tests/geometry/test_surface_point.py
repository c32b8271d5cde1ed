"""Quantities of charts at points: identities of the theory, on random charts and directions."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import kshell.geometry as g
from kshell.errors import InputError
from kshell.geometry.charts import SeparableMap, power, times
from kshell.geometry.intrinsic import christoffel_symbols, gaussian_curvature

seeds = st.integers(0, 10**6)
few = settings(max_examples=12, deadline=None, derandomize=True)


def polynomial_map(rows: list[dict[tuple[int, int], float]]) -> SeparableMap:
    """Three polynomials, each given by its coefficients of u^i v^j."""

    def terms(u, v, order):
        return [
            [(times(c, power(u, i, order)), power(v, j, order)) for (i, j), c in row.items()] for row in rows
        ]

    return SeparableMap(terms)


def random_chart(rng: np.random.Generator, degree: int = 4) -> g.Chart:
    """A polynomial chart near the plane, with mixed parameter lines."""
    powers = [(i, j) for i in range(degree + 1) for j in range(degree + 1 - i) if i + j >= 1]
    rows = [{p: size * rng.uniform(-1, 1) for p in powers} for size in (0.04, 0.04, 0.5)]
    rows[0][1, 0] += 1.0
    rows[1][0, 1] += 1.0
    return g.Chart(polynomial_map(rows))


def random_points(rng: np.random.Generator, n: int = 6) -> tuple[np.ndarray, np.ndarray]:
    return rng.uniform(-0.8, 0.8, n), rng.uniform(-0.8, 0.8, n)


@given(seeds)
@few
def test_gauss_theorem_curvature_from_the_first_form_alone(seed: int) -> None:
    rng = np.random.default_rng(seed)
    s = random_chart(rng).at(*random_points(rng))
    first, second = s.metric_derivatives()
    K = gaussian_curvature(s.first_form, first, second)
    np.testing.assert_allclose(K, s.gaussian_curvature, rtol=1e-9, atol=1e-10)
    np.testing.assert_allclose(christoffel_symbols(s.first_form, first), s.christoffel, rtol=1e-9, atol=1e-10)


@given(seeds)
@few
def test_a_rigid_motion_changes_no_curvature_and_turns_the_normal(seed: int) -> None:
    rng = np.random.default_rng(seed)
    chart, (u, v) = random_chart(rng), random_points(rng)
    rotation = Rotation.random(rng=seed).as_matrix()
    s, moved = chart.at(u, v), chart.moved(rotation, rng.normal(size=3) * 100).at(u, v)
    np.testing.assert_allclose(moved.first_form, s.first_form, rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(moved.second_form, s.second_form, rtol=1e-11, atol=1e-12)
    np.testing.assert_allclose(moved.principal_curvatures, s.principal_curvatures, rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(moved.normal, s.normal @ rotation.T, atol=1e-13)


@given(seeds)
@few
def test_new_parameters_change_no_curvature(seed: int) -> None:
    rng = np.random.default_rng(seed)
    chart = random_chart(rng)
    p, q, r = rng.uniform(-0.15, 0.15, 3)
    rows = [{(1, 0): 1.0, (0, 1): p, (1, 1): q}, {(0, 1): 1.0, (2, 0): r, (0, 3): q}, {}]
    inner = g.Chart(polynomial_map(rows), domain=((-0.8, 0.8), (-0.8, 0.8)))
    s, t = random_points(rng)
    new = chart.reparametrised(inner).at(s, t)
    place = inner(s, t)
    old = chart.at(place[:, 0], place[:, 1])
    for name in ("point", "normal", "principal_curvatures", "mean_curvature", "gaussian_curvature"):
        np.testing.assert_allclose(
            getattr(new, name), getattr(old, name), rtol=1e-9, atol=1e-11, err_msg=name
        )
    # the third derivatives are composed too: K from the new first form
    K = gaussian_curvature(new.first_form, *new.metric_derivatives())
    np.testing.assert_allclose(K, old.gaussian_curvature, rtol=1e-8, atol=1e-9)
    np.testing.assert_allclose(
        chart.swapped().at(s, t).mean_curvature, -chart.at(t, s).mean_curvature, atol=1e-12
    )


@given(seeds, st.floats(-3.2, 3.2))
@few
def test_euler_formula_and_meusnier(seed: int, angle: float) -> None:
    rng = np.random.default_rng(seed)
    s = random_chart(rng).at(*random_points(rng))
    d1, d2 = s.principal_directions[:, 0], s.principal_directions[:, 1]
    direction = np.cos(angle) * d1 + np.sin(angle) * d2
    np.testing.assert_allclose(s.normal_curvature(direction), s.euler(angle), rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(
        s.angle_between(d1, direction), np.arctan2(np.sin(angle), np.cos(angle)), atol=1e-9
    )
    tilted = s.section_curvature(direction, 0.6) * np.cos(0.6)
    np.testing.assert_allclose(tilted, s.euler(angle), rtol=1e-9, atol=1e-11)


def test_meusnier_on_the_parallels_of_a_sphere() -> None:
    v = np.array([0.4, 1.0, 1.5])
    s = g.Sphere(2.0).at(0.3, v)
    # a parallel is the section by a plane whose angle to the normal is pi/2 - v; its radius is 2 sin v
    np.testing.assert_allclose(
        s.section_curvature((1.0, 0.0), np.pi / 2 - v), 1 / (2.0 * np.sin(v)), rtol=1e-12
    )


@given(seeds)
@few
def test_shape_operator_and_weingarten(seed: int) -> None:
    rng = np.random.default_rng(seed)
    chart = random_chart(rng)
    u, v = random_points(rng)
    s = chart.at(u, v)
    np.testing.assert_allclose(s.first_form @ s.shape_operator, s.second_form, atol=1e-12)
    trace = np.trace(s.shape_operator, axis1=1, axis2=2)
    np.testing.assert_allclose(trace / 2, s.mean_curvature, rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(s.shape_operator), s.gaussian_curvature, rtol=1e-10, atol=1e-12)
    step = 1e-5  # the Gauss map, differenced
    N_u = (chart.at(u + step, v).normal - chart.at(u - step, v).normal) / (2 * step)
    N_v = (chart.at(u, v + step).normal - chart.at(u, v - step).normal) / (2 * step)
    np.testing.assert_allclose(s.normal_derivatives, np.stack([N_u, N_v], axis=1), atol=1e-7)
    # Cayley-Hamilton: III - 2 H II + K I = 0
    H, K = s.mean_curvature[:, None, None], s.gaussian_curvature[:, None, None]
    np.testing.assert_allclose(s.third_form - 2 * H * s.second_form + K * s.first_form, 0.0, atol=1e-11)
    # principal directions diagonalise dN: dN(d) = -k d
    for i in range(2):
        d = s.parameters_of(s.principal_directions[:, i])
        dN = np.einsum("nj,njc->nc", d, s.normal_derivatives)
        expected = -s.principal_curvatures[:, i, None] * s.principal_directions[:, i]
        np.testing.assert_allclose(dN, expected, atol=1e-10)
    np.testing.assert_allclose(
        np.cross(s.principal_directions[:, 0], s.principal_directions[:, 1]), s.normal, atol=1e-12
    )
    assert (s.principal_curvatures[:, 0] >= s.principal_curvatures[:, 1]).all()


def test_gauss_map_area_is_the_integral_of_K() -> None:
    ellipsoid = g.Ellipsoid(3, 2, 1)
    image = ellipsoid.integrate(lambda s: np.sqrt(np.linalg.det(s.third_form)) / s.area_element)
    assert image == pytest.approx(4 * np.pi, rel=1e-10)


def test_lengths_and_angles_by_the_first_form() -> None:
    s = g.Cylinder(R=3).at(0.2, 0.4)
    assert s.length((1.0, 0.0)) == pytest.approx(3.0, rel=1e-14)
    assert s.length((1.0, 4.0)) == pytest.approx(5.0, rel=1e-14)
    assert s.angle == pytest.approx(np.pi / 2)
    assert s.angle_between((1.0, 0.0), (1.0, 3.0)) == pytest.approx(np.pi / 4, rel=1e-14)
    assert s.area_element == pytest.approx(3.0)


def test_shapes_follow_the_parameters() -> None:
    torus = g.Torus()
    for shape in [(), (4,), (2, 3)]:
        s = torus.at(np.full(shape, 0.3), 0.4)
        assert s.point.shape == s.normal.shape == (*shape, 3)
        assert s.first_form.shape == s.second_form.shape == s.shape_operator.shape == (*shape, 2, 2)
        assert s.principal_curvatures.shape == (*shape, 2)
        assert s.principal_directions.shape == (*shape, 2, 3)
        assert s.christoffel.shape == (*shape, 2, 2, 2)
        assert np.shape(s.mean_curvature) == np.shape(s.gaussian_curvature) == np.shape(s.kind) == shape
    assert torus.at(np.zeros((2, 1)), np.zeros(3)).point.shape == (2, 3, 3)


def test_plain_functions_are_differentiated_by_tracing() -> None:
    def x(u, v):
        return np.stack([np.cos(u) * np.cosh(v), np.sin(u) * np.cosh(v), 0.1 * v / 0.1], axis=-1)

    mine, exact = g.Chart(x).at(0.3, [0.4, 0.7]), g.Catenoid().at(0.3, [0.4, 0.7])
    np.testing.assert_allclose(mine.second_form, exact.second_form, rtol=1e-12, atol=1e-14)
    graph = g.Chart(lambda u, v: (u, v, u**2 * v)).at(0.5, 2.0)
    assert graph.second_form[0, 0] == pytest.approx(4 / np.sqrt(5.0625), rel=1e-14)


def test_given_derivatives() -> None:
    def x(u, v):
        return u, v, u**2 * v

    def first(u, v):
        return (1.0, 0.0, 2 * u * v), (0.0, 1.0, u**2)

    def second(u, v):
        return (0.0, 0.0, 2 * v), (0.0, 0.0, 2 * u), (0.0, 0.0, 0.0)

    chart = g.Chart(x, derivatives=(first, second))
    exact = g.Chart.from_expressions("u", "v", "u**2*v")
    u, v = np.array([0.1, 0.9]), np.array([0.5, -0.4])
    for name in ("first_form", "second_form", "christoffel", "principal_curvatures"):
        np.testing.assert_allclose(getattr(chart.at(u, v), name), getattr(exact.at(u, v), name), atol=1e-14)
    with pytest.raises(InputError, match="must return 3 components"):
        g.Chart(lambda u, v: np.array([u, v, u * v]), derivatives=(first, second))
    with pytest.raises(InputError, match="tuple of 2 vectors"):
        g.Chart(x, derivatives=(lambda u, v: np.zeros((2, 3)), second))
    with pytest.raises(InputError, match=r"order 3.*up to order 2"):
        chart.at(u, v).metric_derivatives()
    with pytest.raises(InputError, match="derivative"):
        g.Chart(x, derivatives=(first, lambda u, v: ((0, 0, 2 * v), (0, 0, u), (0, 0, 0))))


def test_functions_without_formula_are_refused() -> None:
    def branching(u, v):
        return (u, v, u) if u > v else (u, v, v)

    for function in (branching, lambda u, v: (u, v, np.interp(u, [0, 1], [0, 1])), lambda u, v: (u, v)):
        with pytest.raises(InputError, match=r"derivatives|components"):
            g.Chart(function)
    with pytest.raises(InputError, match="no derivative"):
        g.Chart.from_expressions("u", "v", "floor(u)").at(0.5, 0.5)


@pytest.mark.parametrize(
    ("chart", "u", "v", "place"),
    [
        (g.Cone(), 0.5, 0.0, "u = 0.5, v = 0"),
        (g.Sphere(), [1.0, 1.0], [1.0, 0.0], "u = 1, v = 0"),
        (g.Sphere(), 2.0, np.pi, "v = 3.14159265"),
        (g.Chart.from_expressions("u", "u", "v**2"), 0.0, 0.0, "u = 0, v = 0"),
    ],
)
def test_singular_parametrisations_are_refused_with_the_place(chart, u, v, place) -> None:
    with pytest.raises(InputError, match="singular") as error:
        chart.at(u, v)
    assert place in str(error.value)
    assert np.isfinite(chart(u, v)).all()  # the point itself is there


def test_values_that_are_not_finite_are_refused_with_the_place() -> None:
    with pytest.raises(InputError, match=r"parameter v is nan at index 1"):
        g.Torus().at([0.0, 1.0], [0.0, np.nan])
    root = g.Chart.from_expressions("u", "v", "sqrt(u)")
    with pytest.raises(InputError, match=r"not finite at u = -1, v = 2 \(and at 1 other"):
        root.at([1.0, -1.0, -2.0], 2.0)
    with pytest.raises(InputError, match="do not fit"):
        g.Torus().at([0.0, 1.0], [0.0, 1.0, 2.0])
    with pytest.raises(InputError, match="must be numbers"):
        g.Torus().at("here", 0.0)


def test_directions_are_checked() -> None:
    s = g.Plane().at(0.3, 0.3)
    with pytest.raises(InputError, match="zero vector"):
        s.normal_curvature((0.0, 0.0))
    with pytest.raises(InputError, match="leaves the tangent plane by 45"):
        s.normal_curvature((1.0, 0.0, 1.0))
    with pytest.raises(InputError, match="tangent plane"):
        s.section_curvature((1.0, 0.0), np.pi / 2)


def test_ranges_are_checked() -> None:
    with pytest.raises(InputError, match="empty"):
        g.Plane().area((1.0, 0.0))
    with pytest.raises(InputError, match="finite"):
        g.Plane().area((0.0, np.inf))
