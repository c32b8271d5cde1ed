"""Tables for a terminal: they fit 80 columns without cutting a number, because words fold and numbers do not."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Sequence
from typing import Any

from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table

BETWEEN = 3  # columns
WIDTH = 100  # into a pipe or file, where COLUMNS does not say otherwise


def console() -> Console:
    """Of stdout."""
    if sys.stdout.isatty():
        return Console(highlight=False)
    columns = os.environ.get("COLUMNS", "")
    return Console(highlight=False, width=int(columns) if columns.isdigit() and int(columns) else WIDTH)


def table(heads: Sequence[str], rows: Iterable[Sequence[str]], title: str, numbers: int = 0) -> Table:
    """A table whose last columns are numbers.

    Parameters
    ----------
    heads : sequence of str
    rows : iterable of sequence of str
    title : str
    numbers : int
        How many of the last columns keep to one line; all others fold.
    """
    out = Table(
        title=title,
        title_justify="left",
        title_style="bold",
        box=box.SIMPLE_HEAD,
        pad_edge=False,
        padding=(0, 1),
    )
    body = [[str(part) for part in row] for row in rows]
    words = len(heads) - numbers
    longest = [
        max(map(len, head.split()), default=0) for head in heads[:words]
    ]  # below it a head folds within a word
    needed = [
        max(len(head), *(len(row[words + k]) for row in body), 0) for k, head in enumerate(heads[words:])
    ]
    fits = sum(longest) + sum(needed) + BETWEEN * len(heads) <= console().width
    for place, head in enumerate(heads):
        number = place >= len(heads) - numbers
        out.add_column(
            head,
            justify="right" if number else "left",
            no_wrap=number,
            overflow="fold",
            min_width=longest[place] if fits and not number else None,
        )
    for row in body:
        out.add_row(*(escape(part) for part in row))
    return out


def number(value: Any) -> str:
    """Seven digits."""
    return f"{value:.7g}"


def components(values: Any) -> list[str]:
    """Three numbers, rounding beside larger ones as 0; what is missing is empty."""
    parts = [float(v) for v in values]
    size = max((abs(v) for v in parts), default=0.0)
    words = [number(v if abs(v) > 1e-12 * size else 0.0) for v in parts]
    return words + [""] * (3 - len(words))
