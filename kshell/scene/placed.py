"""What a scene names, with the part of the mesh it acts on."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.distinct import distinct
from kshell.mesh.mesh import Mesh
from kshell.mesh.select import Selection
from kshell.scene.loads import Load
from kshell.scene.masses import Mass
from kshell.scene.normals import with_normals
from kshell.scene.supports import RigidLink, Support
from kshell.values.time import at_time, depends_on_time

Floats = NDArray[np.float64]
T = TypeVar("T", Load, Support, Mass)


@dataclass(frozen=True, eq=False)
class Placed(Generic[T]):
    """A load, support or added mass with the part of the mesh it acts on.

    Attributes
    ----------
    item : Load, Support or Mass
    place : Selection, optional
        Vertices, edges or triangles; None is everywhere.
    link : RigidLink, optional
        Whose point it acts on; its place is then that of the link.
    warning : str
        What the user should know about where it acts.
    missed : float
        Share of a load or spring that is missed because it changes faster than it is integrated.
    """

    item: T
    place: Selection | None
    link: RigidLink | None = None
    warning: str = ""
    missed: float = 0.0

    def members(self, mesh: Mesh) -> NDArray[np.integer]:
        """Numbers of the vertices, edges or triangles it acts on; all triangles where it acts everywhere."""
        return np.arange(len(mesh.triangles)) if self.place is None else self.place.members

    def vertices(self, mesh: Mesh) -> Floats:
        """(n, 3) vertices of the part."""
        if self.link is not None:
            return np.array([self.link.to])
        if self.place is None:
            return mesh.points
        if self.place.dimension == 0:
            return mesh.points[self.place.members]
        corners = mesh.edges if self.place.dimension == 1 else mesh.triangles
        return mesh.points[distinct(len(mesh.points), corners[self.place.members])]

    def places(self, mesh: Mesh) -> Floats:
        """(n, 3) vertices of the part, or (n, 6) with their normals where the values of a load depend on these."""
        if not getattr(self.item, "needs_normal", False):
            return self.vertices(mesh)
        return with_normals(mesh, self.members(mesh))

    @property
    def depends_on_time(self) -> bool:
        """Whether it changes with the time t."""
        return any(depends_on_time(getattr(self.item, key, None)) for key in _keys(self.item))

    def at_time(self, time: float) -> Placed[T]:
        """The same at one time."""
        if not self.depends_on_time:
            return self
        keys = [key for key in _keys(self.item) if hasattr(self.item, key)]
        item: Any = self.item
        values = {key: at_time(getattr(item, key), time) for key in keys}
        return replace(self, item=replace(item, **values))


def _keys(item: Any) -> tuple[str, ...]:
    """What may change with the time."""
    return (*item.scaling, *getattr(item, "placing", ()))
