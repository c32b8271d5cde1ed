"""Tables of a report, and how numbers stand in them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

NEGLIGIBLE = 1e-12  # against the largest component: rounding, written as 0


@dataclass(frozen=True)
class Table:
    """Rows of text under heads.

    Attributes
    ----------
    title : str
    heads : sequence of str
        Empty for pairs of a name and its value.
    rows : sequence of sequence of str
    """

    title: str
    heads: Sequence[str]
    rows: Sequence[Sequence[str]]


def number(value: float | None) -> str:
    """Six digits; a dash for None."""
    return "–" if value is None else f"{value + 0.0:.6g}"


def components(values: Any) -> list[str]:
    """Components of a vector or tensor, those that are rounding as 0."""
    array = np.ravel(np.asarray(values, dtype=float))
    most = float(np.abs(array).max(initial=0.0))
    return [number(v if abs(v) > NEGLIGIBLE * most else 0.0) for v in array.tolist()]


def tall(title: str, heads: Sequence[str], entries: Iterable[tuple[Sequence[str], Any]]) -> Table:
    """A table with the components of a quantity side by side, empty where an entry has fewer.

    Parameters
    ----------
    entries : of (words before them, values)
    """
    rows = [[*words, *components(values)] for words, values in entries]
    return Table(title, heads, [[*row, *[""] * (len(heads) - len(row))] for row in rows])
