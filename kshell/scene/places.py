"""Where something acts: a group name, several names, or a point."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator, WithJsonSchema

from kshell.errors import InputError, clipped
from kshell.material.expansion import as_expansion
from kshell.scene.mapped import Mapped
from kshell.values import kinds
from kshell.values.expression import NORMAL, PLACE, Expression
from kshell.values.time import TIME

Point = tuple[float, float, float]
Place = str | tuple[str, ...] | Point


class ProbePoint(tuple[float, float, float]):
    """A point whose values are wanted, on a surface group where sheets meet.

    Attributes
    ----------
    on : str
    """

    on: str

    def __new__(cls, point: Point, on: str) -> ProbePoint:
        made = super().__new__(cls, point)
        made.on = on
        return made

    def __getnewargs__(self) -> tuple[Any, ...]:
        return (tuple(self), self.on)


def as_probe(value: Any) -> Point:
    """A point, or {"at": point, "on": surface group}.

    Raises
    ------
    ValueError
        With words for the user.
    """
    if isinstance(value, ProbePoint):
        return value
    if not isinstance(value, Mapping):
        return as_point(value)
    if set(value) - {"at", "on"} or "at" not in value:
        raise ValueError('must be a point, or have at = [x, y, z] and on = "group"')
    on = value.get("on")
    if on is None:
        return as_point(value["at"])
    if not isinstance(on, str) or not on:
        raise ValueError("on must be the name of a surface group")
    return ProbePoint(as_point(value["at"]), on)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float | np.number) and not isinstance(value, bool)


def as_point(value: Any) -> Point:
    """Two or three finite numbers as a point; z = 0 where it is left out.

    Raises
    ------
    ValueError
        With words for the user.
    """
    parts = list(value) if isinstance(value, Sequence | np.ndarray) and not isinstance(value, str) else []
    if len(parts) not in (2, 3) or not all(_is_number(part) and np.isfinite(part) for part in parts):
        raise ValueError("must be a point, three numbers [x, y, z]")
    x, y, z = [float(part) for part in [*parts, 0.0][:3]]
    return (x, y, z)


def _as_place(value: Any) -> Place:
    if isinstance(value, str) and value:
        return value
    if isinstance(value, Sequence | np.ndarray) and not isinstance(value, str) and len(value):
        if all(isinstance(part, str) and part for part in value):
            return tuple(value)
        if all(_is_number(part) for part in value):
            return as_point(value)
    raise ValueError("must be a group name, a list of group names, or a point [x, y, z]")


def as_scalar(value: Any, names: tuple[str, ...] = (*PLACE, TIME)) -> Any:
    """A number, a formula or a function, checked.

    Parameters
    ----------
    names : sequence of str
        What formulas may have.

    Raises
    ------
    ValueError
        With words for the user.
    """
    if isinstance(value, str):
        return _formula(value, names)
    if callable(value):
        return value
    if _is_number(value) or (isinstance(value, np.ndarray) and value.ndim == 0):
        if np.isfinite(value):
            return float(value)
        raise ValueError("must be a finite number")
    raise ValueError("must be a number, an expression in x, y, z, or a function f(x, y, z)")


def _scalar_or_file(value: Any, names: tuple[str, ...] = (*PLACE, TIME)) -> Any:
    if isinstance(value, Mapping):
        try:
            return Mapped(**value)
        except InputError as error:
            raise ValueError(str(error)) from None
    return as_scalar(value, names)


def _as_vector(value: Any, names: tuple[str, ...] = (*PLACE, TIME)) -> Any:
    if callable(value):
        return value
    parts = list(value) if isinstance(value, Sequence | np.ndarray) and not isinstance(value, str) else []
    if len(parts) != 3:
        raise ValueError("must be a vector of three numbers or expressions, or a function f(x, y, z)")
    return tuple(as_scalar(part, names) for part in parts)


def _formula(text: str, names: tuple[str, ...]) -> str:
    try:
        Expression(text, names)
    except InputError as error:
        raise ValueError(str(error)) from None  # pydantic adds the key
    return text


On = Annotated[Any, BeforeValidator(_as_place), WithJsonSchema(kinds.PLACE)]
"""A group name, a tuple of group names, or a point (x, y, z)."""

ScalarValue = Annotated[Any, BeforeValidator(as_scalar), WithJsonSchema(kinds.SCALAR)]
"""A number, an expression in x, y, z, or a function."""


def _as_centre(value: Any) -> Any:
    """A place, numbers or formulas; z = 0 where it is left out."""
    if isinstance(value, Sequence | np.ndarray) and not isinstance(value, str) and len(value) == 2:
        value = [*value, 0.0]
    return _as_vector(value)


CentreValue = Annotated[Any, BeforeValidator(_as_centre), WithJsonSchema(kinds.CENTRE)]
VectorValue = Annotated[Any, BeforeValidator(_as_vector), WithJsonSchema(kinds.VECTOR)]
"""Three numbers or expressions, or a function that returns three components."""


ON_SURFACE = (*PLACE, *NORMAL, TIME)

SurfaceScalar = Annotated[
    Any,
    BeforeValidator(partial(_scalar_or_file, names=ON_SURFACE)),
    WithJsonSchema(kinds.SCALAR_OR_FILE),
]
"""A number, an expression in x, y, z and the normal nx, ny, nz, a field of a file, or a function."""

MappedScalar = Annotated[Any, BeforeValidator(_scalar_or_file), WithJsonSchema(kinds.SCALAR_OR_FILE)]
"""A number, an expression in x, y, z, a field of a file, or a function."""

SurfaceVector = Annotated[
    Any, BeforeValidator(partial(_as_vector, names=ON_SURFACE)), WithJsonSchema(kinds.VECTOR)
]
"""Three numbers or expressions, in x, y, z and the normal nx, ny, nz, or a function that returns three components."""


def _as_either(value: Any) -> Any:
    return (
        as_scalar(value) if isinstance(value, str | int | float) or np.ndim(value) == 0 else _as_vector(value)
    )


ScalarOrVector = Annotated[
    Any, BeforeValidator(_as_either), WithJsonSchema(kinds.either(*kinds.SCALAR["anyOf"], kinds.VECTOR))
]

ScalarExpansion = Annotated[
    Any,
    BeforeValidator(lambda value: as_expansion(value, as_scalar)),
    WithJsonSchema(kinds.either(*kinds.SCALAR["anyOf"], kinds.listed(kinds.SCALAR, 2, 2))),
]
"""A thermal expansion that may vary: one, or two along the axes of the material."""

PlacePoint = Annotated[Any, BeforeValidator(as_point), WithJsonSchema(kinds.POINT)]
"""A point."""


def on_words(on: Place | None) -> str:
    """The place in words: `on "left"`, `on "left", "right"`, `on (0, 1, 0)` or `everywhere`."""
    if on is None:
        return "everywhere"
    if isinstance(on, str):
        return f'on "{clipped(on)}"'
    if isinstance(on[0], str):
        return "on " + clipped(", ".join(f'"{name}"' for name in on))
    return "on (" + ", ".join(f"{c:g}" for c in on) + ")"
