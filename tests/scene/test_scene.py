import numpy as np
import pytest

import kshell as ks
from tests.scene.fabricated import scene_on, square_mesh

STEEL = ks.Isotropic(E=210e9, nu=0.3)


def test_the_example_of_the_interface():
    scene = ks.Scene(
        mesh="meshes/plate.msh",
        thickness=0.01,
        material=ks.Isotropic(E=210e9, nu=0.3, density=7850),
        supports=[ks.Clamped("left"), ks.SimplySupported("right")],
        loads=[ks.Pressure(1e3)],
        probes={"centre": (0.5, 0.5, 0.0)},
    )
    assert [s.on for s in scene.supports] == ["left", "right"]
    assert scene.loads[0].value == 1000.0
    assert scene.solve.element == "auto"
    assert "Clamped(on='left'" in repr(scene.supports)


def test_scenes_are_equal_when_they_say_the_same():
    mesh = square_mesh(2)
    assert scene_on(mesh) == scene_on(mesh)
    assert scene_on(mesh) != scene_on(mesh, thickness=0.02)


def test_positions_and_names_of_arguments():
    assert ks.Fixed("a", "rz", value=0.1) == ks.Fixed(on="a", freedoms="zr", value=0.1)
    assert ks.LineForce("right", (0, 0, -1e3)).value == (0.0, 0.0, -1000.0)
    assert ks.Elastic("floor", 1e6).freedoms == "z"
    assert ks.Pressure(1, "plate").on == "plate"
    assert ks.Clamped(["a", "b"]).on == ("a", "b")
    assert ks.Clamped((1, 2)).on == (1.0, 2.0, 0.0)
    assert ks.PointForce(np.array([0, 0, 1]), [0, 0, "2"]).on == (0.0, 0.0, 1.0)
    assert ks.Temperature(gradient=3, expansion=1e-5).mean == 0.0


def test_what_holds_is_told_by_freedoms():
    held = {cls("a").freedoms for cls in (ks.Clamped, ks.SimplySupported, ks.Symmetry, ks.Free)}
    assert held == {"xyzr", "xyz", "r", ""}


def test_prescribed_translations():
    points = np.array([[1.0, 2.0, 0.0], [3.0, 4.0, 0.0]])
    np.testing.assert_array_equal(ks.Clamped("a").translation_at(points), 0.0)
    for value in (0.5, [0, 0, 0.5], lambda x, y, z: 0.5 + 0 * x, lambda x, y, z: (0, 0 * x, 0.5)):
        np.testing.assert_array_equal(
            ks.Fixed("a", "xyz", value=value).translation_at(points), [[0, 0, 0.5]] * 2
        )
    np.testing.assert_array_equal(ks.Fixed("a", "z", value="x").translation_at(points)[:, 2], [1.0, 3.0])


def test_stress_free_curvatures():
    points = np.array([[1.0, 2.0, 0.0]])
    np.testing.assert_allclose(ks.InitialCurvature((1, "y", 0)).curvature_at(points), [[1, 2, 0]])


def test_a_scene_reads_its_mesh():
    mesh = square_mesh(2)
    assert scene_on(mesh).read_mesh() is mesh


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: ks.Clamped(), ["support clamped", "on is missing"]),
        (lambda: ks.Clamped(""), ["on = ''", "group name"]),
        (lambda: ks.Clamped(3), ["on = 3"]),
        (lambda: ks.Clamped([]), ["on = []"]),
        (lambda: ks.Clamped(["a", 3]), ["list of group names"]),
        (lambda: ks.Clamped((1, 2, float("inf"))), ["three numbers"]),
        (lambda: ks.Clamped("a", where="b"), ['"where"', "the keys are on, value"]),
        (lambda: ks.Clamped("a", [0, 1]), ["value = [0, 1]", "three"]),
        (lambda: ks.Fixed("a", "q"), ['"q"', '"xyzr"']),
        (lambda: ks.Fixed("a", ""), ['""']),
        (lambda: ks.Fixed("a", "zz"), ['"zz"', "different"]),
        (lambda: ks.Fixed("a", "xr", value=0.1), ["along z", '"xr"']),
        (lambda: ks.Fixed("a", "z", value=[1, 0, 0]), ["along x"]),
        (lambda: ks.Elastic("a"), ["stiffness is missing"]),
        (lambda: ks.Elastic("a", 0.0), ["stiffness = 0"]),
        (lambda: ks.Elastic("a", "k*x"), ["stiffness", '"k"']),
        (lambda: ks.Elastic("a", "x - 2").stiffness_at(np.zeros((1, 3))), ["-2 at (0, 0, 0)"]),
        (lambda: ks.Pressure(), ["load pressure", "value is missing"]),
        (lambda: ks.Pressure("x^2"), ["load pressure: value", "**"]),
        (lambda: ks.Pressure(float("inf")), ["value = inf", "finite"]),
        (lambda: ks.Pressure([1, 2, 3]), ["value = [1, 2, 3]", "number"]),
        (lambda: ks.Pressure(1, follower=1), ["follower = 1", "true or false"]),
        (lambda: ks.Pressure(1, "a", *9 * [False]), ["too many values"]),
        (lambda: ks.Traction(3), ["value = 3", "three"]),
        (lambda: ks.Gravity([0, 0]), ["three"]),
        (lambda: ks.LineForce("a", (0, 0, "x^2")), ["**"]),
        (lambda: ks.LineForce("a"), ["value is missing"]),
        (lambda: ks.Temperature(gradient=1, expansion=[1e-5]), ["expansion", "[a1, a2]"]),
        (lambda: ks.Scene(), ["mesh is missing"]),
        (lambda: ks.Scene(mesh="a.msh", material=STEEL), ["thickness is missing"]),
        (lambda: ks.Scene(mesh="a.msh", thickness=1), ["material is missing", "Isotropic"]),
        (lambda: ks.Scene(mesh="a.msh", thickness=1, material="steel"), ["material = 'steel'"]),
        (lambda: ks.Scene(mesh="a.msh", thickness=0, material=STEEL), ["thickness = 0"]),
        (lambda: ks.Scene(mesh="a.msh", thickness=float("nan"), material=STEEL), ["thickness = nan"]),
        (lambda: ks.Scene(mesh="a.msh", thickness={"a": -1}, material=STEEL), ['for "a"']),
        (lambda: ks.Scene(mesh="a.msh", thickness={}, material=STEEL), ["at least one"]),
        (lambda: ks.Scene(mesh="a.msh", thickness="1+q", material=STEEL), ['"q"']),
        (lambda: ks.Scene(mesh="a.msh", thickness=1, layers=[ks.Layer(STEEL, 1)]), ["layers and thickness"]),
        (lambda: ks.Scene(mesh="a.msh", layers=[]), ["empty"]),
        (lambda: ks.Scene(mesh="a.msh", layers=[3]), ["layers[0] = 3"]),
        (lambda: ks.Scene(mesh=None, thickness=1, material=STEEL), ["mesh = None"]),
        (lambda: scene_on("a.msh", supports="left"), ["supports = 'left'"]),
        (lambda: scene_on("a.msh", supports=["left"]), ["supports[0] = 'left'", "ks.Clamped"]),
        (lambda: scene_on("a.msh", loads=[ks.Clamped("a")]), ["loads[0]", "ks.Pressure"]),
        (lambda: scene_on("a.msh", probes=[(1, 2, 3)]), ["probes"]),
        (lambda: scene_on("a.msh", probes={"p": (1, "a", 3)}), ['"p"', "three numbers"]),
        (lambda: scene_on("a.msh", mesh_order=3), ["mesh_order = 3", "1 or 2"]),
        (lambda: scene_on("a.msh", mesh_size=0), ["mesh_size = 0"]),
        (lambda: scene_on("a.msh", chart="cylinder"), ["chart = 'cylinder'", "ks.geometry.Cylinder"]),
        (lambda: scene_on("a.msh", chart={"R": 3}), ["chart = ", "kind"]),
        (lambda: scene_on("a.msh", chart={"kind": "cylindre", "R": 3}), ["cylindre", "helicoid"]),
        (lambda: scene_on("a.msh", chart={"kind": "cylinder", "r": 3}), ['no constant "r"', "R"]),
        (lambda: scene_on("a.msh", direction=[0, 0, 0]), ["direction", "zero"]),
        (lambda: scene_on("a.msh", offset="1"), ["offset = '1'", "number"]),
        (lambda: scene_on("a.msh", suports=[]), ['did you mean "supports"']),
        (lambda: scene_on("a.msh", solve={"elemnt": "morley"}), ['did you mean "element"']),
        (lambda: scene_on("a.msh", solve=3), ["solve = 3"]),
        (lambda: ks.solve("plate.toml"), ["not a scene"]),
        (lambda: ks.solve(scene_on("a.msh"), number=6), ['"number"', "analysis, model, element"]),
        (lambda: ks.solve(scene_on("a.msh"), element="kirchhoff"), ["'kirchhoff'", "'koiter'"]),
        (lambda: ks.solve(scene_on("a.msh"), model="solid"), ["'solid'", "'shell'"]),
        (lambda: ks.solve(scene_on("a.msh"), order=13), ["order = 13", "12"]),
        (lambda: ks.solve(scene_on("a.msh"), analysis="mods"), ["'mods'", "'static'"]),
        (lambda: ks.solve(scene_on("a.msh"), large_deflection=2), ["true or false"]),
        (lambda: ks.solve(scene_on("a.msh"), number=3), ['"number"']),
    ],
)
def test_impossible_descriptions_are_refused_in_words(make, words):
    with pytest.raises(ks.InputError) as caught:
        make()
    for word in words:
        assert word in str(caught.value)


def test_public_names():
    for name in ks.__all__:
        assert getattr(ks, name) is not None
    assert set(ks.__all__) <= set(dir(ks))
    with pytest.raises(AttributeError, match="no attribute 'mode'"):
        _ = ks.mode
