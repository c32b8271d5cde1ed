"""A result in pieces is the same as in one file."""

import re
from pathlib import Path

import numpy as np
import pytest

import kshell as ks
from kshell.result.pieces import piece_name, piece_of, pieces_index, read_pieces
from kshell.result.vtu import head, unstructured
from kshell.result.vtu_file import write_triangles


@pytest.fixture(scope="module", params=[1, 2])
def result(request: pytest.FixtureRequest) -> ks.Result:
    mesh = ks.geometry.Cylinder(1.0).mesh(3, 4, request.param, ("a", "b", "c", "d"), (0.5, 1.4), (0.0, 1.0))
    return ks.solve(
        ks.Scene(
            mesh=mesh,
            thickness=0.01,
            material=ks.Isotropic(E=1.0, nu=0.3),
            supports=[ks.Clamped("a")],
            loads=[ks.Pressure(1e-9)],
            probes={"corner": tuple(mesh.points[-1])},
        )
    )


def in_pieces(result: ks.Result, folder: Path, count: int) -> Path:
    whole = unstructured(result)
    part = np.arange(len(result.mesh.triangles)) * 7 % count
    names = [piece_name(k) for k in range(count)]
    for k, name in enumerate(names):
        write_triangles(folder / name, piece_of(whole, part == k), head(result))
    (folder / "result.pvtu").write_text(pieces_index(whole, names), encoding="utf-8")
    return folder / "result.pvtu"


@pytest.mark.parametrize("count", [1, 3])
def test_pieces_put_together_are_the_whole(result: ks.Result, tmp_path: Path, count: int) -> None:
    whole, found = unstructured(result), read_pieces(in_pieces(result, tmp_path, count))
    np.testing.assert_array_equal(found.points, whole.points)
    np.testing.assert_array_equal(found.cells[0].data, whole.cells)
    assert found.cells[0].type == {3: "triangle", 6: "triangle6"}[whole.cells.shape[1]]
    assert set(found.point_data) == set(whole.point_data)
    assert set(found.cell_data) == set(whole.cell_data)
    for name, values in whole.point_data.items():
        np.testing.assert_array_equal(found.point_data[name], values)
    for name, values in whole.cell_data.items():
        np.testing.assert_array_equal(found.cell_data[name][0], values)


def test_the_index_names_columns_as_the_pieces_do(result: ks.Result, tmp_path: Path) -> None:
    index = in_pieces(result, tmp_path, 2).read_text(encoding="utf-8")
    piece = (tmp_path / piece_name(0)).read_text(encoding="utf-8")
    for name, columns in (("moment", "xx yy xy"), ("shear", "x y"), ("displacement", "x y z")):
        if name in result.fields:
            words = "".join(f' ComponentName{k}="{column}"' for k, column in enumerate(columns.split()))
            for text in (index, piece):
                assert re.search(f'Name="{name}" NumberOfComponents="\\d"{words}', text)


def test_a_result_is_read_from_its_pieces(result: ks.Result, tmp_path: Path) -> None:
    result.save(tmp_path / "whole")
    result.solver["processes"] = 3
    result.writer = None
    result.save(tmp_path)
    (tmp_path / "result.vtu").unlink()
    in_pieces(result, tmp_path, 3)
    one, other = ks.Result.load(tmp_path), ks.Result.load(tmp_path / "whole")
    np.testing.assert_array_equal(one.fields["displacement"], other.fields["displacement"])
    np.testing.assert_array_equal(one.mesh.triangles, other.mesh.triangles)
    assert set(one.mesh.groups) == set(other.mesh.groups)
    del result.solver["processes"]


def test_a_missing_piece_is_told(result: ks.Result, tmp_path: Path) -> None:
    index = in_pieces(result, tmp_path, 2)
    (tmp_path / piece_name(1)).unlink()
    with pytest.raises(ks.InputError, match=r"result\.pvtu"):
        read_pieces(index)
