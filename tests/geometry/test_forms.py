"""One-forms and two-forms: d, wedge, closed, exact, Stokes."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import kshell.geometry as g
from kshell.errors import InputError

UNIT = ((0.0, 1.0), (0.0, 1.0))
TURN = 2 * np.pi
ANGLE = ["-v/(u**2 + v**2)", "u/(u**2 + v**2)"]
CIRCLE = g.Curve.from_expressions("cos(t)", "sin(t)")

few = settings(max_examples=12, deadline=None, derandomize=True)
number = st.floats(-2, 2)


def test_d_of_a_function_and_dd_is_zero() -> None:
    f = g.ScalarField("sin(u)*v**2")
    u, v = np.array([0.3, 1.2]), np.array([0.7, -0.4])
    np.testing.assert_allclose(
        f.d()(u, v), np.stack([np.cos(u) * v**2, 2 * np.sin(u) * v], axis=-1), rtol=1e-14
    )
    np.testing.assert_allclose(f.d().d()(u, v), 0.0, atol=1e-15)
    assert g.OneForm(["u*v", "u**3"]).d()(2.0, 5.0) == pytest.approx(3 * 4 - 2)


@given(number, number, number, number)
@few
def test_wedge_is_bilinear_and_alternating(a: float, b: float, u: float, v: float) -> None:
    alpha, beta = g.OneForm(["u + v", "v**2"]), g.OneForm(["sin(u)", "u*v"])
    assert alpha.wedge(beta)(u, v) == pytest.approx(-beta.wedge(alpha)(u, v), abs=1e-12)
    assert alpha.wedge(alpha)(u, v) == pytest.approx(0.0, abs=1e-12)
    mixed = g.OneForm(lambda u, v: (a * (u + v) + b * np.sin(u), a * v**2 + b * u * v))
    assert mixed.wedge(beta)(u, v) == pytest.approx(a * alpha.wedge(beta)(u, v), abs=1e-11)


def test_leibniz_rule() -> None:
    f, omega = g.ScalarField("exp(u)*v"), g.OneForm(["u*v**2", "cos(u*v)"])
    u, v = np.random.default_rng(3).uniform(-1, 1, (2, 20))
    left = omega.times(f).d()(u, v)
    right = f.d().wedge(omega)(u, v) + f(u, v) * omega.d()(u, v)
    np.testing.assert_allclose(left, right, rtol=1e-12, atol=1e-13)


def test_stokes_on_a_rectangle_and_on_a_disc() -> None:
    omega = g.OneForm(["exp(u*v)", "sin(u) + u**3*v"])
    inside, around = g.stokes(omega, (-1.0, 2.0), (0.5, 1.5))
    assert inside == pytest.approx(around, rel=1e-11)
    polar = g.Chart.from_expressions("r*cos(a)", "r*sin(a)", "0", ("r", "a"))
    inside, around = g.stokes(omega.pulled_back(polar), (0.0, 2.0), (0.0, TURN))
    assert inside == pytest.approx(around, rel=1e-10)
    circle = g.Curve.from_expressions("2*cos(t)", "2*sin(t)")
    assert omega.along(circle, 0.0, TURN) == pytest.approx(around, rel=1e-11)


def test_area_by_stokes_and_the_area_form() -> None:
    area = g.OneForm(["-v/2", "u/2"]).along(g.Curve.from_expressions("3*cos(t)", "2*sin(t)"), 0, TURN)
    assert area == pytest.approx(6 * np.pi, rel=1e-12)
    torus = g.Torus(2, 1)
    assert g.TwoForm.area(torus).integrate((0, TURN), (0, TURN)) == pytest.approx(torus.area(), rel=1e-12)


def test_closed_and_exact() -> None:
    gradient = g.ScalarField("u**2*v + sin(v)").d()
    assert gradient.is_closed(*UNIT)
    assert gradient.is_exact(*UNIT)
    assert not g.OneForm(["v", "0"]).is_closed(*UNIT)
    assert not g.OneForm(["v", "0"]).is_exact(*UNIT)


def test_the_angle_form_is_closed_but_not_exact_around_the_origin() -> None:
    angle = g.OneForm(ANGLE)
    square = ((-1.0, 1.0), (-1.0, 1.0))
    assert angle.is_closed(*square)
    assert angle.along(CIRCLE, 0.0, TURN) == pytest.approx(TURN, rel=1e-13)
    assert not angle.is_exact(*square, loops=[(CIRCLE, 0.0, TURN)])
    assert angle.is_exact((0.5, 1.0), (-1.0, 1.0))
    with pytest.raises(InputError, match="does not close"):
        angle.is_exact(*square, loops=[(CIRCLE, 0.0, 1.0)])


def test_potential() -> None:
    f = g.ScalarField("u**2*v + sin(v)")
    u, v = np.random.default_rng(4).uniform(-1, 1, (2, 3, 4))
    np.testing.assert_allclose(
        f.d().potential(u, v, (0.3, 0.2)), f(u, v) - f(0.3, 0.2), rtol=1e-12, atol=1e-13
    )


def test_bad_forms_are_refused() -> None:
    with pytest.raises(InputError, match="not finite at u = 0, v = 0"):
        g.OneForm(ANGLE)(0.0, 0.0)
    with pytest.raises(InputError, match="2 components"):
        g.OneForm(["u", "v", "u"])
    with pytest.raises(InputError, match="unknown name"):
        g.ScalarField("u + w")
    with pytest.raises(InputError, match="empty"):
        g.stokes(g.OneForm(["u", "v"]), (1.0, 0.0), (0.0, 1.0))
