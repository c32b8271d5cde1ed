"""The JSON schema of scene files, with which editors complete and check them."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import Any

from kshell.scene.keys import ABSENT, MATERIALS, Block, Key, blocks
from kshell.values import kinds
from kshell.values.kinds import Schema

# blocks of which a scene has one; of all others it has any number
SINGLE = ("material", "section", "group", "chart", "imperfection", "initial", "damping", "contact", "solve")


def scene_schema() -> Schema:
    """The schema, draft 7."""
    known = blocks()
    families: dict[str, list[Block]] = {}
    for name, block in known.items():
        if name and not name.startswith("contact.with"):
            families.setdefault(name.partition(".")[0], []).append(block)
    properties = {key.name: _property(key) for key in known[""].keys}
    for family, members in families.items():
        one = _any([_table(block.keys, block.words) for block in members])
        if family == "layer":
            one = _layer()
        elif family == "group":
            one = {"type": "object", "additionalProperties": _group(one)}
        elif family == "contact":
            bodies = [block for name, block in known.items() if name.startswith("contact.with.")]
            one["properties"]["with"]["items"] = _any(
                [kinds.PATH, *(_table(block.keys, block.words) for block in bodies)]
            )
        properties[family] = one if family in SINGLE else {"type": "array", "items": one}
    return {
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "Scene file of kshell",
        "type": "object",
        "properties": properties,
        "required": [key.name for key in known[""].keys if key.required],
        "additionalProperties": False,
    }


def schema_text() -> str:
    """The schema as the text of a file."""
    return json.dumps(scene_schema(), indent=1, ensure_ascii=False) + "\n"


def _any(schemas: list[Schema]) -> Schema:
    return schemas[0] if len(schemas) == 1 else {"anyOf": schemas}


def _table(keys: Iterable[Key], words: str) -> Schema:
    keys = list(keys)
    out: Schema = {"type": "object", "description": words, "properties": {k.name: _property(k) for k in keys}}
    required = [key.name for key in keys if key.required]
    return {**out, **({"required": required} if required else {}), "additionalProperties": False}


def _property(key: Key) -> Schema:
    out: dict[str, Any] = {"description": f"{key.words} [{key.unit}]" if key.unit else key.words}
    if key.default is not ABSENT and key.default not in (None, ""):
        out["default"] = key.default
    return {**key.schema, **out}


def _layer() -> Schema:
    """A layer: its own keys beside those of each kind of material."""
    known = blocks()
    own = known["layer"]
    return _any(
        [
            _table(
                {key.name: key for key in (*known[f"material.{kind}"].keys, *own.keys)}.values(), own.words
            )
            for kind in MATERIALS
        ]
    )


def _group(block: Schema) -> Schema:
    known = blocks()
    materials = [
        _table(known[f"material.{kind}"].keys, known[f"material.{kind}"].words) for kind in MATERIALS
    ]
    section = known["section"]
    for key, schema in (
        ("material", _any(materials)),
        ("layer", {"type": "array", "items": _layer()}),
        ("section", _table(section.keys, section.words)),
    ):
        block["properties"][key] = {**schema, "description": block["properties"][key]["description"]}
    return block
