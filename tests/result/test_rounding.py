"""Reactions that are nothing but rounding are written as 0, whatever the units; result.json keeps them."""

import numpy as np
import pytest

import kshell as ks
from kshell.result.rounding import without_rounding

REACTIONS = {
    "left": {"force": np.array([-5e-11, 0.0, 3.0]), "moment": np.array([1.0, -2e-12, 0.0])},
    "right": {"force": np.array([0.0, 2e-11, 2e-9]), "moment": np.array([3e-13, 0.0, 0.0])},
}


@pytest.mark.parametrize("size", [1e-9, 1.0, 1e12])
def test_what_is_below_the_rounding_of_the_largest(size):
    given = {name: {key: size * v for key, v in each.items()} for name, each in REACTIONS.items()}
    shown = without_rounding(given, 1e-14)
    assert (shown["left"]["force"] / size).tolist() == pytest.approx([0.0, 0.0, 3.0], rel=1e-12)
    assert shown["right"]["force"].tolist() == [0.0, 0.0, size * 2e-9]
    assert shown["left"]["moment"].tolist() == [size, 0.0, 0.0]
    assert shown["right"]["moment"].tolist() == [0.0, 0.0, 0.0]
    assert given["left"]["force"][0] == -5e-11 * size  # what was given stays


def test_a_bad_balance_says_how_much_is_rounding_but_hides_little():
    assert without_rounding(REACTIONS, 1e-9)["right"]["force"].tolist() == [0.0, 0.0, 0.0]
    large = {"a": {"force": np.array([1.0, 1e-3, 0.0]), "moment": None}}
    assert without_rounding(large, 0.5)["a"]["force"].tolist() == [1.0, 1e-3, 0.0]
    assert without_rounding(large, float("nan"))["a"]["force"].tolist() == [1.0, 1e-3, 0.0]
    assert without_rounding({}, 0.0) == {}


def test_result_json_has_the_numbers_as_they_are():
    result = ks.solve(ks.Scene.load("meshes/box_girder.toml"), error="off", large_deflection=False)
    for name, reaction in result.reactions.items():
        assert result.to_dict()["reactions"][name]["force"] == np.asarray(reaction["force"]).tolist()
