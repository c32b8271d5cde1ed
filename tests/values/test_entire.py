"""Discs that hold values on complex balls, and None for formulas that may have singularities."""

import cmath
import math

import numpy as np
import pytest

from kshell.values.entire import on_balls

NAMES = {name: getattr(cmath, name) for name in ("sin", "cos", "exp", "sinh", "cosh")} | {
    "pi": math.pi,
    "e": math.e,
}
PLACES = np.array([[0.3, -0.7, 0.1], [1.4, 0.0, -2.0], [-0.9, 0.5, 0.0]])


@pytest.mark.parametrize(
    "text",
    [
        "x",
        "2",
        "e*pi",
        "exp(x)*cos(3*y)",
        "exp(-20*((x - 0.4)**2 + y**2))",
        "-sin(pi*x)*cosh(y)/2 + sinh(z - x*y)**3",
        "cos(x + y) - sinh(2*x)",
        "exp(sin(x)) + cosh(cos(y)*x)",
        "x**0 + (x - y)**4",
    ],
)
@pytest.mark.parametrize("radius", [0.05, 0.6])
def test_values_on_balls_are_within_the_disc(text, radius):
    found = on_balls(text, PLACES, np.full(3, radius))
    rng = np.random.default_rng(3)
    for place, bound in zip(PLACES, found, strict=True):
        centre = eval(text, NAMES, dict(zip("xyz", place, strict=True)))
        for turn in np.exp(2j * np.pi * rng.random((200, 3))):
            at = dict(zip("xyz", place + radius * turn, strict=True))
            assert abs(eval(text, NAMES, at) - centre) <= bound * (1 + 1e-12)


def test_discs_of_single_functions_are_no_larger_than_they_must_be():
    """exp grows most along the real axis, sin and cos where they grow along the imaginary one, from zeros and tops."""
    at, radius = np.zeros((1, 3)), np.array([0.8])
    sharp = {
        "exp(x)": math.expm1(0.8),
        "sin(x)": math.sinh(0.8),
        "cos(x)": math.cosh(0.8) - 1,
        "x": 0.8,
        "x**3": 0.512,
    }
    for text, bound in sharp.items():
        assert on_balls(text, at, radius)[0] == pytest.approx(bound, rel=1e-12)


@pytest.mark.parametrize(
    "value",
    [
        "abs(x)",
        "1/(3 + x)",
        "sqrt(x)",
        "x**0.5",
        "x**-1",
        "2**x",
        "1*(x > 0.5)",
        "x if y < 1 else 0",
        "where(x > 0, 1, 0)",
        "max(x, y)",
        "floor(x)",
        "tan(x)",
        "tanh(50*x)",
        "interp(x, 0, 0, 1, 1)",
        "exp(abs(x))",
        "sin(x) + sign(y)",
        "1/0",
        (0, 0, "abs(x)"),
        lambda x, y, z: x,
    ],
)
def test_nothing_is_claimed_of_what_may_jump(value):
    assert on_balls(value, PLACES, np.ones(3)) is None


def test_vectors_and_values_beyond_all_numbers():
    both = on_balls((1, "3*x", "4*x"), PLACES, np.ones(3))
    np.testing.assert_allclose(both, 5.0)
    assert np.isinf(on_balls("exp(exp(9*x)) - exp(exp(9*x))", PLACES, np.full(3, 5.0))).all()
