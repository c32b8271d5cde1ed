"""Splines against those of scipy."""

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline

from kshell.plate.splines import spline_at, spline_derivatives


@pytest.mark.parametrize("count", [2, 4, 6, 9, 40, 200])
@pytest.mark.parametrize("degree", [1, 3, 5])
def test_open_curves(count, degree):
    if count <= degree:
        pytest.skip("too few points")
    random = np.random.default_rng(count)
    x, y = np.cumsum(random.uniform(0.5, 1.5, count)), random.standard_normal((count, 2))
    spline = make_interp_spline(x, y, k=degree)
    first, second = spline_derivatives(x, y, degree)
    np.testing.assert_allclose(first, spline(x, 1), atol=1e-10 * np.abs(spline(x, 1)).max())
    if degree > 1:
        np.testing.assert_allclose(second, spline(x, 2), atol=1e-10 * np.abs(spline(x, 2)).max())
    else:
        assert not second.any()


@pytest.mark.parametrize("count", [7, 9, 40, 200])
def test_closed_curves(count):
    random = np.random.default_rng(count)
    x, y = np.cumsum(random.uniform(0.5, 1.5, count)), random.standard_normal((count, 2))
    y[-1] = y[0]
    spline = make_interp_spline(x, y, k=5, bc_type="periodic")
    for found, order in zip(spline_derivatives(x, y, 5, periodic=True), (1, 2), strict=True):
        wanted = spline(x, order)
        np.testing.assert_allclose(found, wanted, atol=1e-9 * np.abs(wanted).max())
        np.testing.assert_allclose(found[-1], found[0], atol=1e-9 * np.abs(wanted).max())


@pytest.mark.parametrize(
    ("count", "degree", "periodic"), [(3, 2, False), (6, 4, False), (9, 5, False), (9, 5, True)]
)
def test_between_points(count, degree, periodic):
    random = np.random.default_rng(count)
    x, y = np.cumsum(random.uniform(0.5, 1.5, count)), random.standard_normal((count, 2))
    if periodic:
        y[-1] = y[0]
    at = np.concatenate([x, random.uniform(x[0], x[-1], 20)])
    spline = make_interp_spline(x, y, k=degree, bc_type="periodic" if periodic else None)
    for found, order in zip(spline_at(x, y, degree, at, periodic), (0, 1), strict=True):
        wanted = spline(at, order)
        np.testing.assert_allclose(found, wanted, atol=1e-9 * np.abs(wanted).max())
