"""Least squares with sparse bases, against dense ones."""

import numpy as np
import pytest
import scipy.sparse as sp

from kshell.solvers.nearest import beside, nearest, picked


@pytest.mark.parametrize("kind", ["orthogonal", "coupled", "none"])
def test_nearest(kind):
    random = np.random.default_rng(0)
    basis = np.zeros((8, 3))
    basis[[0, 2, 5], [0, 1, 2]] = 1.0, -2.0, 3.0
    if kind == "coupled":
        basis[3, :2] = 1.0, 1.0
    if kind == "none":
        basis = basis[:, :0]
    find = nearest(sp.csr_matrix(basis))
    for given in (random.standard_normal(8), random.standard_normal((8, 4))):
        np.testing.assert_allclose(find(given), np.linalg.lstsq(basis, given, rcond=None)[0], atol=1e-13)


@pytest.mark.parametrize("kind", ["picks", "coupled", "none"])
def test_what_is_left(kind):
    random = np.random.default_rng(1)
    basis = np.zeros((8, 3))
    basis[[0, 2, 5], [0, 1, 2]] = 1.0, -2.0, 3.0
    if kind == "coupled":
        basis[3, :2] = 1.0, 1.0
    if kind == "none":
        basis = basis[:, :0]
    whole = sp.csc_matrix(basis)
    assert (picked(whole) is None) == (kind == "coupled")
    for given in (random.standard_normal(8), random.standard_normal((8, 4))):
        left = given - basis @ np.linalg.lstsq(basis, given, rcond=None)[0]
        np.testing.assert_allclose(beside(whole)(given), left, atol=1e-13)
