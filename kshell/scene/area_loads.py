"""Loads on surfaces: pressures, tractions, what lies and stands on them, and weight."""

from __future__ import annotations

from dataclasses import field
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.errors import InputError
from kshell.scene.load import Load, Name
from kshell.scene.places import (
    On,
    SurfaceScalar,
    SurfaceVector,
    VectorValue,
)
from kshell.values.validation import Flag, described
from kshell.values.varying import values_at


@described("load pressure")
class Pressure(Load):
    """Force per area along the normal, positive along +z on a plate.

    Attributes
    ----------
    value : scalar [force / length^2]
        Along the normal; against it where negative. A field of a file keeps the integral it has there.
    follower : bool
        Whether it turns with the surface under large deflections.

    Examples
    --------
    ```toml
    [[load]]
    name = "wind"
    kind = "pressure"
    value = "-800*(1 + y)*max(nx, 0)"      # nx, ny, nz: the unit normal
    on = "roof"
    follower = true
    fixed = true
    ```
    """

    kind: ClassVar[str] = "pressure"
    value: SurfaceScalar
    on: On | None = None
    follower: Flag = False
    fixed: Flag = False
    name: Name = field(default="", kw_only=True)

    def stretches(self, points: ArrayLike) -> str:
        return "follows the surface" if self.follower else ""


@described("load traction")
class Traction(Load):
    """Force per area, a vector.

    Attributes
    ----------
    value : vector [force / length^2]
        Its x, y and z.

    Examples
    --------
    ```toml
    [[load]]
    kind = "traction"
    value = [0, 0, "-1500*cos(pi*x)"]
    ```
    """

    kind: ClassVar[str] = "traction"
    components: ClassVar[int | None] = 3
    value: SurfaceVector
    on: On | None = None
    fixed: Flag = False
    name: Name = field(default="", kw_only=True)


@described("load snow")
class Snow(Load):
    """Force per area of the plan, downwards along -z: what lies on a slope, seen from above.

    Attributes
    ----------
    value : scalar [force / length^2]
        Per area of the projection on a plane of constant z; positive.

    Examples
    --------
    ```toml
    [[load]]
    name = "snow"
    kind = "snow"
    on = "roof"
    value = "1500 if nz > 0.5 else 0"
    ```
    """

    kind: ClassVar[str] = "snow"
    value: SurfaceScalar
    on: On | None = None
    fixed: Flag = False
    name: Name = field(default="", kw_only=True)
    components: ClassVar[int | None] = 3
    needs_normal: ClassVar[bool] = True

    def at(self, points: ArrayLike) -> NDArray[np.float64]:
        x = np.asarray(points, dtype=float)
        weight = values_at(self.value, x, what=str(self))
        if (weight < 0.0).any():
            raise InputError(
                f"{self}: the value is negative somewhere: snow lies on the surface, it does not lift"
            )
        return weight[..., None] * np.abs(x[..., 5:6]) * np.array([0.0, 0.0, -1.0])


@described("load gravity")
class Gravity(Load):
    """Acceleration, a vector; the material needs a density.

    Attributes
    ----------
    value : vector [length / time^2]
        Its x, y and z.

    Examples
    --------
    ```toml
    [[load]]
    kind = "gravity"
    value = [0, 0, -9.81]
    ```
    """

    kind: ClassVar[str] = "gravity"
    components: ClassVar[int | None] = 3
    value: VectorValue
    on: On | None = None
    fixed: Flag = False
    name: Name = field(default="", kw_only=True)
