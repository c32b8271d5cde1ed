"""Columns of fields have names in .vtu files, and the head says what the values are of."""

import re

import meshio
import numpy as np

import kshell as ks


def test_names_of_columns_and_head(tmp_path):
    result = ks.solve(ks.Scene.load("meshes/scordelis_lo.toml"), error="off")
    result.save(tmp_path)
    text = (tmp_path / "result.vtu").read_text()
    names = dict(re.findall(r'Name="(\w+)" NumberOfComponents="\d"((?: ComponentName\d="\w+")+)', text))
    assert re.findall('"(\\w+)"', names["moment"]) == ["xx", "yy", "xy"]
    assert re.findall('"(\\w+)"', names["displacement"]) == ["x", "y", "z"]
    first = text.splitlines()[1]
    for words in ("title: Scordelis-Lo roof", "analysis: static", "model: shell koiter", "frame of tensors"):
        assert words in first
    again = meshio.read(tmp_path / "result.vtu")
    count = len(result.fields["moment"])
    np.testing.assert_array_equal(again.point_data["moment"][:count], result.fields["moment"])
