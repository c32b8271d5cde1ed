"""What pictures mark: the largest and smallest values where they are, in a view that sees them; names of groups."""

import numpy as np
import pytest

import kshell as ks
from kshell.cli.commands import run
from kshell.draw.groups import places_of_groups
from kshell.draw.marks import USUAL, marks, seeing
from kshell.draw.pictures import picture_values
from kshell.draw.plot import plot
from kshell.mesh import read_mesh


@pytest.fixture(scope="module")
def girder():
    return ks.solve(ks.Scene.load("meshes/box_girder.toml"), large_deflection=False, error="off")


def test_marks_are_the_ends_of_the_field(girder):
    for what in ("von_mises_top", "moment_xx"):
        values, _ = picture_values(girder, what)
        found = {mark.kind: mark for mark in marks(values, girder.rows)}
        assert values[found["largest"].node] == values.max()
        assert f"{values.max():.4g}" in found["largest"].words
        assert ("smallest" in found) == (values.min() < 0.0)
        if found["largest"].node < len(girder.group):
            assert girder.group[found["largest"].node] in found["largest"].words


def test_a_constant_field_has_no_marks(girder):
    assert marks(np.zeros(len(girder.rows.nodes)), girder.rows) == []


def test_pictures_have_the_words(girder):
    values, _ = picture_values(girder, "von_mises_top")
    figure = plot(girder, "von_mises_top")
    assert any(f"{values.max():.4g}" in text.get_text() for text in figure.axes[0].texts)


def cup():
    """Two square plates, one above the other; the lower one is hidden from above."""
    nodes = np.array([[x, y, z] for z in (0.0, 1.0) for x in (-1.0, 1.0) for y in (-1.0, 1.0)])
    nodes[4:, :2] *= 30.0
    triangles = np.array([[0, 1, 3], [0, 3, 2], [4, 5, 7], [4, 7, 6]])
    return nodes, triangles


def test_the_view_sees_the_place():
    nodes, triangles = cup()
    assert seeing(nodes, triangles, 4) == USUAL
    elevation, _ = seeing(nodes, triangles, 0)
    assert elevation < 0.0  # from below, where nothing hides it


def test_hidden_from_everywhere_takes_the_usual_view():
    nodes, triangles = cup()
    below = nodes[4:].copy()
    below[:, 2] = -1.0
    closed = np.concatenate([triangles, [[8, 9, 11], [8, 11, 10]]])
    assert seeing(np.concatenate([nodes, below]), closed, 0) == USUAL


def test_every_group_has_its_place():
    mesh = read_mesh("meshes/box_girder.msh")
    for name, x in places_of_groups(mesh).items():
        group = mesh.groups[name]
        corners = mesh.edges if group.dimension == 1 else mesh.triangles
        middles = mesh.points[corners[group.members]].mean(axis=1)
        assert np.linalg.norm(middles - x, axis=1).min() == 0.0


@pytest.mark.parametrize("name", ["plate.toml", "box_girder.toml", "disk.msh", "twisted_beam.toml"])
def test_check_draws(name, tmp_path, capsys):
    assert run(["check", f"meshes/{name}", "--plot", "-o", str(tmp_path / "seen")]) == 0
    assert (tmp_path / "seen" / "mesh.png").stat().st_size > 5000
    assert "mesh.png" in capsys.readouterr().out


def test_check_says_where_groups_are(capsys):
    run(["check", "meshes/box_girder.msh"])
    assert "(4, 0, 0), (4, 2, 0.6)" in capsys.readouterr().out


def test_a_folder_without_a_picture_is_refused(tmp_path, capsys):
    assert run(["check", "meshes/plate.toml", "-o", str(tmp_path)]) == 2
    assert "--plot" in capsys.readouterr().err


def test_edges_behind_a_surface_are_not_drawn():
    from kshell.draw.hidden import Depths
    from kshell.draw.space import figure_in_space

    # two sheets, one above the other, seen from above
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
    up = np.array([0, 0, 0.5])
    corners = np.concatenate([square, square * 0.5 + 0.25 - up])
    faces = corners[[[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]]
    _, axes = figure_in_space("", corners, view=(80.0, -60.0))
    depths = Depths(axes, faces)
    above, below = (corners[[[a, a + 1]]] for a in (0, 4))
    length = {}
    for name, line in (("above", above), ("below", below)):
        pieces = depths.visible(line)
        length[name] = float(np.linalg.norm(pieces[:, 1] - pieces[:, 0], axis=1).sum())
    assert length["above"] == pytest.approx(1.0, abs=0.02)
    assert length["below"] == 0.0
    free = depths.visible(np.array([[[1.5, 0.0, -0.5], [1.5, 1.0, -0.5]]]))  # beside the sheets
    assert np.linalg.norm(free[:, 1] - free[:, 0], axis=1).sum() == pytest.approx(1.0, abs=0.02)
