"""Results read back from their files, and what differs between two."""

import json
from pathlib import Path

import numpy as np
import pytest

import kshell as ks
from kshell.result.compare import differences

MESHES = Path(__file__).parents[2] / "meshes"


def plate(**changes):
    scene = ks.Scene.load(MESHES / "plate_cases.toml")
    return scene.changed(**changes)


@pytest.mark.parametrize("name", ["plate_cases", "scordelis_lo", "box_girder"])
def test_a_result_comes_back(name, tmp_path):
    scene = ks.Scene.load(MESHES / f"{name}.toml")
    result = ks.solve(scene)
    result.save(tmp_path)
    again = ks.Result.load(tmp_path)
    assert again.to_dict() == result.to_dict()
    assert list(again.fields) == list(result.fields)
    for key, values in result.fields.items():
        assert np.array_equal(again.fields[key].reshape(values.shape), values)
    assert np.array_equal(again.mesh.triangles, result.mesh.triangles)
    assert set(again.mesh.groups) == set(result.mesh.groups)
    for key, group in result.mesh.groups.items():
        assert again.mesh.groups[key].dimension == group.dimension
        assert sorted(again.mesh.groups[key].members) == sorted(group.members)
    assert list(again.cases) == list(result.cases)
    assert differences(result, again) == []
    at = result.mesh.points[[0, 7]]
    assert again.at(at)["u"] == pytest.approx(again.fields["displacement"][[0, 7]], abs=1e-15)
    assert set(again.save(tmp_path / "copy")) == {
        str(tmp_path / "copy" / path.name) for path in tmp_path.iterdir() if path.is_file()
    }


def test_differences():
    a = ks.solve(plate(cases=(), combinations=()))
    loads = [load.times(1.01) for load in plate().loads]
    b = ks.solve(plate(cases=(), combinations=(), loads=loads))
    found = {d.what: d for d in differences(a, b)}
    assert found["probes.centre.u"].relative == pytest.approx(1 - 1 / 1.01, rel=1e-6)
    assert found["strain_energy"].relative == pytest.approx(1 - 1 / 1.01**2, rel=1e-6)
    assert found["field displacement, largest"].relative == pytest.approx(1 - 1 / 1.01, rel=1e-6)
    assert differences(a, a) == []
    b.probes["centre"]["u"] = a.probes["centre"]["u"] * (1 + 1e-12)
    a.reactions["rounding"] = {"force": [0.0, 0.0, 1e-13], "moment": [0.0, 0.0, 0.0]}
    b.reactions["rounding"] = {"force": [0.0, 0.0, -1e-13], "moment": [0.0, 0.0, 0.0]}
    found = {d.what for d in differences(a, b)}
    assert not found & {"probes.centre.u", "reactions.rounding.force"}
    assert {"probes.centre.u", "reactions.rounding.force"} <= {d.what for d in differences(a, b, 0.0)}
    c = ks.solve(plate(cases=(), combinations=(), probes={}), element="morley")
    assert {"model", "probes.centre"} <= {d.what for d in differences(a, c)}


def test_bad_folders(tmp_path):
    with pytest.raises(ks.InputError, match="no such file"):
        ks.Result.load(tmp_path / "none")
    (tmp_path / "result.json").write_text("{", encoding="utf-8")
    with pytest.raises(ks.InputError, match="cannot be read"):
        ks.Result.load(tmp_path)
    (tmp_path / "result.json").write_text(json.dumps({"a": 1}), encoding="utf-8")
    with pytest.raises(ks.InputError, match="not a result"):
        ks.Result.load(tmp_path)
    ks.solve(plate(cases=(), combinations=()), element="morley").save(tmp_path)
    (tmp_path / "result.vtu").write_text("<VTK", encoding="utf-8")
    with pytest.raises(ks.InputError, match=r"result\.vtu"):
        ks.Result.load(tmp_path)
