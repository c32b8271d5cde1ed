import numpy as np
import pytest

from kshell.errors import InputError
from kshell.values.varying import is_constant, show, values_at

POINTS = np.array([[[0.0, 0.0, 0.0], [1.0, 2.0, 3.0]], [[2.0, 0.0, 1.0], [0.5, 0.5, 0.5]]])  # (2, 2, 3)
X = POINTS[..., 0]


@pytest.mark.parametrize(
    "value", [2.0, np.float64(2), "2", "x*0 + 2", lambda x, y, z: 2.0, lambda x, y, z: np.full_like(x, 2)]
)
def test_scalars(value):
    values = values_at(value, POINTS)
    assert values.shape == (2, 2)
    assert (values == 2.0).all()


@pytest.mark.parametrize(
    "value",
    [
        [1, "x", 0],
        (1.0, lambda x, y, z: x, "0"),
        lambda x, y, z: (1, x, 0 * y),
        lambda x, y, z: np.stack([np.ones_like(x), x, 0 * x]),
    ],
)
@pytest.mark.parametrize("points", [POINTS, POINTS.reshape(-1, 3)[:3], POINTS[0, 1]])
def test_vectors(value, points):
    values = values_at(value, points, components=3)
    assert values.shape == points.shape
    np.testing.assert_array_equal(values[..., 0], 1.0)
    np.testing.assert_array_equal(values[..., 1], points[..., 0])
    np.testing.assert_array_equal(values[..., 2], 0.0)


def test_components_in_the_last_axis_are_not_mistaken():
    with pytest.raises(InputError, match="3 components"):
        values_at(lambda x, y, z: np.stack([x, y, z], axis=-1), POINTS.reshape(-1, 3)[:3], components=3)


@pytest.mark.parametrize(
    ("value", "components", "words"),
    [
        ("1/x", None, ["load", '"1/x"', "inf at (0, 0, 0)"]),
        ("log(x - 1)", None, ["nan"]),
        (lambda x, y, z: np.sqrt(x - 1.5), None, ["nan at (0, 0, 0)"]),
        ([0, 0, "1/(y - 2)"], 3, ["inf at (1, 2, 3)"]),
        (lambda x: x, None, ["failed", "three arrays of shape (4,)"]),
        (lambda x, y, z: 1 if x > 0 else 2, None, ["np.where"]),
        (lambda x, y, z: np.zeros(7), None, ["must return one array"]),
        (lambda x, y, z: (x, y), 3, ["3 components"]),
        ([1, 2], 3, ["3 components", "[1, 2]"]),
        ("x^2", None, ["load", "**"]),
    ],
)
def test_unusable_values_name_the_place(value, components, words):
    with pytest.raises(InputError) as caught:
        values_at(value, POINTS, components, what="load 1 (pressure)")
    for word in words:
        assert word in str(caught.value)


def test_constants_are_told_apart():
    assert is_constant(1.0)
    assert is_constant((1, 2.0, 0))
    assert not is_constant("1")
    assert not is_constant((1, "x", 0))
    assert not is_constant(lambda x, y, z: x)


def test_values_in_words():
    assert show([1, "x", 2.5]) == '[1, "x", 2.5]'
