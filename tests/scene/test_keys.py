"""What is said of the keys of a scene file: everything, and the truth."""

import random
import re
import tomllib
from pathlib import Path

import jsonschema
import pytest

import kshell as ks
from kshell.scene.arguments import KEYS
from kshell.scene.keys import blocks
from kshell.scene.lookup import find, names
from kshell.scene.schema import scene_schema, schema_text
from tests.cli.test_grammar import scene

ROOT = Path(__file__).parents[2]
MESHES = ROOT / "meshes"
VALID = jsonschema.Draft7Validator(scene_schema())


def test_every_key_says_what_it_means_its_unit_and_an_example():
    missing = []
    for block in blocks().values():
        assert block.words, block.name
        for key in block.keys:
            where = f"{block.name}.{key.name}"
            numeric = bool(re.search(r"\b(numbers?)\b", key.kind)) and key.name not in ("on", "loads", "with")
            missing += [f"{where}: words"] * (not key.words)
            missing += [f"{where}: unit, [1] where it has none"] * (numeric and not key.unit)
            missing += [f"{where}: kind of value, by WithJsonSchema"] * ("value" in key.kind.split())
            missing += [f"{where}: example"] * (
                not re.search(rf"\b{key.name} *=|\.{key.name}\]", key.example)
            )
    assert missing == []


SECTION = "thickness = 0.01\nmaterial = {E = 1, nu = 0.3}\n"
LOADS = (
    '[[load]]\nkind = "gravity"\nvalue = [0, 0, 1]\n[[load]]\nname = "snow"\nkind = "pressure"\nvalue = 1\n'
)
# what an example of a block needs before it
BEFORE = {
    "material": "thickness = 0.01\n",
    "layer": "",
    "section": "",
    "group": "thickness = 0.01\n",
    "case": SECTION + LOADS,
    "combination": SECTION + LOADS + '[[case]]\nname = "winter"\nloads = "snow"\n',
}


@pytest.mark.parametrize("name", [name for name in blocks() if name])
def test_examples_are_scenes(name, tmp_path):
    """Every example is TOML that a scene takes, and the schema too; one that shows alternatives, each of them."""
    before = 'mesh = "square.msh"\n' + BEFORE.get(name.partition(".")[0], SECTION)
    for part in re.split(
        r"\n\n(?=\[solve\]|\[damping\]|\[imperfection\]|\[group\.web\.)", blocks()[name].example
    ):
        data = tomllib.loads(before + part)
        ks.Scene.from_dict(data, tmp_path)
        VALID.validate(data)


def test_first_keys_are_a_scene(tmp_path):
    data = tomllib.loads(blocks()[""].example + "\nmaterial = {E = 1, nu = 0.3}")
    ks.Scene.from_dict(data, tmp_path)
    VALID.validate(data)


@pytest.mark.parametrize("path", sorted(MESHES.glob("*.toml")), ids=lambda path: path.stem)
def test_shipped_scenes_are_valid(path):
    VALID.validate(tomllib.loads(path.read_text(encoding="utf-8")))


def test_what_scenes_take_the_schema_takes():
    taken = 0
    for seed in random.Random(5).sample(range(10**6), 60):
        data = scene(seed)
        try:
            ks.Scene.from_dict(data)
        except ks.InputError:
            continue
        VALID.validate(data)
        taken += 1
    assert taken > 10


@pytest.mark.parametrize(
    "wrong",
    [
        "thicknes = 0.01",
        "thickness = true",
        'material = {E = "steel", nu = 0.3}',
        'load = [{kind = "presure", value = 1}]',
        'load = [{kind = "pressure"}]',
        'load = [{kind = "traction", value = 3}]',
        'support = [{kind = "clamped"}]',
        'probe = {name = "a", at = [0, 0, 0]}',
        'solve = {analysis = "statics"}',
        "solve = {steps = 0}",
        'contact = {with = [{kind = "sphere", radius = 1}]}',
    ],
)
def test_what_scenes_refuse_the_schema_refuses(wrong):
    data = tomllib.loads(f'mesh = "a.msh"\n{wrong}')
    assert not VALID.is_valid(data)
    with pytest.raises(ks.InputError):
        ks.Scene.from_dict({"thickness": 0.01, "material": {"E": 1, "nu": 0.3}, **data})


def test_the_shipped_schema_is_current():
    shipped = (ROOT / "docs" / "scene.schema.json").read_text(encoding="utf-8")
    assert shipped == schema_text(), "write it anew: kshell explain --schema > docs/scene.schema.json"


def test_all_keys_of_the_parser_are_there():
    assert set(scene_schema()["properties"]) == set(KEYS)


def test_all_names_are_found():
    for name in names():
        assert find(name), name


@pytest.mark.parametrize(
    ("asked", "block", "key"),
    [
        ("load.line_force", "load.line_force", None),
        ("load.2.line_force.value", "load.line_force", "value"),
        ("[[probe]]", "probe", None),
        ("group.web.thickness", "group", "thickness"),
        ("group.web.material.E", "material.isotropic", "E"),
        ("thickness", "", "thickness"),
        ("support.fix", "support.fix", None),
    ],
)
def test_names_lead_to_blocks_and_keys(asked, block, key):
    found = find(asked)
    assert (block, key) in [(b.name, k and k.name) for b, k in found]


@pytest.mark.parametrize(
    ("asked", "near"),
    [
        ("load.lineforce", "load.line_force"),
        ("E", "material.E"),
        ("solv.tolerance", "solve.tolerance"),
        ("?", "mesh"),
    ],
)
def test_unknown_names_are_answered_with_near_ones(asked, near):
    with pytest.raises(ks.InputError, match=re.escape(near)):
        find(asked)
