"""What acts on a plate or shell: on curves and at points; and all loads by kind."""

from __future__ import annotations

from dataclasses import field
from typing import Any, ClassVar

from numpy.typing import ArrayLike

from kshell.scene.area_loads import Gravity, Pressure, Snow, Traction
from kshell.scene.free_strains import InitialCurvature, InitialStrain, Temperature
from kshell.scene.load import NEGLIGIBLE, Load, Name, exceeds
from kshell.scene.placed_pressures import Disc, Hydrostatic, PlacedPressure, Rectangle
from kshell.scene.places import (
    On,
    ScalarValue,
    VectorValue,
)
from kshell.values.validation import Flag, described

__all__ = [
    "LOADS",
    "NEGLIGIBLE",
    "Disc",
    "EdgeMoment",
    "Gravity",
    "Hydrostatic",
    "InitialCurvature",
    "InitialStrain",
    "LineForce",
    "Load",
    "Name",
    "PlacedPressure",
    "PointForce",
    "PointMoment",
    "Pressure",
    "Rectangle",
    "Snow",
    "Temperature",
    "Traction",
    "exceeds",
]


@described("load line_force")
class LineForce(Load):
    """Force per length along curves, a vector.

    Attributes
    ----------
    on : str, tuple of str or (x, y, z)
        The curves it acts along.
    value : vector [force / length]
        Its x, y and z.

    Examples
    --------
    ```toml
    [[load]]
    kind = "line_force"
    on = "rim"
    value = [0, 0, -200]
    ```
    """

    kind: ClassVar[str] = "line_force"
    dimensions: ClassVar[tuple[int, ...]] = (1,)
    components: ClassVar[int | None] = 3
    on: On
    value: VectorValue
    fixed: Flag = False
    name: Name = field(default="", kw_only=True)


@described("load edge_moment")
class EdgeMoment(Load):
    """Bending moment per length on an edge: positive puts the face z = +t/2 in tension.

    Attributes
    ----------
    on : str, tuple of str or (x, y, z)
        The curves it acts along.
    value : scalar [force]
        Moment per length.

    Examples
    --------
    ```toml
    [[load]]
    kind = "edge_moment"
    on = "right"
    value = 50
    ```
    """

    kind: ClassVar[str] = "edge_moment"
    dimensions: ClassVar[tuple[int, ...]] = (1,)
    on: On
    value: ScalarValue
    fixed: Flag = False
    name: Name = field(default="", kw_only=True)


@described("load point_force")
class PointForce(Load):
    """Force at a point, a vector.

    Attributes
    ----------
    on : str, tuple of str or (x, y, z)
        A group of points, several, or the nearest vertex.
    value : vector [force]
        Its x, y and z.

    Examples
    --------
    ```toml
    [[load]]
    kind = "point_force"
    on = [0.75, 0.5, 0]
    value = [0, 0, -500]
    ```
    """

    kind: ClassVar[str] = "point_force"
    dimensions: ClassVar[tuple[int, ...]] = (0,)
    components: ClassVar[int | None] = 3
    on: On
    value: VectorValue
    fixed: Flag = False
    name: Name = field(default="", kw_only=True)


@described("load point_moment")
class PointMoment(Load):
    """Moment vector at a point.

    Attributes
    ----------
    on : str, tuple of str or (x, y, z)
        A group of points, several, or the nearest vertex.
    value : vector [force * length]
        About x, y and z.

    Examples
    --------
    ```toml
    [[load]]
    kind = "point_moment"
    on = "hub"
    value = [0, 120, 0]
    ```
    """

    kind: ClassVar[str] = "point_moment"
    dimensions: ClassVar[tuple[int, ...]] = (0,)
    components: ClassVar[int | None] = 3
    on: On
    value: VectorValue
    fixed: Flag = False
    name: Name = field(default="", kw_only=True)

    def stretches(self, points: ArrayLike) -> str:
        value = self.at(points)
        return "turns it in its plane" if exceeds(value[:, 2], value) else ""


LOADS: dict[str, type[Any]] = {
    cls.kind: cls
    for cls in (
        Pressure,
        Traction,
        Snow,
        Hydrostatic,
        Disc,
        Rectangle,
        Gravity,
        LineForce,
        EdgeMoment,
        PointForce,
        PointMoment,
        Temperature,
        InitialCurvature,
        InitialStrain,
    )
}
