"""Columns of fields have names in .vtu files, and the head says what the values are of."""

import re

import meshio
import numpy as np
import pytest

import kshell as ks
from tests.plate.plates import UNIT, rectangle


def test_names_of_columns_and_head(tmp_path):
    result = ks.solve(ks.Scene.load("meshes/scordelis_lo.toml"), error="off")
    result.save(tmp_path)
    text = (tmp_path / "result.vtu").read_text(encoding="utf-8")
    names = dict(re.findall(r'Name="(\w+)" NumberOfComponents="\d"((?: ComponentName\d="\w+")+)', text))
    assert re.findall('"(\\w+)"', names["moment"]) == ["xx", "yy", "xy"]
    assert re.findall('"(\\w+)"', names["displacement"]) == ["x", "y", "z"]
    first = text.splitlines()[1]
    for words in ("title: Scordelis-Lo roof", "analysis: static", "model: shell koiter", "frame of tensors"):
        assert words in first
    again = meshio.read(tmp_path / "result.vtu")
    count = len(result.fields["moment"])
    np.testing.assert_array_equal(again.point_data["moment"][:count], result.fields["moment"])
    facts = set(again.field_data)
    assert {"title: Scordelis-Lo roof", "analysis: static", f"kshell: {ks.__version__}"} <= facts


def test_paraview_lists_what_a_file_is_of(tmp_path):
    pyvista = pytest.importorskip("pyvista")
    mesh = rectangle(2)
    result = ks.solve(
        ks.Scene(
            mesh=mesh,
            title='A "plate" <with> ü & more',
            units="N, mm",
            thickness=1.0,
            material=ks.Isotropic(**UNIT),
            supports=[ks.Clamped("left")],
            loads=[ks.Pressure(1.0, name="snow")],
            cases=[ks.Case("winter", ["snow"])],
        ),
        large_deflection=False,
    )
    result.save(tmp_path)
    envelope = (tmp_path / "envelope.vtu").read_text(encoding="utf-8")
    assert 'Name="max_moment" NumberOfComponents="3" ComponentName0="xx"' in envelope
    assert 'Name="min_case_shear" NumberOfComponents="2" ComponentName0="x"' in envelope
    read = pyvista.read(tmp_path / "case-winter.vtu")
    assert {'title: A "plate" <with> ü & more', "case: winter", "units: N, mm"} <= set(read.field_data.keys())
    assert read.n_cells == len(mesh.triangles)


def test_states_in_one_file(tmp_path):
    pytest.importorskip("h5py")
    scene = ks.Scene(
        mesh=rectangle(2),
        thickness=0.1,
        material=ks.Isotropic(**UNIT),
        supports=[ks.Clamped("left")],
        loads=[ks.LineForce("right", (0, 0, 1e-4))],
        probes={"tip": (1, 0.5, 0)},
    )
    path = ks.trace(scene, steps=2)
    written = path.save(tmp_path, xdmf=True)
    names = {name.rpartition("/")[2] for name in written}
    assert {"series.xdmf", "series.h5"} <= names
    assert not any(name.startswith("step-") or name.endswith(".pvd") for name in names)
    with meshio.xdmf.TimeSeriesReader(tmp_path / "series.xdmf") as reader:
        points, cells = reader.read_points_cells()
        assert len(points) == len(path.points)
        assert len(cells[0].data) == len(path.mesh.triangles)
        assert reader.num_steps == len(path.series)
        time, fields, _ = reader.read_data(reader.num_steps - 1)
    assert time == path.series[-1][0]
    np.testing.assert_array_equal(fields["displacement"], path.series[-1][1]().fields["displacement"])
    path.save(tmp_path / "each")
    step = sorted((tmp_path / "each").glob("step-*.vtu"))[-1]
    facts = meshio.read(step).field_data
    assert facts["TimeValue"].tolist() == [time]
    assert {"analysis: path", f"model: shell koiter of order {path.model['order']}"} <= set(facts)
    with pytest.raises(ks.InputError, match="no states of a path or motion"):
        ks.solve(scene, large_deflection=False).save(tmp_path / "static", xdmf=True)
