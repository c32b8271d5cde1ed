"""How the mesh messages speak of places, lists and counts."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kshell.errors import clipped

ROUNDING = 1e-12  # of the largest coordinate of a place, below which others are zero


def shown(value: Any) -> str:
    """A value in a message as Python writes it, cut where it is long."""
    try:
        return clipped(repr(value))
    except ValueError:  # Python does not write whole numbers of more than 4300 digits
        return "a whole number of thousands of digits"
    except RecursionError:
        return "a list of lists, nested too deeply"


def is_file(path: Path) -> bool:
    """Whether there is a file; false for paths that the system cannot even look for, such as too long ones."""
    try:
        return path.is_file()
    except OSError:
        return False


def is_folder(path: Path) -> bool:
    """Whether there is a folder, as `is_file`."""
    try:
        return path.is_dir()
    except OSError:
        return False


def place(point: ArrayLike) -> str:
    """Coordinates as the user writes them, without rounding; z is left out where it is zero."""
    x = np.asarray(point, dtype=float).ravel()
    x = np.where(np.abs(x) < ROUNDING * np.abs(x).max(initial=0.0), 0.0, x)
    if len(x) == 3 and x[2] == 0.0:
        x = x[:2]
    return "(" + ", ".join(f"{c + 0.0:.6g}" for c in x) + ")"


def quoted(names: Iterable[str], limit: int = 12) -> str:
    """Names in quotes, cut off after `limit`."""
    names = list(names)
    text = ", ".join(f"'{clipped(name)}'" for name in names[:limit])
    return text + (f" and {len(names) - limit} more" if len(names) > limit else "")


def count(number: int, one: str, many: str | None = None) -> str:
    """ "1 triangle", "3 triangles"."""
    return f"{number} {one if number == 1 else many or one + 's'}"


def nearest_name(name: str, names: Sequence[str], cutoff: float = 0.5) -> str | None:
    """The most similar name, upper and lower case alike, or None when nothing is similar (0 none, 1 "
    "equal)."""
    from difflib import get_close_matches

    by_folded = {known.casefold(): known for known in names}
    close = get_close_matches(name.casefold(), list(by_folded), n=1, cutoff=cutoff)
    return by_folded[close[0]] if close else None
