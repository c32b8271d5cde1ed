"""Files and pictures of solved shells, and what they say of material axes."""

import builtins
import dataclasses

import meshio
import numpy as np
import pytest

import kshell as ks
from tests.shell.shell_scenes import MESHES


def test_files_and_pictures(tmp_path, monkeypatch):
    result = ks.solve(ks.Scene.load(MESHES / "raasch_hook.toml"))
    result.save(tmp_path, plots=True)
    names = {path.name for path in tmp_path.iterdir()}
    assert {
        "result.json",
        "result.vtu",
        "deflection.png",
        "force_xx.png",
        "mesh.png",
        "von_mises_middle.png",
    } <= names
    file = meshio.read(tmp_path / "result.vtu")
    assert file.cells[0].type == "triangle6"
    tip = np.argmin(np.linalg.norm(file.points - result.probe("tip")["x"], axis=1))
    assert file.point_data["displacement"][tip] == pytest.approx(result.probe("tip")["u"], rel=1e-9)
    # mid-edge nodes move as the solution does, not as the mean of the ends
    ends, middle = result.mesh.edges, result.edge_fields["displacement"]
    mean = result.fields["displacement"][ends].mean(axis=1)
    assert 1e-4 < np.abs(middle - mean).max() < 0.2
    assert result.at(result.mesh.midpoints[:5])["u"] == pytest.approx(middle[:5], abs=1e-6)
    axes = result.plot("deflection").axes[0]
    assert (axes.get_xlabel(), axes.get_zlabel()) == ("x", "z")
    with pytest.raises(ks.InputError, match="the pictures are"):
        result.plot("nothing")
    real = builtins.__import__

    def without_pyvista(name, *rest, **more):
        if name == "pyvista":
            raise ImportError("No module named 'pyvista'")
        return real(name, *rest, **more)

    monkeypatch.setattr(builtins, "__import__", without_pyvista)
    with pytest.raises(ks.InputError, match=r"pip install kshell\[view\]"):
        result.show()


CARBON = ks.Orthotropic(E1=140e9, E2=10e9, nu12=0.3, G12=5e9)


def test_material_axes_follow_a_direction_on_the_surface():
    """A tube with fibres along its axis z or around it, pulled along z: the axis counts from the direction given."""
    scene = ks.Scene.load(MESHES / "tube.toml", ["load.0.value=[0, 0, -1]"])
    supports = [ks.Symmetry("cuts"), ks.Symmetry("far")]
    scene = dataclasses.replace(scene, supports=supports, material=CARBON)
    stretch = {}
    for angle in (0.0, 90.0):
        material = dataclasses.replace(CARBON, angle=angle)
        result = ks.solve(dataclasses.replace(scene, material=material, direction=(0, 0, 1)))
        assert not result.warnings
        stretch[angle] = result.probe("end")["u"][2]
    assert stretch[0.0] == pytest.approx(-1 / (0.01 * 140e9), rel=2e-3)
    assert stretch[90.0] == pytest.approx(-1 / (0.01 * 10e9), rel=2e-3)
    assert any("x is nearly normal" in words for words in ks.solve(scene).warnings)
    drawn = ks.solve(dataclasses.replace(scene, direction=(0, 0, 1))).plot("mesh")
    assert "material axis 1: 0 degrees" in [text.get_text() for text in drawn.legends[0].get_texts()]


def test_view_has_curved_triangles():
    from kshell.draw.drawn import Drawn
    from kshell.draw.view import surface_grid

    result = ks.solve(ks.Scene.load(MESHES / "scordelis_lo.toml"))
    grid = surface_grid(Drawn(dataclasses.replace(result, sampled=None)), 10.0)
    assert grid.n_cells == len(result.mesh.triangles)
    assert set(grid.celltypes) == {22}  # quadratic triangles
    assert grid.area == pytest.approx(25 * np.radians(40) * 25, rel=0.05)


@pytest.mark.full
def test_stills_by_pyvista(tmp_path, monkeypatch):
    pytest.importorskip("pyvista")
    from kshell.draw import stills
    from kshell.draw.plot import save_picture

    result = ks.solve(ks.Scene.load("meshes/scordelis_lo.toml"), error="off")
    assert not stills.drawn_by_pyvista(result, "deflection")
    monkeypatch.setenv(stills.CHOICE, "")
    assert stills.drawn_by_pyvista(result, "deflection")
    assert not stills.drawn_by_pyvista(result, "mesh")
    save_picture(result, "deflection", tmp_path / "a.png")
    image = stills.still(result, "deflection")
    assert image.shape == (900, 1200, 3)
    inside = image[250:650, 300:900].reshape(-1, 3)
    assert len(np.unique(inside, axis=0)) > 50  # a field, not an empty window
    assert (tmp_path / "a.png").read_bytes()[:4] == b"\x89PNG"
    pale = stills.still(result, "force_yy")[250:650, 300:900].reshape(-1, 3).astype(int)
    assert (pale[:, 2] - pale[:, 0] > 8).sum() > 5000  # small negative forces are bluish, not white
