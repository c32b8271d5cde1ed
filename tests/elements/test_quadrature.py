"""Quadrature on the triangle: exact to its degree, inside, positive where that is known."""

from math import factorial

import numpy as np
import pytest

from kshell.elements.quadrature import triangle_rule


@pytest.mark.parametrize("degree", range(24))
def test_exact_for_polynomials(degree):
    points, weights = triangle_rule(degree)
    (x, y), error = points.T, 0.0
    for a in range(degree + 1):
        for b in range(degree + 1 - a):
            exact = factorial(a) * factorial(b) / factorial(a + b + 2)
            error = max(error, abs((weights * x**a * y**b).sum() - exact))
    assert error < 5e-16
    assert (points > 0).all()
    assert (points.sum(axis=1) < 1).all()


def test_rules_are_lean():
    """Points of the symmetric rules; a rule of the Gauss type on a square has (degree / 2 + 1)^2 of them."""
    assert [len(triangle_rule(d)[1]) for d in (2, 4, 6, 8, 10, 14, 17, 19)] == [3, 6, 12, 16, 25, 42, 61, 73]


def test_moments_do_not_depend_on_the_vertex():
    points, weights = triangle_rule(9)
    first = 1 - points.sum(axis=1)
    for power in (12, 15):  # beyond the degree: symmetry alone makes these equal
        moments = [weights @ coordinate**power for coordinate in (first, *points.T)]
        np.testing.assert_allclose(moments, moments[0], rtol=1e-13)
