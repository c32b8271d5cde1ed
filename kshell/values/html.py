"""Small pieces of HTML for notebooks."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape


def html_table(heads: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table of text."""
    head = "".join(f"<th>{escape(str(part))}</th>" for part in heads)
    body = "".join(
        "<tr>" + "".join(f"<td>{escape(str(part))}</td>" for part in row) + "</tr>" for row in rows
    )
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def html_list(items: Iterable[str], title: str) -> str:
    """A list under a title; empty without items."""
    entries = "".join(f"<li>{escape(item)}</li>" for item in items)
    return f"<b>{escape(title)}</b><ul>{entries}</ul>" if entries else ""
