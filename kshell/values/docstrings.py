"""What the docstrings of described classes say, for people who write scene files.

The section Attributes has lines `name : type [unit]` with words indented below; Examples has a block of TOML. What
the classes say from which a class derives is said of it too.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator
from dataclasses import dataclass, field

UNDERLINE = re.compile(r"-{3,}")
HEAD = re.compile(r"(?P<names>[\w, ]+?)\s*(?::\s*(?P<type>.*?))?\s*(?:\[(?P<unit>[^\]]*)\])?\s*")


@dataclass
class Described:
    """The docstring of a class.

    Attributes
    ----------
    words : str
        What stands before the first section.
    keys : dict of str to (words, unit)
        Of every attribute.
    example : str
        TOML.
    """

    words: str = ""
    keys: dict[str, tuple[str, str]] = field(default_factory=dict)
    example: str = ""


def described_by_docstring(cls: type) -> Described:
    """What a class and those it derives from say."""
    out = Described()
    for part in reversed(cls.__mro__):
        text = part.__dict__.get("__doc__") or ""
        sections = _sections(inspect.cleandoc(text).splitlines())
        out.keys |= dict(_keys(sections.get("Attributes", [])))
        out.words = "\n".join(sections[""]).strip()
        out.example = _fenced(sections.get("Examples", []))
    return out


def _sections(lines: list[str]) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {"": []}
    name = ""
    for line, below in zip(lines, [*lines[1:], ""], strict=True):
        if line and UNDERLINE.fullmatch(below.strip()):
            name = line.strip()
            found[name] = []
        elif not UNDERLINE.fullmatch(line.strip()):
            found[name].append(line)
    return found


def _keys(lines: list[str]) -> Iterator[tuple[str, tuple[str, str]]]:
    names: list[str] = []
    unit, words = "", []
    for line in [*lines, "end"]:
        if line.startswith(" ") or not line:
            words.append(line.strip())
            continue
        yield from ((name, (" ".join(words).strip(), unit)) for name in names)
        found = HEAD.fullmatch(line)
        assert found is not None, line
        names, unit, words = [part.strip() for part in found["names"].split(",")], found["unit"] or "", []


def _fenced(lines: list[str]) -> str:
    fences = [number for number, line in enumerate(lines) if line.startswith("```")]
    return "\n".join(lines[fences[0] + 1 : fences[1]]) if len(fences) >= 2 else ""
