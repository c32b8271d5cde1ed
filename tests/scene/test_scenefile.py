import copy

import pytest

import kshell as ks
from kshell.scene.toml import apply_override

DATA = {
    "title": "Steel plate",
    "mesh": "plate.msh",
    "thickness": 0.01,
    "material": {"E": 210e9, "nu": 0.3},
    "support": [
        {"on": "left", "kind": "clamped"},
        {"on": [0, 0, 0], "fix": "zx", "value": [0, 0, 0.01]},
        {"on": ["a", "b"], "stiffness": 1e6},
    ],
    "load": [
        {"kind": "pressure", "value": "1 - x/2"},
        {"kind": "temperature", "gradient": 3, "expansion": 1e-5, "on": "plate"},
    ],
    "probe": [{"name": "centre", "at": [0.5, 0.5, 0.0]}],
    "solve": {"element": "morley"},
}

TEXT = """
title = "Steel plate"
mesh = "plate.msh"
thickness = 0.01
[material]
E = 210e9
nu = 0.3
[[support]]
on = "left"
kind = "clamped"
[[support]]
on = [0, 0, 0]
fix = "zx"
value = [0, 0, 0.01]
[[support]]
on = ["a", "b"]
stiffness = 1e6
[[load]]
kind = "pressure"
value = "1 - x/2"
[[load]]
kind = "temperature"
gradient = 3
expansion = 1e-5
on = "plate"
[[probe]]
name = "centre"
at = [0.5, 0.5, 0.0]
[solve]
element = "morley"
"""


def test_file_dict_and_python_say_the_same(tmp_path):
    (tmp_path / "scene.toml").write_text(TEXT, encoding="utf-8")
    expected = ks.Scene(
        title="Steel plate",
        mesh=tmp_path / "plate.msh",
        thickness=0.01,
        material=ks.Isotropic(E=210e9, nu=0.3),
        supports=[
            ks.Clamped("left"),
            ks.Fixed((0, 0, 0), "xz", value=[0, 0, 0.01]),
            ks.Elastic(["a", "b"], 1e6),
        ],
        loads=[ks.Pressure("1 - x/2"), ks.Temperature(gradient=3, expansion=1e-5, on="plate")],
        probes={"centre": (0.5, 0.5, 0.0)},
        solve={"element": "morley"},
    )
    assert ks.Scene.load(tmp_path / "scene.toml") == expected
    assert ks.Scene.from_dict(DATA, tmp_path) == expected


def test_all_kinds():
    vectors = ["traction", "gravity", "line_force", "point_force", "point_moment", "initial_curvature"]
    loads = [{"kind": kind, "value": [0, "x", 1], "on": "a"} for kind in vectors]
    loads += [
        {"kind": "edge_moment", "value": 3, "on": "a"},
        {"kind": "pressure", "value": 1, "follower": True},
    ]
    kinds = ["clamped", "simply_supported", "symmetry", "free"]
    supports = [{"kind": kind, "on": "a"} for kind in kinds] + [{"on": "b", "stiffness": "x", "fix": "zr"}]
    scene = ks.Scene.from_dict({**DATA, "load": loads, "support": supports})
    assert [load.kind for load in scene.loads] == [load["kind"] for load in loads]
    assert [support.kind for support in scene.supports] == [*kinds, "elastic"]
    assert scene.supports[-1].freedoms == "zr"


@pytest.mark.parametrize(
    ("material", "cls"),
    [
        ({"E": 1.0, "nu": 0.2, "density": 3.0}, ks.Isotropic),
        ({"lame_lambda": 1.0, "lame_mu": 1.0}, ks.Isotropic),
        ({"E1": 2.0, "E2": 1.0, "nu12": 0.2, "G12": 1.0, "angle": 30}, ks.Orthotropic),
        ({"C": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}, ks.Anisotropic),
    ],
)
def test_materials_and_layers(material, cls):
    scene = ks.Scene.from_dict({**DATA, "material": material})
    assert isinstance(scene.material, cls)
    without = {key: value for key, value in DATA.items() if key not in ("thickness", "material")}
    material = {key: value for key, value in material.items() if key != "angle"}
    layered = ks.Scene.from_dict({**without, "layer": [{**material, "thickness": 0.1, "angle": 45}] * 2})
    assert [layer.angle for layer in layered.layers] == [45.0, 45.0]
    assert isinstance(layered.layers[0].material, cls)


def test_thickness_by_group():
    assert ks.Scene.from_dict({**DATA, "thickness": {"a": 0.1, "b": "x"}}).thickness == {"a": 0.1, "b": "x"}


@pytest.mark.parametrize(
    ("override", "value_of"),
    [
        ("material.E=70e9", lambda s: s.material.E == 70e9),
        ("load.0.value=2000", lambda s: s.loads[0].value == 2000.0),
        ("load.0.value=x*y", lambda s: s.loads[0].value == "x*y"),
        ('load.0.value="2*x"', lambda s: s.loads[0].value == "2*x"),
        ("support.0.on=right", lambda s: s.supports[0].on == "right"),
        ("support.0.on=[1, 2, 3]", lambda s: s.supports[0].on == (1.0, 2.0, 3.0)),
        ("solve.solver = multigrid", lambda s: s.solve.solver == "multigrid"),
        ("title=a=b", lambda s: s.title == "a=b"),
        ("load.0.on=plate", lambda s: s.loads[0].on == "plate"),
    ],
)
def test_overrides(override, value_of):
    data = copy.deepcopy(DATA)
    apply_override(data, override)
    assert value_of(ks.Scene.from_dict(data))


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("thicknes=1", ['did you mean "thickness"']),
        ("chart.R=2", ["[chart]", "kind"]),
        ("chart={kind = 'cylinder', R = -1}", ["[chart]", "R = -1"]),
        ("solve.number=6", ["[solve]", '"number"', "analysis, model"]),
        ("solve.steps=0", ["steps = 0", "whole number"]),
        ("solve.order=13", ["order = 13"]),
        ("solve.model=solid", ["'solid'", "'shell'"]),
        ("solve.element=kirchhoff", ["'kirchhoff'", "'koiter'"]),
        ("solve.analysis=creep", ["'creep'", "'path'"]),
        ("solve.large_deflection=2", ["large_deflection", "true or false"]),
        ("solve=3", ["[solve]", "table"]),
        ("material.nu=0.5", ["[material]: nu = 0.5"]),
        ("material.G=3", ["[material]", '"G"']),
        ("material={a = 1}", ["E and nu", "keys a"]),
        ("material=steel", ["[material]", "'steel'"]),
        ("layer=[{E = 1, nu = 0.1}]", ["[[layer]] 1", "thickness is missing"]),
        ("layer.E=3", ["double brackets"]),
        ("thickness=-1", ["thickness = -1"]),
        ("support.0.kind=clampd", ["[[support]] 1", 'did you mean "clamped"']),
        ("support.0.kind=3", ["kind = 3"]),
        ("support.0.fix=xz", ["leave one of them out"]),
        ("support.1.freedoms=xz", ["leave one of them out"]),
        ("support.1.fix=abc", ["[[support]] 2", '"abc"']),
        ("support.2.stiffness=-1", ["[[support]] 3", "stiffness = -1"]),
        ("support.2={on = 'a'}", ["[[support]] 3", "kind", "fix", "stiffness"]),
        ("support.0.valu=1", ['did you mean "value"']),
        ("support=left", ["[[support]]", "double brackets"]),
        ("support.0=left", ["'left'", "table"]),
        ("load.0.kind=presure", ["[[load]] 1", 'did you mean "pressure"']),
        ("load.0.kindd=1", ['"kindd"']),
        ("load.1={value = 1}", ["[[load]] 2", "kind is missing"]),
        ("load.0.value=x^2", ["[[load]] 1", "**"]),
        ("probe.0.at=[1]", ["[[probe]] 1: at = [1]", "three numbers"]),
        ("probe.0={at = [0, 0, 0]}", ["[[probe]] 1", "name is missing"]),
        ("probe.0.name=3", ["name = 3"]),
        ("probe.0.nam=x", ['did you mean "name"']),
        ("probe=[{name='a', at=[0,0,0]}, {name='a', at=[1,0,0]}]", ["[[probe]] 2", "taken"]),
        ("mesh=3", ["mesh = 3"]),
        ("mesh=", ["mesh = ''"]),
        ("mesh_size=fine", ["mesh_size = 'fine'"]),
        ("title=3", ["title = 3"]),
    ],
)
def test_wrong_values_are_named_with_their_place(override, words):
    data = copy.deepcopy(DATA)
    apply_override(data, override)
    with pytest.raises(ks.InputError) as caught:
        ks.Scene.from_dict(data, source="plate.toml")
    for word in ["plate.toml", *words]:
        assert word in str(caught.value)


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("load", ["KEY=VALUE"]),
        ("=3", ["KEY=VALUE"]),
        ("a..b=3", ["KEY=VALUE"]),
        ("load.7.value=3", ['"load" is a list of 2', '"7"']),
        ("load.first.value=3", ['"first"', "number from 0 to 1"]),
        ("load.7=3", ['"7"']),
        ("thickness.a=3", ['"thickness" is 0.01']),
        ("title.a.b=3", ['"title"']),
    ],
)
def test_wrong_overrides(override, words):
    with pytest.raises(ks.InputError) as caught:
        apply_override(copy.deepcopy(DATA), override)
    for word in words:
        assert word in str(caught.value)


def test_mesh_is_required():
    with pytest.raises(ks.InputError, match="mesh is missing"):
        ks.Scene.from_dict({key: value for key, value in DATA.items() if key != "mesh"})


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"title = \nmesh = 1", "not valid TOML.*line 1"),
        (b"a = 1\na = 2", "not valid TOML"),
        (b"\xff\xfe\x00", "not text"),
    ],
)
def test_unreadable_files(tmp_path, content, words):
    path = tmp_path / "scene.toml"
    path.write_bytes(content)
    with pytest.raises(ks.InputError, match=words):
        ks.Scene.load(path)


def test_missing_files(tmp_path):
    (tmp_path / "plate.toml").write_text(TEXT, encoding="utf-8")
    with pytest.raises(ks.InputError, match=r'no such file. did you mean "plate.toml"'):
        ks.Scene.load(tmp_path / "plaet.toml")
    with pytest.raises(ks.InputError, match="no such file"):
        ks.Scene.load(tmp_path / "nowhere" / "scene.toml")
    with pytest.raises(ks.InputError, match="folder"):
        ks.Scene.load(tmp_path)
