"""What is written is read back the same, and a file is written whole or not at all."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kshell.errors import InputError
from kshell.mesh import Mesh, read_mesh, write_msh
from tests.mesh.mesh_samples import group_places, msh2_text, square, write_with_gmsh


@pytest.mark.parametrize("version", ["2.2", "4.1"])
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("by_gmsh", [False, True])
def test_round_trip(tmp_path, version, order, by_gmsh):
    if by_gmsh:
        write_with_gmsh(tmp_path / "first.msh", 4.1, True, order, False)
        mesh = read_mesh(tmp_path / "first.msh")
    else:
        mesh = square(3, order)
    path = tmp_path / "written.msh"
    write_msh(mesh, path, version)
    again = read_mesh(path)
    assert again.notes == ()
    np.testing.assert_array_equal(again.points, mesh.points)
    np.testing.assert_array_equal(again.edges, mesh.edges)
    assert {tuple(t) for t in again.triangles.tolist()} == {tuple(t) for t in mesh.triangles.tolist()}
    assert group_places(again) == group_places(mesh)
    if order == 2:
        np.testing.assert_array_equal(again.midpoints, mesh.midpoints)


@settings(max_examples=20, derandomize=True, deadline=None)
@given(
    chosen=st.lists(
        st.tuples(st.integers(0, 2), st.sets(st.integers(0, 7), min_size=1)), min_size=0, max_size=6
    ),
    version=st.sampled_from(["2.2", "4.1"]),
)
def test_any_overlap_of_groups(tmp_path_factory, chosen, version):
    bare = square(2)
    cells = (np.arange(len(bare.points)), bare.edges, bare.triangles)
    groups = {
        f"group {k}": cells[dimension][sorted(members)] for k, (dimension, members) in enumerate(chosen)
    }
    mesh = Mesh.from_arrays(bare.points, bare.triangles, groups)
    path = tmp_path_factory.mktemp("overlap") / "mesh.msh"
    write_msh(mesh, path, version)
    again = read_mesh(path)
    if groups:
        assert group_places(again) == group_places(mesh)
    assert len(again.triangles) == len(mesh.triangles)


@pytest.mark.parametrize("order", [1, 2])
def test_gmsh_reads_what_is_written(tmp_path, order):
    import gmsh

    mesh = square(3, order)
    for version in ("2.2", "4.1"):
        path = tmp_path / f"{version}.msh"
        write_msh(mesh, path, version)
        gmsh.initialize(readConfigFiles=False, interruptible=False)
        try:
            gmsh.option.setNumber("General.Terminal", 0)
            gmsh.open(str(path))
            names = {gmsh.model.getPhysicalName(d, t) for d, t in gmsh.model.getPhysicalGroups()}
            n_nodes = len(gmsh.model.mesh.getNodes()[0])
        finally:
            gmsh.finalize()
        assert names == set(mesh.groups)
        assert n_nodes == len(mesh.points) + (len(mesh.edges) if order == 2 else 0)


def test_names_shared_by_kinds_and_unnamed_groups_survive(tmp_path):
    names = '$PhysicalNames\n2\n1 5 "rim"\n2 1 "rim"\n$EndPhysicalNames\n'
    first, second = tmp_path / "first.msh", tmp_path / "second.msh"
    first.write_text(
        msh2_text([(0, 0, 0), (1, 0, 0), (0, 1, 0)], ["2 1 1 2 3", "1 5 1 2", "1 6 2 3"], names),
        encoding="utf-8",
    )
    mesh = read_mesh(first)
    write_msh(mesh, second)
    assert group_places(read_mesh(second)) == group_places(mesh)
    assert set(mesh.groups) == {"rim (curve)", "rim (surface)", "1:6"}


def test_an_earlier_file_survives_a_failure(tmp_path, monkeypatch):
    path = tmp_path / "mesh.msh"
    write_msh(square(2), path)
    before = path.read_text(encoding="utf-8")

    def full_disk(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.replace", full_disk)
    with pytest.raises(OSError, match="No space"):
        write_msh(square(3), path)
    assert path.read_text(encoding="utf-8") == before
    assert [file.name for file in tmp_path.iterdir()] == ["mesh.msh"]


def test_wrong_version_and_folder(tmp_path):
    with pytest.raises(InputError, match=r"choose '4\.1' or '2\.2'"):
        write_msh(square(2), tmp_path / "mesh.msh", "3")
    with pytest.raises(InputError, match="there is no folder"):
        write_msh(square(2), tmp_path / "nowhere" / "mesh.msh")
