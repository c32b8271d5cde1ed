"""Prescribed rotations that cannot be meant are refused with the way out."""

import pytest

import kshell as ks
from tests.scene.fabricated import square_mesh


def solve(*supports, **options):
    scene = ks.Scene(
        mesh=square_mesh(4), thickness=0.1, material=ks.Isotropic(E=1e6, nu=0.3), supports=list(supports)
    )
    return ks.solve(scene, error="off", **options)


def test_a_rotation_needs_r_among_the_freedoms():
    with pytest.raises(ks.InputError, match='fix = "zr"'):
        ks.Fixed("left", "z", rotation=0.1)
    assert ks.Fixed("left", "z", rotation=0.0).rotation is None


@pytest.mark.parametrize("on", [(0.0, 0.0, 0.0), "plate"])
def test_a_rotation_is_about_edges(on):
    with pytest.raises(ks.InputError, match="rotation is about edges"):
        solve(ks.Clamped("right"), ks.Fixed(on, "zr", rotation=0.1))


@pytest.mark.parametrize("model", ["plate", "shell"])
@pytest.mark.parametrize("other", [ks.SimplySupported("bottom"), ks.Clamped("bottom")])
def test_a_rotation_that_breaks_off_at_a_corner_is_refused(model, other):
    turned = ks.Fixed("left", "zr", rotation=0.1)
    with pytest.raises(ks.InputError, match=r"meet at \(0, 0\).*sin\(pi\*y\)"):
        solve(turned, other, model=model)


def test_one_that_vanishes_there_or_meets_a_plane_of_symmetry_is_not():
    turned = ks.Fixed("left", "zr", rotation="0.01*y*(1 - y)")
    assert solve(turned, ks.SimplySupported(["bottom", "top"])).strain_energy > 0.0
    assert solve(ks.Fixed("left", "zr", rotation=0.01), ks.Symmetry("bottom")).strain_energy < 1e-12


def test_scene_files_have_it(tmp_path):
    data = {
        "mesh": square_mesh(4),
        "thickness": 0.1,
        "material": {"E": 1e6, "nu": 0.3},
        "support": [{"on": "left", "fix": "zr", "rotation": "0.1*cos(y)"}],
    }
    scene = ks.Scene.from_dict(data)
    assert scene.supports[0].rotation == "0.1*cos(y)"
    scene.save(tmp_path / "turned.toml")
    assert ks.Scene.load(tmp_path / "turned.toml").supports[0].rotation == "0.1*cos(y)"


def test_a_plate_that_is_free_in_its_plane_keeps_its_linear_answer_with_a_word():
    with pytest.warns(ks.KshellWarning, match=r"large deflections would tell, but .* it can move along x"):
        result = solve(ks.Fixed("left", "zr", rotation="0.5*y*(1 - y)"), ks.Fixed(["bottom", "top"], "z"))
    assert result.model["kind"] == "plate"
