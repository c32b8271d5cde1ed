"""Words as Markdown that shows them as they are."""

from __future__ import annotations

ENTITIES = {letter: f"&#{ord(letter)};" for letter in "|<>$*_[]\\"}


def in_table(words: str) -> str:
    """Words for a cell of a table or a paragraph; what stands between backticks is code."""
    parts = words.split("`")
    whole = len(parts) % 2 == 1
    return "".join(
        f"<code>{_plain(part)}</code>" if whole and place % 2 else _plain(part)
        for place, part in enumerate(parts)
    )


def _plain(words: str) -> str:
    return "".join(ENTITIES.get(letter, letter) for letter in words)
