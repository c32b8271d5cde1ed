"""Loads, supports and masses of a scene, put on the parts of a mesh that they name."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, cast

from kshell.errors import InputError, clipped
from kshell.mesh.mesh import Mesh
from kshell.mesh.select import select
from kshell.scene.loads import Load, PointForce, PointMoment
from kshell.scene.masses import Mass
from kshell.scene.placed import Placed
from kshell.scene.scene import Scene
from kshell.scene.supports import Clamped, Fixed, RigidLink, Support


def links_by_name(scene: Scene, space: Mesh) -> dict[str, Placed[Support]]:
    """Rigid links by their names.

    Raises
    ------
    InputError
        If two have the same name, or one that of a group.
    """
    out: dict[str, Placed[Support]] = {}
    for support in scene.supports:
        if isinstance(support, RigidLink):
            name = support.name
            if name and (name in out or name in space.groups):
                raise InputError(f'{support}: the name "{clipped(name)}" is taken: give it another')
            chosen = select(space, support.on, dimensions=support.dimensions, what=f"support {support.kind}")
            out[name] = Placed(cast(Support, support), chosen)
    out.pop("", None)
    return out


def _at_point(item: Any, link: Placed[Any]) -> Placed[Any]:
    """A load or support on the point of a rigid link."""
    if (
        not isinstance(item, PointForce | PointMoment | Clamped | Fixed)
        or getattr(item, "axes", None) is not None
        or getattr(item, "rotation", None) is not None
    ):
        raise InputError(
            f"{item}: the point of a rigid link takes point_force, point_moment, clamped and fix (along x, y, z "
            "and r), without axes or a prescribed rotation"
        )
    return Placed(item, link.place, link.item)


def placed_load(load: Any, space: Mesh, links: Mapping[str, Placed[Support]]) -> Placed[Load]:
    """A load, on what it names: a group, a point, that of a rigid link, or everything."""
    if isinstance(load.on, str) and load.on in links:
        return _at_point(load, links[load.on])
    if load.on is None:
        return Placed(load, None)
    what = f"load {load.kind}"
    return Placed(load, select(space, load.on, dimensions=load.dimensions, what=what))


def placed_supports(
    supports: Iterable[Any], space: Mesh, links: Mapping[str, Placed[Support]]
) -> Iterator[Placed[Support]]:
    """Supports, one for each group they name; rigid links stay whole."""
    for support in supports:
        what = f"support {support.kind}"
        if isinstance(support.on, str) and support.on in links:
            yield _at_point(support, links[support.on])
            continue
        if isinstance(support, RigidLink):  # one body, however many groups
            yield Placed(support, select(space, support.on, dimensions=support.dimensions, what=what))
            continue
        names: tuple[Any, ...] = (support.on,)
        if isinstance(support.on, tuple) and isinstance(support.on[0], str):
            names = support.on
            if len(names) > 1:  # which must be of one kind
                select(space, names, dimensions=support.dimensions, what=what)
        for on in names:
            yield Placed(support, select(space, on, dimensions=support.dimensions, what=what))


def placed_masses(masses: Iterable[Any], space: Mesh) -> Iterator[Placed[Mass]]:
    """Added masses, one for each group they name."""
    for mass in masses:
        names = mass.on if isinstance(mass.on, tuple) and isinstance(mass.on[0], str) else (mass.on,)
        for on in names:
            yield Placed(mass, select(space, on, dimensions=mass.dimensions, what="mass"))
