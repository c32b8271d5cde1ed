"""Meshes of meshio and scikit-fem, and the formats meshio reads."""

from __future__ import annotations

import meshio
import numpy as np
import pytest
import skfem

from kshell.errors import InputError
from kshell.mesh import check, read_mesh
from tests.mesh.mesh_samples import group_places, square, write_with_gmsh


def test_scikit_fem_with_boundaries_and_subdomains():
    source = skfem.MeshTri().refined(2).with_defaults().with_subdomains({"half": lambda x: x[0] < 0.5})
    mesh = read_mesh(source)
    summary = {group.name: group for group in check.summary(mesh).groups}
    assert {name: group.kind for name, group in summary.items()} == {
        "left": "curve", "right": "curve", "bottom": "curve", "top": "curve", "half": "surface",
    }  # fmt: skip
    assert summary["half"].measure == pytest.approx(0.5)
    for name, place in (("left", (0, 0.0)), ("right", (0, 1.0)), ("bottom", (1, 0.0)), ("top", (1, 1.0))):
        ends = mesh.points[mesh.edges[mesh.groups[name].members]]
        np.testing.assert_array_equal(ends[..., place[0]], place[1])
        assert len(ends) == 4


def test_scikit_fem_of_order_2():
    mesh = read_mesh(skfem.MeshTri2.init_circle(3))
    assert mesh.order == 2
    rim = mesh.midpoints[mesh.boundary_edges]
    np.testing.assert_allclose(np.linalg.norm(rim, axis=1), 1.0, rtol=1e-12)
    assert check.summary(mesh).area == pytest.approx(np.pi, rel=2e-5)


def test_scikit_fem_there_and_back():
    mesh = square(3)
    again = read_mesh(mesh.to_skfem())
    places = group_places(mesh)
    del places["origin"]  # scikit-fem has no groups of points
    assert group_places(again) == places


@pytest.mark.parametrize("version", [2.2, 4.1])
def test_meshio_objects(tmp_path, version):
    path = tmp_path / "mesh.msh"
    write_with_gmsh(path, version, False, 2, False)
    own, foreign = read_mesh(path), read_mesh(meshio.read(path))
    assert foreign.order == 2
    assert foreign.notes == ()  # no group comes twice
    if version == 2.2:  # of a curve in two groups meshio keeps the first one in 4.1
        assert own.groups["1:7"].members.tolist() == foreign.groups["1:7"].members.tolist()
    np.testing.assert_array_equal(foreign.points, own.points)
    for name in ("right half", "middle"):
        assert group_places(foreign)[name] == group_places(own)[name]


@pytest.mark.parametrize("suffix", ["vtu", "vtk", "stl", "obj", "ply", "off", "mesh", "bdf"])
def test_formats(tmp_path, suffix):
    mesh = square(3)
    path = tmp_path / f"mesh.{suffix}"
    # Nastran keeps 32-bit coordinates; PLY keeps 32-bit indices
    meshio.write(path, meshio.Mesh(mesh.points, [("triangle", mesh.triangles)]))
    read = read_mesh(path)
    assert len(read.triangles) == 18
    assert len(read.points) == 16
    assert read.areas.sum() == pytest.approx(1.0, rel=1e-5)
    assert read.source == path.name


def test_cell_sets_of_several_kinds():
    mesh = square(2)
    cells = [("line", mesh.edges[mesh.boundary_edges]), ("triangle", mesh.triangles)]
    sets = {"all": [np.arange(8), np.arange(8)], "part": [np.empty(0, int), np.array([1, 2])]}
    read = read_mesh(meshio.Mesh(mesh.points, cells, cell_sets=sets))
    assert {name: len(group.members) for name, group in read.groups.items()} == {
        "all (curve)": 8, "all (surface)": 8, "part": 2,
    }  # fmt: skip


def test_quadrilaterals_are_split():
    source = meshio.Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [("quad", [[0, 1, 2, 3]])])
    mesh = read_mesh(source)
    assert (len(mesh.triangles), mesh.areas.sum()) == (2, pytest.approx(1.0))
    assert mesh.notes == ("1 quadrilateral split into triangles along the shorter diagonal",)


def test_groups_numbered_by_cell_data(tmp_path):
    mesh = square(2)
    left = mesh.edges[mesh.groups["left"].members]
    half = np.array([1, 1, 2, 2, 1, 1, 2, 2])
    path = tmp_path / "mesh.vtu"
    cells = [("triangle", mesh.triangles), ("line", left)]
    meshio.write(path, meshio.Mesh(mesh.points, cells, cell_data={"CellEntityIds": [half, np.full(2, 11)]}))
    found = {name: (group.kind, len(group.members)) for name, group in read_mesh(path).groups.items()}
    assert found == {"1:11": ("curve", 2), "2:1": ("surface", 4), "2:2": ("surface", 4)}
    meshio.write(
        path, meshio.Mesh(mesh.points, cells[:1], cell_data={"layup": [half], "serial": [np.arange(8)]})
    )
    found = {name: (group.kind, len(group.members)) for name, group in read_mesh(path).groups.items()}
    assert found == {"layup 1": ("surface", 4), "layup 2": ("surface", 4)}  # serial numbers are no groups


def test_other_objects():
    with pytest.raises(InputError, match=r"scikit-fem MeshQuad1: kshell takes triangles only.*to_meshtri"):
        read_mesh(skfem.MeshQuad())
    with pytest.raises(InputError, match="object of class dict"):
        read_mesh({})


WRONG_FILES = {
    "mesh.vtu": ("<VTKFile><broken", "meshio cannot read it"),
    "mesh.vtk": ("# vtk DataFile Version 3.0\nnonsense\n", "meshio cannot read it"),
    "mesh.stl": ("solid x\n facet normal 0 0\n", "is ended by endsolid|are ended by endsolid"),
    "mesh.inp": ("", "the file is empty"),
    "mesh.doc": ("text", r"the format '\.doc' is not known\. Readable are"),
    "mesh": ("text", "the format '' is not known"),
}


@pytest.mark.parametrize("name", WRONG_FILES)
def test_wrong_files(tmp_path, name, capfd):
    text, message = WRONG_FILES[name]
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=message):
        read_mesh(path)
    assert capfd.readouterr().out == ""
