"""Reading text files of any encoding, and their numbers."""

from __future__ import annotations

import re
from pathlib import Path

from kshell.errors import InputError

LARGEST = 2**62
_FORTRAN = re.compile(r"^([+-]?(?:\d+\.?\d*|\.\d+))(?:[dDeE]?([+-]\d+)|[dDeE](\d+))?$")


def text_of(path: Path) -> str:
    """The text of a file, UTF-8 or Latin-1.

    Raises
    ------
    InputError
        If it is empty, or binary.
    """
    data = path.read_bytes()
    if not data.strip():
        raise InputError(f"{path.name}: the file is empty")
    if b"\0" in data:
        raise InputError(f"{path.name}: holds binary data where text is expected. Save it as text")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def whole(word: str, where: str) -> int:
    """A whole number.

    Raises
    ------
    InputError
        If the word is none; `where` names file and line.
    """
    try:
        number = int(word)
    except ValueError:
        raise InputError(f"{where}: {word[:40]!r} stands where a whole number should") from None
    if abs(number) >= LARGEST:
        raise InputError(f"{where}: the number {word[:40]} is too large to number anything")
    return number


def real(word: str, where: str) -> float:
    """A number, also as Fortran writes it: 1.5D+3, 1.5+3; an empty word is 0.

    Raises
    ------
    InputError
        If the word is none; `where` names file and line.
    """
    try:
        return float(word)
    except ValueError:
        pass
    if not word:
        return 0.0
    match = _FORTRAN.match(word)
    if match is None:
        raise InputError(f"{where}: {word[:40]!r} stands where a number should")
    return float(f"{match[1]}e{match[2] or match[3] or 0}")
