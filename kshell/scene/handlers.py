"""From each kind of load or support to what a model makes of it.

A model registers functions by class; a class without one is handled as the nearest class it derives from, so that a new
kind that only says otherwise what an old one says (`class Snow(Traction)`) needs nothing here. What a model has no
function for is refused.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

from kshell.errors import InputError
from kshell.scene.placed import Placed

F = TypeVar("F", bound=Callable[..., None])


class Handlers:
    """Functions of a model by class of load or support.

    Parameters
    ----------
    refusal : str
        What is said of a load or support without one, after its name, and how to mend it.
    """

    def __init__(self, refusal: str) -> None:
        self.refusal = refusal
        self._table: dict[type, Callable[..., None]] = {}

    def of(self, *kinds: type) -> Callable[[F], F]:
        """Register the function below for classes."""

        def register(function: F) -> F:
            for kind in kinds:
                self._table[kind] = function
            return function

        return register

    def handle(self, builder: Any, placed: Placed[Any], warnings: list[str]) -> None:
        """Call the function of a load or support with the builder, the load or support, and its place.

        Raises
        ------
        InputError
            If there is none.
        """
        if placed.place is not None and placed.place.warning:
            warnings.append(placed.place.warning)
        if placed.warning:
            warnings.append(placed.warning)
        for kind in type(placed.item).__mro__:
            if kind in self._table:
                self._table[kind](builder, placed.item, placed)
                return
        raise InputError(f"{placed.item} {self.refusal}")


def of_acting(
    warnings: Sequence[str], numbers: Sequence[int], factors: Sequence[float]
) -> tuple[list[str], list[int]]:
    """Warnings, each of the load of a number, without those of loads of factor 0; all of them where none acts."""
    none = not any(factors)
    kept = [(words, k) for words, k in zip(warnings, numbers, strict=True) if none or factors[k] != 0.0]
    return [words for words, _ in kept], [k for _, k in kept]
