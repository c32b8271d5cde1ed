"""What all loads have in common. Values are numbers, expressions in x, y, z, or functions of the place."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from functools import partial
from typing import Annotated, Any, ClassVar, Self, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BeforeValidator

from kshell.scene.places import (
    Place,
    on_words,
)
from kshell.values.time import depends_on_normal
from kshell.values.varying import show, values_at

# part of a load that is nothing but rounding
NEGLIGIBLE = 1e-12


def exceeds(part: NDArray[np.float64], whole: NDArray[np.float64]) -> bool:
    """Whether components of values are more than rounding of the largest."""
    return bool(np.abs(part).max(initial=0.0) > NEGLIGIBLE * np.abs(whole).max(initial=0.0))


class Load:
    """What all loads have in common.

    Attributes
    ----------
    kind : str
        The name in a scene file.
    on : str, tuple of str, (x, y, z) or None
        Where it acts: a group, several, or the nearest vertex; everywhere if absent.
    value : scalar or vector
    fixed : bool
        Whether it does not grow in buckling.
    name : str
        By which load cases know it.
    scaling : tuple of str
        The values that it grows with.
    placing : tuple of str
        Further values, that say where it is.
    components : int or None
        Length of the vector, None for a scalar.
    dimensions : tuple of int
        What it may be on: 0 points, 1 curves, 2 surfaces.
    """

    kind: ClassVar[str] = ""
    components: ClassVar[int | None] = None
    dimensions: ClassVar[tuple[int, ...]] = (2,)
    scaling: ClassVar[tuple[str, ...]] = ("value",)
    placing: ClassVar[tuple[str, ...]] = ()
    on: Place | None
    value: Any
    fixed: bool = False
    name: str = ""

    @property
    def needs_normal(self) -> bool:
        """Whether its values depend on the normal, so that `at` needs it beside the points."""
        return any(depends_on_normal(getattr(self, key, None)) for key in self.scaling)

    def at(self, points: ArrayLike) -> NDArray[np.float64]:
        """The value at points (..., 3), or (..., 6) with normals: (...) for a scalar, else (..., components)."""
        return values_at(self.value, points, self.components, what=str(self))

    def require_finite(self, points: ArrayLike) -> None:
        """Raise InputError if it has no finite value at some of the points (n, 3)."""
        self.at(points)

    def stretches(self, points: ArrayLike) -> str:
        """How it stretches a plate in its plane z = const, in words; empty if it only bends it.

        Parameters
        ----------
        points : (n, 3)
            Vertices of its place.
        """
        if self.components != 3:
            return ""
        value = self.at(points)
        return "acts in its plane" if exceeds(value[:, :2], value) else ""

    def times(self, factor: float) -> Self:
        """The same load times a factor."""
        if factor == 1.0:
            return self
        given = {f.name: getattr(self, f.name) for f in fields(cast(Any, self)) if f.init}
        given |= {key: _times(factor, given[key]) for key in self.scaling}
        return type(self)(**given)

    @property
    def where(self) -> str:
        """Where it acts, in words."""
        return on_words(self.on)

    @property
    def amount(self) -> str:
        """How large it is, in words."""
        keys = (*self.scaling, *self.placing)
        if keys == ("value",):
            return show(self.value)
        return ", ".join(f"{key} {show(getattr(self, key))}" for key in keys)

    def __str__(self) -> str:
        named = f' "{self.name}"' if self.name else ""
        return f"load {self.kind}{named} {self.where}"


def _times(factor: float, value: Any) -> Any:
    """A number, formula, function, or vector of them, times a factor."""
    if isinstance(value, str):
        return f"({factor!r}) * ({value})"
    if callable(value):
        return partial(_product, factor, value)
    if isinstance(value, tuple):
        return tuple(_times(factor, part) for part in value)
    return factor * value


def _product(factor: float, function: Callable[..., Any], *place: NDArray[np.float64]) -> Any:
    value = function(*place)
    return [factor * part for part in value] if isinstance(value, list | tuple) else factor * value


def _name(value: Any) -> Any:
    if not isinstance(value, str):
        raise ValueError("must be text")
    return value


Name = Annotated[str, BeforeValidator(_name)]
"""By which a load is known to load cases."""
