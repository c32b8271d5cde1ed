"""Strains and curvatures that come without stress: of temperature, or as they are given."""

from __future__ import annotations

from dataclasses import field
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.scene.load import Load, Name
from kshell.scene.places import (
    MappedScalar,
    On,
    ScalarExpansion,
    VectorValue,
)
from kshell.values.validation import Flag, described
from kshell.values.varying import is_constant, values_at


@described("load temperature")
class Temperature(Load):
    """A temperature change that varies linearly through the thickness.

    Materials have an `expansion`; one that is given here goes before it.

    Attributes
    ----------
    mean : scalar [temperature]
        Change at the mesh, the middle without an offset; a plate that is free to stretch does not feel it, unless its
        layers expand differently.
    gradient : scalar [temperature / length]
        Change per length along +z: (T_top - T_bottom) / thickness.
    expansion : scalar or [a1, a2], optional [1 / temperature]
        Coefficient of thermal expansion, strain per temperature; two along the axes of the material. That of the
        materials if absent.

    Examples
    --------
    ```toml
    [[load]]
    kind = "temperature"
    mean = 30
    gradient = 500
    expansion = 1.2e-5
    ```
    """

    kind: ClassVar[str] = "temperature"
    scaling: ClassVar[tuple[str, ...]] = ("mean", "gradient")
    mean: MappedScalar = 0.0
    gradient: MappedScalar = 0.0
    expansion: ScalarExpansion = None
    on: On | None = None
    fixed: Flag = False
    name: Name = field(default="", kw_only=True)

    def values(self, key: str, points: ArrayLike) -> NDArray[np.float64]:
        """Mean or gradient (...) at points (..., 3)."""
        return values_at(getattr(self, key), points, what=f"{self}, {key}")

    def expansions(
        self, points: ArrayLike
    ) -> list[tuple[NDArray[np.float64] | float, tuple[float, float] | None]]:
        """Whose sum the expansion is: numbers (...) at points (..., 3) times expansions along both axes.

        None is that of the materials.
        """
        what = f"{self}, expansion"
        if self.expansion is None:
            return [(1.0, None)]
        if not isinstance(self.expansion, tuple):
            return [(values_at(self.expansion, points, what=what), (1.0, 1.0))]
        first, second = (values_at(a, points, what=what) for a in self.expansion)
        return [(first, (1.0, 0.0)), (second, (0.0, 1.0))]

    def require_finite(self, points: ArrayLike) -> None:
        for key in ("mean", "gradient"):
            self.values(key, points)
        self.expansions(points)

    def stretches(self, points: ArrayLike) -> str:
        return "" if is_constant(self.mean) and self.mean == 0.0 else "stretches it"


@described("load initial_curvature")
class InitialCurvature(Load):
    """Curvature (w_xx, w_yy, w_xy) that the plate takes up without moments.

    Attributes
    ----------
    value : vector [1 / length]
        The three of them.

    Examples
    --------
    ```toml
    [[load]]
    kind = "initial_curvature"
    value = [0.001, 0.001, 0]
    ```
    """

    kind: ClassVar[str] = "initial_curvature"
    components: ClassVar[int | None] = 3
    value: VectorValue
    on: On | None = None
    fixed: Flag = False
    name: Name = field(default="", kw_only=True)

    def curvature_at(self, points: ArrayLike) -> NDArray[np.float64]:
        """Stress-free (w_xx, w_yy, w_xy) at points (..., 3)."""
        return self.at(points)

    def stretches(self, points: ArrayLike) -> str:
        return ""


@described("load initial_strain")
class InitialStrain(Load):
    """Strain of the middle surface (E_11, E_22, E_12) that a shell takes up without stress; E_12 is half the shear.

    In the frame of the results: e_1 is the projection of the global x (of y where x is normal).

    Attributes
    ----------
    value : vector [1]
        The three of them.

    Examples
    --------
    ```toml
    [[load]]
    kind = "initial_strain"
    value = [1e-4, 1e-4, 0]
    ```
    """

    kind: ClassVar[str] = "initial_strain"
    components: ClassVar[int | None] = 3
    value: VectorValue
    on: On | None = None
    fixed: Flag = False
    name: Name = field(default="", kw_only=True)

    def stretches(self, points: ArrayLike) -> str:
        return "stretches it"
