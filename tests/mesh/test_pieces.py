"""Files that hold a piece of a mesh are refused, whatever tells it; the whole is read."""

import numpy as np
import pytest

from kshell.errors import InputError
from kshell.mesh.read import read_mesh

meshio = pytest.importorskip("meshio")

POINTS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])


def written(path, **cell_data):
    data = {name: [np.array(values, dtype=np.uint8)] for name, values in cell_data.items()}
    meshio.Mesh(POINTS, [("triangle", TRIANGLES)], cell_data=data).write(path)
    return path


@pytest.mark.parametrize("suffix", [".vtu", ".vtk"])
@pytest.mark.parametrize(
    ("name", "values", "words"),
    [
        ("vtkGhostType", (0, 1), "1 cell"),
        ("vtkGhostType", (33, 32), "2 cells"),
        ("vtkGhostLevels", (0, 2), "1 cell"),
    ],
)
def test_copies_of_other_pieces_are_refused(tmp_path, suffix, name, values, words):
    with pytest.raises(InputError, match=rf"{words} that belong.*{name}.*in one file"):
        read_mesh(written(tmp_path / f"piece{suffix}", **{name: values}))


@pytest.mark.parametrize(("name", "values"), [("vtkGhostType", (0, 0)), ("vtkGhostType", (16, 16))])
def test_a_whole_mesh_may_say_that_nothing_is_a_copy(tmp_path, name, values):
    mesh = read_mesh(written(tmp_path / "whole.vtu", **{name: values}))
    assert mesh.areas.sum() == pytest.approx(1.0)


def index_of(*names):
    pieces = "".join(f'<Piece Source="{name}"/>' for name in names)
    return f'<VTKFile type="PUnstructuredGrid"><PUnstructuredGrid>{pieces}</PUnstructuredGrid></VTKFile>'


@pytest.mark.parametrize("folder", ["", "parts/"])
def test_a_file_that_an_index_names_among_others_is_refused(tmp_path, folder):
    (tmp_path / folder).mkdir(exist_ok=True)
    written(tmp_path / folder / "a_0.vtu")
    (tmp_path / "a.pvtu").write_text(index_of(f"{folder}a_0.vtu"), encoding="utf-8")
    assert len(read_mesh(tmp_path / folder / "a_0.vtu").triangles) == 2  # the only one
    (tmp_path / "a.pvtu").write_text(index_of(f"{folder}a_0.vtu", f"{folder}a_1.vtu"), encoding="utf-8")
    with pytest.raises(InputError, match=r"one of 2 pieces.*a\.pvtu"):
        read_mesh(tmp_path / folder / "a_0.vtu")
    with pytest.raises(InputError, match=r"names files.*in one file"):
        read_mesh(tmp_path / "a.pvtu")
    assert len(read_mesh(written(tmp_path / folder / "b.vtu")).triangles) == 2


def test_the_file_of_one_process_of_kratos_is_refused(tmp_path):
    path = tmp_path / "piece.mdpa"
    whole = (
        "Begin Nodes\n1 0 0 0\n2 1 0 0\n3 0 1 0\nEnd Nodes\n"
        "Begin Elements ShellThinElement3D3N\n1 1 1 2 3\nEnd Elements\n"
    )
    path.write_text(whole, encoding="utf-8")
    assert len(read_mesh(path).triangles) == 1
    path.write_text(
        whole + "Begin CommunicatorData\nNUMBER_OF_COLORS 1\nEnd CommunicatorData\n", encoding="utf-8"
    )
    with pytest.raises(InputError, match=r"one process.*CommunicatorData"):
        read_mesh(path)


def test_a_med_file_with_joints_is_refused(tmp_path):
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "piece.med"
    meshio.Mesh(POINTS, [("triangle", TRIANGLES)]).write(path)
    assert len(read_mesh(path).triangles) == 2
    with h5py.File(path, "a") as file:
        file.create_group("JNT/mesh/joint_1")
    with pytest.raises(InputError, match=r"1 joint"):
        read_mesh(path)
