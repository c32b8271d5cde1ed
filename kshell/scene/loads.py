"""What acts on a plate or shell. Values are numbers, expressions in x, y, z, or functions of the place."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import field, fields
from functools import partial
from typing import Annotated, Any, ClassVar, Self, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BeforeValidator

from kshell.errors import InputError
from kshell.scene.places import (
    MappedScalar,
    On,
    Place,
    ScalarExpansion,
    ScalarValue,
    SurfaceScalar,
    SurfaceVector,
    VectorValue,
    on_words,
)
from kshell.values.time import depends_on_normal
from kshell.values.validation import Flag, described
from kshell.values.varying import is_constant, values_at

# part of a load that is nothing but rounding
NEGLIGIBLE = 1e-12


def exceeds(part: NDArray[np.float64], whole: NDArray[np.float64]) -> bool:
    """Whether components of values are more than rounding of the largest."""
    return bool(np.abs(part).max(initial=0.0) > NEGLIGIBLE * np.abs(whole).max(initial=0.0))


class Load:
    """What all loads have in common.

    Attributes
    ----------
    kind : str
        The name in a scene file.
    on : str, tuple of str, (x, y, z) or None
        Where it acts: a group, several, or the nearest vertex; everywhere if absent.
    value : scalar or vector
    fixed : bool
        Whether it does not grow in buckling.
    name : str
        By which load cases know it.
    scaling : tuple of str
        The values that it grows with.
    placing : tuple of str
        Further values, that say where it is.
    components : int or None
        Length of the vector, None for a scalar.
    dimensions : tuple of int
        What it may be on: 0 points, 1 curves, 2 surfaces.
    """

    kind: ClassVar[str] = ""
    components: ClassVar[int | None] = None
    dimensions: ClassVar[tuple[int, ...]] = (2,)
    scaling: ClassVar[tuple[str, ...]] = ("value",)
    placing: ClassVar[tuple[str, ...]] = ()
    on: Place | None
    value: Any
    fixed: bool = False
    name: str = ""

    @property
    def needs_normal(self) -> bool:
        """Whether its values depend on the normal, so that `at` needs it beside the points."""
        return any(depends_on_normal(getattr(self, key, None)) for key in self.scaling)

    def at(self, points: ArrayLike) -> NDArray[np.float64]:
        """The value at points (..., 3), or (..., 6) with normals: (...) for a scalar, else (..., components)."""
        return values_at(self.value, points, self.components, what=str(self))

    def require_finite(self, points: ArrayLike) -> None:
        """Raise InputError if it has no finite value at some of the points (n, 3)."""
        self.at(points)

    def stretches(self, points: ArrayLike) -> str:
        """How it stretches a plate in its plane z = const, in words; empty if it only bends it.

        Parameters
        ----------
        points : (n, 3)
            Vertices of its place.
        """
        if self.components != 3:
            return ""
        value = self.at(points)
        return "acts in its plane" if exceeds(value[:, :2], value) else ""

    def times(self, factor: float) -> Self:
        """The same load times a factor."""
        if factor == 1.0:
            return self
        given = {f.name: getattr(self, f.name) for f in fields(cast(Any, self)) if f.init}
        given |= {key: _times(factor, given[key]) for key in self.scaling}
        return type(self)(**given)

    def __str__(self) -> str:
        named = f' "{self.name}"' if self.name else ""
        return f"load {self.kind}{named} {on_words(self.on)}"


def _times(factor: float, value: Any) -> Any:
    """A number, formula, function, or vector of them, times a factor."""
    if isinstance(value, str):
        return f"({factor!r}) * ({value})"
    if callable(value):
        return partial(_product, factor, value)
    if isinstance(value, tuple):
        return tuple(_times(factor, part) for part in value)
    return factor * value


def _product(factor: float, function: Callable[..., Any], *place: NDArray[np.float64]) -> Any:
    value = function(*place)
    return [factor * part for part in value] if isinstance(value, list | tuple) else factor * value


def _name(value: Any) -> Any:
    if not isinstance(value, str):
        raise ValueError("must be text")
    return value


Name = Annotated[str, BeforeValidator(_name)]
"""By which a load is known to load cases."""


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


@described("load hydrostatic")
class Hydrostatic(Load):
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

    @property
    def value(self) -> Any:
        """Of the pressure: a function of the place."""
        return self.at

    def at(self, points: ArrayLike) -> NDArray[np.float64]:
        x = np.asarray(points, dtype=float)
        depth = values_at(self.level, x, what=f"{self}, level") - x[..., 2]
        return values_at(self.weight, x, what=f"{self}, weight") * np.maximum(depth, 0.0)

    def stretches(self, points: ArrayLike) -> str:
        return "follows the surface" if self.follower else ""


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


@described("load line_force")
class LineForce(Load):
    """Force per length along curves, a vector.

    Attributes
    ----------
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


LOADS: dict[str, type[Any]] = {
    cls.kind: cls
    for cls in (
        Pressure,
        Traction,
        Snow,
        Hydrostatic,
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
