"""How a plate or shell is held, by name.

Freedoms are letters: x, y, z are translations, r is the rotation about the edge.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import field
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import WithJsonSchema

from kshell.errors import InputError
from kshell.mesh.words import shown
from kshell.scene.places import On, Place, PlacePoint, ScalarOrVector, ScalarValue, on_words
from kshell.values import kinds
from kshell.values.validation import Flag, described
from kshell.values.varying import is_constant, values_at

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


@described("support clamped")
class Clamped(Support):
    """No translation and no rotation about the edge; `value` prescribes a translation.

    On shells, where the translations are those of a rigid body, the edges turn with it.

    Examples
    --------
    ```toml
    [[support]]
    on = "left"
    kind = "clamped"
    ```
    """

    kind: ClassVar[str] = "clamped"
    on: On
    value: ScalarOrVector | None = None
    freedoms: str = field(default=FREEDOMS, init=False, repr=False)
    fixed: Flag = False


@described("support simply_supported")
class SimplySupported(Support):
    """No translation, rotation free; along an edge of a plate the hard kind, w = 0 all along.

    Examples
    --------
    ```toml
    [[support]]
    on = ["bottom", "top"]
    kind = "simply_supported"
    value = [0, 0, -0.002]
    fixed = true
    ```
    """

    kind: ClassVar[str] = "simply_supported"
    on: On
    value: ScalarOrVector | None = None
    freedoms: str = field(default="xyz", init=False, repr=False)
    fixed: Flag = False


@described("support soft_supported")
class SoftSupported(SimplySupported):
    """As simply_supported, but the twist about the normal of the edge is not held either.

    The theory does not tell the two apart (w = 0 along an edge holds its twist): both have the same solution. In a
    plate that shears they differ, which the shear entry of the error budget tells.

    Examples
    --------
    ```toml
    [[support]]
    on = "top"
    kind = "soft_supported"
    ```
    """

    kind: ClassVar[str] = "soft_supported"
    on: On
    value: ScalarOrVector | None = None
    freedoms: str = field(default="xyz", init=False, repr=False)
    fixed: Flag = False


@described("support symmetry")
class Symmetry(Support):
    """A plane of symmetry: no translation across it and no rotation about the edge.

    Examples
    --------
    ```toml
    [[support]]
    on = "middle"
    kind = "symmetry"
    ```
    """

    kind: ClassVar[str] = "symmetry"
    dimensions: ClassVar[tuple[int, ...]] = (1,)
    on: On
    freedoms: str = field(default="r", init=False, repr=False)


@described("support free")
class Free(Support):
    """Nothing is held: only says so.

    Examples
    --------
    ```toml
    [[support]]
    on = "right"
    kind = "free"
    ```
    """

    kind: ClassVar[str] = "free"
    on: On
    freedoms: str = field(default="", init=False, repr=False)


@described("support hinge")
class Hinge(Support):
    """A hinge line of a shell: the sheets that meet there turn freely about it, nothing else is released.

    Examples
    --------
    ```toml
    [[support]]
    on = "seam"
    kind = "hinge"
    ```
    """

    kind: ClassVar[str] = "hinge"
    dimensions: ClassVar[tuple[int, ...]] = (1,)
    on: On
    freedoms: str = field(default="", init=False, repr=False)


@described("support rigid_link")
class RigidLink(Support):
    """Ties curves or surfaces of a shell to a point: all move as one rigid body, of small turns.

    Point forces and moments, `Clamped` and `Fixed` may be on its name: they act on the point.

    Attributes
    ----------
    to : (x, y, z) [length]
        The point.
    name : str
        Of the point, for loads and supports on it.

    Examples
    --------
    ```toml
    [[support]]
    on = "rim"
    kind = "rigid_link"
    to = [0, 0, 1]
    name = "hub"
    ```
    """

    kind: ClassVar[str] = "rigid_link"
    dimensions: ClassVar[tuple[int, ...]] = (1, 2)
    on: On
    to: PlacePoint
    name: str = ""
    freedoms: str = field(default="", init=False, repr=False)


@described("support fixed")
class Fixed(Support):
    """Exact freedoms, letters of "xyzr", with an optional prescribed translation and rotation.

    `value` is a vector (x, y, z), or a scalar for z; a function may return either. `axes`, on shells, are three
    vectors at right angles that x, y and z of the letters then mean; `value` stays in global components. `rotation` is
    about boundary edges, with r among the freedoms; > 0 turns as a positive edge moment.

    Attributes
    ----------
    axes : (3, 3), optional [1]
        Directions that x, y and z of the letters mean; the global ones if absent.

    Examples
    --------
    ```toml
    [[support]]
    on = "left"
    fix = "xzr"
    value = [0, 0, "0.001*y"]
    axes = [[1, 1, 0], [-1, 1, 0], [0, 0, 1]]
    fixed = true

    [[support]]
    on = "right"
    fix = "zr"
    rotation = "0.1*sin(pi*y)"
    ```
    """

    kind: ClassVar[str] = "fixed"
    scaling: ClassVar[tuple[str, ...]] = ("value", "rotation")
    on: On
    freedoms: str = FREEDOMS
    value: ScalarOrVector | None = None
    axes: Axes = None
    fixed: Flag = False
    rotation: ScalarValue | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        object.__setattr__(self, "freedoms", checked_freedoms(self.freedoms, "fixed"))
        if self.rotation is not None and is_constant(self.rotation) and self.rotation == 0.0:
            object.__setattr__(self, "rotation", None)
        if self.rotation is not None and "r" not in self.freedoms:
            raise InputError(
                f'support fixed: rotation = {shown(self.rotation)}, but "{self.freedoms}" does not hold the rotation: '
                f'add r, fix = "{self.freedoms}r", or leave rotation out'
            )
        if self.axes is None:
            _require_matching_value(self.freedoms, self.value)
        else:
            object.__setattr__(self, "axes", _checked_axes(self.axes, "fixed"))


@described("support elastic")
class Elastic(Support):
    """Springs: stiffness per area on surfaces (Winkler), per length on curves, plain at points.

    A rotation spring ("r") has stiffness moment per radian and length; "n" is along the normal of the surface.
    `axes` are three vectors at right angles that x, y and z of the letters then mean.

    Attributes
    ----------
    stiffness : scalar [force / length^3 on surfaces, force / length^2 on curves, force / length at points]
        Of every freedom; rotation springs of curves have force, at points force * length.
    freedoms : str
        Letters of "xyzrn": translations, rotation about the edge, and the normal.
    axes : (3, 3), optional [1]
        Directions that x, y and z of the letters mean; the global ones if absent.

    Examples
    --------
    ```toml
    [[support]]
    on = "ground"
    stiffness = 5e7
    freedoms = "xyz"
    axes = [[1, 0, 1], [0, 1, 0], [-1, 0, 1]]
    ```
    """

    kind: ClassVar[str] = "elastic"
    on: On
    stiffness: ScalarValue
    freedoms: str = "z"
    axes: Axes = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "freedoms", checked_freedoms(self.freedoms, "elastic", SPRINGS))
        if self.axes is not None:
            object.__setattr__(self, "axes", _checked_axes(self.axes, "elastic"))
        if is_constant(self.stiffness) and not self.stiffness > 0.0:
            raise InputError(f"support elastic: stiffness = {self.stiffness:g} must be > 0")

    def directions(self) -> list[str | NDArray[np.float64]]:
        """What its letters mean: "r", "n", or unit vectors (3,)."""
        axes = np.eye(3) if self.axes is None else np.array(self.axes)
        return [letter if letter in "rn" else axes["xyz".index(letter)] for letter in self.freedoms]

    def require_finite(self, points: ArrayLike) -> None:
        self.stiffness_at(points)

    def stiffness_at(self, points: ArrayLike) -> NDArray[np.float64]:
        """(...) stiffness at points (..., 3), not negative.

        Raises
        ------
        InputError
            If it is negative somewhere.
        """
        stiffness = values_at(self.stiffness, points, what=str(self))
        if stiffness.size and stiffness.min() < 0.0:
            x, y, z = np.asarray(points, float).reshape(-1, 3)[stiffness.argmin()]
            raise InputError(
                f"{self}: stiffness {shown(self.stiffness)} is {stiffness.min():g} at "
                f"({x:.6g}, {y:.6g}, {z:.6g}): it must not be negative"
            )
        return stiffness


def checked_freedoms(freedoms: str, kind: str, known: str = FREEDOMS) -> str:
    """The letters in the order of the known ones, each once."""
    wrong = [letter for letter in freedoms if letter not in known]
    if wrong or not freedoms or len(set(freedoms)) < len(freedoms):
        raise InputError(
            f'support {kind}: freedoms "{freedoms}" must be different letters of "{known}" '
            f"(x y z translations, r rotation about the edge{', n along the normal' if 'n' in known else ''})"
        )
    return "".join(letter for letter in known if letter in freedoms)


def _checked_axes(axes: Any, kind: str) -> tuple[tuple[float, ...], ...]:
    """Three unit vectors at right angles, as given up to their lengths."""
    try:
        rows = np.array(axes, dtype=float)
    except (TypeError, ValueError):
        rows = np.zeros(0)
    if rows.shape != (3, 3) or not np.isfinite(rows).all() or not np.linalg.norm(rows, axis=1).all():
        raise InputError(
            f"support {kind}: axes = {shown(axes)}: must be three vectors, [[1, 0, 0], [0, 1, 0], [0, 0, 1]]"
        )
    rows /= np.linalg.norm(rows, axis=1, keepdims=True)
    skew = np.abs(rows @ rows.T - np.eye(3)).max()
    if skew > 1e-6:
        raise InputError(
            f"support {kind}: axes are not at right angles to each other (cosine up to {skew:.2g}): "
            "give vectors that are"
        )
    return tuple(map(tuple, rows.tolist()))


def _require_matching_value(freedoms: str, value: Any) -> None:
    """A translation can only be prescribed where it is held."""
    if value is None or callable(value):
        return
    vector = value if isinstance(value, tuple) else (0.0, 0.0, value)
    for axis, part in zip("xyz", vector, strict=True):
        if axis not in freedoms and not (is_constant(part) and part == 0.0):
            raise InputError(
                f'support fixed: value prescribes a translation along {axis}, which "{freedoms}" does '
                f"not hold: add {axis} to the freedoms or make that component 0"
            )


SUPPORTS: dict[str, type[Any]] = {
    cls.kind: cls
    for cls in (Clamped, SimplySupported, SoftSupported, Symmetry, Free, Hinge, RigidLink, Fixed, Elastic)
}
