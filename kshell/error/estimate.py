"""A value and how far it can be from the truth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Estimate:
    """A value with its interval.

    Attributes
    ----------
    value : float
        Middle of the interval.
    half_width : float
        The exact value of the model lies within value +- half_width: proved where kind is "guaranteed".
    expected : float
        The size the error of ``value`` is likely to have, at most ``half_width``.
    kind : "guaranteed" or "estimated"
    why_not : str
        What is missing for a proof; empty where there is one.
    """

    value: float
    half_width: float
    expected: float
    kind: Literal["guaranteed", "estimated"]
    why_not: str = ""

    @property
    def lower(self) -> float:
        """Lower end of the interval."""
        return self.value - self.half_width

    @property
    def upper(self) -> float:
        """Upper end of the interval."""
        return self.value + self.half_width

    def contains(self, value: float) -> bool:
        """Whether a value lies in the interval."""
        return abs(value - self.value) <= self.half_width
