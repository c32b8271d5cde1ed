"""Intervals around eigenvalues, and what is known about all that were asked for."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Interval:
    """Of one eigenvalue; None where nothing is known."""

    lower: float | None
    upper: float | None
    kind: Literal["guaranteed", "estimated", "none"]


NOTHING = Interval(None, None, "none")


@dataclass
class Known:
    """What is known about all of them.

    Attributes
    ----------
    of : list of Interval
    why_not : str
        Why a tolerance is not reached.
    levels : list of dict
        Meshes that a tolerance took.
    misfit : (triangle,) array, optional
        Where the width of the intervals comes from.
    shape : float, optional
        Share of the first value by which the shape of the mesh widens them.
    """

    of: list[Interval]
    reasons: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    why_not: str = ""
    levels: list[dict[str, Any]] = field(default_factory=list)
    misfit: Floats | None = None
    shape: float | None = None

    @property
    def kind(self) -> str:
        """The weakest of all."""
        kinds = {interval.kind for interval in self.of}
        return next((kind for kind in ("none", "estimated", "guaranteed") if kind in kinds), "none")

    @property
    def width(self) -> float | None:
        """Largest width, relative to the size of the eigenvalue; None where one is not known."""
        widths = []
        for i in self.of:
            if i.lower is None or i.upper is None:
                return None
            widths.append((i.upper - i.lower) / max(abs(i.upper), abs(i.lower), 1e-300))
        return max(widths, default=None)

    def only(self, count: int) -> Known:
        """The first ones."""
        return replace(self, of=self.of[:count])


def unknown(count: int) -> Known:
    """Nothing known about so many."""
    return Known([NOTHING] * count)


def apart(values: Floats, other: Floats, wider: float = 1.0) -> list[Interval]:
    """Estimated: as far to both sides as the value of the same sign and rank in another answer is away.

    Parameters
    ----------
    values, other : arrays
        In the order of their size; None where the other answer has no such value.
    wider : float
        By which the distance is taken.
    """
    out = []
    for k, value in enumerate(values.tolist()):
        rank = int(np.sum(np.sign(values[:k]) == np.sign(value)))
        same = other[np.sign(other) == np.sign(value)]
        if rank >= len(same):
            out.append(NOTHING)
            continue
        half = wider * abs(value - float(same[rank]))
        out.append(Interval(value - half, value + half, "estimated"))
    return out
