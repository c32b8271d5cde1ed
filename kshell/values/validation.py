"""What users describe is checked by pydantic; what is wrong is said in one sentence as an InputError."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields
from typing import Annotated, Any, TypeVar, dataclass_transform

import numpy as np
from pydantic import BeforeValidator, ConfigDict, Strict, ValidationError
from pydantic.dataclasses import dataclass as pydantic_dataclass

from kshell.errors import InputError, clipped
from kshell.mesh.words import shown
from kshell.values.naming import listing, suggestion

T = TypeVar("T", bound=type)


def _plain(value: Any) -> Any:
    """numpy scalars as Python numbers."""
    return value.item() if isinstance(value, np.generic) else value


Number = Annotated[float, Strict(), BeforeValidator(_plain)]
"""A finite real number; text and booleans are not numbers."""

Flag = Annotated[bool, Strict()]
"""true or false, not 0 or 1."""

CONFIG = ConfigDict(extra="forbid", arbitrary_types_allowed=True, allow_inf_nan=False)


@dataclass_transform(frozen_default=True)
def described(name: str, moved: Mapping[str, str] | None = None) -> Callable[[T], T]:
    """Class decorator: an immutable dataclass checked by pydantic, called `name` in messages.

    Its constructor raises InputError that names the key, its value, and what is expected.

    Parameters
    ----------
    moved : mapping, optional
        Keys that stand elsewhere, and where, in words.
    """

    def decorate(cls: T) -> T:
        checked: Any = pydantic_dataclass(cls, config=CONFIG, frozen=True)
        unworded = checked.__init__

        def __init__(self: Any, /, *args: Any, **kwargs: Any) -> None:
            for key, words in (moved or {}).items():
                if key in kwargs:
                    raise InputError(f"{name}: {key} = {shown(kwargs[key])}: {words}")
            try:
                unworded(self, *args, **kwargs)
            except ValidationError as error:
                keys = [field.name for field in fields(checked) if field.init]
                raise InputError(f"{name}: {reworded(error, keys)}") from None

        __init__.__doc__, __init__.__wrapped__ = unworded.__doc__, unworded  # type: ignore[attr-defined]
        checked.__init__ = __init__
        checked.described_as = name
        return checked

    return decorate


def reworded(error: ValidationError, keys: list[str]) -> str:
    """The first complaint of pydantic as: key, value, what is wrong and how to mend it."""
    first = error.errors(include_url=False)[0]
    location = [str(part) for part in first["loc"]]
    key = location[0] if location else ""
    if key.isdigit() and int(key) < len(keys):  # given by position
        key = keys[int(key)]
    value = first.get("input")
    match first["type"]:
        case "unexpected_keyword_argument" | "extra_forbidden":
            return unknown_key(key, keys)
        case (
            "missing"
            | "missing_argument"
            | "missing_keyword_only_argument"
            | "missing_positional_only_argument"
        ):
            return f"{key} is missing: give a value for it"
        case "unexpected_positional_argument":
            return f"too many values in a row: the keys are {listing(keys)}"
        case "multiple_argument_values":
            return f"{key} is given twice"
        case "value_error":
            complaint = str(first["ctx"]["error"])
            return (
                f"{key}: {complaint}"
                if complaint.startswith("expression ")
                else f"{key} = {shown(value)}: {complaint}"
            )
        case "literal_error":
            wanted = first["ctx"]["expected"]
            return f"{key} = {shown(value)}: must be one of {wanted}"
    expected = {
        "float_type": "must be a number (without quotes or units)",
        "finite_number": "must be a finite number",
        "string_type": "must be text",
        "bool_type": "must be true or false",
    }.get(first["type"], first["msg"][0].lower() + first["msg"][1:])
    return f"{key} = {shown(value)}: {expected}"


def unknown_key(key: str, keys: list[str]) -> str:
    """Words for a key that does not exist, with the nearest one that does."""
    return f'unknown key "{clipped(key)}": {suggestion(key, keys)}the keys are {listing(keys)}'
