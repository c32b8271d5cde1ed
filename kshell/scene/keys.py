"""All keys of a scene file, with what their models say: for `kshell explain`, the reference, the JSON schema."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import MISSING, dataclass, fields, replace
from functools import cache
from typing import Any

from pydantic import TypeAdapter

from kshell.geometry.charts import READY
from kshell.material.given import Section
from kshell.material.laminate import Layer
from kshell.material.materials import Anisotropic, Isotropic, Orthotropic
from kshell.scene.arguments import SIMPLE_KEYS
from kshell.scene.blocks import Cut, Probe
from kshell.scene.cases import Case, Combination
from kshell.scene.contact import SHAPES, Contact, Obstacle
from kshell.scene.imperfection import Imperfection
from kshell.scene.line import Line
from kshell.scene.loads import LOADS
from kshell.scene.masses import Mass
from kshell.scene.motion import Damping, Initial
from kshell.scene.options import SolveOptions
from kshell.scene.reading import GROUP_KEYS, NAMED_SUPPORTS
from kshell.scene.scene import Scene
from kshell.scene.supports import Elastic, Fixed
from kshell.values import kinds
from kshell.values.docstrings import Described, described_by_docstring

ABSENT = object()

# file key: attribute of the model
RENAMED = {
    Line: {"start": "from", "end": "to"},
    Fixed: {"freedoms": "fix"},
}
MATERIALS = {"isotropic": Isotropic, "orthotropic": Orthotropic, "anisotropic": Anisotropic}
SHAPE_KEYS = {
    "point": (kinds.POINT, "A point of the plane, or of the axis.", "length"),
    "normal": (kinds.DIRECTION, "Of the plane, towards the shell.", "1"),
    "centre": (kinds.POINT, "Of the sphere.", "length"),
    "axis": (kinds.DIRECTION, "Of the cylinder.", "1"),
    "radius": (kinds.POSITIVE, "Of the sphere or cylinder.", "length"),
    "file": (kinds.PATH, "Of a mesh, relative to the scene file.", ""),
}


@dataclass(frozen=True)
class Key:
    """A key of a block.

    Attributes
    ----------
    name : str
    words : str
        What it means.
    unit : str
        Of its numbers, "1" where they have none, "" where it has no numbers.
    schema : dict
        Its value as JSON schema.
    default : object
        ABSENT where there is none.
    required : bool
    example : str
        TOML.
    """

    name: str
    words: str
    unit: str
    schema: kinds.Schema
    default: Any
    required: bool
    example: str

    @property
    def kind(self) -> str:
        """Its type in words."""
        return kinds.words(self.schema)

    @property
    def default_words(self) -> str:
        """Its default as in the file, "required" or nothing."""
        if self.required:
            return "required"
        if self.default is ABSENT or self.default in (None, ""):
            return ""
        if isinstance(self.default, bool):
            return "true" if self.default else "false"
        return f'"{self.default}"' if isinstance(self.default, str) else f"{self.default:g}"


@dataclass(frozen=True)
class Block:
    """A block of a scene file, of one kind.

    Attributes
    ----------
    name : str
        Dotted: "load.line_force"; "" for the keys that stand before all blocks.
    head : str
        As in the file: "[[load]]".
    words : str
    keys : tuple of Key
    example : str
        TOML.
    """

    name: str
    head: str
    words: str
    keys: tuple[Key, ...]
    example: str

    def key(self, name: str) -> Key | None:
        """The key of a name."""
        return next((key for key in self.keys if key.name == name), None)


@cache
def blocks() -> dict[str, Block]:
    """All blocks by name, in the order in which a scene file is written."""
    found = list(_blocks())
    family: dict[tuple[str, str], str] = {}  # an example of each key of loads, supports, ...
    for block in found:
        for key in block.keys:
            if key.example:
                family.setdefault((block.head, key.name), key.example)
    return {
        block.name: replace(
            block,
            keys=tuple(
                replace(key, example=key.example or family.get((block.head, key.name), ""))
                for key in block.keys
            ),
        )
        for block in found
    }


def _blocks() -> Iterator[Block]:
    scene = _block(Scene, "", "", of=("title", "mesh", "geometry", *SIMPLE_KEYS[1:]))
    yield replace(scene, words="What stands before all blocks.")
    for kind, cls in MATERIALS.items():
        yield _block(cls, f"material.{kind}", "[material]")
    layer = _block(Layer, "layer", "[[layer]]", of=("thickness", "angle"))
    yield replace(layer, words=f"{layer.words} Beside these keys those of its material; bottom to top.")
    yield _block(Section, "section", "[section]")
    yield _group_block()
    yield from _charts()
    yield _block(Imperfection, "imperfection", "[imperfection]")
    for kind, cls in NAMED_SUPPORTS.items():
        if cls is not Elastic:
            yield _kind(_block(cls, f"support.{kind}", "[[support]]"), kind)
    yield _block(Fixed, "support.fix", "[[support]]", required=("fix",))
    yield _kind(_block(Elastic, "support.elastic", "[[support]]"), Elastic.kind, required=False)
    for kind, cls in LOADS.items():
        yield _kind(_block(cls, f"load.{kind}", "[[load]]"), kind)
    for cls, name in (
        (Probe, "probe"),
        (Case, "case"),
        (Combination, "combination"),
        (Line, "line"),
        (Cut, "cut"),
        (Mass, "mass"),
    ):
        yield _block(cls, name, f"[[{name}]]")
    yield _block(Initial, "initial", "[initial]")
    yield _block(Damping, "damping", "[damping]")
    yield _contact()
    yield from _obstacles()
    yield _block(SolveOptions, "solve", "[solve]")


def _block(
    cls: type[Any], name: str, head: str, of: Sequence[str] | None = None, required: Sequence[str] = ()
) -> Block:
    """The block of a model; `of` are its keys, all if absent."""
    said, renamed = described_by_docstring(cls), RENAMED.get(cls, {})
    schemas = TypeAdapter(cls).json_schema()["properties"]
    defaults = {f.name: f.default for f in fields(cls) if f.init}
    keys = []
    for attribute in of or [*defaults]:
        key = renamed.get(attribute, attribute)
        default = defaults[attribute]
        words, unit = said.keys.get(attribute, ("", ""))
        needed = key in required or (
            default is MISSING
            and next(f for f in fields(cls) if f.name == attribute).default_factory is MISSING
        )
        keys.append(
            Key(
                key,
                words,
                unit,
                _plain(schemas[attribute]),
                ABSENT if default is MISSING or needed else default,
                needed,
                _line_of(said.example, key),
            )
        )
    return Block(name, head, " ".join(said.words.split()), tuple(keys), said.example)


def _plain(schema: Mapping[str, Any]) -> kinds.Schema:
    """Without what TOML does not know (null) and names that only repeat the key."""
    out = {key: value for key, value in schema.items() if key not in ("title", "default")}
    if "anyOf" in out:
        parts: list[kinds.Schema] = []
        for part in out["anyOf"]:
            parts += part.get("anyOf", [part])
        out["anyOf"] = [part for part in parts if part.get("type") != "null"]
        if len(out["anyOf"]) == 1:
            return {**out.pop("anyOf")[0], **out}
    return out


def _line_of(example: str, key: str) -> str:
    """The line of a key in TOML, all of them where a list has several; the whole where it stands within one."""
    found = re.search(rf"^{re.escape(key)} *= *", example, re.MULTILINE)
    if found is None:
        return example if re.search(rf"\b{re.escape(key)} *=", example) else ""
    rest = example[found.start() :]
    depth = 0
    for end, letter in enumerate(rest):
        depth += {"[": 1, "{": 1, "]": -1, "}": -1}.get(letter, 0)
        if letter == "\n" and depth == 0:
            return rest[:end]
    return rest


def _kind(block: Block, kind: str, required: bool = True) -> Block:
    """The block with the key kind in front."""
    key = Key(
        "kind", f"{block.words.partition('. ')[0].rstrip('.')}.", "", {"const": kind}, ABSENT, required, ""
    )
    return replace(block, keys=(replace(key, example=f'kind = "{kind}"'), *block.keys))


def _group_block() -> Block:
    known = {key.name: key for key in _block(Scene, "", "", of=("thickness", "offset", "direction")).keys}
    example = (
        "[group.web]\nthickness = 0.006\noffset = 0.003\ndirection = [1, 0, 0]\n"
        "material = {E = 70e9, nu = 0.33}\n\n[[group.flange.layer]]\nE = 70e9\nnu = 0.33\nthickness = 0.002\n\n"
        "[group.core]\nsection = {A = [[3e7, 9e6, 0], [9e6, 3e7, 0], [0, 0, 1e7]], "
        "D = [[900, 270, 0], [270, 900, 0], [0, 0, 315]]}"
    )
    like = {"material": "[material]", "layer": "[[layer]]", "section": "[section]"}
    keys = []
    for name in GROUP_KEYS:
        line = "[[group.flange.layer]]" if name == "layer" else _line_of(example, name)
        if name in known:
            schema = known[name].schema
            inner = [part for part in schema.get("anyOf", [schema]) if part.get("type") != "object"]
            keys.append(replace(known[name], schema=kinds.either(*inner), default=ABSENT, example=line))
        else:
            schema = {"type": "array", "items": {"type": "object"}} if name == "layer" else {"type": "object"}
            keys.append(Key(name, f"As {like[name]}, of the group.", "", schema, ABSENT, False, line))
    words = "What one surface group NAME has, before what is given for all."
    return Block("group", "[group.NAME]", words, tuple(keys), example)


def _charts() -> Iterator[Block]:
    for kind, make in READY.items():
        constants = inspect.signature(make).parameters
        keys = [Key("kind", "Which chart.", "", {"const": kind}, ABSENT, True, f'kind = "{kind}"')]
        for name, parameter in constants.items():
            default: Any = ABSENT if parameter.default is inspect.Parameter.empty else parameter.default
            line = f"{name} = {float(2.5 if default is ABSENT else default)}"
            keys.append(
                Key(name, "Constant of the chart.", "length", kinds.NUMBER, default, default is ABSENT, line)
            )
        example = "\n".join(["[chart]", *(key.example for key in keys)])
        words = " ".join((inspect.getdoc(make) or "").split())
        yield Block(f"chart.{kind}", "[chart]", words, tuple(keys), example)


def _contact() -> Block:
    block = _block(Contact, "contact", "[contact]")
    body = Key("with", "What the shell may touch: obstacles.", "", kinds.listed({}, 0), ABSENT, False, "")
    return replace(block, keys=(replace(body, example=_line_of(block.example, "with")), *block.keys))


def _obstacles() -> Iterator[Block]:
    said: Described = described_by_docstring(Obstacle)
    known = _block(Obstacle, "", "")
    common = [replace(key, example=said.example) for key in known.keys if key.name in ("name", "motion")]
    for kind, names in {**SHAPES, "file": ("file",)}.items():
        keys = (
            []
            if kind == "file"
            else [Key("kind", "Which shape.", "", {"const": kind}, ABSENT, True, f'kind = "{kind}"')]
        )
        for name in names:
            schema, words, unit = SHAPE_KEYS[name]
            keys.append(Key(name, words, unit, schema, ABSENT, True, said.example))
        what = "A mesh file as an obstacle." if kind == "file" else f"A {kind} as an obstacle."
        yield Block(f"contact.with.{kind}", "[contact] with", what, (*keys, *common), said.example)
