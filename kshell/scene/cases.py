"""Load cases: which loads act together, and which cases are added up with which factors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, WithJsonSchema

from kshell.errors import InputError
from kshell.scene.loads import Load
from kshell.values import kinds
from kshell.values.naming import listing, suggestion
from kshell.values.validation import described

Floats = NDArray[np.float64]


def _name(value: Any) -> Any:
    if not isinstance(value, str) or not value.strip():
        raise ValueError("must be text that is not empty")
    return value


def _finite(value: Any) -> bool:
    number = isinstance(value, int | float | np.number) and not isinstance(value, bool)
    return number and bool(np.isfinite(value))


def _loads(value: Any) -> Any:
    parts = [value] if isinstance(value, str | int) and not isinstance(value, bool) else value
    if not isinstance(parts, Sequence) or isinstance(parts, str) or not parts:
        raise ValueError("must be a list of names of loads, or of their numbers from 0")
    for part in parts:
        if isinstance(part, bool) or not isinstance(part, str | int):
            raise ValueError(f"{part!r} must be the name of a load, or its number from 0")
    return tuple(parts)


def _factors(value: Any) -> Any:
    if value is None:
        return None
    if not isinstance(value, Sequence) or isinstance(value, str) or not all(map(_finite, value)):
        raise ValueError("must be a list of finite numbers, one for each of the loads")
    return tuple(float(part) for part in value)


def _by_case(value: Any) -> Any:
    if not isinstance(value, Mapping) or not value:
        raise ValueError("must be a table of case to factor, such as {dead = 1.35, snow = 1.5}")
    for name, factor in value.items():
        if not _finite(factor):
            raise ValueError(f'the factor of "{name}" is {factor!r}: it must be a finite number')
    return {str(name): float(factor) for name, factor in value.items()}


_NAME_OR_NUMBER = kinds.either(kinds.TEXT, {"type": "integer", "minimum": 0})
LOAD_NAMES = kinds.either(*_NAME_OR_NUMBER["anyOf"], kinds.listed(_NAME_OR_NUMBER))


@described("case")
class Case:
    """Loads that act together.

    Attributes
    ----------
    name : str
        By which its results are reported and combinations know it.
    loads : sequence of str or int
        Names of loads, or their numbers from 0; a name that several loads share means all of them.
    factors : sequence of float, optional [1]
        One for each entry of `loads`; 1 if absent.

    Examples
    --------
    ```toml
    [[case]]
    name = "winter"
    loads = ["snow", 0]
    factors = [1.0, 1.35]
    ```
    """

    name: Annotated[str, BeforeValidator(_name)]
    loads: Annotated[Any, BeforeValidator(_loads), WithJsonSchema(LOAD_NAMES)]
    factors: Annotated[Any, BeforeValidator(_factors), WithJsonSchema(kinds.listed(kinds.NUMBER))] = None

    def __post_init__(self) -> None:
        if self.factors is not None and len(self.factors) != len(self.loads):
            raise InputError(
                f'case "{self.name}": {len(self.factors)} factors for {len(self.loads)} loads: give one for each'
            )


@described("combination")
class Combination:
    """Cases added up.

    Attributes
    ----------
    name : str
        By which its results are reported.
    factors : dict of str to float [1]
        Case to factor; cases that are not named do not act.

    Examples
    --------
    ```toml
    [[combination]]
    name = "design"
    factors = {winter = 1.5}
    ```
    """

    name: Annotated[str, BeforeValidator(_name)]
    factors: Annotated[
        Any,
        BeforeValidator(_by_case),
        WithJsonSchema({"type": "object", "additionalProperties": kinds.NUMBER, "minProperties": 1}),
    ]


def load_factors(
    loads: Sequence[Load], cases: Sequence[Case], combinations: Sequence[Combination]
) -> dict[str, Floats]:
    """Factors (load,) of the loads in every case and combination, by name and in their order.

    Raises
    ------
    InputError
        If a name is taken twice, or a load or case does not exist.
    """
    out: dict[str, Floats] = {}
    for case in cases:
        _require_new(case.name, out, "case")
        out[case.name] = _of_case(loads, case)
    names = list(out)
    for combination in combinations:
        _require_new(combination.name, out, "combination")
        total = np.zeros(len(loads))
        for name, factor in combination.factors.items():
            if name not in names:
                raise InputError(
                    f'combination "{combination.name}": no case "{name}": {suggestion(name, names)}the cases are '
                    f"{listing(names) or 'none'}"
                )
            total += factor * out[name]
        out[combination.name] = total
    return out


def _require_new(name: str, taken: Mapping[str, Any], what: str) -> None:
    if name in taken:
        raise InputError(
            f'{what} "{name}": the name is taken by an earlier case or combination: give another'
        )


def _of_case(loads: Sequence[Load], case: Case) -> Floats:
    out = np.zeros(len(loads))
    taken: set[int] = set()
    for part, factor in zip(case.loads, case.factors or [1.0] * len(case.loads), strict=True):
        numbers = _numbers(loads, part, case.name)
        if taken & set(numbers):
            raise InputError(f'case "{case.name}": load {part!r} is named twice: give its factor once')
        taken |= set(numbers)
        out[numbers] = factor
    return out


def _numbers(loads: Sequence[Load], part: str | int, case: str) -> list[int]:
    """The loads that a name or number means."""
    if isinstance(part, str):
        found = [number for number, load in enumerate(loads) if load.name == part]
        if found:
            return found
        names = sorted({load.name for load in loads if load.name})
        known = f"the names are {listing(names)}" if names else 'no load has a name: give one, name = "snow"'
        raise InputError(f'case "{case}": no load "{part}": {suggestion(part, names)}{known}')
    if not 0 <= part < len(loads):
        raise InputError(
            f'case "{case}": no load {part}: there are {len(loads)}, numbered from 0 in the order of the scene'
        )
    return [part]


def idle_loads(loads: Sequence[Load], factors: Mapping[str, Floats]) -> list[str]:
    """Words about loads that act in no case."""
    if not factors:
        return []
    acting = np.any([row != 0.0 for row in factors.values()], axis=0)
    return [
        f"{load} (number {number}) is in no case: it does not act"
        for number, load in enumerate(loads)
        if not acting[number]
    ]
