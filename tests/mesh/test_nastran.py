"""Nastran bulk data arrive whole: area, properties, sets, places; or the message says what does not."""

from __future__ import annotations

import numpy as np
import pytest

from kshell.errors import InputError
from kshell.mesh import check, read_mesh, select

NX, NY = 4, 2  # cells of a plate 2 x 1
POINTS = [(2 * i / NX, j / NY) for j in range(NY + 1) for i in range(NX + 1)]
QUADS = [
    [j * (NX + 1) + i + 1, j * (NX + 1) + i + 2, (j + 1) * (NX + 1) + i + 2, (j + 1) * (NX + 1) + i + 1]
    for j in range(NY)
    for i in range(NX)
]
TRIANGLES = [half for a, b, c, d in QUADS for half in ([a, b, c], [a, c, d])]
BEGIN, END = "SOL 101\nCEND\nTITLE = plate\nSET 1 = 1 THRU 5\nBEGIN BULK\n", "ENDDATA\n"


def small(name, *words):
    """An entry in fields of 8 columns, continued as far as needed."""
    lines = [words[k : k + 8] for k in range(0, len(words), 8)] or [()]
    return "".join(
        f"{name if k == 0 else '':<8s}" + "".join(f"{word!s:<8s}" for word in line) + "\n"
        for k, line in enumerate(lines)
    )


def large(name, *words):
    """The same in fields of 16 columns."""
    lines = [words[k : k + 4] for k in range(0, len(words), 4)]
    return "".join(
        f"{name + '*' if k == 0 else '*':<8s}" + "".join(f"{word!s:<16s}" for word in line) + "\n"
        for k, line in enumerate(lines)
    )


def free(name, *words):
    """The same between commas."""
    lines = [words[k : k + 8] for k in range(0, len(words), 8)]
    return "".join(f"{name if k == 0 else ''},{','.join(map(str, line))}\n" for k, line in enumerate(lines))


def words(text):
    return text.split()


def grids(form=small, points=POINTS, system="", height="0."):
    return "".join(form("GRID", k, system, x, y, height) for k, (x, y) in enumerate(points, 1))


def shells(name="CTRIA3", cells=TRIANGLES, form=small, second=4):
    """Cells of property 1, but those with their first node at x >= 1 of property `second`."""
    return "".join(
        form(name, k, 1 if (cell[0] - 1) % (NX + 1) < 2 else second, *cell) for k, cell in enumerate(cells, 1)
    )


def groups(mesh):
    return {
        group.name: (group.kind, pytest.approx(group.measure) if group.kind != "point" else group.members)
        for group in check.summary(mesh).groups
    }


@pytest.fixture
def read(tmp_path):
    def write_and_read(text, suffix="bdf", **others):
        for name, content in others.items():
            (tmp_path / f"{name}.inc").write_text(content, encoding="utf-8")
        path = tmp_path / f"deck.{suffix}"
        path.write_text(text, encoding="utf-8")
        return read_mesh(path)

    return write_and_read


WHOLE = {"2:1": ("surface", 1.0), "2:4": ("surface", 1.0)}
SAME = {
    "small fields": BEGIN + grids() + shells() + END,
    "large fields": BEGIN + grids(large) + shells(form=large) + END,
    "free fields": BEGIN + grids(free) + shells(form=free) + END,
    "free fields of all kinds": BEGIN + grids(free).replace("GRID,", "GRID    ").replace("0.\n", "0.,,,,,,,\n", 3)
    + shells(form=free) + "DEQATN  1       F(A,B)=A+B\n        +A*B\nENDDATA  1a2b3c\n",
    "marks in small letters": BEGIN + grids() + shells().replace(
        small("CTRIA3", 1, 1, 1, 2, 7), "CTRIA3  1       1       1       2       7       " + " " * 24 + "+Ab\n+AB\n"
    ),
    "marks with other first signs": BEGIN + grids() + shells().replace(
        small("CTRIA3", 1, 1, 1, 2, 7), "CTRIA3  1       1       1       2       7       " + " " * 24 + "CORD\n+ORD\n"
    ),
    "no BEGIN BULK": grids() + shells(),
    "no ENDDATA": BEGIN + grids() + shells(),
    "cells first": BEGIN + shells() + grids() + END,
    "small letters": (BEGIN + grids() + shells() + END).lower(),
    "comments": BEGIN + "$ GRID\n" + grids().replace("\n", " $ here\n") + "\n\n" + shells() + END + "no more\n",
    "tabs": BEGIN + grids().replace("GRID    ", "GRID\t") + shells().replace("CTRIA3  ", "CTRIA3\t") + END,
    "marks of continuation": BEGIN + grids() + shells().replace(" 1       1       2       7       \n", "") + END,
    "CTRIAR": BEGIN + grids() + shells("CTRIAR") + END,
    "CQUAD4": BEGIN + grids() + shells("CQUAD4", QUADS) + END,
    "CQUADR": BEGIN + grids(free) + shells("CQUADR", QUADS, large) + END,
    "CPLSTS4": BEGIN + grids() + shells("CPLSTS4", QUADS) + END,
    "numbers without E": BEGIN + grids().replace(" 2.0 ", " 2.0+0 ").replace(" 0.5 ", " 5.-1 ") + shells() + END,
    "system for all": BEGIN + small("GRDSET", "", 7) + small("CORD2R", 7, 0, *words("0. 0. 0. 0. 0. 1. 1. 0. 0."))
    + grids() + shells() + END,
}  # fmt: skip
SAME["marks of continuation"] = BEGIN + grids() + shells().replace(
    small("CTRIA3", 1, 1, 1, 2, 7), "CTRIA3  1       1       1       2       7       " + " " * 24 + "+A1\n+A1\n"
) + END  # fmt: skip


@pytest.mark.parametrize("name", SAME)
def test_the_same_plate(read, name):
    mesh = read(SAME[name])
    assert groups(mesh) == WHOLE
    assert (len(mesh.points), len(mesh.triangles)) == (15, 16)
    np.testing.assert_array_equal(sorted(map(tuple, mesh.points[:, :2].tolist())), sorted(POINTS))


@pytest.mark.parametrize("suffix", ["nas", "fem", "dat", "BDF"])
def test_endings(read, suffix):
    assert groups(read(SAME["small fields"], suffix)) == WHOLE


def cylinder(system, angles, heights, radius):
    """Grid points of a quarter of a cylinder in a cylindrical system, and its cells."""
    text = "".join(
        small("GRID", k, system, radius, f"{a:.6g}"[:8], h)
        for k, (h, a) in enumerate(((h, a) for h in heights for a in angles), 1)
    )
    n = len(angles)
    cells = [
        [r * n + c + 1, r * n + c + 2, (r + 1) * n + c + 2, (r + 1) * n + c + 1]
        for r in range(len(heights) - 1)
        for c in range(n - 1)
    ]
    return text + "".join(small("CQUAD4", k, 1, *cell) for k, cell in enumerate(cells, 1))


@pytest.mark.parametrize("kind", ["CORD2C", "CORD1C", "chain"])
def test_cylindrical_systems(read, kind):
    """Radius 10, length 20: its axis is the line through (1, 2, 3) along y, its x axis is z."""
    text = cylinder(5, np.linspace(0, 90, 9), [0.0, 10.0, 20.0], 10.0)
    system = {
        "CORD2C": small("CORD2C", 5, 0, *words("1. 2. 3. 1. 7. 3. 1. 2. 4.")),
        "CORD1C": small("CORD1C", 5, 91, 92, 93)
        + small("GRID", 91, "", "1.", "2.", "3.") + small("GRID", 92, 0, "1.", "7.", "3.")
        + small("GRID", 93, "", "1.", "2.", "4."),
        # a rectangular system at (1, 2, 3), in it a spherical one, in it the cylindrical one
        "chain": small("CORD2R", 3, "", *words("1. 2. 3. 1. 2. 4. 2. 2. 3."))
        + small("CORD2S", 4, 3, *words("0. 0. 0. 0. 0. 1. 1. 0. 0."))
        + small("CORD2C", 5, 4, *words("0. 0. 0. 5. 90. 90. 1. 0. 0.")),
    }[kind]  # fmt: skip
    mesh = read(BEGIN + system + text + END)
    radius = np.hypot(mesh.points[:, 0] - 1, mesh.points[:, 2] - 3)
    np.testing.assert_allclose(radius, 10.0, rtol=1e-12)
    assert mesh.areas.sum() == pytest.approx(8 * 2 * 10 * np.sin(np.pi / 32) * 20)
    np.testing.assert_allclose(mesh.points[0], [1, 2, 13], atol=1e-12)  # angle 0: along the system's x
    np.testing.assert_allclose(
        mesh.points[8], [11, 2, 3], atol=1e-12
    )  # 90 degrees: along y x z of the system
    np.testing.assert_allclose(np.ptp(mesh.points[:, 1]), 20.0)


def test_spherical_system(read):
    """An octant of a sphere: radius, angle from z, angle about z."""
    down, turn = np.linspace(10, 90, 5), np.linspace(0, 90, 5)
    text = small("CORD2S", 1, 0, *words("0. 0. 0. 0. 0. 1. 1. 0. 0."))
    for k, (a, b) in enumerate(((a, b) for a in down for b in turn), 1):
        text += small("GRID", k, 1, "2.", a, b)
    cells = [[r * 5 + c + 1, r * 5 + c + 2, r * 5 + c + 7, r * 5 + c + 6] for r in range(4) for c in range(4)]
    mesh = read(text + "".join(small("CQUAD4", k, 1, *cell) for k, cell in enumerate(cells, 1)))
    np.testing.assert_allclose(np.linalg.norm(mesh.points, axis=1), 2.0, rtol=1e-12)
    np.testing.assert_allclose(mesh.points[20], [2, 0, 0], atol=1e-12)
    np.testing.assert_allclose(mesh.points[24], [0, 2, 0], atol=1e-12)
    np.testing.assert_allclose(
        mesh.points[0], 2 * np.array([np.sin(np.pi / 18), 0, np.cos(np.pi / 18)]), atol=1e-12
    )


def test_mid_side_nodes(read):
    """A square with one curved side, as two CTRIA6 and as a CQUAD8; left out mid-side nodes are straight."""
    points = [(0, 0), (1, 0), (1, 1), (0, 1), (0.5, -0.1), (1, 0.5), (0.5, 1), (0, 0.5), (0.5, 0.5)]
    two = small("CTRIA6", 1, 1, 1, 2, 3, 5, 6, 9) + small("CTRIA6", 2, 1, 1, 3, 4, 9, "", 8)
    one = small("CQUAD8", 1, 1, 1, 2, 3, 4, 5, 6, "", 8)
    for text, rest in ((two, ()), (one, (9,))):
        mesh = read(
            "".join(small("GRID", k, "", *p, "0.") for k, p in enumerate(points, 1) if k not in rest) + text
        )
        assert mesh.order == 2
        assert check.summary(mesh).area == pytest.approx(1 + 2 / 3 * 0.1)  # a parabola's segment


def test_sets_of_grid_points(read):
    mesh = read(
        BEGIN + grids().replace(small("GRID", 8, "", 1.0, 0.5, "0."), small("GRID", 8, "", 1.0, 0.5, "0.", "", 3))
        + shells() + small("SPC1", 2, 123456, 1, 6, 11) + small("SPC1", 3, 123, 1, "THRU", 5)
        + small("SPC1", 4, 3, 5, 10) + small("SPC", 4, 3, 3, "0.", 15, 1) + small("SET1", 9, 3, 8, 13) + END
    )  # fmt: skip
    assert groups(mesh) == WHOLE | {
        "SPC 2": ("curve", 1.0), "SPC 3": ("curve", 2.0), "SPC 4:3 (curve)": ("curve", 0.5),
        "SPC 4:3 (point)": ("point", 1), "SPC 4:1": ("point", 1), "PS 3": ("point", 1), "SET 9": ("curve", 1.0),
    }  # fmt: skip
    assert any("holds the freedoms of 'SPC 2' in 123456, 'SPC 3' in 123" in note for note in mesh.notes)
    assert select(mesh, "2:4").dimension == 2


def test_what_is_told(read):
    mesh = read(
        BEGIN + "$ Femap Property 1 : Skin\n" + grids() + shells() + small("CBAR", 90, 7, 1, 2, "0.", "0.", "1.")
        + small("PSHELL", 1, 5, "0.01", 5) + small("MAT1", 5, "2.1+11", "", "0.3", "7850.")
        + small("PCOMP", 4, "", "", "", "", "", "", "", 6, "0.001", "45.", "YES", "", "", "-45.")
        + small("MAT8", 6, "1.3+11", "9.+9", "0.3", "5.+9") + small("FORCE", 1, 5, "", "1.", "0.", "0.", "1.")
        + small("CONM2", 95, 3, "", "2.") + small("PARAM", "POST", -1) + END
    )  # fmt: skip
    assert groups(mesh) == {"Skin": ("surface", 1.0), "2:4": ("surface", 1.0), "1:7": ("curve", 0.5)}
    assert mesh.notes == (
        "1 element CBAR taken as lines without stiffness",
        "the file gives property 1 thickness 0.01, material 5 (E = 2.1+11, nu = 0.3, density = 7850.)",
        "the file gives property 4 layers 0.001, material 6 (E1 = 1.3+11, E2 = 9.+9, nu12 = 0.3, G12 = 5.+9) at 45. "
        "degrees; 0.001, material 6 (E1 = 1.3+11, E2 = 9.+9, nu12 = 0.3, G12 = 5.+9) at -45. degrees",
        "not read, to be said in the scene where it matters: 'FORCE', 'CONM2'",
    )


def test_offsets_and_own_thicknesses_are_told(read):
    cell = small("CTRIA3", 40, 1, 1, 2, 7, "", "0.02", "", "", "", "0.1", "0.1", "0.1")
    text = BEGIN + grids() + shells().replace(small("CTRIA3", 1, 1, 1, 2, 7), cell) + END
    assert read(text).notes[:2] == (
        "1 element with an offset (ZOFFS), not read",
        "1 element with own thicknesses at corners, not read",
    )


def test_included_files(read):
    mesh = read(
        BEGIN + "INCLUDE 'points.inc'\ninclude \"cells.\ninc\"\n" + END,
        points=grids(),
        cells="$ cells\n" + shells(),
    )
    assert groups(mesh) == WHOLE


WRONG = {
    "solids": (grids() + shells() + small("CTETRA", 90, 1, 1, 2, 7, 9), "1 solid cells"),
    "axisymmetric": (grids() + small("CTRIAX6", 90, 1, 1, 2, 7), "1 axisymmetric cells"),
    "grid twice": (grids() + small("GRID", 3, "", "9."), r"line 16: grid point 3 is defined twice"),
    "element twice": (grids() + shells() + small("CTRIA3", 3, 1, 1, 2, 8), "element 3 is defined twice"),
    "missing grid": (grids() + small("CTRIA3", 1, 1, 1, 2, 99), "element 1 names grid point 99"),
    "missing system": (grids(system=8) + shells(), "names coordinate system 8, which the file does not hold"),
    "system of itself": (
        grids(system=8) + small("CORD2R", 8, 8, *words("0. 0. 0. 0. 0. 1. 1. 0. 0.")) + shells(),
        "coordinate system 8 is defined by itself",
    ),
    "points on a line": (
        grids(system=8) + small("CORD2R", 8, 0, *words("0. 0. 0. 0. 0. 1. 0. 0. 2.")) + shells(),
        "the three points of coordinate system 8 lie on a line",
    ),
    "a word": (grids().replace("0.5  ", "0.5x ", 1) + shells(), r"line 2, GRID: '0\.5x' stands where a number"),
    "replication": (grids() + "=       *1      =\n", "replication of entries"),
    "continuation of nothing": ("+       1\n" + grids(), "a continuation of nothing"),
    "out of order": (
        grids() + "CTRIA3  1       1       1       2       7       " + " " * 24 + "+A1\n+B1\n",
        r"line 17: the continuation '\+B1' does not follow",
    ),
    "superelements": ("BEGIN BULK\n" + grids() + "BEGIN SUPER=1\n", "superelements"),
    "missing file": ("INCLUDE 'gone.inc'\n", r"line 1: the included file gone\.inc is not found"),
    "itself": ("INCLUDE 'deck.bdf'\n", "include each other without end"),
    "no bulk data": ("SOL 101\nCEND\n", "is no bulk data entry|has no triangles"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_what_is_refused(read, name):
    text, message = WRONG[name]
    with pytest.raises(InputError, match=message):
        read(text)


def test_missing_grid_points_of_a_set(read):
    mesh = read(grids() + shells() + small("SPC1", 2, 3, 1, 6, 11, 99))
    assert mesh.groups["SPC 2"].lost == 1
