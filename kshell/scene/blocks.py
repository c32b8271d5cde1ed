"""Blocks of a scene file that are no objects of their own in Python: what a probe and a cut have."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, WithJsonSchema

from kshell.scene.places import PlacePoint
from kshell.values import kinds
from kshell.values.validation import described


def _name(value: Any) -> Any:
    if not isinstance(value, str) or not value:
        raise ValueError("must be text that is not empty")
    return value


def _group(value: Any) -> Any:
    if value is not None and (not isinstance(value, str) or not value):
        raise ValueError("must be the name of a surface group")
    return value


def _curves(value: Any) -> Any:
    names = [value] if isinstance(value, str) else value
    if not isinstance(names, list) or not names or not all(isinstance(name, str) and name for name in names):
        raise ValueError("must be a group of curves, or a list of them")
    return names


@described("probe")
class Probe:
    """A point whose values are reported: the nearest one of the surface.

    Attributes
    ----------
    name : str
        By which its values are reported.
    at : (x, y, z) [length]
        The place; farther from the surface than a mesh size there is a warning with the distance.
    on : str, optional
        Surface group whose values are wanted, where sheets meet.

    Examples
    --------
    ```toml
    [[probe]]
    name = "centre"
    at = [0.5, 0.5, 0.0]
    on = "plating"
    ```
    """

    name: Annotated[str, BeforeValidator(_name)]
    at: PlacePoint
    on: Annotated[Any, BeforeValidator(_group), WithJsonSchema(kinds.GROUP)] = None


@described("cut")
class Cut:
    """Curves along which the mesh is cut open.

    Attributes
    ----------
    on : str or list of str
        Groups of curves; the lips are the groups "NAME+" and "NAME-".

    Examples
    --------
    ```toml
    [[cut]]
    on = "crack"
    ```
    """

    on: Annotated[Any, BeforeValidator(_curves), WithJsonSchema(kinds.GROUPS)]
