"""What single keys of a scene may be: each function takes a value as written and gives it as it is kept.

They raise ValueError with words that go behind the key and its value, which the caller adds.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from kshell.errors import InputError
from kshell.mesh.words import shown
from kshell.scene.places import as_point, as_probe
from kshell.scene.sections import as_direction


def as_mesh(value: Any) -> Any:
    """A path, or a mesh in memory."""
    if value is None or isinstance(value, int | float) or value == "":
        raise ValueError("must be the path of a mesh file, or a mesh of kshell, scikit-fem or meshio")
    return Path(value) if isinstance(value, str | os.PathLike) else value


def as_geometry(value: Any) -> Any:
    """The path of a geometry file, or None."""
    if value is not None and (not isinstance(value, str | os.PathLike) or value == ""):
        raise ValueError("must be the path of a geometry file: .geo, .step, .brep or .iges")
    return None if value is None else Path(value)


def as_chart(value: Any) -> Any:
    """A chart, made where a dict names its kind; or None."""
    if isinstance(value, Mapping):
        from kshell.geometry import ready_chart

        constants = {str(key): part for key, part in value.items() if key != "kind"}
        if "kind" not in value:
            raise ValueError('must have a kind, for example {"kind": "cylinder", "R": 25.0}')
        try:
            return ready_chart(value["kind"], **constants)
        except InputError as error:
            raise ValueError(str(error)) from None
    if value is not None and not callable(getattr(value, "derivatives", None)):
        raise ValueError("must be a chart of kshell.geometry such as ks.geometry.Cylinder(R=25)")
    return value


def as_top_towards(value: Any) -> Any:
    """None, a direction, or a dict with the key point."""
    if isinstance(value, Mapping):
        if set(value) != {"point"}:
            raise ValueError("must be a direction [x, y, z] or {point = [x, y, z]}")
        return {"point": as_point(value["point"])}
    return None if value is None else as_direction(value, "")


def as_cuts(value: Any) -> Any:
    """Names of groups of curves."""
    names = (value,) if isinstance(value, str) else value
    if not isinstance(names, Sequence) or not all(isinstance(name, str) and name for name in names):
        raise ValueError("must be a group of curves, or a list of them")
    return tuple(names)


def as_probes(value: Any) -> Any:
    """Points by name."""
    if not isinstance(value, Mapping):
        raise ValueError("must be a dict of name to point (x, y, z)")
    points = {}
    for name, point in value.items():
        try:
            points[str(name)] = as_probe(point)
        except ValueError as error:
            raise ValueError(f'"{name}" = {shown(point)} {error}') from None
    return points


def all_of(items: Any, cls: type, key: str, words: str) -> tuple[Any, ...]:
    """The items of a scene under a key, one or a list, each of a class."""
    if isinstance(items, tuple) and not items:
        return ()
    if isinstance(items, cls):
        items = (items,)
    if not isinstance(items, Sequence) or isinstance(items, str):
        raise InputError(f"scene: {key} = {shown(items)}: must be a list of {key}")
    for number, item in enumerate(items):
        if not isinstance(item, cls):
            raise InputError(f"scene: {key}[{number}] = {shown(item)}: must be {words}")
    return tuple(items)
