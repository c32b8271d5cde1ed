"""Names in messages: the nearest existing name, and short lists of what exists."""

from __future__ import annotations

from collections.abc import Iterable

from kshell.errors import clipped
from kshell.mesh.words import nearest_name


def listing(names: Iterable[str], most: int = 20) -> str:
    """The names separated by commas, shortened after `most`; "none" if there are none."""
    names = list(names)
    text = ", ".join(clipped(name) for name in names[:most])
    if len(names) > most:
        text += f", ... ({len(names)} in all)"
    return text or "none"


def suggestion(name: str, names: Iterable[str]) -> str:
    """`did you mean "left"? ` if one of the names is close to `name`, else the empty string."""
    close = nearest_name(name, list(names), cutoff=0.65)
    return f'did you mean "{close}"? ' if close else ""
