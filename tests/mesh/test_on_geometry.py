"""Meshes of order 1 get mid-edge nodes on the curves and surfaces of the geometry they were made from."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import kshell as ks
from kshell.errors import InputError
from kshell.mesh import Mesh, read_mesh
from kshell.mesh.on_geometry import put_on_geometry
from kshell.scene.scene import Scene
from kshell.scene.toml import read_toml

SHIPPED = Path(__file__).parents[2] / "meshes"


def written(folder, make, size, suffix="brep"):
    """A geometry made by OpenCASCADE, and its mesh of order 1."""
    import gmsh

    path = folder / f"shape.{suffix}"
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        make(gmsh.model.occ)
        gmsh.model.occ.synchronize()
        gmsh.write(str(path))
    finally:
        gmsh.finalize()
    named = folder / "named.geo"
    named.write_text(
        f'SetFactory("OpenCASCADE"); Merge "{path.name}";\nPhysical Surface("skin") = Surface{{:}};\n',
        encoding="utf-8",
    )
    return path, read_mesh(named, size, 1)


# off the surface by
SHAPES = {
    "sphere": (lambda o: o.addSphere(1, 2, 3, 2), 0.5, lambda x: np.linalg.norm(x - [1, 2, 3], axis=1) - 2),
    "torus": (
        lambda o: o.addTorus(0, 0, 0, 3, 1),
        0.6,
        lambda x: np.hypot(np.hypot(x[:, 0], x[:, 1]) - 3, x[:, 2]) - 1,
    ),
    "cone": (
        lambda o: o.addCone(0, 0, 0, 0, 0, 2, 1, 0.5),
        0.25,
        lambda x: x[:, 2] * (2 - x[:, 2]) * (np.hypot(x[:, 0], x[:, 1]) - (1 - x[:, 2] / 4)),
    ),
    "can": (
        lambda o: o.addCylinder(0, 0, 0, 0, 0, 2, 1),
        0.4,
        lambda x: x[:, 2] * (2 - x[:, 2]) * (np.hypot(x[:, 0], x[:, 1]) - 1),
    ),
}


@pytest.mark.parametrize("suffix", ["brep", "step"])
@pytest.mark.parametrize("name", SHAPES)
def test_shapes_of_opencascade(tmp_path, name, suffix):
    """Closed surfaces with seams, poles and faces that meet at sharp edges."""
    make, size, off = SHAPES[name]
    path, mesh = written(tmp_path, make, size, suffix)
    assert np.abs(off(mesh.points[mesh.edges].mean(axis=1))).max() > 1e-3
    lifted = put_on_geometry(mesh, path)
    assert lifted.order == 2
    assert np.abs(off(lifted.midpoints)).max() < 1e-8
    ends = lifted.points[lifted.edges]
    a, b = (np.linalg.norm(lifted.midpoints - ends[:, k], axis=1) for k in (0, 1))
    assert np.abs(a - b).max() < 0.05 * mesh.edge_lengths.max()


def test_edges_where_faces_meet_are_on_both(tmp_path):
    """The rim of a can is a circle, and its lids stay flat although their corner triangles have all corners on it."""
    path, mesh = written(tmp_path, lambda o: o.addCylinder(0, 0, 0, 0, 0, 2, 1), 0.7)
    lifted = put_on_geometry(mesh, path)
    z, radius = lifted.midpoints[:, 2], np.hypot(*lifted.midpoints[:, :2].T)
    on_lid = (mesh.points[mesh.edges][:, :, 2] == 0.0).all(axis=1)
    assert np.abs(z[on_lid]).max() < 1e-12
    neighbours = mesh.triangles[(mesh.points[mesh.triangles][:, :, 2] != 0.0).any(axis=1)]
    wall = np.isin(
        np.arange(len(mesh.edges)), mesh.edge_index(neighbours[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2))
    )
    assert np.count_nonzero(on_lid & wall) > 5
    np.testing.assert_allclose(radius[on_lid & wall], 1.0, atol=1e-12)
    assert radius[on_lid & ~wall].max() < 1 - 1e-3


DISK = 'SetFactory("OpenCASCADE");\nDisk(1) = {0, 0, 0, 1};\nPhysical Curve("rim") = {1};\n'


@pytest.fixture
def disk(tmp_path):
    path = tmp_path / "disk.geo"
    path.write_text(DISK, encoding="utf-8")
    return path


def test_chords_of_a_circle_stay_straight(disk):
    """All vertices of a hexagon without centre lie on the circle; only its sides are parts of it."""
    angle = np.arange(6) * np.pi / 3 + 0.1  # none where the circle starts
    points = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    mesh = Mesh.from_arrays(points, [[0, 2, 4], [0, 1, 2], [2, 3, 4], [4, 5, 0]])
    radius = np.linalg.norm(put_on_geometry(mesh, disk).midpoints, axis=1)
    side = mesh.edge_counts == 1
    np.testing.assert_allclose(radius[side], 1.0, rtol=1e-12)
    np.testing.assert_allclose(radius[~side], 0.5, rtol=1e-9)


def test_groups_notes_and_vertices_are_kept(disk):
    mesh = read_mesh(disk, 0.3)
    lifted = put_on_geometry(replace(mesh, notes=("one",)), disk)
    assert lifted.groups is mesh.groups
    np.testing.assert_array_equal(lifted.points, mesh.points)
    assert lifted.notes[0] == "one"
    assert "put on disk.geo" in lifted.notes[1]
    np.testing.assert_allclose(
        np.linalg.norm(lifted.midpoints[mesh.groups["rim"].members], axis=1), 1.0, rtol=1e-12
    )


def test_part_of_a_geometry(tmp_path):
    """Half of the mesh of a sphere: its border lies on no curve, and is put on the sphere; the note counts it."""
    path, mesh = written(tmp_path, lambda o: o.addSphere(0, 0, 0, 1), 0.3)
    low = mesh.points[mesh.triangles][:, :, 0].max(axis=1) < 0.1
    part = put_on_geometry(Mesh.from_arrays(mesh.points, mesh.triangles[low]), path)
    np.testing.assert_allclose(np.linalg.norm(part.midpoints, axis=1), 1.0, rtol=1e-10)
    assert "of the border on none of its curves" in part.notes[-1]


def test_curve_inside_a_surface(tmp_path):
    path = tmp_path / "line.geo"
    path.write_text(
        """Point(1) = {-1, -1, 0, 0.5}; Point(2) = {1, -1, 0, 0.5}; Point(3) = {1, 1, 0, 0.5};
Point(4) = {-1, 1, 0, 0.5}; Point(5) = {0.6, 0, 0, 0.4}; Point(6) = {0, 0.6, 0, 0.4}; Point(7) = {0, 0, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1}; Circle(5) = {5, 7, 6};
Curve Loop(1) = {1:4}; Plane Surface(1) = {1}; Curve{5} In Surface{1};
Physical Surface("plate") = {1}; Physical Curve("arc") = {5};
""",
        encoding="utf-8",
    )
    mesh = read_mesh(path)
    lifted = put_on_geometry(mesh, path)
    arc = mesh.groups["arc"].members
    np.testing.assert_allclose(np.linalg.norm(lifted.midpoints[arc], axis=1), 0.6, rtol=1e-6)
    others = np.setdiff1d(np.arange(len(mesh.edges)), arc)
    np.testing.assert_allclose(
        lifted.midpoints[others], mesh.points[mesh.edges[others]].mean(axis=1), atol=1e-9
    )


@pytest.mark.parametrize("name", ["scordelis_lo", "pinched_cylinder"])
def test_scenes_give_the_answer_of_order_2(tmp_path, name):
    """An order-1 file of the mesh with its geometry against the shipped mesh of order 2, p = 2."""
    scene = Scene.load(SHIPPED / f"{name}.toml")
    curved = scene.read_mesh()
    flat = tmp_path / "flat.msh"
    ks.mesh.write_msh(replace(curved, midpoints=None), flat)
    scenes = {
        "order 2": scene,
        "lifted": ks.Scene.from_dict(
            {
                **read_toml(SHIPPED / f"{name}.toml"),
                "mesh": str(flat),
                "geometry": str(SHIPPED / f"{name}.geo"),
            }
        ),
        "flat": replace(scene, mesh=flat, facets="flat"),
        "curved": replace(scene, mesh=flat),
    }
    where = next(iter(scene.probes))
    w = {key: ks.solve(s, order=2).probe(where)["u"][2] for key, s in scenes.items()}
    assert w["lifted"] == pytest.approx(w["order 2"], rel=1e-5)
    assert abs(w["flat"] / w["order 2"] - 1) > 1e-3
    assert w["curved"] == pytest.approx(w["order 2"], rel=1e-7)


def wrong(tmp_path, disk, case):
    """(mesh, geometry) that do not fit."""
    square = Mesh.from_arrays([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1, 2], [0, 2, 3]])
    match case:
        case "other unit":
            mesh = read_mesh(disk, 0.3)
            return replace(mesh, points=1000 * mesh.points), disk
        case "other shape":
            return square, disk
        case "order 2":
            return read_mesh(disk, 0.3, 2), disk
        case "no geometry file":
            return read_mesh(disk, 0.3), tmp_path / "disk.stl"
        case "not there":
            return read_mesh(disk, 0.3), tmp_path / "dish.geo"
        case "geometry as mesh":
            return disk, disk
        case "coarse":
            return Mesh.from_arrays([[1, 0], [-1, 0], [0, 1]], [[0, 2, 1]]), disk
        case "across an edge":
            path = tmp_path / "two.geo"
            path.write_text(
                'SetFactory("OpenCASCADE");\nRectangle(1) = {0, 0, 0, 1, 1};\n'
                "Rectangle(2) = {1, 0, 0, 1, 1};\nCoherence;\n",
                encoding="utf-8",
            )
            points = [[0, 0], [2, 0], [2, 1], [0, 1]]
            return Mesh.from_arrays(points, [[0, 1, 2], [0, 2, 3]]), path
    raise ValueError(case)


WRONG = {
    "other unit": r"is no mesh of disk.geo: \d+ of \d+ vertices lie off .* by 999,.*from \(-98\d.*geometry about",
    "other shape": r"1 of 4 vertices lie off its surfaces, \(1, 1\) by 0.414",
    "order 2": "is of order 2 already.*Leave geometry",
    "no geometry file": "is no geometry file: give the .geo",
    "not there": r"geometry file .*dish.geo not found. Did you mean 'disk.geo'",
    "geometry as mesh": "is a geometry file itself. Leave geometry out and write mesh_order = 2",
    "coarse": "1 edge bulge by more than 0.45 .*at \\(0, 0\\).*Mesh finer",
    "across an edge": r"2 triangles lie across an edge of two.geo.*follow the edges",
}


@pytest.mark.parametrize("case", WRONG)
def test_what_does_not_fit(tmp_path, disk, case):
    mesh, path = wrong(tmp_path, disk, case)
    with pytest.raises(InputError, match=WRONG[case]):
        read_mesh(mesh, geometry=path)


def test_a_geometry_of_triangles_is_none(tmp_path, disk):
    import meshio

    mesh = read_mesh(disk, 0.5)
    meshio.Mesh(mesh.points, [("triangle", mesh.triangles)]).write(tmp_path / "disk.stl")
    path = tmp_path / "merged.geo"
    path.write_text('Merge "disk.stl";\n', encoding="utf-8")
    with pytest.raises(InputError, match="holds triangles instead of smooth surfaces"):
        put_on_geometry(mesh, path)


def test_a_triangle_turned_inside_out(tmp_path):
    """A flat triangle between two arcs that cross it."""
    path = tmp_path / "lens.geo"
    path.write_text(
        """Point(1) = {-1, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {0, -1.2, 0}; Point(4) = {0, 0.5, 0};
Circle(1) = {1, 3, 2}; Line(2) = {2, 4}; Line(3) = {4, 1};
Curve Loop(1) = {1, 2, 3}; Plane Surface(1) = {1};
""",
        encoding="utf-8",
    )
    mesh = Mesh.from_arrays([[-1, 0], [1, 0], [0, 0.5]], [[0, 1, 2]])
    with pytest.raises(InputError, match="turned inside out by their mid-edge nodes"):
        put_on_geometry(mesh, path)


def test_scene_and_command_line(tmp_path, disk):
    mesh = tmp_path / "disk.msh"
    ks.mesh.write_msh(read_mesh(disk, 0.3), mesh)
    (tmp_path / "disk.toml").write_text(
        """mesh = "disk.msh"
geometry = "disk.geo"
thickness = 0.01
[material]
E = 1e9
nu = 0.3
[[support]]
on = "rim"
kind = "clamped"
[[load]]
kind = "pressure"
value = 1.0
""",
        encoding="utf-8",
    )
    from kshell.cli.commands import run

    assert run(["solve", str(tmp_path / "disk.toml"), "-o", str(tmp_path / "a")]) == 0
    assert (
        run(
            [
                *["solve", str(mesh), "--thickness", "0.01", "--E", "1e9", "--nu", "0.3", "--clamped", "rim"],
                *["--pressure", "1", "--geometry", str(disk), "-o", str(tmp_path / "b")],
            ]
        )
        == 0
    )
    import json

    found = [json.loads((tmp_path / d / "result.json").read_text(encoding="utf-8")) for d in "ab"]
    energies = [r["strain_energy"] for r in found]
    stiffness = 1e9 * 0.01**3 / (12 * (1 - 0.3**2))
    assert energies[0] == energies[1] == pytest.approx(np.pi / (384 * stiffness), rel=1e-5)
    assert any("put on disk.geo" in reason for reason in found[0]["model"]["reasons"])


def test_geometry_or_chart():
    with pytest.raises(InputError, match="geometry and chart given"):
        ks.Scene(
            mesh="a.msh",
            thickness=1.0,
            material=ks.Isotropic(E=1, nu=0),
            geometry="a.geo",
            chart=ks.geometry.Cylinder(R=1),
        )
    with pytest.raises(InputError, match="geometry = 3: must be the path"):
        ks.Scene(mesh="a.msh", thickness=1.0, material=ks.Isotropic(E=1, nu=0), geometry=3)
