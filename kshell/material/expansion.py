"""The key `expansion` of materials and temperatures: one coefficient, or two along the axes of the material."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator, WithJsonSchema

from kshell.values import kinds


def as_expansion(value: Any, one: Callable[[Any], Any]) -> Any:
    """None, a coefficient, or two as a tuple; `one` checks each.

    Raises
    ------
    ValueError
        With words for the user.
    """
    if value is None:
        return None
    if isinstance(value, str) or not isinstance(value, Sequence | np.ndarray) or np.ndim(value) == 0:
        return one(value)
    if len(value) != 2:
        raise ValueError("must be a number, or two along the axes of the material, [a1, a2]")
    return (one(value[0]), one(value[1]))


def _number(value: Any) -> float:
    if not isinstance(value, int | float | np.number) or isinstance(value, bool) or not np.isfinite(value):
        raise ValueError("must be a number, or two along the axes of the material, [a1, a2]")
    return float(value)


ExpansionKey = Annotated[
    Any,
    BeforeValidator(lambda value: as_expansion(value, _number)),
    WithJsonSchema(kinds.either(kinds.NUMBER, kinds.listed(kinds.NUMBER, 2, 2))),
]
"""Of a material: a number, or two."""
