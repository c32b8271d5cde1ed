"""What a load on a plate is: a linear form, triangle by triangle, with its resultant for the check of equilibrium."""

from __future__ import annotations

import copy
from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable, Iterator
from dataclasses import dataclass, field
from typing import Any, Protocol, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

T = TypeVar("T")


class LinearForm(Protocol):
    """A load, triangle by triangle; a triangle may occur more than once."""

    @property
    def everywhere(self) -> bool:
        """Whether it covers the plate, in the blocks of its domain."""

    def blocks(self) -> Iterator[tuple[Ints, Ints]]:
        """Batches: (positions in this load, triangle numbers)."""

    def vectors(self, positions: Ints, transform: Floats) -> Floats:
        """(n, local) element vectors in the unknowns that ``transform`` leads to."""

    def resultant(self, origin: Floats) -> Floats:
        """(3,) force along z, moments about x and y through ``origin``, straight from the data."""

    def gross(self, size: float) -> float:
        """Sum of absolute forces, moments divided by a size: the scale for errors of equilibrium."""

    def times(self, factor: float) -> LinearForm:
        """The same load times a factor."""


def resultant_of(force: Floats, xy: Floats, origin: Floats) -> Floats:
    """Force and moments of forces (...,) along z at points (..., 2)."""
    arm = xy - origin
    return np.array([force.sum(), (force * arm[..., 1]).sum(), -(force * arm[..., 0]).sum()])


@dataclass
class Scaled(ABC):
    """A load times a factor; what is found of the load itself is kept for all of its multiples."""

    factor: float = field(default=1.0, kw_only=True)
    kept: dict[Hashable, Any] = field(default_factory=dict, kw_only=True, repr=False, compare=False)

    def times(self, factor: float) -> Self:
        out = copy.copy(self)
        out.factor = factor * self.factor
        return out

    @property
    def alone(self) -> Self:
        """The load without its factor."""
        out = copy.copy(self)
        out.factor = 1.0
        return out

    def once(self, key: Hashable, find: Callable[[], T]) -> T:
        """What is found of the load without its factor, when it is first asked for."""
        if key not in self.kept:
            self.kept[key] = find()
        found: T = self.kept[key]
        return found

    def vectors(self, positions: Ints, transform: Floats) -> Floats:
        return self.factor * self._vectors(positions, transform)

    def resultant(self, origin: Floats) -> Floats:
        return self.factor * self.once(("resultant", origin.tobytes()), lambda: self._resultant(origin))

    def gross(self, size: float) -> float:
        return abs(self.factor) * self.once(("gross", size), lambda: self._gross(size))

    @property
    @abstractmethod
    def everywhere(self) -> bool: ...

    @abstractmethod
    def blocks(self) -> Iterator[tuple[Ints, Ints]]: ...

    # the same without the factor

    @abstractmethod
    def _vectors(self, positions: Ints, transform: Floats) -> Floats: ...

    @abstractmethod
    def _resultant(self, origin: Floats) -> Floats: ...

    @abstractmethod
    def _gross(self, size: float) -> float: ...
