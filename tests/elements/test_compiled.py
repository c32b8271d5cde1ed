"""The compiled loops of elements make what those of numpy make, number by number."""

import numpy as np
import pytest

from kshell.elements import kernels
from kshell.elements.hierarchic import orthonormal

built = pytest.mark.skipif(kernels.compiled is None, reason="kshell was installed without a C compiler")


@built
@pytest.mark.parametrize("degree", [0, 1, 2, 5, 13, 31, 32])
def test_orthonormal(monkeypatch, degree):
    points = np.random.default_rng(degree).uniform(-0.2, 1.1, (7, 5, 2))
    chosen = [points, points[0], points[:, ::2], points[..., ::-1], points[:0], points[0, 0]]
    fast = [orthonormal(degree, some) for some in chosen]
    monkeypatch.setattr(kernels, "compiled", None)
    for one, some in zip(fast, chosen, strict=True):
        other = orthonormal(degree, some)
        assert one.shape == other.shape
        np.testing.assert_array_equal(one, other)
