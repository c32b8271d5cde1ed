"""Supports by their freedoms: held, moved, or on springs, along x, y, z or axes of their own."""

from __future__ import annotations

from dataclasses import field
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.errors import InputError
from kshell.mesh.words import shown
from kshell.scene.places import On, ScalarOrVector, ScalarValue
from kshell.scene.support import FREEDOMS, SPRINGS, Axes, Support
from kshell.values.validation import Flag, described
from kshell.values.varying import is_constant, values_at


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
