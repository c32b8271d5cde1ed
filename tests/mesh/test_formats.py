"""Meshes of other programs arrive with their area, groups and coordinates, or are refused in words."""

from __future__ import annotations

import meshio
import numpy as np
import pytest

from kshell.errors import InputError
from kshell.mesh import check, read_mesh
from tests.mesh.mesh_samples import square, write_with_gmsh

POINTS = [(x, y, 0.5) for y in (0, 1) for x in (0, 1, 2)]  # a plate 2 x 1 of two quadrilaterals
QUADS = [(0, 1, 4, 3), (1, 2, 5, 4)]
TRIANGLES = [(0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4)]


def groups(mesh):
    return {
        group.name: (group.kind, pytest.approx(group.measure) if group.kind != "point" else group.members)
        for group in check.summary(mesh).groups
    }


@pytest.fixture
def read(tmp_path):
    def write_and_read(name, content):
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return read_mesh(path)

    return write_and_read


def is_plate(mesh, triangles=4):
    assert (len(mesh.points), len(mesh.triangles)) == (6, triangles)
    assert mesh.areas.sum() == pytest.approx(2.0)
    np.testing.assert_array_equal(sorted(map(tuple, mesh.points.tolist())), sorted(POINTS))


V = "".join(f"v {x} {y} {z}\n" for x, y, z in POINTS)
HALVES = {"A": ("surface", 1.0), "B": ("surface", 1.0)}
OBJ = {
    "v": V + "g A\nf 1 2 5\nf 1 5 4\ng B\nf 2 3 6\nf 2 6 5\n",
    "v/vt": V + "vt 0 0\ng A\nf 1/1 2/1 5/1\nf 1/1 5/1 4/1\ng B\nf 2/1 3/1 6/1\nf 2/1 6/1 5/1\n",
    "v//vn": V
    + "vn 0 0 1\ng A\nf 1//1 2//1 5//1\nf 1//1 5//1 4//1\ng B\nf 2//1 3//1 6//1\nf 2//1 6//1 5//1\n",
    "v/vt/vn": V
    + "vn 0 0 1\nvt 0 0\no A\nf 1/1/1 2/1/1 5/1/1\nf 1/1/1 5/1/1 4/1/1\no B\nf 2 3 6\nf 2/1/1 6/1/1 5/1/1\n",
    "negative": V + "g A\nf -6 -5 -2\nf -6 -2 -3\ng B\nf -5 -4 -1\nf -5 -1 -2\n",
    "quadrilaterals": "# Blender\nmtllib a.mtl\n"
    + V
    + "s off\ng A\nusemtl m\nf 1 2 5 4\ng B\nf 2 3 \\\n6 5\n",
    "several names": V + "g A all\nf 1 2 5 4\ng B all\nf 2 3 6 5\n",
}


@pytest.mark.parametrize("name", OBJ)
def test_obj(read, name):
    mesh = read("plate.obj", OBJ[name])
    is_plate(mesh)
    assert groups(mesh) == (HALVES | {"all": ("surface", 2.0)} if name == "several names" else HALVES)


def test_lines_of_obj(read):
    mesh = read("plate.obj", V + "f 1 2 5 4\nf 2 3 6 5\ng left\nl 1 4\ng corner\np 3\n")
    assert groups(mesh) == {"left": ("curve", 1.0), "corner": ("point", 1)}


def stl(*solids):
    text = ""
    for name, triangles in solids:
        text += f"solid {name}\n"
        for triangle in triangles:
            corners = "".join("  vertex {:e} {:e} {:e}\n".format(*POINTS[k]) for k in triangle)
            text += f" facet normal 0 0 1\n outer loop\n{corners} endloop\n endfacet\n"
        text += f"endsolid {name}\n"
    return text


def test_stl(read):
    mesh = read("plate.stl", stl(("A", TRIANGLES[:2]), ("B", TRIANGLES[2:])))
    is_plate(mesh)
    assert groups(mesh) == HALVES
    assert len(mesh.boundary_edges) == 6  # joined where the solids meet
    assert groups(read("one.stl", stl(("made by a program", TRIANGLES)))) == {}


def test_binary_stl(read):
    record = np.zeros(4, dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    record["corners"] = np.array(POINTS)[np.array(TRIANGLES)]
    data = b"solid by name only".ljust(80) + (4).to_bytes(4, "little") + record.tobytes()
    is_plate(read("plate.stl", data))
    with pytest.raises(InputError, match=r"has 0 facets|cut off|is ended"):
        read("cut.stl", data[:-30])


SU2 = (
    "% a plate\nNDIME= 3\nNELEM= 2\n9 0 1 4 3 0\n9 1 2 5 4 1\nNPOIN= 6\n"
    + "".join(f"{x} {y} {z} {k}\n" for k, (x, y, z) in enumerate(POINTS))
    + "NMARK= 2\nMARKER_TAG= left\nMARKER_ELEMS= 1\n3 0 3\nMARKER_TAG= right\nMARKER_ELEMS= 1\n3 2 5\n"
)


def test_su2(read):
    mesh = read("plate.su2", SU2)
    is_plate(mesh)
    assert groups(mesh) == {"left": ("curve", 1.0), "right": ("curve", 1.0)}


def test_off(read):
    body = "".join(f"{x} {y} {z}\n" for x, y, z in POINTS) + "4 0 1 4 3\n3 1 2 5 255 0 0\n3 1 5 4\n"
    for head in ("OFF\n6 3 0\n", "OFF 6 3 0\n", "# made\n6 3\n", "COFF\n6 3 0\n"):
        is_plate(read("plate.off", head + body))


def unv(nodes, elements, groups, code=2477):
    """A universal file; elements are (descriptor, nodes), groups (name, kind, numbers)."""
    text = "    -1\n  2411\n"
    for k, (x, y, z) in enumerate(nodes, 1):
        text += (
            f"{k:10d}{1:10d}{1:10d}{11:10d}\n"
            + "".join(f"{c:25.16e}".replace("e", "D") for c in (x, y, z))
            + "\n"
        )
    text += "    -1\n    -1\n  2412\n"
    for k, (descriptor, cell) in enumerate(elements, 1):
        text += "".join(f"{n:10d}" for n in (k, descriptor, 1, 1, 7, len(cell))) + "\n"
        text += f"{0:10d}{1:10d}{1:10d}\n" if descriptor in (11, 21, 24) and descriptor != 11 else ""
        text += "".join(f"{n:10d}" for n in cell) + "\n"
    text += f"    -1\n    -1\n  {code}\n"
    for k, (name, kind, numbers) in enumerate(groups, 1):
        text += "".join(f"{n:10d}" for n in (k, 0, 0, 0, 0, 0, 0, len(numbers))) + f"\n{name}\n"
        words = [f"{kind:10d}{n:10d}{0:10d}{0:10d}" for n in numbers]
        text += "".join("".join(words[j : j + 2]) + "\n" for j in range(0, len(words), 2))
    return text + "    -1\n"


@pytest.mark.parametrize("code", [2435, 2452, 2467, 2477])
def test_unv(read, code):
    elements = [(94, (1, 2, 5, 4)), (91, (2, 3, 6)), (41, (2, 6, 5)), (21, (1, 4)), (11, (3, 6))]
    sets = [("A", 8, [1]), ("B  ", 8, [2, 3]), ("left", 8, [4]), ("right", 7, [3, 6]), ("corner", 7, [1])]
    mesh = read("plate.unv", unv(POINTS, elements, sets, code))
    is_plate(mesh)
    assert groups(mesh) == HALVES | {"left": ("curve", 1.0), "right": ("curve", 1.0), "corner": ("point", 1)}


def test_unv_of_order_2(read):
    """Nodes go round the element: corner, mid-side node, corner."""
    nodes = [
        (0, 0, 0),
        (0.5, -0.1, 0),
        (1, 0, 0),
        (1, 0.5, 0),
        (1, 1, 0),
        (0.5, 1, 0),
        (0, 1, 0),
        (0, 0.5, 0),
    ]
    nodes += [(0.5, 0.5, 0)]
    two = unv(
        nodes, [(92, (1, 2, 3, 4, 5, 9)), (92, (1, 9, 5, 6, 7, 8)), (24, (1, 2, 3))], [("bottom", 8, [3])]
    )
    one = unv(nodes[:8], [(95, (1, 2, 3, 4, 5, 6, 7, 8)), (24, (1, 2, 3))], [("bottom", 8, [2])])
    for text in (two, one):
        mesh = read("plate.unv", text)
        assert mesh.order == 2
        assert check.summary(mesh).area == pytest.approx(1 + 2 / 3 * 0.1)
        assert groups(mesh)["bottom"][0] == "curve"
        assert len(mesh.groups["bottom"].members) == 1


def test_unv_of_gmsh(tmp_path):
    write_with_gmsh(tmp_path / "plate.unv", 4.1, False, 1, False)
    measures = {name: measure for name, (_, measure) in groups(read_mesh(tmp_path / "plate.unv")).items()}
    assert {name: measures[name] for name in ("all", "middle", "outline")} == {
        "all": 2.0, "middle": 1.0, "outline": 6.0,
    }  # gmsh writes one group of each cell  # fmt: skip


@pytest.mark.parametrize("order", [1, 2])
def test_med_of_gmsh(tmp_path, order):
    write_with_gmsh(tmp_path / "plate.med", 4.1, False, order, False)
    mesh = read_mesh(tmp_path / "plate.med")
    assert mesh.order == order
    found = groups(mesh)
    for name, kind, measure in (
        ("all", "surface", 2.0),
        ("right half", "surface", 1.0),
        ("middle", "curve", 1.0),
    ):
        assert found[name] == (kind, measure)
    assert found["outline"] == ("curve", 6.0)
    if order == 2:
        np.testing.assert_allclose(mesh.midpoints, mesh.points[mesh.edges].mean(axis=1), atol=1e-12)


def med(path, types, family_of=None, node_family=None, names=None):
    """A MED file by hand: cells by type, family numbers and the names of groups in each family."""
    import h5py

    with h5py.File(path, "w") as file:
        mesh = file.create_group("ENS_MAA/plate")
        mesh.attrs["ESP"] = 3
        step = mesh.create_group("-0000000000000000001-0000000000000000001")
        step["NOE/COO"] = np.array(POINTS, dtype=float).T.ravel()
        if node_family is not None:
            step["NOE/FAM"] = np.array(node_family)
        for name, cells in types.items():
            block = step.create_group(f"MAI/{name}")
            block["NOD"] = np.array(cells).T.ravel() + 1
            block["NOD"].attrs["NBR"] = len(cells)
            if family_of and name in family_of:
                block["FAM"] = np.array(family_of[name])
        for number, of_family in (names or {}).items():
            kind = "NOEUD" if number > 0 else "ELEME"
            family = file.create_group(f"FAS/plate/{kind}/F{number}")
            family.attrs["NUM"] = number
            rows = [np.frombuffer(name.encode().ljust(80, b"\0"), np.int8) for name in of_family]
            family["GRO/NOM"] = np.array(rows)


def test_med_with_groups_in_common(tmp_path):
    path = tmp_path / "plate.med"
    med(
        path, {"QU4": QUADS, "SE2": [(0, 3)]}, {"QU4": [-1, -2], "SE2": [-3]}, [0, 0, 4, 0, 0, 4],
        {-1: ["A", "all  "], -2: ["B", "all"], -3: ["left"], 4: ["Geländer"]},
    )  # fmt: skip
    mesh = read_mesh(path)
    is_plate(mesh)
    assert groups(mesh) == HALVES | {
        "all": ("surface", 2.0), "left": ("curve", 1.0), "Geländer": ("curve", 1.0),
    }  # fmt: skip


def test_wrong_med_files(tmp_path, read):
    with pytest.raises(InputError, match="cannot be read as a MED file"):
        read("plate.med", b"\x89HDF\r\n\x1a\n" + b"\0" * 50)
    path = tmp_path / "solid.med"
    med(path, {"TE4": [(0, 1, 4, 3)]})
    with pytest.raises(InputError, match="1 solid cells"):
        read_mesh(path)
    med(path, {"TR3": [(0, 1, 40)]})
    with pytest.raises(InputError, match="names a node that the file does not hold"):
        read_mesh(path)


MDPA = (
    "Begin ModelPartData\n//  VAR 1\nEnd ModelPartData\nBegin Properties 0\nEnd Properties\nBegin Nodes\n"
    + "".join(f"{10 * k} {x} {y} {z}\n" for k, (x, y, z) in enumerate(POINTS, 1))
    + "End Nodes\nBegin Elements ShellThinElement3D3N // cells\n1 0 10 20 50\n2 0 10 50 40\nEnd Elements\n"
    "Begin Elements ShellThickElementCorotational3D4N\n3 1 20 30 60 50\nEnd Elements\n"
    "Begin Conditions SurfaceLoadCondition3D3N\n1 0 10 20 50\n2 0 50 40 10\nEnd Conditions\n"
    "Begin Conditions LineLoadCondition3D2N\n3 0 10 40\nEnd Conditions\n"
    "Begin SubModelPart Clamp\n Begin SubModelPartNodes\n 30\n 60\n End SubModelPartNodes\n"
    " Begin SubModelPart One\n  Begin SubModelPartNodes\n  60\n  End SubModelPartNodes\n End SubModelPart\n"
    "End SubModelPart\nBegin SubModelPart Load\n Begin SubModelPartNodes\n10\n End SubModelPartNodes\n"
    " Begin SubModelPartConditions\n 1\n 2\n End SubModelPartConditions\nEnd SubModelPart\n"
    "Begin SubModelPart Line\n Begin SubModelPartConditions\n 3\n End SubModelPartConditions\nEnd SubModelPart\n"
)


def test_mdpa(read):
    mesh = read("plate.mdpa", MDPA)
    is_plate(mesh)
    assert groups(mesh) == {
        "properties 0": ("surface", 1.0), "properties 1": ("surface", 1.0), "Clamp": ("curve", 1.0),
        "Clamp.One": ("point", 1), "Load": ("surface", 1.0), "Line": ("curve", 1.0),
    }  # fmt: skip
    with pytest.raises(InputError, match="1 solid cells"):
        read("solid.mdpa", MDPA.replace("ShellThickElementCorotational3D4N", "SmallDisplacementElement3D4N"))


WRONG = {
    "short.obj": (V + "f 1 2\nf 1 9 2\n", "line 8: names vertex 9, but 6 vertices were given so far"),
    "zero.obj": (V + "f 0 1 2\n", "names vertex 0"),
    "five.obj": (V + "f 1 2 3 6 5\n", "1 polygons of more than four sides"),
    "curved.obj": (V + "cstype bezier\n", "free-form surfaces"),
    "cut.stl": (stl(("A", TRIANGLES))[:-30], "0 of its solids are ended|instead of"),
    "facet.stl": (stl(("A", TRIANGLES)).replace("vertex", "corner", 1), "4 facets and 11 corners"),
    "count.su2": (SU2.replace("NELEM= 2", "NELEM= 1"), "stands where a key such as NELEM"),
    "more.su2": (SU2.replace("NELEM= 2", "NELEM= 3"), "announces 3 lines, but fewer follow"),
    "node.su2": (SU2.replace("9 0 1 4 3", "9 0 1 4 33"), "an element names point 33"),
    "less.off": ("OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", r"announces \[3, 2\]"),
    "node.off": ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "names others than 0 to 2"),
    "cut.unv": (unv(POINTS, [(91, (1, 2, 5))], [("A", 8, [1])])[:-20], "is not ended by -1|too early"),
    "node.unv": (unv(POINTS, [(91, (1, 2, 9))], []), "names node 9, which the file does not hold"),
    "solid.unv": (unv(POINTS, [(111, (1, 2, 5, 6))], []), "1 solid cells"),
    "kind.unv": (unv(POINTS, [(999, (1, 2, 5))], []), "of the descriptor 999 are not known"),
    "cut.mdpa": (MDPA[: MDPA.rindex("End SubModelPart")], "SubModelPart is not ended"),
    "node.mdpa": (MDPA.replace("1 0 10 20 50", "1 0 10 20 57"), "names node 57"),
    "plate.cgns": ("text", r"the format '\.cgns' is not known"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_refused(read, name):
    text, message = WRONG[name]
    with pytest.raises(InputError, match=message):
        read(name, text)


# what each format read through meshio keeps of groups: numbers, or nothing
THROUGH_MESHIO = {
    "vtk": "medit:ref", "vtu": "CellEntityIds", "mesh": "medit:ref", "meshb": "medit:ref", "xdmf": "medit:ref",
    "xmf": "gmsh:physical", "vol": "netgen:index", "avs": "avsucd:material", "ply": None, "xml": None, "tec": None,
    "e": None, "ex2": None, "exo": None,
}  # fmt: skip


@pytest.mark.parametrize("suffix", THROUGH_MESHIO)
def test_formats_through_meshio(tmp_path, suffix):
    if suffix in ("e", "ex2", "exo"):
        pytest.importorskip("netCDF4", reason="meshio reads Exodus files by netCDF4")
    mesh = square(3)
    left = mesh.edges[mesh.groups["left"].members]
    numbers = [np.repeat([3, 4], 9).astype(np.int32), np.full(3, 7, dtype=np.int32)]
    array = THROUGH_MESHIO[suffix]
    cells = [("triangle", mesh.triangles), ("line", left)] if array else [("triangle", mesh.triangles)]
    path = tmp_path / f"mesh.{suffix}"
    meshio.write(path, meshio.Mesh(mesh.points, cells, cell_data={array: numbers} if array else None))
    read = read_mesh(path)
    assert read.areas.sum() == pytest.approx(1.0)
    np.testing.assert_allclose(sorted(read.points.tolist()), sorted(mesh.points.tolist()), atol=1e-12)
    expected = {"1:7": ("curve", 1.0), "2:3": ("surface", 0.5), "2:4": ("surface", 0.5)}
    if suffix == "vol":  # Netgen names faces and edges by their number and codimension
        expected = {"cd2_7": ("curve", 1.0), "cd1_3": ("surface", 0.5), "cd1_4": ("surface", 0.5)}
    assert groups(read) == (expected if array else {})
