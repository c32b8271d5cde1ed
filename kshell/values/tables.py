"""Tables from files as formulas: values between rows are interpolated, beyond the ends those of the ends stay."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from kshell.errors import InputError

CALL = re.compile(r"""\btable\(\s*(["'])(?P<path>[^"']+)\1\s*(?:,\s*(?P<of>[A-Za-z_]\w*)\s*)?\)""")


def table(path: str | os.PathLike[str], of: str = "t") -> str:
    """The formula of a table: interp(t, t0, value0, t1, value1, ...).

    Parameters
    ----------
    path : path
        A file with two columns of numbers, separated by commas, semicolons or blanks; a line of heads may go before.
        The first column rises.
    of : str
        What the first column is: t, or x, y or z.

    Raises
    ------
    InputError
        If the file cannot be read or is not such a table.
    """
    try:
        text = Path(path).read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        why = getattr(error, "strerror", None) or "it is no text"
        raise InputError(f"{path}: cannot be read ({why})") from None
    lines = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    rows = [_numbers(line) for line in lines]
    if rows and rows[0] is None:
        rows, lines = rows[1:], lines[1:]
    for line, row in zip(lines, rows, strict=True):
        if row is None or len(row) != 2:
            raise InputError(f'{path}: the line "{line[:60]}" is not two finite numbers')
    if len(rows) < 2:
        raise InputError(f"{path}: a table needs two rows of two numbers at least")
    values = np.array(rows, dtype=float)
    falls = np.flatnonzero(np.diff(values[:, 0]) <= 0.0)
    if len(falls):
        raise InputError(
            f'{path}: the first column must rise: it does not after the line "{lines[falls[0]][:60]}"'
        )
    return f"interp({of}, {', '.join(repr(float(value)) for value in values.ravel())})"


def _numbers(line: str) -> list[float] | None:
    try:
        found = [float(part) for part in re.split(r"[\s,;]+", line.strip()) if part]
    except ValueError:
        return None
    return found if np.isfinite(found).all() else None


def with_tables(data: Any, folder: Path) -> Any:
    """What a scene file says, with table("file.csv") in its texts replaced by the formula of the table."""
    if isinstance(data, str) and "table(" in data:
        return CALL.sub(lambda call: f"({table(folder / call['path'], call['of'] or 't')})", data)
    if isinstance(data, Mapping):
        return {key: with_tables(value, folder) for key, value in data.items()}
    if isinstance(data, list):
        return [with_tables(value, folder) for value in data]
    return data
