"""Masses that are added to those of the material: machines, paint, fittings."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.errors import InputError
from kshell.mesh.words import shown
from kshell.scene.places import On, ScalarValue, on_words
from kshell.values.validation import described
from kshell.values.varying import is_constant, values_at

Floats = NDArray[np.float64]


@described("mass")
class Mass:
    """A mass without stiffness: at points, per length on curves, per area on surfaces.

    It moves with the middle surface and has no inertia against turning of its own.

    Attributes
    ----------
    on : str, tuple of str, or (x, y, z)
        A group, several groups, or the nearest mesh vertex.
    value : scalar [mass at points, mass / length on curves, mass / length^2 on surfaces]
        How much, > 0.

    Examples
    --------
    ```toml
    [[mass]]
    on = "motor"
    value = 40
    ```
    """

    dimensions: ClassVar[tuple[int, ...]] = (0, 1, 2)
    scaling: ClassVar[tuple[str, ...]] = ()
    on: On
    value: ScalarValue

    def __post_init__(self) -> None:
        if is_constant(self.value) and not self.value > 0.0:
            raise InputError(f"mass: value = {self.value:g} must be > 0")

    def at(self, points: ArrayLike) -> Floats:
        """(...) mass at points (..., 3), not negative.

        Raises
        ------
        InputError
            If it is negative somewhere.
        """
        mass = values_at(self.value, points, what=str(self))
        if mass.size and mass.min() < 0.0:
            x, y, z = np.asarray(points, float).reshape(-1, 3)[mass.argmin()]
            raise InputError(
                f"{self}: {shown(self.value)} is {mass.min():g} at ({x:.6g}, {y:.6g}, {z:.6g}): it must not be negative"
            )
        return mass

    def require_finite(self, points: ArrayLike) -> None:
        """Raise InputError if it has no finite value at some of the points (n, 3)."""
        self.at(points)

    def __str__(self) -> str:
        return f"mass {on_words(self.on)}"
