"""What all supports have in common.

Freedoms are letters: x, y, z are translations, r is the rotation about the edge.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import WithJsonSchema

from kshell.scene.places import Place, on_words
from kshell.values import kinds
from kshell.values.varying import values_at

FREEDOMS = "xyzr"
SPRINGS = "xyzrn"  # of springs: n is the normal of the surface


# three vectors at right angles, or None
Axes = Annotated[Any, WithJsonSchema(kinds.matrix(3))]


class Support:
    """What all supports have in common.

    Attributes
    ----------
    on : str, tuple of str, or (x, y, z)
        A group, several groups, or the nearest mesh vertex.
    kind : str
        The name in a scene file.
    freedoms : str
        The freedoms that are held (or sprung): letters of x, y, z (translations) and r (rotation about the edge).
    value : scalar, vector or None [length]
        Prescribed translation: a vector, or a scalar for z; zero if absent.
    rotation : scalar or None [rad]
        Prescribed rotation about boundary edges: positive as a positive edge moment turns; zero if absent.
    fixed : bool
        Whether what is prescribed does not grow in buckling.
    dimensions : tuple of int
        What it may be on: 0 points, 1 curves, 2 surfaces.
    scaling : tuple of str
        Keys that a factor multiplies, and that may depend on the time t.
    """

    kind: ClassVar[str] = ""
    scaling: ClassVar[tuple[str, ...]] = ("value",)
    dimensions: ClassVar[tuple[int, ...]] = (0, 1, 2)
    on: Place
    freedoms: str
    value: Any = None
    rotation: Any = None
    fixed: bool = False

    @property
    def moves(self) -> bool:
        """Whether it prescribes a motion."""
        return self.value is not None or self.rotation is not None

    def translation_at(self, points: ArrayLike) -> NDArray[np.float64]:
        """Prescribed translation (..., 3) at points (..., 3); zero where nothing is prescribed."""
        points = np.asarray(points, dtype=float)
        result = np.zeros(points.shape)
        if self.value is None:
            return result
        if isinstance(self.value, tuple) or (callable(self.value) and _returns_vector(self.value, points)):
            return values_at(self.value, points, components=3, what=str(self))
        result[..., 2] = values_at(self.value, points, what=str(self))
        return result

    def rotation_at(self, points: ArrayLike) -> NDArray[np.float64]:
        """Prescribed rotation (...) at points (..., 3); zero where nothing is prescribed."""
        if self.rotation is None:
            return np.zeros(np.shape(points)[:-1])
        return values_at(self.rotation, points, what=f"{self}, rotation")

    def require_finite(self, points: ArrayLike) -> None:
        """Raise InputError if what it prescribes has no finite value at some of the points (n, 3)."""
        self.translation_at(points)
        self.rotation_at(points)

    def __str__(self) -> str:
        return f"support {self.kind} {on_words(self.on)}"


def _returns_vector(function: Callable[..., Any], points: NDArray[np.float64]) -> bool:
    """Whether a function of the place gives three components or one."""
    with np.errstate(all="ignore"):
        result = function(*points.reshape(-1, 3)[:1].T)
    return isinstance(result, tuple | list) or np.ndim(result) == 2
