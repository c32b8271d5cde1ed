"""Every variant of .msh files arrives with all of its groups; damaged ones are refused in words."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from kshell.errors import InputError
from kshell.mesh import check, read_mesh, select
from kshell.mesh.order import in_spatial_order
from kshell.mesh.refine import bisect
from tests.mesh.mesh_samples import EXPECTED_GROUPS, group_places, msh2_text, write_with_gmsh

VARIANTS = [(2.2, b, o, False) for b in (0, 1) for o in (1, 2)] + [
    (4.1, b, o, s) for b in (0, 1) for o in (1, 2) for s in (False, True)
]
TRIANGLE = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("variants")


@pytest.mark.parametrize(("version", "binary", "order", "save_all"), VARIANTS)
def test_every_variant_has_the_same_groups(folder, version, binary, order, save_all):
    path = folder / f"{version}_{binary}_{order}_{save_all}.msh"
    write_with_gmsh(path, version, binary, order, save_all)
    mesh = read_mesh(path)
    assert mesh.order == order
    assert mesh.areas.sum() == pytest.approx(2.0, rel=1e-12)  # no cell twice
    found = {group.name: group for group in check.summary(mesh).groups}
    assert set(found) == set(EXPECTED_GROUPS)
    for name, (dimension, measure) in EXPECTED_GROUPS.items():
        assert mesh.groups[name].dimension == dimension
        assert found[name].measure == pytest.approx(measure, rel=1e-9)
    assert mesh.notes == ()
    np.testing.assert_allclose(mesh.points[mesh.groups["corner"].members], [[2, 1, 0]])
    if order == 2:
        np.testing.assert_allclose(mesh.midpoints, mesh.points[mesh.edges].mean(axis=1), atol=1e-12)


def test_all_variants_are_the_same_mesh(folder):
    meshes = []
    for version, binary in ((2.2, 0), (2.2, 1), (4.1, 0), (4.1, 1)):
        path = folder / f"same_{version}_{binary}.msh"
        write_with_gmsh(path, version, bool(binary), 1, False)
        meshes.append(read_mesh(path))
    for mesh in meshes[1:]:
        assert group_places(mesh) == group_places(meshes[0])
        np.testing.assert_allclose(mesh.points, meshes[0].points, atol=1e-14)


@pytest.mark.parametrize(("version", "binary"), [(2.2, 0), (2.2, 1), (4.0, 0), (4.1, 0), (4.1, 1)])
def test_partitioned_files(tmp_path, version, binary):
    path = tmp_path / "partitioned.msh"
    write_with_gmsh(path, version, bool(binary), 1, False, partitions=3)
    mesh = read_mesh(path)
    measures = {group.name: group.measure for group in check.summary(mesh).groups}
    for name, (_, measure) in EXPECTED_GROUPS.items():
        assert measures[name] == pytest.approx(measure, rel=1e-9)
    whole = tmp_path / "whole.msh"
    write_with_gmsh(whole, version, bool(binary), 1, False)
    assert len(mesh.triangles) == len(read_mesh(whole).triangles)  # no copies of neighbours
    assert read_mesh(whole).parts is None
    sizes = np.bincount(mesh.parts)
    assert len(sizes) == 3
    assert sizes.min() >= 0.6 * sizes.mean()


def test_parts_stay_with_their_triangles(tmp_path):
    path = tmp_path / "partitioned.msh"
    write_with_gmsh(path, 4.1, False, 1, False, partitions=3)
    mesh = read_mesh(path)
    moved, _ = in_spatial_order(mesh)
    fine = bisect(mesh, np.arange(len(mesh.triangles))).mesh

    def middles(mesh):
        """Where the parts are: a part of equal triangles has its middle in the mean of theirs."""
        centres, weights = mesh.points[mesh.triangles].mean(axis=1), mesh.areas[:, None]
        return [(centres * weights)[mesh.parts == k].sum(axis=0) for k in range(3)]

    np.testing.assert_allclose(middles(moved), middles(mesh), atol=1e-12)
    np.testing.assert_allclose(middles(fine), middles(mesh), atol=1e-12)


@pytest.mark.parametrize("version", [2.2, 4.0, 4.1])
def test_pieces_of_entities_count_as_these(tmp_path, version):
    """Without physical groups curves and surfaces are called by their numbers, divided or not."""
    found = []
    for partitions in (0, 3):
        path = tmp_path / f"{partitions}.msh"
        write_with_gmsh(path, version, False, 1, False, partitions=partitions, groups=False)
        found.append({group.name: group.measure for group in check.summary(read_mesh(path)).groups})
    assert found[1] == pytest.approx(found[0], rel=1e-12)
    assert len(found[0]) == (0 if version == 2.2 else 9)


@pytest.mark.parametrize(("version", "binary"), [(1, 0), (2.2, 0), (2.2, 1), (4.0, 0), (4.1, 0), (4.1, 1)])
def test_one_of_several_files_is_refused(tmp_path, version, binary):
    write_with_gmsh(tmp_path / "split.msh", version, bool(binary), 1, False, partitions=3, split=True)
    for part in (1, 2, 3):
        with pytest.raises(InputError, match=rf"part {part}( of 3)? alone.*in one file"):
            read_mesh(tmp_path / f"split_{part}.msh")


@pytest.mark.parametrize("version", [2.2, 4.0, 4.1])
def test_one_part_is_the_whole(tmp_path, version):
    path = tmp_path / "one.msh"
    write_with_gmsh(path, version, False, 1, False, partitions=1)
    mesh = read_mesh(path)
    assert mesh.areas.sum() == pytest.approx(2.0)
    assert ["taken as the whole" in note for note in mesh.notes] == ([True] if version == 2.2 else [])


@pytest.mark.parametrize("binary", [False, True])
def test_nodes_with_parameters_of_their_curves_and_surfaces(tmp_path, binary):
    plain, parametric = tmp_path / "plain.msh", tmp_path / "parametric.msh"
    write_with_gmsh(plain, 4.1, binary, 1, False)
    write_with_gmsh(parametric, 4.1, binary, 1, False, parametric=True)
    assert parametric.stat().st_size > plain.stat().st_size
    np.testing.assert_array_equal(read_mesh(parametric).points, read_mesh(plain).points)


def test_save_all_in_the_old_version_is_said(tmp_path):
    path = tmp_path / "old.msh"
    write_with_gmsh(path, 2.2, False, 1, True)
    mesh = read_mesh(path)
    assert any("SaveAll" in note for note in mesh.notes)
    with pytest.raises(InputError, match=r"'middle'.*is empty.*MSH 4.1"):
        select(mesh, "middle")


def test_without_groups_the_numbers_of_gmsh_serve(tmp_path):
    import gmsh

    path = tmp_path / "bare.msh"
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.occ.addRectangle(0, 0, 0, 2, 1)
    gmsh.model.occ.synchronize()
    gmsh.model.mesh.generate(2)
    gmsh.write(str(path))
    gmsh.finalize()
    mesh = read_mesh(path)
    assert {"1:1", "1:2", "1:3", "1:4", "2:1"} == set(mesh.groups)
    assert any("no physical groups" in note for note in mesh.notes)


def test_cells_in_several_groups_are_one_cell(tmp_path):
    path = tmp_path / "twice.msh"
    path.write_text(
        msh2_text(TRIANGLE, ["2 1 1 2 3", "2 2 1 2 3", "2 1 2 4 3", "1 5 1 2", "1 6 1 2"]), encoding="utf-8"
    )
    mesh = read_mesh(path)
    assert len(mesh.triangles) == 2
    assert mesh.notes == ()
    assert {name: len(group.members) for name, group in mesh.groups.items()} == {
        "1:5": 1,
        "1:6": 1,
        "2:1": 2,
        "2:2": 1,
    }
    np.testing.assert_array_equal(mesh.groups["1:5"].members, mesh.groups["1:6"].members)


def test_a_cell_twice_in_one_group_is_said(tmp_path):
    path = tmp_path / "copies.msh"
    path.write_text(
        msh2_text(TRIANGLE, ["2 1 1 2 3", "2 1 3 1 2", "2 2 1 2 3", "2 0 2 4 3", "2 0 4 3 2"]),
        encoding="utf-8",
    )
    mesh = read_mesh(path)
    assert len(mesh.triangles) == 2
    assert mesh.notes == ("2 copies of triangles left out",)


def test_one_name_for_two_kinds_of_groups(tmp_path):
    names = '$PhysicalNames\n2\n1 5 "rim"\n2 1 "rim"\n$EndPhysicalNames\n'
    path = tmp_path / "names.msh"
    path.write_text(msh2_text(TRIANGLE, ["2 1 1 2 3", "1 5 1 2"], names), encoding="utf-8")
    mesh = read_mesh(path)
    assert set(mesh.groups) == {"rim (curve)", "rim (surface)"}
    assert any("told apart" in note for note in mesh.notes)


def test_a_negative_tag_turns_the_surface_over(tmp_path):
    """gmsh reverses a surface by `Physical Surface(1) = {-1};`; here in space, where orientation is kept."""
    path = tmp_path / "negative.msh"
    text = """$MeshFormat
4.1 0 8
$EndMeshFormat
$Entities
0 0 1 0
1 0 0 0 1 1 1 1 {tag} 0
$EndEntities
$Nodes
1 3 1 3
2 1 0 3
1
2
3
0 0 0
1 0 0
0 0 1
$EndNodes
$Elements
1 1 1 1
2 1 2 1
1 1 2 3
$EndElements
"""
    for tag, triangle in ((7, [0, 1, 2]), (-7, [0, 2, 1])):
        path.write_text(text.format(tag=tag), encoding="utf-8")
        mesh = read_mesh(path)
        np.testing.assert_array_equal(mesh.triangles, [triangle])
        assert set(mesh.groups) == {"2:7"}


def test_line_ends_of_windows(tmp_path):
    path = tmp_path / "windows.msh"
    names = '$PhysicalNames\n1\n1 5 "Stütze links"\n$EndPhysicalNames\n'
    text = msh2_text(TRIANGLE, ["2 1 1 2 3", "2 1 2 4 3", "1 5 1 2"], names)
    path.write_bytes(text.replace("\n", "\r\n").encode())
    mesh = read_mesh(path)
    assert list(mesh.groups) == ["Stütze links", "2:1"]


def test_node_tags_may_be_any_numbers(tmp_path):
    path = tmp_path / "sparse.msh"
    text = msh2_text(TRIANGLE, ["2 1 100 7 31", "2 1 7 5000000 31", "15 3 31"])
    for tag, new in ((4, 5000000), (3, 31), (2, 7), (1, 100)):
        x, y, z = TRIANGLE[tag - 1]
        text = text.replace(f"\n{tag} {x} {y} {z}\n", f"\n{new} {x} {y} {z}\n")
    path.write_text(text, encoding="utf-8")
    mesh = read_mesh(path)
    np.testing.assert_array_equal(mesh.triangles, [[0, 1, 2], [1, 3, 2]])
    assert mesh.groups["0:3"].members.tolist() == [2]


def test_heavy_libraries_stay_out():
    """A .msh file is read without gmsh, meshio or scikit-fem; the package alone not even loads scipy."""
    folder = Path(__file__).parents[2] / "meshes"
    program = (
        "import sys, kshell.mesh\nloaded = lambda: {name.partition('.')[0] for name in "
        "sys.modules}\nassert not loaded() & {'gmsh', 'meshio', 'skfem', 'scipy', 'matplotlib'}, "
        f"loaded()\nkshell.mesh.read_mesh({str(folder / 'plate.msh')!r})\nassert not loaded() & {{'gmsh', "
        "'meshio', 'skfem', 'matplotlib'}, loaded()\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True, cwd=folder.parent)


def test_big_endian_binary(tmp_path):
    """Files from machines with the other order of bytes."""
    points = np.array(TRIANGLE, dtype=">f8")
    nodes = b"".join(np.array([k], ">i4").tobytes() + row.tobytes() for k, row in enumerate(points, 1))
    cells = np.array([2, 2, 2, 1, 7, 1, 1, 2, 3, 2, 7, 1, 2, 4, 3, 15, 1, 1, 3, 9, 4], ">i4").tobytes()
    data = (
        b"$MeshFormat\n2.2 1 8\n" + np.array([1], ">i4").tobytes() + b"\n$EndMeshFormat\n"
        b"$Nodes\n4\n" + nodes + b"\n$EndNodes\n$Elements\n3\n" + cells + b"\n$EndElements\n"
    )
    path = tmp_path / "big.msh"
    path.write_bytes(data)
    mesh = read_mesh(path)
    assert len(mesh.triangles) == 2
    assert {name: group.members.tolist() for name, group in mesh.groups.items()} == {
        "0:9": [3],
        "2:7": [0, 1],
    }


GOOD = msh2_text(TRIANGLE, ["2 1 1 2 3", "2 1 2 4 3"])
DAMAGED = {
    "empty": ("", "the file is empty"),
    "other format": ("hello world", "not a gmsh file"),
    "version 1": ("$NOD\n1\n1 0 0 0\n$ENDNOD\n", r"has no \$ELM"),
    "version 4.0": (GOOD.replace("2.2 0 8", "4 0 8"), "The file is damaged"),
    "version 3": (GOOD.replace("2.2 0 8", "3 0 8"), "version 3 is not read.*msh41"),
    "format line": (GOOD.replace("2.2 0 8", "2.2"), "MeshFormat"),
    "cut off": (GOOD[: GOOD.index("$EndElements")], "Elements is not ended"),
    "nodes missing": (GOOD.replace("4\n1 0", "5\n1 0"), "announces 5 nodes"),
    "cells missing": (GOOD.replace("$Elements\n2", "$Elements\n7"), "ends before its 7 cells"),
    "letters": (GOOD.replace("1 2 2 1 1 1 2 3", "1 2 2 1 1 1 x 3"), "'x' where a number"),
    "decimal comma": (GOOD.replace("2 1 0 0", "2 1,5 0 0"), "'1,5' where a number"),
    "unknown type": (GOOD.replace("1 2 2 1 1 1 2 3", "1 99 2 1 1 1 2 3"), "unknown type 99|ends before"),
    "unknown node": (GOOD.replace("1 2 2 1 1 1 2 3", "1 2 2 1 1 1 2 9"), "names node 9"),
    "node twice": (GOOD.replace("4 1 1 0", "3 1 1 0"), "node 3 is stored twice"),
    "no cells": (GOOD[: GOOD.index("$Elements")], "no \\$Elements"),
    "name line": (
        GOOD.replace("$Nodes", "$PhysicalNames\n1\n1 7 left\n$EndPhysicalNames\n$Nodes"),
        "dimension tag",
    ),
}


@pytest.mark.parametrize("case", DAMAGED)
def test_damaged_files(tmp_path, case):
    text, message = DAMAGED[case]
    path = tmp_path / "damaged.msh"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=message) as caught:
        read_mesh(path)
    assert str(caught.value).startswith("damaged.msh: ")


@pytest.mark.parametrize("version", [2.2, 4.1])
def test_binary_files_cut_off_anywhere(tmp_path, version):
    whole, cut = tmp_path / "whole.msh", tmp_path / "cut.msh"
    write_with_gmsh(whole, version, True, 1, False)
    data = whole.read_bytes()
    end = data.index(b"$EndElements")
    for keep in (*range(20, end, 397), end - 6):
        for tail in (b"", b"\n$EndNodes\n$Elements\n0\n$EndElements\n", b"\n$EndElements\n"):
            cut.write_bytes(data[:keep] + tail)
            with pytest.raises(InputError, match=r"cut\.msh"):
                read_mesh(cut)


def test_noise_instead_of_a_file(tmp_path):
    path = tmp_path / "noise.msh"
    noise = np.random.default_rng(3).integers(0, 256, 4000, dtype=np.uint8).tobytes()
    for data in (
        noise,
        b"$MeshFormat\n4.1 1 8\n\x01\0\0\0\n$EndMeshFormat\n$Nodes\n"
        + noise
        + b"\n$EndNodes\n$Elements\n"
        + noise
        + b"\n$EndElements\n",
    ):
        path.write_bytes(data)
        with pytest.raises(InputError):
            read_mesh(path)


@pytest.mark.parametrize("version", [1.0, 4.0])
@pytest.mark.parametrize("order", [1, 2])
def test_old_versions(tmp_path, version, order):
    write_with_gmsh(tmp_path / "old.msh", version, False, order, False)
    write_with_gmsh(tmp_path / "new.msh", 4.1, False, order, False)
    old, new = read_mesh(tmp_path / "old.msh"), read_mesh(tmp_path / "new.msh")
    assert old.order == order
    np.testing.assert_allclose(sorted(old.points.tolist()), sorted(new.points.tolist()), atol=1e-12)
    places, expected = group_places(old), group_places(new)
    if version == 1.0:  # knows no names
        tags = {f"{group.dimension}:{group.tag}": name for name, group in new.groups.items()}
        expected = {name: expected[tags[name]] for name in places}
        assert len(places) == len(new.groups)
    assert places == expected


@pytest.mark.parametrize("version", [1.0, 4.0])
@pytest.mark.parametrize("section", ["NOD", "ELM", "Nodes", "Elements"])
def test_wrong_counts_in_old_versions(tmp_path, version, section):
    path = tmp_path / "old.msh"
    write_with_gmsh(path, version, False, 1, False)
    lines = path.read_text(encoding="utf-8").splitlines()
    if f"${section}" not in lines:
        assert section.isupper() != (version == 1.0)
        return
    at = lines.index(f"${section}") + 1
    *blocks, number = lines[at].split()
    for change in (-5, -1, 1):
        lines[at] = " ".join([*blocks, str(int(number) + change)])
        path.write_text("\n".join(lines), encoding="utf-8")
        with pytest.raises(InputError, match="The file is damaged"):
            read_mesh(path)
    lines[at] = " ".join([*blocks, number])
    lines[at + 1] += " 7"
    path.write_text("\n".join(lines), encoding="utf-8")
    with pytest.raises(InputError, match="The file is damaged"):
        read_mesh(path)


def counted(tmp_path, version, binary=False):
    path = tmp_path / "mesh.msh"
    write_with_gmsh(path, version, binary, 1, False)
    return path, path.read_bytes().split(b"\n")


def test_wrong_counts_in_version_2(tmp_path):
    path, lines = counted(tmp_path, 2.2)
    nodes, cells, end = (lines.index(word) for word in (b"$Nodes", b"$Elements", b"$EndElements"))
    wrong = {
        "fewer cells": {cells + 1: b"%d" % (int(lines[cells + 1]) - 1)},
        "no cells": {cells + 1: b"0"},
        "more cells": {cells + 1: b"%d" % (int(lines[cells + 1]) + 1)},
        "fewer nodes": {nodes + 1: b"%d" % (int(lines[nodes + 1]) - 1)},
        "more nodes": {nodes + 1: b"%d" % (int(lines[nodes + 1]) + 1)},
        "a word more": {end - 1: lines[end - 1] + b" 3"},
        "a word less": {end - 1: lines[end - 1].rsplit(None, 1)[0]},
        "a cell again": {end - 1: lines[end - 1] + b"\n" + lines[end - 1]},
        "endless tags": {end - 1: b"1 2 9223372036854775807 1 2 3"},
        "tags less than none": {end - 1: b"1 2 -9223372036854775807 1 2 3"},
        "cells again": {end: b"\n".join([lines[end], *lines[cells : end + 1]])},
        "nodes again": {end: b"\n".join([lines[end], *lines[nodes:cells]])},
    }
    for name, changes in wrong.items():
        path.write_bytes(b"\n".join(changes.get(k, line) for k, line in enumerate(lines)))
        with pytest.raises(InputError, match="The file is damaged"):
            read_mesh(path)
        assert name


def test_wrong_counts_in_version_4(tmp_path):
    path, lines = counted(tmp_path, 4.1)
    nodes, cells, end = (lines.index(word) for word in (b"$Nodes", b"$Elements", b"$EndElements"))
    head = lines[cells + 1].split()
    # the first line of the last block of cells
    block = max(
        k for k in range(cells + 2, end) if lines[k].split()[:1] == [b"2"] and len(lines[k].split()) == 4
    )
    of_block = lines[block].split()

    def less(words, k):
        return b" ".join([*words[:k], b"%d" % (int(words[k]) - 1), *words[k + 1 :]])

    wrong = [
        {cells + 1: less(head, 0)},
        {cells + 1: less(head, 1)},
        {block: less(of_block, 3)},
        {block: less(of_block, 3), cells + 1: less(head, 1)},
        {nodes + 1: less(lines[nodes + 1].split(), 0)},
        {nodes + 1: less(lines[nodes + 1].split(), 1)},
        {end: b"\n".join([lines[end], *lines[cells : end + 1]])},
    ]
    for changes in wrong:
        path.write_bytes(b"\n".join(changes.get(k, line) for k, line in enumerate(lines)))
        with pytest.raises(InputError, match="The file is damaged"):
            read_mesh(path)


@pytest.mark.parametrize("version", [2.2, 4.1])
def test_wrong_counts_in_binary_files(tmp_path, version):
    path, _ = counted(tmp_path, version, binary=True)
    data = path.read_bytes()
    for section in (b"$Nodes", b"$Elements"):
        end = data.index(b"$End" + section[1:])
        path.write_bytes(data[:end] + bytes(range(1, 41)) + b"\n" + data[end:])
        with pytest.raises(InputError, match="The file is damaged"):
            read_mesh(path)
