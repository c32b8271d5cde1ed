"""Pressures whose value says where they act: liquids at rest, and discs and rectangles that may move."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import field
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BeforeValidator, WithJsonSchema

from kshell.errors import InputError
from kshell.scene.load import Load, Name
from kshell.scene.places import CentreValue, On, ScalarValue
from kshell.values import kinds
from kshell.values.time import depends_on_time
from kshell.values.validation import Flag, Number, described
from kshell.values.varying import show, values_at

Floats = NDArray[np.float64]

NEIGHBOURS = 8  # vertices around the centre, whose distances are those of the mesh there
ENOUGH = 1.0  # size over these distances from which the mesh tells where a patch is


class PlacedPressure(Load):
    """A pressure along the normal that is given by other words than its value."""

    follower: bool

    @property
    def value(self) -> Any:
        """Of the pressure: a function of the place."""
        return self.at

    def stretches(self, points: ArrayLike) -> str:
        return "follows the surface" if self.follower else ""


@described("load hydrostatic")
class Hydrostatic(PlacedPressure):
    """Pressure of a liquid at rest along the normal: its weight per volume times the depth below its level.

    Attributes
    ----------
    weight : number [force / length^3]
        Per volume; negative where the liquid stands on the side the normal points to, which it pushes away from.
    level : number or expression [length]
        The z of its surface; above it there is no pressure.
    follower : bool
        Whether it turns with the surface under large deflections; the depth is that of the undeformed place.

    Examples
    --------
    ```toml
    [[load]]
    kind = "hydrostatic"
    on = "wall"
    weight = 9810
    level = 4.0
    follower = true
    ```
    """

    kind: ClassVar[str] = "hydrostatic"
    scaling: ClassVar[tuple[str, ...]] = ("weight",)
    placing: ClassVar[tuple[str, ...]] = ("level",)
    weight: ScalarValue
    level: ScalarValue
    on: On | None = None
    fixed: Flag = False
    follower: Flag = False
    name: Name = field(default="", kw_only=True)

    def at(self, points: ArrayLike) -> Floats:
        x = np.asarray(points, dtype=float)
        depth = values_at(self.level, x, what=f"{self}, level") - x[..., 2]
        return values_at(self.weight, x, what=f"{self}, weight") * np.maximum(depth, 0.0)


class Patch(PlacedPressure):
    """A pressure on a patch around a centre, which may move in time."""

    extent: ClassVar[tuple[str, ...]] = ()
    pressure: Any
    centre: Any

    @property
    def where(self) -> str:
        around = f"around {show(self.centre)}"
        return around if self.on is None else f"{around} {super().where}"

    @property
    def amount(self) -> str:
        return ", ".join(f"{key} {show(getattr(self, key))}" for key in (*self.scaling, *self.extent))

    @abstractmethod
    def outline(self) -> Floats:
        """(n, 3) places on its rim in the plan, one after the other and closed; numbers must stand in the centre."""

    @abstractmethod
    def _inside(self, step: Floats) -> NDArray[np.bool_]:
        """Whether places (..., 3) less the centre are in the patch."""

    @property
    @abstractmethod
    def _narrowest(self) -> float:
        """The smallest distance from the centre to the rim."""

    def at(self, points: ArrayLike) -> Floats:
        x = np.asarray(points, dtype=float)[..., :3]
        return np.where(self._inside(x - self._at(x)), values_at(self.pressure, x, what=str(self)), 0.0)

    def _at(self, x: Floats) -> Floats:
        """(3,) the centre."""
        origin = np.zeros((1, 3))
        centre: Floats = values_at(self.centre, origin, 3, what=f"{self}, centre")[0]
        return centre

    def require_finite(self, points: ArrayLike) -> None:
        """Raise InputError for a value that is not finite, and for a patch that falls between the vertices."""
        x = np.asarray(points, dtype=float)[..., :3].reshape(-1, 3)
        self.at(x)
        centre = self._at(x)
        if len(x) < 2 or ((centre < x.min(axis=0)) | (centre > x.max(axis=0))).any():
            return  # beside the surface, as a wheel before it comes
        from scipy.spatial import cKDTree

        tree = cKDTree(x)
        _, around = tree.query(centre, min(NEIGHBOURS, len(x)))
        apart = float(np.median(tree.query(x[around], 2)[0][:, 1]))
        if self._narrowest < ENOUGH * apart:
            raise InputError(
                f"{self}: it reaches {self._narrowest:g} from its centre, vertices there are {apart:.3g} apart: the "
                "mesh cannot tell where it presses; refine the mesh there, or use a point_force"
            )


def _positive(value: Any) -> Any:
    if isinstance(value, bool) or not isinstance(value, int | float | np.number) or not 0.0 < value < np.inf:
        raise ValueError("must be a positive number")
    return float(value)


def _sides(value: Any) -> Any:
    parts = list(value) if isinstance(value, list | tuple | np.ndarray) else []
    if len(parts) != 2:
        raise ValueError("must be two positive numbers [a, b]")
    return tuple(_positive(part) for part in parts)


Length = Annotated[Any, BeforeValidator(_positive), WithJsonSchema(kinds.NUMBER)]
Sides = Annotated[Any, BeforeValidator(_sides), WithJsonSchema(kinds.listed(kinds.NUMBER, 2, 2))]


@described("load disc")
class Disc(Patch):
    """Pressure along the normal on all that is nearer to a centre than a radius: a disc, which may move in a motion.

    Attributes
    ----------
    pressure : scalar [force / length^2]
        Along the normal; against it where negative.
    centre : point [length]
        Numbers, or in a motion expressions in t; z = 0 where it is left out.
    radius : number [length]
        Not less than the distance of neighbouring vertices.
    follower : bool
        Whether it turns with the surface under large deflections.

    Examples
    --------
    ```toml
    [[load]]
    name = "wheel"
    kind = "disc"
    on = "deck"
    pressure = "-5000/(pi*0.1**2)"
    centre = ["2*t", 0.5, 0]
    radius = 0.1
    ```
    """

    kind: ClassVar[str] = "disc"
    scaling: ClassVar[tuple[str, ...]] = ("pressure",)
    placing: ClassVar[tuple[str, ...]] = ("centre",)
    extent: ClassVar[tuple[str, ...]] = ("radius",)
    pressure: ScalarValue
    centre: CentreValue
    radius: Length
    on: On | None = None
    fixed: Flag = False
    follower: Flag = False
    name: Name = field(default="", kw_only=True)

    def __post_init__(self) -> None:
        _require_place(self)

    def _inside(self, step: Floats) -> NDArray[np.bool_]:
        return np.asarray((step**2).sum(axis=-1) <= self.radius**2)

    def outline(self) -> Floats:
        turn = np.linspace(0.0, 2.0 * np.pi, 73)
        rim = self.radius * np.stack([np.cos(turn), np.sin(turn), 0.0 * turn], axis=1)
        return np.asarray(self._at(rim) + rim)

    @property
    def _narrowest(self) -> float:
        return float(self.radius)


@described("load rectangle")
class Rectangle(Patch):
    """Pressure along the normal on a rectangle in the plan, seen along z, which may move in a motion.

    Attributes
    ----------
    pressure : scalar [force / length^2]
        Along the normal; against it where negative.
    centre : point [length]
        Numbers, or in a motion expressions in t; its z does not matter, and may be left out.
    size : list of 2 numbers [length]
        Of its sides a along x and b along y, before it is turned.
    angle : number [degrees]
        By which it is turned about z.
    follower : bool
        Whether it turns with the surface under large deflections.

    Examples
    --------
    ```toml
    [[load]]
    kind = "rectangle"
    pressure = -2000
    centre = [0.6, 0.5]
    size = [0.4, 0.3]
    angle = 30
    ```
    """

    kind: ClassVar[str] = "rectangle"
    scaling: ClassVar[tuple[str, ...]] = ("pressure",)
    placing: ClassVar[tuple[str, ...]] = ("centre",)
    extent: ClassVar[tuple[str, ...]] = ("size", "angle")
    pressure: ScalarValue
    centre: CentreValue
    size: Sides
    angle: Number = 0.0
    on: On | None = None
    fixed: Flag = False
    follower: Flag = False
    name: Name = field(default="", kw_only=True)

    def __post_init__(self) -> None:
        _require_place(self)

    def _inside(self, step: Floats) -> NDArray[np.bool_]:
        c, s = np.cos(np.radians(self.angle)), np.sin(np.radians(self.angle))
        along, across = c * step[..., 0] + s * step[..., 1], c * step[..., 1] - s * step[..., 0]
        return np.asarray((np.abs(along) <= 0.5 * self.size[0]) & (np.abs(across) <= 0.5 * self.size[1]))

    def outline(self) -> Floats:
        c, s = np.cos(np.radians(self.angle)), np.sin(np.radians(self.angle))
        a, b = (0.5 * side for side in self.size)
        x, y = np.array([[-a, a, a, -a, -a], [-b, -b, b, b, -b]])
        rim = np.stack([c * x - s * y, s * x + c * y, 0.0 * x], axis=1)
        return np.asarray(self._at(rim) + rim)

    @property
    def _narrowest(self) -> float:
        return float(min(self.size)) / 2.0


def _require_place(load: Any) -> None:
    """A centre is one place: numbers, or formulas in t alone."""
    if callable(load.centre):
        raise InputError(f"{load}: centre must be two or three numbers, or expressions in t")
    for part in load.centre:
        if isinstance(part, str) and not depends_on_time(part):
            try:
                values_at(part, np.full((1, 3), np.nan), what=str(load))
            except InputError:
                raise InputError(
                    f'{load}: centre has "{part}": it is one place, numbers or expressions in t, not in x, y, z'
                ) from None
