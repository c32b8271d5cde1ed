"""How a plate or shell is held, by name.

Freedoms are letters: x, y, z are translations, r is the rotation about the edge.
"""

from __future__ import annotations

from dataclasses import field
from typing import Any, ClassVar

from kshell.scene.exact_supports import Elastic, Fixed
from kshell.scene.places import On, PlacePoint, ScalarOrVector
from kshell.scene.support import FREEDOMS, SPRINGS, Support
from kshell.values.validation import Flag, described

__all__ = [
    "FREEDOMS",
    "SPRINGS",
    "SUPPORTS",
    "Clamped",
    "Elastic",
    "Fixed",
    "Free",
    "Hinge",
    "RigidLink",
    "SimplySupported",
    "SoftSupported",
    "Support",
    "Symmetry",
]


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


SUPPORTS: dict[str, type[Any]] = {
    cls.kind: cls
    for cls in (Clamped, SimplySupported, SoftSupported, Symmetry, Free, Hinge, RigidLink, Fixed, Elastic)
}
