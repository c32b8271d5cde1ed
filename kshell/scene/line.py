"""A line along which values are reported."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, WithJsonSchema

from kshell.errors import InputError
from kshell.scene.places import PlacePoint
from kshell.values.validation import described


def _name(value: Any) -> Any:
    if not isinstance(value, str) or not value.strip():
        raise ValueError("must be text that is not empty")
    return value


def _points(value: Any) -> Any:
    if isinstance(value, bool) or not isinstance(value, int) or not 2 <= value <= 1_000_000:
        raise ValueError("must be a whole number of points from 2 to 1000000")
    return value


@described("line")
class Line:
    """Points at equal distances on the straight line from one place to another.

    Attributes
    ----------
    name : str
        By which its values are reported.
    start, end : (x, y, z) [length]
        Where it begins and ends; "from" and "to" in a scene file.
    n : int [1]
        Number of points, both ends among them.

    Examples
    --------
    ```toml
    [[line]]
    name = "middle"
    from = [0, 0.5, 0]
    to = [2, 0.5, 0]
    n = 41
    ```
    """

    name: Annotated[str, BeforeValidator(_name)]
    start: PlacePoint
    end: PlacePoint
    n: Annotated[int, BeforeValidator(_points), WithJsonSchema({"type": "integer", "minimum": 2})] = 101

    def __post_init__(self) -> None:
        if self.start == self.end:
            raise InputError(f'line "{self.name}": its ends are the same point: give two')

    def points(self) -> NDArray[np.float64]:
        """(n, 3)."""
        start, end = np.array(self.start), np.array(self.end)
        share = np.linspace(0.0, 1.0, self.n)[:, None]
        return (1.0 - share) * start + share * end
