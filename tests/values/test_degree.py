"""Degrees of formulas that are polynomials, and None for all others."""

import numpy as np
import pytest

from kshell.values.degree import polynomial_degree


@pytest.mark.parametrize(
    ("value", "degree"),
    [
        (3.0, 0),
        ("2*pi", 0),
        ("z + sin(1)", 0),
        ("1 - x/2", 1),
        ("-(x + y)**2 * x", 3),
        ("x*y/(2 + 1)", 2),
        ((0, 0, "x**4"), 4),
        (np.array([1.0, 2.0]), 0),
        ("sin(x)", None),
        ("1/x", None),
        ("x**0.5", None),
        ("x**-1", None),
        ("x if y < 1 else 0", None),
        ("abs(x)", None),
        ((0, "exp(y)", 1), None),
        (lambda x, y, z: x, None),
    ],
)
def test_degree(value, degree):
    assert polynomial_degree(value) == degree
