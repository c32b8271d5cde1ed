"""What `kshell explain` prints."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from rich.markup import escape
from rich.padding import Padding
from rich.text import Text

from kshell.cli.tables import console, table
from kshell.scene.keys import blocks
from kshell.scene.lookup import find

if TYPE_CHECKING:
    from rich.console import Console

    from kshell.scene.keys import Block, Key


def print_explanation(key: str | None) -> None:
    """Say what a key, a block or a kind means; of none all blocks.

    Raises
    ------
    InputError
        If there is no such key.
    """
    out = console()
    if key is None:
        _families(out, blocks().values())
        return
    found = find(key)
    keys = [(block, one) for block, one in found if one is not None]
    if not keys and len(found) == 1:
        _block(out, found[0][0])
    elif not keys:
        _list(out, [block for block, _ in found])
    else:
        _keys(out, keys)


def _families(out: Console, blocks: Iterable[Block]) -> None:
    """All blocks, those of one name together."""
    families: dict[str, list[Block]] = {}
    for block in blocks:
        families.setdefault(block.name.partition(".")[0], []).append(block)
    rows = []
    for name, members in families.items():
        kinds = [block.name.rpartition(".")[2] for block in members if "." in block.name]
        keys = [key.name for key in members[0].keys] if len(kinds) != len(members) else kinds
        rows.append([members[0].head or "(first)", name, ", ".join(keys)])
    out.print(table(["in the file", "name", "keys, or kinds"], rows, "Blocks of a scene file"))
    out.print(
        "kshell explain NAME, NAME.KIND or NAME.KEY says more; keys that stand first have no name",
        markup=False,
    )


def _list(out: Console, blocks: Iterable[Block]) -> None:
    rows = [[block.name, _first(block.words), ", ".join(key.name for key in block.keys)] for block in blocks]
    out.print(table(["name", "what it is", "keys"], rows, ""))


def _first(words: str) -> str:
    """The first sentence."""
    return words.partition(". ")[0].rstrip(".")


def _block(out: Console, block: Block) -> None:
    out.print(f"{block.head}  {block.words}".strip(), markup=False)
    for key in block.keys:
        kind = f"{key.kind}{f' [{key.unit}]' if key.unit else ''}"
        default = key.default_words
        out.print()
        out.print(f"[bold]{key.name}[/bold]: {escape(kind)}{f'; {default}' if default == 'required' else ''}")
        if key.name != "kind":
            _said(out, key.words)
        if default and default != "required":
            _said(out, f"Default: {default}")
    out.print()
    _example(out, block.example)


def _keys(out: Console, keys: list[tuple[Block, Key]]) -> None:
    """A key of one block, or the key of that name in several: those that say the same together."""
    alike: dict[tuple[str, ...], list[tuple[Block, Key]]] = {}
    for block, key in keys:
        alike.setdefault((key.words, key.kind, key.unit, key.default_words), []).append((block, key))
    for (words, kind, unit, default), members in alike.items():
        names = ", ".join(".".join(part for part in (block.name, key.name) if part) for block, key in members)
        out.print(f"[bold]{names}[/bold]")
        for label, text in (("", words), ("type: ", kind), ("unit: ", unit), ("default: ", default)):
            if text:
                _said(out, f"{label}{text}")
        _example(out, members[0][1].example)


def _said(out: Console, text: str) -> None:
    out.print(Padding(Text(text), (0, 0, 0, 2)))


def _example(out: Console, example: str) -> None:
    for line in example.splitlines():
        out.print(f"    {line}", markup=False, soft_wrap=True)
