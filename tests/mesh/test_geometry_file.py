"""Geometry files are meshed through gmsh, in silence, and what goes wrong is said in gmsh's words."""

from __future__ import annotations

import os
import sys

import numpy as np
import pytest

from kshell.errors import InputError
from kshell.mesh import check, read_mesh

SQUARE = """SetFactory("OpenCASCADE");
Rectangle(1) = {0, 0, 0, 1, 1};
MeshSize{ PointsOf{ Surface{1}; } } = 0.5;
Physical Curve("left") = {4};
"""


@pytest.fixture
def geo(tmp_path):
    def write(text: str, name: str = "shape.geo"):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return path

    return write


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="file names are bytes on Linux")
@pytest.mark.parametrize("name", [b"r\xe9.geo", b"r\xe9/shape.geo"])
def test_names_in_other_encodings_are_refused_in_words(name, tmp_path):
    path = tmp_path / os.fsdecode(name)
    path.parent.mkdir(exist_ok=True)
    path.write_text(SQUARE, encoding="utf-8")
    with pytest.raises(InputError, match="names in UTF-8"):
        read_mesh(path)
    sound = tmp_path / "shape.geo"
    sound.write_text(SQUARE, encoding="utf-8")
    assert read_mesh(sound).areas.sum() == pytest.approx(1.0)


def test_sizes_and_orders(geo):
    path = geo(SQUARE)
    sizes = {size: read_mesh(path, size) for size in (None, 0.25, 0.125)}
    assert len(sizes[None].groups["left"].members) == 2
    assert len(sizes[0.25].groups["left"].members) == 4
    assert len(sizes[0.125].groups["left"].members) == 8
    assert read_mesh(path).order == 1
    assert read_mesh(path, mesh_order=2).order == 2
    assert read_mesh(geo(SQUARE + "Mesh.ElementOrder = 2;\n")).order == 2
    assert read_mesh(geo(SQUARE + "Mesh.ElementOrder = 3;\n"), mesh_order=1).order == 1


def test_a_file_that_meshes_itself(geo):
    text = SQUARE + "Mesh 2;\n"
    assert len(read_mesh(geo(text)).groups["left"].members) == 2
    assert len(read_mesh(geo(text), 0.25).groups["left"].members) == 4


def test_groups_survive_whatever_the_file_asks_to_be_written(geo):
    for more in (
        "Mesh.SaveAll = 1;\n",
        "Mesh.MshFileVersion = 2.2;\n",
        "Mesh.Binary = 1;\n",
        'Physical Surface("all") = {1};\n',
    ):
        mesh = read_mesh(geo(SQUARE + more))
        assert mesh.areas.sum() == pytest.approx(1.0)
        assert mesh.groups["left"].kind == "curve"


def test_a_single_line_without_line_end_keeps_its_groups(geo):
    assert set(read_mesh(geo(SQUARE.replace("\n", " "))).groups) == {"left"}


def test_curved_sides_at_order_2(geo):
    mesh = read_mesh(geo('SetFactory("OpenCASCADE");\nDisk(1) = {0, 0, 0, 1};\n'), 0.3, 2)
    rim = mesh.midpoints[mesh.boundary_edges]
    np.testing.assert_allclose(np.linalg.norm(rim, axis=1), 1.0, rtol=1e-9)
    assert check.summary(mesh).area == pytest.approx(np.pi, rel=1e-4)


@pytest.mark.parametrize("suffix", ["step", "brep"])
def test_surfaces_of_cad_files(tmp_path, suffix):
    """Two faces: they are called by gmsh's numbers."""
    import gmsh

    path = tmp_path / f"box.{suffix}"
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.occ.addRectangle(0, 0, 0, 2, 1)
    gmsh.model.occ.addRectangle(3, 0, 0, 1, 1)
    gmsh.model.occ.synchronize()
    gmsh.write(str(path))
    gmsh.finalize()
    mesh = read_mesh(path, 0.5)
    assert mesh.areas.sum() == pytest.approx(3.0)
    assert {"2:1", "2:2"} <= set(mesh.groups)
    assert any("no physical groups" in note for note in mesh.notes)
    assert any("millimetres" in note for note in mesh.notes) == (suffix == "step")


def test_a_crack_opened_by_gmsh_is_a_slit(geo):
    text = """h = 0.2;
Point(1) = {0, 0, 0, h}; Point(2) = {1, 0, 0, h}; Point(3) = {1, 1, 0, h}; Point(4) = {0, 1, 0, h};
Point(5) = {0, 0.5, 0, h}; Point(6) = {0.5, 0.5, 0, h};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5}; Line(5) = {5, 1}; Line(6) = {5, 6};
Curve Loop(1) = {1:5}; Plane Surface(1) = {1}; Curve{6} In Surface{1};
Physical Surface("plate", 1) = {1}; Physical Curve("crack", 2) = {6}; Physical Point("mouth", 3) = {5};
Mesh 2;
Plugin(Crack).Dimension = 1; Plugin(Crack).PhysicalGroup = 2; Plugin(Crack).OpenBoundaryPhysicalGroup = 3;
Plugin(Crack).Run;
"""
    mesh = read_mesh(geo(text))
    sides = {group.name: group.measure for group in check.summary(mesh).groups}
    assert sides["crack"] == pytest.approx(1.0)  # both sides
    assert mesh.notes == ("slit: 3 pairs of vertices at the same place, e.g. at (0, 0.5)",)


def test_sheets_that_meet_in_a_tee(geo):
    text = """SetFactory("OpenCASCADE");
Rectangle(1) = {0, 0, 0, 1, 1};
Rectangle(2) = {0, 0, 0, 1, 1};
Rotate{ {0, 1, 0}, {0.5, 0, 0}, Pi/2 }{ Surface{2}; }
Coherence;
"""
    mesh = read_mesh(geo(text), 0.25)
    assert np.count_nonzero(mesh.edge_counts == 4) == 4
    assert any("sheets of a shell branch" in note for note in mesh.notes)


def test_output_stays_clean(geo, capfd):
    read_mesh(geo(SQUARE + 'Printf("chatter");\n'))
    with pytest.raises(InputError):
        read_mesh(geo("nonsense (;\n"))
    captured = capfd.readouterr()
    assert (captured.out, captured.err) == ("", "")
    print("still here")
    assert capfd.readouterr().out == "still here\n"


WRONG = {
    "syntax": ("nonsense (;\n", "gmsh cannot mesh it: 'shape.geo', line 1: syntax error"),
    "unknown loop": ("Plane Surface(1) = {7};\n", "Unknown curve loop 7"),
    "no surface": ("Point(1) = {0, 0, 0};\n", "has no surface to mesh"),
    "order 5": (SQUARE + "Mesh.ElementOrder = 5;\n", "order 5 or higher"),
    "unmerged": (SQUARE + "Rectangle(2) = {1, 0, 0, 1, 1};\n", "vertices at the same place.*Coherence"),
    "overlap": (SQUARE + "Rectangle(2) = {0.3, 0.3, 0.4, 1, 1};\n", None),
}


@pytest.mark.parametrize("case", WRONG)
def test_wrong_geometry(geo, case):
    import gmsh

    text, message = WRONG[case]
    if message is None:
        assert any("2 parts that are not connected" in note for note in read_mesh(geo(text)).notes)
    else:
        with pytest.raises(InputError, match=message) as caught:
            read_mesh(geo(text))
        assert str(caught.value).startswith("shape.geo: ")
        assert "/" not in str(caught.value).split("Open the file")[0]
    assert not gmsh.isInitialized()


def test_merging_as_advised(geo):
    text = SQUARE + "Rectangle(2) = {1, 0, 0, 1, 1};\nCoherence;\n"
    assert read_mesh(geo(text)).notes == ()


@pytest.mark.parametrize(
    "options", [{"mesh_size": 0.0}, {"mesh_size": -1.0}, {"mesh_size": float("nan")}, {"mesh_order": 3}]
)
def test_wrong_options(geo, options):
    with pytest.raises(InputError, match=r"mesh_(size|order) must be"):
        read_mesh(geo(SQUARE), **options)


def test_options_are_for_geometry_only(tmp_path):
    path = tmp_path / "mesh.msh"
    path.write_text("", encoding="utf-8")
    with pytest.raises(InputError, match=r"mesh_size is for geometry files.*mesh\.msh is meshed already"):
        read_mesh(path, 0.1)
    with pytest.raises(InputError, match="mesh_order is for geometry files"):
        read_mesh(path, mesh_order=2)


def test_missing_files(tmp_path, geo):
    geo(SQUARE)
    with pytest.raises(InputError, match=r"shapes\.geo not found\. Did you mean 'shape\.geo'"):
        read_mesh(tmp_path / "shapes.geo")
    with pytest.raises(InputError, match="is a folder"):
        read_mesh(tmp_path)


class _Failing:
    """An import that fails as it does on a machine without the graphics libraries."""

    def __init__(self, error: Exception) -> None:
        self.error = error

    def find_spec(self, name, *_):
        if name == "gmsh":
            raise self.error


@pytest.mark.parametrize(
    ("error", "message"),
    [
        (
            OSError("libGLU.so.1: cannot open shared object file"),
            "apt-get install libglu1-mesa .*or mesh the file elsewhere",
        ),
        (OSError("libXft.so.2: cannot open shared object file"), "apt-get install libxft2 libglu1-mesa"),
        (ModuleNotFoundError("No module named 'gmsh'"), "pip install gmsh"),
    ],
)
def test_gmsh_that_cannot_be_loaded(geo, monkeypatch, error, message):
    monkeypatch.delitem(sys.modules, "gmsh", raising=False)
    monkeypatch.setattr(sys, "meta_path", [_Failing(error), *sys.meta_path])
    with pytest.raises(InputError, match=message):
        read_mesh(geo(SQUARE))


def test_a_session_of_the_caller_is_left_alone(geo):
    import gmsh

    path = geo(SQUARE)
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    try:
        with pytest.raises(InputError, match=r"gmsh is in use already.*gmsh\.finalize\(\)"):
            read_mesh(path)
        assert gmsh.isInitialized()
    finally:
        gmsh.finalize()


BOX = 'SetFactory("OpenCASCADE");\nBox(1) = {0, 0, 0, 1000, 500, 10};\nMesh.MeshSizeMin = 200;\n'


def test_a_solid_is_not_its_skin(geo):
    with pytest.raises(
        InputError, match=r"holds 1 solid, whose skin of 6 faces.*Physical Surface\(.plate.\)"
    ):
        read_mesh(geo(BOX))
    mesh = read_mesh(geo(BOX + 'Physical Surface("mid") = {5};\n'))
    assert mesh.areas.sum() == pytest.approx(5e5)
    assert list(mesh.groups) == ["mid"]


def test_a_solid_in_a_cad_file(geo, tmp_path):
    import gmsh

    gmsh.initialize(readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(geo(BOX)))
        gmsh.write(str(tmp_path / "box.step"))
    finally:
        gmsh.finalize()
    with pytest.raises(InputError, match=r"box\.step: holds 1 solid.*Merge .box\.step."):
        read_mesh(tmp_path / "box.step")
    with pytest.raises(InputError, match=r"6 around \(500, 250, 10\)"):
        read_mesh(tmp_path / "box.step", 100.0)
    everything = 'SetFactory("OpenCASCADE"); Merge "box.step"; Physical Surface("skin") = Surface{:};\n'
    assert len(read_mesh(geo(everything), 200.0).boundary_edges) == 0
    way_out = 'SetFactory("OpenCASCADE"); Merge "box.step"; Physical Surface("mid") = {6};\nMesh.MeshSizeMin = 200;\n'
    mesh = read_mesh(geo(way_out))
    assert mesh.areas.sum() == pytest.approx(5e5)
    assert mesh.points[:, 2] == pytest.approx(10.0)


def test_far_too_small_sizes_are_foreseen(geo):
    with pytest.raises(
        InputError, match=r"mesh_size = 1e-07 would make about 2\.3e\+14 triangles of the area 1\."
    ):
        read_mesh(geo(SQUARE), 1e-7)
    sphere = 'SetFactory("OpenCASCADE");\nSphere(1) = {0, 0, 0, 10};\nPhysical Surface("s") = {1};\n'
    with pytest.raises(InputError, match=r"triangles of the area 1\.2\de\+03. Is it in the unit"):  # 4 pi 100
        read_mesh(geo(sphere), 1e-4)
    # a box around the surfaces of a thin ring is much larger than they are
    ring = 'SetFactory("OpenCASCADE");\nDisk(1) = {0, 0, 0, 1};\nDisk(2) = {0, 0, 0, 0.999};\n'
    ring += "BooleanDifference{ Surface{1}; Delete; }{ Surface{2}; Delete; }\n"
    assert read_mesh(geo(ring), 1e-3).areas.sum() == pytest.approx(np.pi * (1 - 0.999**2), rel=1e-3)


def test_quadrilaterals_of_a_geometry(geo):
    mesh = read_mesh(geo(SQUARE + "Recombine Surface{1};\n"))
    assert mesh.areas.sum() == pytest.approx(1.0)
    assert "split into triangles" in mesh.notes[0]


CURVED = {
    "square": ("Rectangle(1) = {0, 0, 0, 1, 1};", 1),
    "disk": ("Disk(1) = {0, 0, 0, 1};", 2),
    "tube": ("Circle(1) = {0, 0, 0, 1}; Extrude {0, 0, 1} { Curve{1}; }", 2),
    "box": ("Box(1) = {0, 0, 0, 1, 1, 1}; Delete { Volume{1}; }", 1),
}


@pytest.mark.parametrize("name", CURVED)
def test_order_by_itself_where_something_is_curved(geo, name):
    text, order = CURVED[name]
    path = geo('SetFactory("OpenCASCADE");\n' + text + "\nMesh.MeshSizeMax = 0.5;\n")
    assert read_mesh(path, mesh_order="auto").order == order
    assert read_mesh(path).order == 1
    assert read_mesh(path, mesh_order=1).order == 1


def test_straight_triangles_where_order_2_turns_one_inside_out(geo):
    """A triangle whose arc bulges to 0.9 of the way to the opposite corner."""
    text = "Point(1) = {-1, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {0, 0.886111111, 0}; Point(4) = {0, -0.5, 0};\n"
    text += "Circle(1) = {1, 3, 2}; Line(2) = {2, 4}; Line(3) = {4, 1};\n"
    text += "Transfinite Curve {1, 2, 3} = 2;\nCurve Loop(1) = {1, 2, 3}; Plane Surface(1) = {1};\n"
    path = geo(text)
    with pytest.raises(InputError, match="inside out"):
        read_mesh(path, mesh_order=2)
    mesh = read_mesh(path, mesh_order="auto")
    assert mesh.order == 1
    assert any("inside out" in note for note in mesh.notes)
