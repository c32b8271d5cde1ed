"""Decks of Abaqus and CalculiX arrive whole: area, sets, places; or the message says what does not."""

from __future__ import annotations

import numpy as np
import pytest

from kshell.errors import InputError
from kshell.mesh import check, read_mesh

NX, NY = 4, 2  # cells of a plate 2 x 1


def grid(order=1):
    """Points of the plate and its cells: triangles of order 1 or 2, and quadrilaterals."""
    n, m = order * NX, order * NY
    x, y = np.meshgrid(np.linspace(0, 2, n + 1), np.linspace(0, 1, m + 1))
    points = np.column_stack([x.ravel(), y.ravel()])
    number = np.arange(1, len(points) + 1).reshape(m + 1, n + 1)
    triangles, quads = [], []
    for j in range(0, m, order):
        for i in range(0, n, order):
            block = number[j : j + order + 1, i : i + order + 1]
            a, b, c, d = block[0, 0], block[0, -1], block[-1, -1], block[-1, 0]
            triangles += [[a, b, c], [a, c, d]]
            quads.append([a, b, c, d])
            if order == 2:
                ab, bc, cd, da, middle = block[0, 1], block[1, 2], block[2, 1], block[1, 0], block[1, 1]
                triangles[-2] += [ab, bc, middle]
                triangles[-1] += [middle, cd, da]
                quads[-1] += [ab, bc, cd, da]
    return points, triangles, quads


def nodes(points, first=1, form="{}, {}, {}, 0.\n"):
    return "".join(form.format(k, x, y) for k, (x, y) in enumerate(points.tolist(), first))


def elements(cells, first=1):
    return "".join(f"{k}, {', '.join(map(str, cell))}\n" for k, cell in enumerate(cells, first))


POINTS, TRIANGLES, QUADS = grid()
LEFT = [1, 6, 11]
PLATE = f"*NODE\n{nodes(POINTS)}*ELEMENT, TYPE=S3, ELSET=PLATE\n{elements(TRIANGLES)}"
SETS = "*NSET, NSET=LEFT\n1, 6, 11\n*NSET, NSET=RIGHT\n5, 10, 15\n"


def groups(mesh):
    return {
        group.name: (group.kind, pytest.approx(group.measure) if group.kind != "point" else group.members)
        for group in check.summary(mesh).groups
    }


@pytest.fixture
def read(tmp_path):
    def write_and_read(text, **others):
        for name, content in others.items():
            (tmp_path / f"{name}.inp").write_text(content, encoding="utf-8")
        path = tmp_path / "deck.inp"
        path.write_text(text, encoding="utf-8")
        return read_mesh(path)

    return write_and_read


WHOLE = {"PLATE": ("surface", 2.0), "LEFT": ("curve", 1.0), "RIGHT": ("curve", 1.0)}
SAME = {
    "plain": PLATE + SETS,
    "small letters": PLATE.lower().replace("elset=plate", "elset=PLATE")
    + "*nset, nset=LEFT\n1, 6, 11\n*Nset, NSet=RIGHT\n5,10,15\n",
    "blanks": PLATE.replace(", TYPE=", " , TYPE = ").replace("ELSET=", "ELSET = ") + SETS.replace(",", " ,  "),
    "blank coordinates": PLATE.replace(", 0.\n", ",\n") + SETS,
    "Fortran numbers": PLATE.replace(", 0.\n", ", 0.D+00\n").replace("2.0,", "0.2D1,").replace("1.0,", "1.0+0,") + SETS,
    "comments and empty lines": "** a deck\n*HEADING\nplate, 2 x 1\n"
    + PLATE.replace("*ELEM", "\n** cells\n*ELEM")
    + SETS,
    "generate": PLATE + "*NSET, NSET=LEFT, GENERATE\n1, 11, 5\n*NSET, NSET=RIGHT, GENERATE\n 5, 15, 5,\n",
    "set twice": PLATE + "*NSET, NSET=LEFT\n1,6\n*NSET, NSET=RIGHT\n5,10,15\n*NSET, NSET=left\n11\n",
    "two blocks of elements": f"*NODE\n{nodes(POINTS)}*ELEMENT, TYPE=S3, ELSET=PLATE\n{elements(TRIANGLES[12:], 13)}"
    f"*ELEMENT, TYPE=S3, ELSET=PLATE\n{elements(TRIANGLES[:12])}{SETS}",
    "nodes in blocks of a set": "*NODE, NSET=LEFT\n1,0,0\n6,0,0.5\n11,0,1\n*NODE, NSET=RIGHT\n5,2,0\n10,2,0.5\n15,2,1\n"
    "*NODE\n" + "".join(line for line in nodes(POINTS).splitlines(True) if int(line.split(",")[0]) % 5 > 1)
    + f"*ELEMENT, TYPE=S3, ELSET=PLATE\n{elements(TRIANGLES)}",
    "keyword over two lines": PLATE.replace("*ELEMENT, ", "*ELEMENT,\n") + SETS,
    "element over two lines": PLATE.replace("1, 1, 2, 7\n", "1, 1, 2,\n7\n") + SETS,
    "STRI3": PLATE.replace("S3", "STRI3") + SETS,
    "S3R": PLATE.replace("S3", "S3R") + SETS,
    "CPS3": PLATE.replace("S3", "CPS3") + SETS,
    "CPE3": PLATE.replace("S3", "CPE3") + SETS,
    "a title first": "a plate, 2 x 1\n" + PLATE + SETS,
    "quoted": PLATE.replace("ELSET=PLATE", 'ELSET="PLATE"') + SETS,
    "no elset in the block": PLATE.replace(", ELSET=PLATE", "") + "*ELSET, ELSET=PLATE, GENERATE\n1, 16\n" + SETS,
    "a part without instance": "*PART, NAME=P\n" + PLATE + SETS + "*END PART\n",
}  # fmt: skip


@pytest.mark.parametrize("name", SAME)
def test_the_same_plate(read, name):
    mesh = read(SAME[name])
    assert groups(mesh) == WHOLE
    assert (len(mesh.points), len(mesh.triangles)) == (15, 16)
    np.testing.assert_array_equal(
        sorted(map(tuple, mesh.points[:, :2].tolist())), sorted(map(tuple, POINTS.tolist()))
    )


@pytest.mark.parametrize("name", ["S4", "S4R", "S4R5", "S4RS", "CPS4", "CPE4R", "CPS4I", "M3D4", "s4r"])
def test_quadrilaterals(read, name):
    mesh = read(f"*NODE\n{nodes(POINTS)}*ELEMENT, TYPE={name}, ELSET=PLATE\n{elements(QUADS)}{SETS}")
    assert groups(mesh) == WHOLE
    assert "8 quadrilaterals split into triangles along the shorter diagonal" in mesh.notes


@pytest.mark.parametrize("name", ["S6", "STRI65", "CPS6", "CPE6M", "S8", "S8R", "S8R5", "CPS8R", "M3D8"])
def test_order_2(read, name):
    points, triangles, quads = grid(2)
    cells = quads if "8" in name else triangles
    points = points + 0.02 * np.sin(np.pi * points[:, ::-1])  # curved sides
    sets = "*NSET, NSET=LEFT, GENERATE\n1, 37, 9\n*NSET, NSET=RIGHT, GENERATE\n9, 45, 9\n"
    mesh = read(f"*NODE\n{nodes(points)}*ELEMENT, TYPE={name}, ELSET=PLATE\n{elements(cells)}{sets}")
    assert mesh.order == 2
    assert len(mesh.triangles) == 16
    assert {name: group.kind for name, group in mesh.groups.items()} == {
        "PLATE": "surface", "LEFT": "curve", "RIGHT": "curve",
    }  # fmt: skip
    given = {tuple(row) for row in np.round(points, 12).tolist()}
    read_points = np.concatenate([mesh.points, mesh.midpoints])[:, :2]
    assert given >= {tuple(row) for row in np.round(mesh.points[:, :2], 12).tolist()}
    missing = given - {tuple(row) for row in np.round(read_points, 12).tolist()}
    assert not missing  # every node of the deck is a vertex or a mid-edge node, none straightened
    assert len(mesh.groups["LEFT"].members) == 2


SETS_OF_SETS = PLATE + SETS + (
    "*ELSET, ELSET=A, GENERATE\n1, 4\n*ELSET, ELSET=B\n5, 6,\n7, 8\n*ELSET, ELSET=LOWER\nA, B\n"
    "*NSET, NSET=ENDS\nleft, RIGHT\n*NSET, NSET=OFA, ELSET=A\n*NSET, NSET=MID\n3, 8, 13\n*NSET, NSET=ONE\n8\n"
    "*NSET, NSET=FAR\nONE, 15\n"
)  # fmt: skip


def test_sets_of_sets(read):
    assert groups(read(SETS_OF_SETS)) == WHOLE | {
        "A": ("surface", 0.5), "B": ("surface", 0.5), "LOWER": ("surface", 1.0), "ENDS": ("curve", 2.0),
        "OFA": ("surface", 0.5), "MID": ("curve", 1.0), "ONE": ("point", 1), "FAR": ("point", 2),
    }  # fmt: skip


PART = "*PART, NAME=P\n" + PLATE.replace("=PLATE", "=E") + "*NSET, NSET=Edge\n1, 6, 11\n*END PART\n"


def test_parts_and_instances(read):
    mesh = read(
        PART + "*ASSEMBLY, NAME=A\n*INSTANCE, NAME=P-1, PART=P\n*END INSTANCE\n"
        "*INSTANCE, NAME=P-2, PART=p\n3., 4., 0.\n3., 4., 0., 3., 4., 1., 90.\n*END INSTANCE\n"
        "*NSET, NSET=both, INSTANCE=P-1\n1, 6, 11\n*NSET, NSET=both, INSTANCE=P-2\n1,6,11\n"
        "*NSET, NSET=named\nP-1.Edge, P-2.3, P-2.8, P-2.13\n*ELSET, ELSET=all\nP-1.E, P-2.E\n"
        "*NSET, NSET=again\nboth\n*END ASSEMBLY\n"
    )
    assert len(mesh.triangles) == 32
    assert groups(mesh) == {
        "P-1.E": ("surface", 2.0), "P-1.Edge": ("curve", 1.0), "P-2.E": ("surface", 2.0), "P-2.Edge": ("curve", 1.0),
        "both": ("curve", 2.0), "named": ("curve", 2.0), "again": ("curve", 2.0), "all": ("surface", 4.0),
    }  # fmt: skip
    second = mesh.points[mesh.triangles[mesh.groups["P-2.E"].members].ravel()]
    # shifted by (3, 4), then turned by a right angle about the line x = 3, y = 4
    np.testing.assert_allclose(second.min(axis=0), [2.0, 4.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(second.max(axis=0), [3.0, 6.0, 0.0], atol=1e-12)
    edge = mesh.points[mesh.edges[mesh.groups["P-2.Edge"].members]]
    np.testing.assert_allclose(edge[..., 1], 4.0, atol=1e-12)


def test_nodes_in_other_systems(read):
    """A quarter of a cylinder of radius 2 and length 3 given by radius, angle and z, in a frame that is turned."""
    angle, z = np.meshgrid(np.linspace(0, 90, 5), np.linspace(0, 3, 4))
    text = "*SYSTEM\n10., 0., 0., 10., 1., 0.\n9., 0., 0.\n*NODE, SYSTEM=C\n"
    for k, (a, h) in enumerate(zip(angle.ravel(), z.ravel(), strict=True), 1):
        text += f"{k}, 2., {a}, {h}\n"
    cells = [[r * 5 + c + 1, r * 5 + c + 2, r * 5 + c + 7, r * 5 + c + 6] for r in range(3) for c in range(4)]
    mesh = read(text + "*ELEMENT, TYPE=S4\n" + elements(cells))
    np.testing.assert_allclose(np.hypot(mesh.points[:, 0] - 10, mesh.points[:, 1]), 2.0, rtol=1e-12)
    assert mesh.points[:, 1].min() == pytest.approx(0.0, abs=1e-12)  # x local = y, y local = -x
    assert mesh.points[:, 0].max() == pytest.approx(10.0)
    assert mesh.areas.sum() == pytest.approx(4 * 2 * 2 * np.sin(np.pi / 16) * 3)


def test_included_files(read):
    others = {"points": f"*NODE\n{nodes(POINTS)}", "cells": elements(TRIANGLES), "left": "1, 6, 11\n"}
    mesh = read(
        "*INCLUDE, INPUT=points.inp\n*ELEMENT, TYPE=S3, ELSET=PLATE, INPUT=cells.inp\n*NSET, NSET=LEFT\n"
        "*include, input='left.inp'\n*NSET, NSET=RIGHT\n5, 10, 15\n",
        **others,
    )
    assert groups(mesh) == WHOLE


def test_what_is_told(read):
    mesh = read(
        PLATE + "*ELEMENT, TYPE=B31, ELSET=BEAMS\n101, 1, 2, 9\n*ELEMENT, TYPE=MASS, ELSET=M\n102, 3\n"
        "*MATERIAL, NAME=Steel\n*ELASTIC\n2.1e11, 0.3\n*DENSITY\n7850.\n"
        "*SHELL SECTION, ELSET=PLATE, MATERIAL=STEEL, OFFSET=0.5\n0.01, 5\n*SURFACE, NAME=S\nPLATE, SPOS\n"
        "*TRANSFORM, NSET=LEFT, TYPE=C\n0.,0.,0.,0.,0.,1.\n*STEP\n*STATIC\n*BOUNDARY\n1, 1, 6\n"
        "*CLOAD\n5, 3, 1.\n*END STEP\n"
    )
    assert mesh.notes[:4] == (
        "1 element B31 are taken as lines without stiffness",
        "1 element MASS are left out: neither stiffness nor mass is read",
        "the deck gives 'PLATE' thickness 0.01, offset 0.5, material 'STEEL' (E = 2.1e11, nu = 0.3, density 7850.)",
        "not read, to be said in the scene where it matters: '*TRANSFORM', '*BOUNDARY', '*CLOAD'",
    )
    assert groups(mesh)["BEAMS"] == ("curve", 0.5)


def test_composites_are_told(read):
    mesh = read(PLATE + "*SHELL SECTION, ELSET=PLATE, COMPOSITE\n0.1, 3, CFRP, 45.\n0.2, 3, CFRP, -45.\n")
    assert mesh.notes == (
        "the deck gives 'PLATE' layers 0.1 of 'CFRP' at 45. degrees, 0.2 of 'CFRP' at -45. degrees",
    )


WRONG = {
    "solids": (PLATE + "*ELEMENT, TYPE=C3D4\n101, 1, 2, 6, 9\n", "1 solid cells.*midsurface"),
    "axisymmetric": (PLATE + "*ELEMENT, TYPE=CAX3\n101, 1, 2, 6\n", "1 axisymmetric cells"),
    "unknown type": (PLATE + "*ELEMENT, TYPE=ZZ9\n101, 1, 2, 6\n", r"deck\.inp, line 34: elements of the type ZZ9"),
    "generation of nodes": (PLATE + "*NGEN\n1, 5, 1\n", r"line 34: \*NGEN makes a part of the model"),
    "node twice": (PLATE + "*NODE\n3, 0, 0, 5\n", r"line 35: node 3 is defined twice, at different places"),
    "element twice": (PLATE + "*ELEMENT, TYPE=S3\n3, 1, 2, 6\n", r"line 35: element 3 is defined twice"),
    "element too short": (PLATE + "*ELEMENT, TYPE=S3\n30, 1, 2\n", "the last element S3 ends before its 3 nodes"),
    "element too long": (PLATE + "*ELEMENT, TYPE=S3\n30, 1, 2, 7, 8\n", "an element S3 has 4 nodes instead of 3"),
    "missing node": (PLATE + "*ELEMENT, TYPE=S3\n30, 1, 2, 77\n", "element 30 names node 77"),
    "unknown set": (PLATE + "*NSET, NSET=A\nNOWHERE\n", r"line 35: names a set 'NOWHERE' of nodes"),
    "unknown part": ("*INSTANCE, NAME=I, PART=Q\n*END INSTANCE\n", "instance 'I' of part 'Q'"),
    "no number": (PLATE.replace("2.0,", "2.x,", 1), r"line 6: '2\.x' stands where a number should"),
    "missing file": ("*INCLUDE, INPUT=gone.inp\n", r"line 1: the included file gone\.inp is not found"),
    "itself": ("*INCLUDE, INPUT=deck.inp\n", "include each other without end"),
    "data first": ("1, 0, 0, 0\n*NODE\n", "data before the first keyword"),
    "no type": (PLATE.replace("TYPE=S3, ", ""), r"\*ELEMENT lacks TYPE="),
    "empty": (" \n", "the file is empty"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_what_is_refused(read, name):
    text, message = WRONG[name]
    with pytest.raises(InputError, match=message):
        read(text)


def test_touching_instances_are_not_joined_by_chance(read):
    twice = PART + (
        "*ASSEMBLY, NAME=A\n*INSTANCE, NAME=P-1, PART=P\n*END INSTANCE\n*INSTANCE, NAME=P-2, PART=P\n2., 0., 0.\n"
        "*END INSTANCE\n*END ASSEMBLY\n"
    )
    with pytest.raises(InputError, match="3 pairs of vertices at the same place that are not joined"):
        read(twice)


def test_members_that_do_not_exist(read):
    mesh = read(
        PLATE
        + "*NSET, NSET=LEFT\n1, 6, 11, 99\n*ELSET, ELSET=E\n1, 2, 500\n*ELSET, ELSET=GAPS, GENERATE\n1, 40, 2\n"
    )
    assert {name: group.lost for name, group in mesh.groups.items()} == {
        "PLATE": 0,
        "E": 1,
        "GAPS": 0,
        "LEFT": 1,
    }
