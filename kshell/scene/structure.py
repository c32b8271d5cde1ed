"""What is to be computed: a scene with everything found that its words mean on its mesh.

Made once, by an analysis; what models are built from. Groups are looked up, values checked and the cross-section
made here, and nowhere else.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.material.section import Section, shell_section
from kshell.mesh.mesh import Mesh
from kshell.mesh.select import Selection, select
from kshell.scene.imperfection import Imperfection
from kshell.scene.loads import Load
from kshell.scene.on_chart import mesh_in_space
from kshell.scene.places import Point
from kshell.scene.scene import Scene
from kshell.scene.supports import Support

Floats = NDArray[np.float64]
T = TypeVar("T", Load, Support)


@dataclass(frozen=True, eq=False)
class Placed(Generic[T]):
    """A load or support with the part of the mesh it acts on.

    Attributes
    ----------
    item : Load or Support
    place : Selection, optional
        Vertices, edges or triangles; None is everywhere.
    """

    item: T
    place: Selection | None

    def members(self, mesh: Mesh) -> NDArray[np.integer]:
        """Numbers of the vertices, edges or triangles it acts on; all triangles where it acts everywhere."""
        return np.arange(len(mesh.triangles)) if self.place is None else self.place.members

    def vertices(self, mesh: Mesh) -> Floats:
        """(n, 3) vertices of the part."""
        if self.place is None:
            return mesh.points
        if self.place.dimension == 0:
            return mesh.points[self.place.members]
        corners = mesh.edges if self.place.dimension == 1 else mesh.triangles
        return mesh.points[np.unique(corners[self.place.members])]


@dataclass(frozen=True, eq=False)
class Structure:
    """A scene, resolved on its mesh.

    Attributes
    ----------
    space : Mesh
        In space.
    parameters : Mesh
        As read: in the parameter plane where there is a chart, else the same.
    section : Section
        Stiffness and thickness at any place of `space`.
    supports : tuple of Placed
        One for each name, where a support is on several groups.
    loads : tuple of Placed
        In the order of the scene; loads are known by their numbers in it.
    probes : dict of str to (x, y, z)
    chart : Chart, optional
    offset, direction, imperfection :
        As in a scene.
    title : str
    movable : bool
        Whether parts may move as rigid bodies.
    """

    space: Mesh
    parameters: Mesh
    section: Section
    supports: tuple[Placed[Support], ...] = ()
    loads: tuple[Placed[Load], ...] = ()
    probes: Mapping[str, Point] = field(default_factory=dict)
    chart: Any = None
    offset: float = 0.0
    direction: Point | None = None
    imperfection: Imperfection | None = None
    title: str = ""
    movable: bool = False

    def on(self, space: Mesh) -> Structure:
        """The same with vertices moved."""
        return replace(self, space=space, section=self.section.on(space))


def resolve(scene: Scene, mesh: Mesh) -> Structure:
    """Find what a scene means on its mesh, as read.

    Raises
    ------
    InputError
        If a group does not exist or is of the wrong kind, a value is not finite at some vertex, or thickness and
        layers do not fit.
    """
    space = mesh_in_space(scene.chart, mesh)
    # values inside come at quadrature points: without a look at vertices a pole on one would go unnoticed
    supports = tuple(_supports(scene.supports, space))
    for support in supports:
        support.item.require_finite(support.vertices(space))
    loads = tuple(_load(load, space) for load in scene.loads)
    for load in loads:
        load.item.require_finite(load.vertices(space))
    return Structure(
        space,
        mesh,
        shell_section(space, scene.thickness, scene.material, scene.layers),
        supports,
        loads,
        scene.probes,
        scene.chart,
        scene.offset,
        scene.direction,
        scene.imperfection,
        scene.title,
    )


def problems(scene: Scene, mesh: Mesh) -> Iterator[str]:
    """Everything that `resolve` would raise, in words."""
    try:
        space = mesh_in_space(scene.chart, mesh)
    except InputError as error:
        yield str(error)
        return
    try:
        shell_section(space, scene.thickness, scene.material, scene.layers)
    except InputError as error:
        yield str(error)
    for item in [*scene.supports, *scene.loads]:
        try:
            found = _supports([item], space) if isinstance(item, Support) else [_load(item, space)]
            for placed in found:
                placed.item.require_finite(placed.vertices(space))
        except InputError as error:
            yield str(error)


def _load(load: Any, space: Mesh) -> Placed[Load]:
    if load.on is None:
        return Placed(load, None)
    what = f"load {load.kind}"
    return Placed(load, select(space, load.on, dimensions=load.dimensions, what=what))


def _supports(supports: Iterable[Any], space: Mesh) -> Iterator[Placed[Support]]:
    for support in supports:
        what = f"support {support.kind}"
        names: tuple[Any, ...] = (support.on,)
        if isinstance(support.on, tuple) and isinstance(support.on[0], str):
            names = support.on
            if len(names) > 1:  # which must be of one kind
                select(space, names, dimensions=support.dimensions, what=what)
        for on in names:
            yield Placed(support, select(space, on, dimensions=support.dimensions, what=what))
