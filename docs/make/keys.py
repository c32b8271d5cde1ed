"""The page of all keys of a scene file, from their models."""

from __future__ import annotations

from collections.abc import Iterator

from docs.make.markdown import in_table
from kshell.scene.keys import Block, Key, blocks

INTRODUCTION = """# Scene files

A scene file is TOML: what is modelled, how it is held and loaded, and what is asked for. Relative paths in it are
relative to the file. Lengths, forces, masses, times and temperatures are in units of your choice that belong together,
such as m, N, kg, s; the columns below say how they combine. A value that is an `expression` is text in x, y, z (and in
a motion t): `"1000*(1 + x/2)"`, with `sin`, `cos`, `exp`, `sqrt`, `pi`, comparisons and `a if x > 1 else b`.

`kshell explain load.pressure` prints the same in the terminal. Editors complete and check scene files whose first
line is `#:schema scene.schema.json` ([the schema](../scene.schema.json), also from `kshell explain --schema`;
`kshell new` writes both): VS Code with the extension Even Better TOML, and every editor that runs the language server
of taplo.
"""


def scene_page() -> str:
    """Markdown."""
    return "\n".join([INTRODUCTION, *_families()])


def _families() -> Iterator[str]:
    last = None
    for block in blocks().values():
        family = block.name.partition(".")[0]
        if family != last:
            yield f"## {block.head or 'First keys'}\n"
            last = family
        yield from _block(block)


def _block(block: Block) -> Iterator[str]:
    if "." in block.name:
        yield f"### {block.name}\n"
    yield f"{in_table(block.words)}\n"
    yield "| key | type | unit | default | |\n|---|---|---|---|---|"
    for key in block.keys:
        yield _row(key)
    yield f"\n```toml\n{block.example}\n```\n"


def _row(key: Key) -> str:
    default = key.default_words
    shown = default if default in ("", "required") else f"`{default}`"
    words = "" if key.name == "kind" else key.words
    return f"| `{key.name}` | {in_table(key.kind)} | {in_table(key.unit)} | {shown} | {in_table(words)} |"
