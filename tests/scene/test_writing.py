"""Scenes written and read back: the same scene; what no file holds is refused."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

import kshell as ks

MESHES = Path(__file__).parents[2] / "meshes"


@pytest.mark.parametrize("path", sorted(MESHES.glob("*.toml")), ids=lambda path: path.stem)
def test_shipped_scenes_come_back(path, tmp_path):
    scene = ks.Scene.load(path)
    (written,) = scene.save(tmp_path / "deeper" / "copy.toml")
    again = ks.Scene.load(written)
    assert again.mesh.resolve() == scene.mesh.resolve()
    for there, here in zip(again.obstacles, scene.obstacles, strict=True):
        if isinstance(here.shape, Path):
            assert there.shape.resolve() == here.shape.resolve()
        else:
            assert there == here
    assert again.changed(mesh=scene.mesh, obstacles=scene.obstacles) == scene


def test_everything_comes_back_with_a_mesh_in_memory(tmp_path):
    mesh = ks.geometry.Plane().mesh(2, 2, 1, ("left", "right", "bottom", "top"), (0, 1), (0, 1))
    glass = ks.Orthotropic(E1=40e9, E2=8e9, nu12=0.25, G12=4e9, density=1800)
    scene = ks.Scene(
        mesh=mesh,
        layers=[
            ks.Layer(glass, 0.001, 45.0),
            ks.Layer(ks.Anisotropic(C=np.diag([9e9, 8e9, 3e9])), 0.002),
        ],
        supports=[
            ks.Fixed("left", "xz", (0, 0, "0.001*y")),
            ks.Elastic("right", 1e6, "zr"),
            ks.Clamped("top"),
        ],
        loads=[
            ks.Pressure("1 - x", name='a "quoted" name', fixed=True),
            ks.Temperature(mean=3.0, gradient="y", expansion=1e-5),
            ks.PointForce((0.5, 0.5, 0.0), (0, 0, -1)),
        ],
        probes={"p": (0.5, 0.5, 0.0)},
        cases=[ks.Case("one", [0, 1], [1.0, 2.0])],
        combinations=[ks.Combination("two", {"one": 1.5})],
        lines=[ks.Line("l", (0, 0, 0), (1, 0, 0), 5)],
        title="Ünïcode \\ and\nlines",
        solve={"analysis": "path", "steps": 4, "control": {"probe": "p", "component": "z", "to": -0.1}},
    )
    paths = scene.save(tmp_path / "scene.toml")
    assert paths == [str(tmp_path / "scene.toml"), str(tmp_path / "scene.msh")]
    again = ks.Scene.load(paths[0])
    assert again.changed(mesh=mesh) == scene
    read = again.read_mesh()
    assert np.array_equal(read.points, mesh.points)
    assert set(read.groups) == set(mesh.groups)


def test_charts_come_back(tmp_path):
    scene = ks.Scene(
        mesh="a.msh", thickness=1.0, material=ks.Isotropic(E=1.0, nu=0.3), chart=ks.geometry.Hypar(2.0)
    )
    scene.save(tmp_path / "a.toml")
    data = tomllib.loads((tmp_path / "a.toml").read_text(encoding="utf-8"))
    assert data["chart"]["kind"] == "hypar"
    assert ks.Scene.load(tmp_path / "a.toml").chart == scene.chart


def test_what_no_file_holds_is_refused(tmp_path):
    material = ks.Isotropic(E=1.0, nu=0.3)
    scene = ks.Scene(mesh="a.msh", thickness=lambda x, y, z: 1 + x, material=material)
    with pytest.raises(ks.InputError, match=r"thickness = .* cannot be written"):
        scene.save(tmp_path / "a.toml")
    with pytest.raises(ks.InputError, match=r"ends in \.toml"):
        scene.save(tmp_path / "a.json")
    assert list(tmp_path.iterdir()) == []
