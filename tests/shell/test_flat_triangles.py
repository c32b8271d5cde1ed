"""Flat triangles of curved shells under `auto`: against membrane theory and known deflections."""

import dataclasses

import numpy as np
import pytest

import kshell as ks
from tests.mesh import curved_shapes as shapes
from tests.shell.shell_scenes import MESHES

E, NU, PRESSURE = 2e11, 0.3, 1e5


def near(points, x):
    return tuple(points[np.argmin(np.linalg.norm(points - np.array(x), axis=1))].tolist())


def sphere(n, thickness, **keys):
    """A closed unit sphere under pressure; its radial displacement p R^2 (1 - nu) / (2 E t), stress p R / (2 t)."""
    points, triangles = shapes.sphere(n)
    a, b, c = (near(points, x) for x in ((1, 0, 0), (-1, 0, 0), (0, 1, 0)))
    supports = [ks.Fixed(a, "yz"), ks.Fixed(b, "yz"), ks.Fixed(c, "xz")]
    scene = shell(ks.Mesh.from_arrays(points, triangles), thickness, supports, **keys)
    return scene, [1, 1, 1], PRESSURE * (1 - NU) / (2 * E * thickness), PRESSURE / (2 * thickness)


def tube(n, thickness, **keys):
    """An open tube of radius 1 and length 2, free to grow: p R^2 / (E t), p R / t."""
    points, triangles = shapes.cylinder(n, n // 3)
    mesh = ks.Mesh.from_arrays(points, triangles)
    rim = mesh.edges[mesh.boundary_edges]
    mesh = ks.Mesh.from_arrays(points, triangles, {"low": rim[points[rim[:, 0], 2] < 1]})
    supports = [
        ks.Fixed("low", "z"),
        ks.Fixed((1, 0, 0), "y"),
        ks.Fixed((-1, 0, 0), "y"),
        ks.Fixed((0, 1, 0), "x"),
    ]
    return (
        shell(mesh, thickness, supports, **keys),
        [1, 1, 0],
        PRESSURE / (E * thickness),
        PRESSURE / thickness,
    )


def shell(mesh, thickness, supports, **keys):
    return ks.Scene(
        mesh=mesh,
        thickness=thickness,
        material=ks.Isotropic(E=E, nu=NU),
        supports=supports,
        loads=[ks.Pressure(PRESSURE)],
        solve={"large_deflection": False},
        **keys,
    )


@pytest.mark.parametrize("thickness", [1e-2, 1e-3])
@pytest.mark.parametrize(("make", "n"), [(sphere, 16), (tube, 48)])
def test_pressure_against_membrane_theory(make, n, thickness):
    """Mean radial displacement within 0.4 %, largest von Mises stress within 1 %; h = R / 10 and R / 8."""
    scene, radial, u_exact, stress = make(n, thickness)
    result = ks.solve(scene)
    direction = result.mesh.points * radial
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    u = (result.fields["displacement"] * direction).sum(axis=1).mean()
    assert abs(u) == pytest.approx(u_exact, rel=4e-3)
    assert result.extremes["von_mises"]["value"] == pytest.approx(stress, rel=1e-2)
    assert result.model["order"] == 3
    assert not any("flat triangles" in words for words in result.warnings)
    assert any("moved" in words for words in result.model["reasons"])
    assert any("moved" in words for words in result.mesh.notes)


def test_roof_from_80_flat_triangles(tmp_path):
    """Scordelis-Lo: -8 % with flat triangles of order 2; -0.300592457 is the deflection of the free edge."""
    geometry = tmp_path / "roof.geo"
    text = (MESHES / "scordelis_lo.geo").read_text(encoding="utf-8")
    assert "n = 14; m = 3;" in text
    geometry.write_text(text.replace("n = 14; m = 3;", "n = 8; m = 5;"), encoding="utf-8")
    mesh = dataclasses.replace(ks.mesh.read_mesh(geometry, mesh_order=1), midpoints=None)
    assert len(mesh.triangles) == 80
    result = ks.solve(dataclasses.replace(ks.Scene.load(MESHES / "scordelis_lo.toml"), mesh=mesh))
    assert result.probe("free edge")["u"][2] == pytest.approx(-0.300592457, rel=1e-6)


def test_noise_is_told_and_solved_with_order_1():
    scene, *_ = sphere(8, 1e-3)
    points = scene.mesh.points + np.random.default_rng(3).uniform(-1, 1, scene.mesh.points.shape) * 1e-3
    noisy = dataclasses.replace(scene, mesh=dataclasses.replace(scene.mesh, points=points), supports=[])
    supports = [
        ks.Fixed(near(points, x), fix)
        for x, fix in (((1, 0, 0), "yz"), ((-1, 0, 0), "yz"), ((0, 1, 0), "xz"))
    ]
    result = ks.solve(dataclasses.replace(noisy, supports=supports))
    assert result.model["order"] == 1
    assert any("too far off" in words and "of the thickness" in words for words in result.warnings)


def test_keys_decide_by_hand(tmp_path):
    scene, *_ = tube(18, 1e-2)
    assert scene.read_mesh().order == 2
    assert dataclasses.replace(scene, facets="flat").read_mesh().order == 1
    assert dataclasses.replace(scene, crease=19).read_mesh().order == 1
    with pytest.raises(ks.InputError, match="crease = 200"):
        dataclasses.replace(scene, crease=200)
    with pytest.raises(ks.InputError, match="facets"):
        dataclasses.replace(scene, facets="round")
    curved = dataclasses.replace(scene, mesh=scene.read_mesh(), facets="curved")
    with pytest.raises(ks.InputError, match='facets = "curved" is for flat triangles'):
        curved.read_mesh()
    ks.mesh.write_msh(scene.mesh, tmp_path / "tube.msh")
    keys = {"mesh": "tube.msh", "thickness": 0.01, "facets": "flat", "crease": 25.0}
    read = ks.Scene.from_dict({**keys, "material": {"E": 1.0, "nu": 0.3}}, tmp_path)
    assert (read.facets, read.crease) == ("flat", 25.0)
