"""TOML: its text as tables, and single values replaced in them."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from kshell.errors import InputError, clipped
from kshell.mesh.words import is_folder, shown
from kshell.values.naming import suggestion


def read_toml(path: Path) -> dict[str, Any]:
    """The tables of a TOML file.

    Raises
    ------
    InputError
        If there is no such file or it is not TOML; the message has the line.
    """
    where = clipped(path)
    try:
        text = path.read_text(encoding="utf-8-sig")  # some editors begin with a mark of the order of bytes
    except FileNotFoundError:
        near = [p.name for p in path.parent.glob("*.toml")] if is_folder(path.parent) else []
        hint = suggestion(path.name, near)
        raise InputError(f"{where}: no such file. {hint}".rstrip()) from None
    except IsADirectoryError:
        raise InputError(f"{where}: is a folder: give a scene file, .toml") from None
    except UnicodeDecodeError:
        raise InputError(f"{where}: is not text: a scene file is TOML in UTF-8") from None
    except PermissionError:
        raise InputError(f"{where}: may not be read: check its permissions") from None
    except OSError as error:
        raise InputError(
            f"{where}: cannot be read ({error.strerror}): give the path of a scene file"
        ) from None
    try:
        return parsed_toml(text)
    except ValueError as error:
        raise InputError(f"{where}: not valid TOML: {clipped(error)}") from None


def parsed_toml(text: str) -> dict[str, Any]:
    """The tables of a text.

    Raises
    ------
    ValueError
        If it is not TOML, or nested too deeply, or has a whole number of more digits than Python reads.
    """
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise ValueError("lists or tables nested too deeply") from None


def apply_override(data: dict[str, Any], override: str) -> None:
    """Replace one value in place: "material.E=70e9", "load.0.value=2000", 'title="x"'.

    The value is written as in TOML; what is not TOML is taken as text.
    """
    key, equals, text = override.partition("=")
    override = clipped(override)
    parts = key.strip().split(".")
    if not equals or not all(parts):
        raise InputError(
            f'--set {override}: write KEY=VALUE, for example "material.E=70e9" or "load.0.value=2000"'
        )
    value = value_of(text)
    data.update(set_value(data, parts, value, f"--set {override}"))


def value_of(text: str) -> Any:
    """A value written as in TOML; what is not TOML is text."""
    try:
        return parsed_toml(f"value = {text.strip()}")["value"]
    except ValueError:
        return text.strip()


def set_value(data: Any, parts: Sequence[str], value: Any, what: str) -> Any:
    """A copy of tables and lists with one value replaced, the rest shared.

    Parameters
    ----------
    parts : sequence of str
        Keys from the outside in; of a list a number from 0. A table that is missing is made.
    what : str
        For messages.

    Raises
    ------
    InputError
        If there is no such place.
    """
    return _changed(data, list(parts), value, what, [])


def _changed(table: Any, parts: list[str], value: Any, what: str, above: list[str]) -> Any:
    if not parts:
        return value
    part, *rest = parts
    if isinstance(table, list):
        key = _index(table, part, what, above)
        return [
            _changed(item, rest, value, what, [*above, part]) if number == key else item
            for number, item in enumerate(table)
        ]
    if isinstance(table, dict):
        inner = _changed(table.get(part, {}), rest, value, what, [*above, part])
        return {**table, part: inner}
    raise InputError(f'{what}: "{clipped(".".join(above))}" is {shown(table)} and has no keys')


def _index(items: list[Any], part: str, what: str, above: list[str]) -> int:
    if not part.isascii() or not part.isdigit() or len(part) > 9 or int(part) >= len(items):
        raise InputError(
            f'{what}: "{clipped(".".join(above))}" is a list of {len(items)}: '
            f'"{clipped(part)}" must be a number from 0 to {len(items) - 1}'
        )
    return int(part)
