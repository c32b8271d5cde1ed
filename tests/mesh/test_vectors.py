import numpy as np
import pytest

from kshell.mesh.vectors import cross


@pytest.mark.parametrize(
    ("one", "other"), [((4, 3), (4, 3)), ((2, 4, 3), (2, 4, 3)), ((3,), (5, 3)), ((4, 1, 3), (3, 3))]
)
def test_vector_products_are_those_of_numpy(one, other):
    rng = np.random.default_rng(1)
    a, b = rng.normal(size=one), rng.normal(size=other)
    np.testing.assert_array_equal(cross(a, b), np.cross(a, b))
