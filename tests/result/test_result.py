import copy
import json
import os
import pickle

import meshio
import numpy as np
import pytest

import kshell as ks
from kshell.plate.recovery import Fields
from kshell.result.deferred import Deferred
from kshell.result.saving import write_together
from tests.scene.fabricated import fabricated_result, fields_at, square_mesh

KEYS = [
    "kshell",
    "title",
    "analysis",
    "model",
    "mesh",
    "probes",
    "extremes",
    "input",
    "strain_energy",
    "external_work",
    "reactions",
    "balance",
    "eigen",
    "path",
    "error",
    "solver",
    "warnings",
]


def test_document():
    document = json.loads(json.dumps(fabricated_result().to_dict(), allow_nan=False))
    assert list(document) == KEYS
    assert document["kshell"] == ks.__version__
    assert document["mesh"] == {"vertices": 81, "triangles": 128, "unknowns": 243}
    assert document["model"]["kind"] == "plate"
    centre = document["probes"]["centre"]
    assert centre["u"] == [0.0, 0.0, 1.0]
    assert centre["frame"] == "global x, y"
    assert {"x", "rotation", "M", "N", "stress_top", "stress_bottom"} <= set(centre)
    assert document["reactions"]["left"]["force"] == [0.0, 0.0, -5.0]
    assert document["error"]["kind"] == "none"
    assert document["error"]["estimate"] is None
    assert set(document["error"]["budget"]) == {
        "discretisation",
        "algebra",
        "shear",
        "large_deflection",
        "geometry",
    }


def test_extremes_keep_the_sign_and_the_place():
    mesh = square_mesh(4)
    fields = fields_at(mesh.points)
    fields["displacement"] *= -2.0
    extremes = fabricated_result(mesh, fields=fields).extremes
    assert extremes["deflection"] == {"value": -2.0, "at": [0.5, 0.5, 0.0], "group": "plate"}
    assert extremes["von_mises"]["value"] == pytest.approx(fields["von_mises_top"].max())


def test_probes_and_values_anywhere():
    result = fabricated_result()
    np.testing.assert_allclose(result.probe("centre")["u"], [0, 0, 1])
    with pytest.raises(
        ks.InputError, match=r'no probe "center": did you mean "centre"\? the probes are centre'
    ):
        result.probe("center")
    assert result.at([[0.5, 0.5, 0], [0.25, 0.5, 0]])["displacement"].shape == (2, 3)
    assert result.at([0.5, 0.5, 0])["displacement"].shape == (1, 3)
    with pytest.raises(ks.InputError, match="shape"):
        result.at([[0.5, 0.5]])
    with pytest.raises(ks.SolveError, match="vertices only"):
        fabricated_result(evaluate=None).at([[0.5, 0.5, 0]])


@pytest.mark.parametrize("value", [np.nan, np.inf, np.float64(np.nan)])
def test_no_nan_leaves(value, tmp_path):
    with pytest.raises(ks.SolveError, match="strain_energy"):
        fabricated_result(strain_energy=value).to_dict()
    result = fabricated_result()
    result.probes["centre"]["M"] = np.array([0.0, value, 0.0])
    with pytest.raises(ks.SolveError, match=r"probes.centre.M\[1\]"):
        result.save(tmp_path)
    result = fabricated_result()
    result.fields["moment"][3, 1] = value
    with pytest.raises(ks.SolveError, match="moment"):
        result.save(tmp_path)
    assert os.listdir(tmp_path) == []


def test_saved_files_read_back(tmp_path):
    result = fabricated_result()
    written = result.save(tmp_path / "deep" / "out")
    assert sorted(os.path.basename(path) for path in written) == ["result.json", "result.vtu"]
    assert json.loads((tmp_path / "deep/out/result.json").read_text(encoding="utf-8")) == json.loads(
        json.dumps(result.to_dict())
    )
    mesh = meshio.read(tmp_path / "deep/out/result.vtu")
    np.testing.assert_array_equal(mesh.points, result.mesh.points)
    np.testing.assert_array_equal(mesh.cells_dict["triangle"], result.mesh.triangles)
    for name, values in result.fields.items():
        np.testing.assert_array_equal(mesh.point_data[name], values)
    assert mesh.cell_data["thickness"][0].shape == (128,)
    assert mesh.cell_data["group west"][0].sum() == 64
    assert mesh.point_data["group left"].sum() == 9
    assert sorted(os.listdir(tmp_path / "deep/out")) == ["result.json", "result.vtu"]


def test_quadratic_triangles(tmp_path):
    result = fabricated_result(square_mesh(8, order=2))
    result.save(tmp_path)
    mesh = meshio.read(tmp_path / "result.vtu")
    cells = mesh.cells_dict["triangle6"]
    corners, middles = mesh.points[cells[:, :3]], mesh.points[cells[:, 3:]]
    np.testing.assert_allclose(middles, 0.5 * (corners + corners[:, [1, 2, 0]]), atol=1e-14)
    # cubic Hermite interpolation of the deflection: error h^4 / 384 max |w''''|
    exact = fields_at(mesh.points)["displacement"]
    error = np.abs(mesh.point_data["displacement"] - exact).max()
    assert 0 < error < (np.sqrt(2) / 8) ** 4 / 384 * 4 * np.pi**4
    assert mesh.point_data["group left"].sum() == 17


def test_a_failed_save_leaves_the_earlier_result(tmp_path):
    fabricated_result(title="first").save(tmp_path)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    broken = fabricated_result(title="second")
    broken.fields["moment"] = np.full((81, 3), np.nan)
    with pytest.raises(ks.SolveError):
        broken.save(tmp_path)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before
    fabricated_result(title="third").save(tmp_path)
    assert json.loads((tmp_path / "result.json").read_text(encoding="utf-8"))["title"] == "third"


def test_writing_is_all_or_nothing(tmp_path):
    (tmp_path / "a").write_text("old", encoding="utf-8")

    def fail(path):
        path.write_text("half", encoding="utf-8")
        raise OSError(28, "No space left on device", str(path))

    with pytest.raises(ks.InputError, match=r"No space left.*another output folder"):
        write_together(tmp_path, {"a": lambda path: path.write_text("new", encoding="utf-8"), "b": fail})
    assert (tmp_path / "a").read_text(encoding="utf-8") == "old"
    assert os.listdir(tmp_path) == ["a"]

    def interrupt(path):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_together(tmp_path, {"a": lambda path: path.write_text("new", encoding="utf-8"), "b": interrupt})
    assert (tmp_path / "a").read_text(encoding="utf-8") == "old"
    assert os.listdir(tmp_path) == ["a"]


def test_places_that_cannot_be_written(tmp_path):
    (tmp_path / "file").write_text("", encoding="utf-8")
    with pytest.raises(ks.InputError, match="cannot be written"):
        fabricated_result().save(tmp_path / "file")
    with pytest.raises(ks.InputError, match="cannot be written"):
        fabricated_result().save(tmp_path / "file" / "below")
    (tmp_path / "result.vtu").mkdir()
    with pytest.raises(ks.InputError, match=r"result.vtu: is a folder"):
        fabricated_result().save(tmp_path)
    assert not (tmp_path / "result.json").exists()


def test_deferred_values_are_made_once_and_copied_as_a_dict():
    calls = []

    def make(value):
        calls.append(value)
        return value

    deferred = Deferred({"a": lambda: make(1.0), "b": lambda: make(2.0)})
    assert list(deferred) == ["a", "b"]
    assert "b" in deferred
    assert len(deferred) == 2
    assert not calls
    assert deferred["a"] == deferred["a"] == 1.0
    assert calls == [1.0]
    assert dict(deferred) == {"a": 1.0, "b": 2.0}
    assert calls == [1.0, 2.0]
    deferred["c"] = 3.0
    del deferred["a"]
    for other in (copy.deepcopy(deferred), pickle.loads(pickle.dumps(deferred))):
        assert type(other) is dict
        assert other == {"b": 2.0, "c": 3.0}
    assert repr(deferred) == "{'b': 2.0, 'c': 3.0}"
    with pytest.raises(KeyError):
        deferred["a"]


def test_fields_of_a_plate_are_recovered_when_they_are_looked_at(monkeypatch):
    asked = []
    recover = Fields.stresses
    monkeypatch.setattr(Fields, "stresses", lambda *of: asked.append(1) or recover(*of))
    scene = ks.Scene(
        mesh=square_mesh(4),
        thickness=0.1,
        material=ks.Isotropic(E=1.0, nu=0.3),
        supports=[ks.Clamped("left")],
        loads=[ks.Pressure(1.0)],
    )
    result = ks.solve(scene, element="argyris")
    assert not asked
    worst = result.extremes["von_mises"]
    top, bottom = result.fields["von_mises_top"], result.fields["von_mises_bottom"]
    assert worst["value"] == np.maximum(top, bottom).max()
    assert len(asked) == 1


def test_names_and_words_that_xml_cannot_have(tmp_path):
    """Names of groups may hold anything; ParaView's own reader takes the file too."""
    mesh = square_mesh(2)
    names = ["<\"&'>", "tab\tand\nline", "bell\x07", "größe"]
    groups = {name: mesh.boundary_edges[:1] for name in names}
    groups = {name: mesh.edges[edges] for name, edges in groups.items()}
    result = fabricated_result(ks.Mesh.from_arrays(mesh.points, mesh.triangles, groups))
    result.nodal_values = "means --- of all <sides> --"
    result.save(tmp_path)
    known = {f"group {name}".replace("\x07", "\ufffd") for name in names}
    assert known <= set(meshio.read(tmp_path / "result.vtu").point_data)
    pyvista = pytest.importorskip("pyvista")
    read = pyvista.read(tmp_path / "result.vtu")
    np.testing.assert_array_equal(read.points, result.mesh.points)
    np.testing.assert_array_equal(read["displacement"], result.fields["displacement"])
    np.testing.assert_array_equal(read.cells_dict[5], result.mesh.triangles)
