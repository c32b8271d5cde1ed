"""What is to be computed: a scene with everything found that its words mean on its mesh.

Made once, by an analysis; what models are built from. Groups are looked up, values checked and the cross-section
made here, and nowhere else.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.material.by_group import per_triangle
from kshell.material.section import Section, shell_section
from kshell.mesh.mesh import Mesh
from kshell.mesh.select import select
from kshell.scene.exact_supports import Elastic
from kshell.scene.imperfection import Imperfection
from kshell.scene.jumps import acts_nowhere, missed_forces, missed_on_the_way, rough_words
from kshell.scene.loads import Load, Pressure, Temperature
from kshell.scene.mapped import Mapped, keep_resultant
from kshell.scene.masses import Mass
from kshell.scene.on_chart import mesh_in_space
from kshell.scene.placed import Placed
from kshell.scene.placed_pressures import Patch
from kshell.scene.places import Point, ProbePoint
from kshell.scene.placing import links_by_name, placed_load, placed_masses, placed_supports
from kshell.scene.scene import Scene
from kshell.scene.sense import contradictions, lost_into_supports
from kshell.scene.supports import Support
from kshell.scene.thermal import require_expansions
from kshell.values.time import depends_on_time

Floats = NDArray[np.float64]


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
    offset : (triangle,)
        Height of the middle of the material above the mesh.
    direction : (3,) or (triangle, 3), optional
        From which the angles of materials count; NaN where there is none.
    imperfection :
        As in a scene.
    title : str
    movable : bool
        Whether parts may move as rigid bodies.
    masses : tuple of Placed
        Added ones, one for each name.
    touching : bool
        Whether it touches itself or obstacles.
    elastic : bool
        Whether materials are taken as elastic, whatever they remember of their past.
    notes : tuple of str
        What was made of its values, in words.
    found : dict
        What follows from its mesh and supports, and is found once; another structure made from it begins anew.
    """

    space: Mesh
    parameters: Mesh
    section: Section
    supports: tuple[Placed[Support], ...] = ()
    loads: tuple[Placed[Load], ...] = ()
    probes: Mapping[str, Point] = field(default_factory=dict)
    chart: Any = None
    offset: Floats = field(default_factory=lambda: np.zeros(1))
    direction: Floats | None = None
    imperfection: Imperfection | None = None
    title: str = ""
    movable: bool = False
    masses: tuple[Placed[Mass], ...] = ()
    touching: bool = False
    elastic: bool = False
    notes: tuple[str, ...] = ()
    found: dict[str, Any] = field(default_factory=dict, init=False, repr=False)

    @property
    def thickness(self) -> Floats:
        """(triangle,) in the middle of each."""
        return self.section.thickness_per_triangle

    def on(self, space: Mesh) -> Structure:
        """The same with vertices moved."""
        return replace(self, space=space, section=self.section.on(space))

    @property
    def missed(self) -> float:
        """Share of loads and springs that is missed because they change faster than they are integrated."""
        return self.missed_under(None)

    def missed_under(self, factors: Sequence[float] | None) -> float:
        """The same where loads have factors, (load,); those of factor 0 do not act."""
        acts = [True] * len(self.loads) if factors is None else [f != 0.0 for f in factors]
        of_loads = sum(x.missed for x, does in zip(self.loads, acts, strict=True) if does)
        return of_loads + sum(x.missed for x in self.supports)

    def acting(self, factors: Sequence[float] | None) -> Structure:
        """The same under the loads alone that act where loads have factors, (load,), in a load case."""
        if factors is None or all(f != 0.0 for f in factors):
            return self
        loads = tuple(placed for placed, f in zip(self.loads, factors, strict=True) if f != 0.0)
        out = replace(self, loads=loads)
        out.found.update(self.found)  # of mesh and supports
        return out

    def at_time(self, time: float) -> Structure:
        """The same with loads and prescribed motions as they are at one time."""
        return replace(
            self,
            supports=tuple(placed.at_time(time) for placed in self.supports),
            loads=tuple(placed.at_time(time) for placed in self.loads),
        )


def resolve(
    scene: Scene,
    mesh: Mesh,
    moving: bool = False,
    looks: Sequence[float] = (0.0,),
    words_only: bool = False,
) -> Structure:
    """Find what a scene means on its mesh, as read.

    Parameters
    ----------
    moving : bool
        Whether values may depend on the time t; they are then looked at as they are at t = 0.
    looks : sequence of float
        Times at which loads that move are looked at.
    words_only : bool
        Whether nobody asks for errors, so that of what is missed of loads inside triangles only words are wanted.

    Raises
    ------
    InputError
        If a group does not exist or is of the wrong kind, a value is not finite at some vertex, thickness and
        layers do not fit, or supports and loads contradict each other.
    """
    space = mesh_in_space(scene.chart, mesh)
    # values inside come at quadrature points: without a look at vertices a pole on one would go unnoticed
    links = links_by_name(scene, space)
    supports = tuple(placed_supports(scene.supports, space, links))
    loads = tuple(placed_load(load, space, links) for load in scene.loads)
    masses = tuple(placed_masses(scene.masses, space))
    every: list[Placed[Any]] = [*supports, *loads, *masses]
    for placed in every:
        (placed.at_time(0.0) if moving else placed).item.require_finite(placed.places(space))
    for words in contradictions(supports, [load.at_time(0.0) for load in loads] if moving else loads, space):
        raise InputError(words)
    for name, point in scene.probes.items():
        if isinstance(point, ProbePoint):
            select(space, point.on, dimensions=(2,), what=f'probe "{name}"')
    loads = tuple(_warned(placed, supports, space, moving, looks, words_only) for placed in loads)
    supports = tuple(_spring(placed, space, moving) for placed in supports)
    section = shell_section(space, scene.thickness, scene.material, scene.layers, scene.section)
    for placed in loads:
        if isinstance(placed.item, Temperature):
            require_expansions(placed.item, section, placed.members(space))
    loads, notes = _from_files(loads, space)
    return Structure(
        space,
        mesh,
        section,
        supports,
        loads,
        scene.probes,
        scene.chart,
        per_triangle(space, "offset", scene.offset, 0.0),
        _directions(scene.direction, space),
        scene.imperfection,
        scene.title,
        masses=masses,
        movable=scene.contact is not None,  # until it touches what holds it
        touching=scene.contact is not None,
        notes=tuple(notes),
    )


def _from_files(loads: Iterable[Placed[Load]], space: Mesh) -> tuple[tuple[Placed[Load], ...], list[str]]:
    """Loads, with the resultants that the files of mapped pressures have, and words about them."""
    out, notes = [], []
    for placed in loads:
        if isinstance(placed.item, Pressure) and isinstance(placed.item.value, Mapped):
            item, words = keep_resultant(placed.item, space, placed.members(space))
            placed = replace(placed, item=item)
            notes.append(words)
        out.append(placed)
    return tuple(out), notes


def _warned(
    load: Placed[Load],
    supports: Sequence[Placed[Support]],
    space: Mesh,
    moving: bool,
    looks: Sequence[float],
    words_only: bool,
) -> Placed[Load]:
    """A load, with a warning where it goes into supports that hold it, or changes fast inside triangles."""
    now = load.at_time(0.0) if moving else load
    if moving and isinstance(load.item, Patch) and depends_on_time(load.item.centre):
        states = (load.at_time(time).item for time in looks)
        missed = missed_on_the_way(states, space, now.members(space))
        rough = rough_words(load.item, missed, 2, moves=True)
    else:
        missed, rough = _missed(now, space, words_only)
    if not moving and not missed and acts_nowhere(now.item, space, now.members(space), _dimension(now)):
        rough = f"{now.item} is zero wherever it is integrated: nothing comes of it"
    words = "; ".join(part for part in (lost_into_supports(now, supports, space), rough) if part)
    return replace(load, warning=words, missed=missed) if words or missed else load


def _spring(placed: Placed[Support], space: Mesh, moving: bool) -> Placed[Support]:
    """A support, with a warning where it is a spring whose stiffness changes fast inside triangles."""
    now = placed.at_time(0.0) if moving else placed
    if not isinstance(now.item, Elastic):
        return placed
    missed, words = _missed(now, space)
    both = "; ".join(part for part in (placed.warning, words) if part)
    return replace(placed, warning=both, missed=missed) if missed else placed


def _missed(placed: Placed[Any], space: Mesh, words_only: bool = False) -> tuple[float, str]:
    """What is missed of a load or a spring, and words about it."""
    dimension = _dimension(placed)
    missed, _ = missed_forces(placed.item, space, placed.members(space), dimension, words_only)
    return missed, rough_words(placed.item, missed, dimension)


def _dimension(placed: Placed[Any]) -> int:
    return 2 if placed.place is None else placed.place.dimension


def _directions(given: Any, mesh: Mesh) -> Floats | None:
    if given is None or not isinstance(given, Mapping):
        return None if given is None else np.array(given, dtype=float)
    return per_triangle(mesh, "direction", given, (np.nan, np.nan, np.nan))


def problems(scene: Scene, mesh: Mesh, moving: bool = False) -> Iterator[str]:
    """Everything that `resolve` would raise, in words."""
    try:
        space = mesh_in_space(scene.chart, mesh)
    except InputError as error:
        yield str(error)
        return
    section = None
    try:
        section = shell_section(space, scene.thickness, scene.material, scene.layers, scene.section)
    except InputError as error:
        yield str(error)
    try:
        links = links_by_name(scene, space)
    except InputError as error:
        yield str(error)
        return
    supports: list[Placed[Support]] = []
    loads: list[Placed[Load]] = []
    for item in [*scene.supports, *scene.loads, *scene.masses]:
        try:
            if isinstance(item, Support):
                found: list[Any] = list(placed_supports([item], space, links))
                supports += found
            elif isinstance(item, Mass):
                found = list(placed_masses([item], space))
            else:
                found = [placed_load(item, space, links)]
                loads += found
            for placed in found:
                (placed.at_time(0.0) if moving else placed).item.require_finite(placed.places(space))
                if section is not None and isinstance(placed.item, Temperature):
                    require_expansions(placed.item, section, placed.members(space))
        except InputError as error:
            yield str(error)
    yield from contradictions(supports, [load.at_time(0.0) for load in loads] if moving else loads, space)
