"""Options that several commands share are declared once: as the fields of a dataclass.

A command takes such dataclasses as parameters; typer sees their fields in place of them.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import MISSING, fields, is_dataclass
from typing import Any, get_type_hints


def flat(function: Callable[..., None]) -> Callable[..., None]:
    """The function with the fields of its dataclass parameters as parameters of their own.

    Raises
    ------
    TypeError
        If two parameters have the same name.
    """
    hints = get_type_hints(function, include_extras=True)
    given = inspect.signature(function).parameters
    groups: dict[str, tuple[type[Any], list[str]]] = {}
    flattened: list[inspect.Parameter] = []
    for name, parameter in given.items():
        if is_dataclass(hints[name]):
            parts = _parameters(hints[name])
            groups[name] = (hints[name], [part.name for part in parts])
            flattened += parts
        else:
            flattened.append(_parameter(name, hints[name], parameter.default))
    if len({part.name for part in flattened}) < len(flattened):
        raise TypeError(f"{function.__name__}: two options have the same name")

    def command(**values: Any) -> None:
        made = {name: cls(**{key: values.pop(key) for key in keys}) for name, (cls, keys) in groups.items()}
        function(**values, **made)

    command.__name__ = function.__name__
    command.__doc__ = function.__doc__
    command.__annotations__ = {part.name: part.annotation for part in flattened} | {"return": None}
    command.__signature__ = inspect.Signature(flattened)  # type: ignore[attr-defined]
    return command


def _parameters(group: Any) -> list[inspect.Parameter]:
    """The fields of a class, before them those of the classes that derive from it."""
    hints = get_type_hints(group, include_extras=True)
    known = {field.name: field for field in fields(group)}
    names = dict.fromkeys(name for cls in group.__mro__ for name in inspect.get_annotations(cls))
    return [
        _parameter(name, hints[name], inspect.Parameter.empty if field.default is MISSING else field.default)
        for name, field in ((name, known[name]) for name in names if name in known)
    ]


def _parameter(name: str, annotation: Any, default: Any) -> inspect.Parameter:
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)
