"""What a shell touches: itself and obstacles."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator, WithJsonSchema

from kshell.errors import InputError
from kshell.mesh.mesh import Mesh
from kshell.mesh.words import shown
from kshell.scene.places import as_point
from kshell.values import kinds
from kshell.values.expression import Expression
from kshell.values.naming import listing, suggestion
from kshell.values.time import TIME
from kshell.values.validation import Flag, Number, described

# shape of an obstacle: its keys
SHAPES = {
    "plane": ("point", "normal"),
    "sphere": ("centre", "radius"),
    "cylinder": ("point", "axis", "radius"),
}


def _auto(value: Any) -> Any:
    if value == "auto":
        return value
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 < value < float("inf"):
        raise ValueError('must be "auto" or a number > 0')
    return float(value)


AUTO_OR_LENGTH = kinds.either(kinds.AUTO, kinds.POSITIVE)


@described("contact")
class Contact:
    """How surfaces touch.

    Attributes
    ----------
    friction : float [1]
        Coulomb's coefficient.
    self : bool
        Whether the shell touches itself.
    thickness : "auto" or float [length]
        Distance kept between middle surfaces, half of it to obstacles; auto: the thickness of the shell.
    distance : "auto" or float [length]
        From which surfaces feel each other, beyond the thickness; auto: a tenth of the smallest edge, at most half of
        the smallest distance at the start.
    speed : float [length / time]
        Of sliding up to which friction sticks; at rest it slides by the way at this speed in a unit of time, at most.

    Examples
    --------
    ```toml
    [contact]
    with = [{kind = "plane", point = [0, 0, 0], normal = [0, 0, 1]}]
    friction = 0.3
    self = false
    thickness = 0.01
    distance = 0.002
    speed = 0.01
    ```
    """

    friction: Number = 0.0
    self: Flag = True
    thickness: Annotated[Any, BeforeValidator(_auto), WithJsonSchema(AUTO_OR_LENGTH)] = "auto"
    distance: Annotated[Any, BeforeValidator(_auto), WithJsonSchema(AUTO_OR_LENGTH)] = "auto"
    speed: Number = 1e-3

    def __post_init__(self) -> None:
        if self.friction < 0.0:
            raise InputError(f"contact: friction = {self.friction:g} must not be negative")
        if not self.speed > 0.0:
            raise InputError(f"contact: speed = {self.speed:g} must be > 0")


def _shape(value: Any) -> Any:
    if isinstance(value, Mesh):
        return value
    if isinstance(value, str | os.PathLike) and value != "":
        return Path(value)
    if not isinstance(value, Mapping):
        raise ValueError(
            'must be a mesh, its path, or a table such as {kind = "plane", point = .., normal = ..}'
        )
    kind = value.get("kind")
    if kind not in SHAPES:
        raise ValueError(f"kind = {kind!r}: {suggestion(str(kind), SHAPES)}the kinds are {listing(SHAPES)}")
    for key in value:
        if key not in ("kind", *SHAPES[kind]):
            raise ValueError(f"unknown key {key!r}: a {kind} has {listing(SHAPES[kind])}")
    out: dict[str, Any] = {"kind": kind}
    for key in SHAPES[kind]:
        if key not in value:
            raise ValueError(f"{key} is missing: a {kind} has {listing(SHAPES[kind])}")
        if key == "radius":
            radius = value[key]
            if (
                isinstance(radius, bool)
                or not isinstance(radius, int | float)
                or not 0 < radius < float("inf")
            ):
                raise ValueError(f"radius = {radius!r} must be a number > 0")
            out[key] = float(radius)
            continue
        out[key] = as_point(value[key])
        if key in ("normal", "axis") and not np.linalg.norm(out[key]) > 0.0:
            raise ValueError(f"{key} must not be zero")
    return out


def _motion(value: Any) -> Any:
    if value is None:
        return None
    parts = list(value) if isinstance(value, Sequence) and not isinstance(value, str) else []
    if len(parts) != 3:
        raise ValueError("must be three displacements since t = 0, numbers or expressions in t")
    for part in parts:
        if isinstance(part, str):
            try:
                Expression(part, (TIME,))
            except InputError as error:
                raise ValueError(str(error)) from None
        elif isinstance(part, bool) or not isinstance(part, int | float):
            raise ValueError("must be three numbers or expressions in t")
    return tuple(parts)


@described("obstacle")
class Obstacle:
    """Something rigid that the shell may touch.

    Attributes
    ----------
    shape : path, Mesh or dict
        A dict has the kind plane (point, normal towards the shell), sphere (centre, radius) or cylinder (point, axis,
        radius).
    motion : three expressions in t, optional [length]
        Displacement since t = 0; in statics t goes from 0 to 1.
    name : str, optional
        Of its forces in the history.

    Examples
    --------
    ```toml
    [contact]
    with = [
        {kind = "sphere", centre = [0, 0, -1], radius = 0.5, name = "ball", motion = [0, 0, "0.1*t"]},
        {kind = "plane", point = [0, 0, -2], normal = [0, 0, 1]},
        {kind = "cylinder", point = [0, 0, -1], axis = [1, 0, 0], radius = 0.2},
        {file = "table.stl", name = "table"},
    ]
    ```
    """

    shape: Annotated[Any, BeforeValidator(_shape)]
    motion: Annotated[Any, BeforeValidator(_motion), WithJsonSchema(kinds.VECTOR)] = None
    name: str | None = None

    def displacement(self, time: float) -> np.ndarray:
        """(3,) since the time 0.

        Raises
        ------
        InputError
            If it is not finite.
        """
        if self.motion is None:
            return np.zeros(3)
        parts = [Expression(part, (TIME,))(time) if isinstance(part, str) else part for part in self.motion]
        found = np.array(parts, dtype=float)
        if not np.isfinite(found).all():
            raise InputError(f"obstacle: motion = {shown(self.motion)} is not finite at t = {time:g}")
        return found


def contact(value: Any) -> Contact | None:
    """From what a scene takes."""
    if value is None or isinstance(value, Contact):
        return value
    if not isinstance(value, Mapping):
        raise InputError(f"scene: contact = {shown(value)}: must be ks.Contact(...)")
    return Contact(**value)


def obstacles(value: Any) -> tuple[Obstacle, ...]:
    """From what a scene takes: an obstacle or a list of them."""
    given = (value,) if isinstance(value, Obstacle) else value
    if not isinstance(given, Sequence) or not all(isinstance(one, Obstacle) for one in given):
        raise InputError(f"scene: obstacles = {shown(value)}: must be a list of ks.Obstacle(...)")
    names = [one.name for one in given if one.name is not None]
    if len(set(names)) < len(names):
        raise InputError("scene: two obstacles have the same name: give each its own")
    return tuple(given)


def obstacle_from(data: Any, folder: Path) -> Obstacle:
    """An obstacle of a scene file: a path, or a table with a kind or a file, name and motion."""
    if isinstance(data, str):
        return Obstacle(folder / data, name=Path(data).stem)
    if not isinstance(data, Mapping):
        raise InputError(f"with: {shown(data)}: must be the path of a mesh, or a table with a kind")
    rest = dict(data)
    name, motion, file = (rest.pop(key, None) for key in ("name", "motion", "file"))
    return Obstacle(rest if file is None else folder / file, motion, name)
