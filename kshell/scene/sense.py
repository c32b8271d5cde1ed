"""What supports and loads say against each other: held and free at once, loads along what their own edge holds."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.distinct import distinct
from kshell.mesh.mesh import Mesh
from kshell.mesh.words import place
from kshell.scene.loads import (
    NEGLIGIBLE,
    EdgeMoment,
    InitialCurvature,
    InitialStrain,
    Load,
    PointMoment,
    Temperature,
)
from kshell.scene.placed import Placed
from kshell.scene.supports import Elastic, Free, SimplySupported, Support
from kshell.scene.turns import wrong_turns

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


def contradictions(
    supports: Sequence[Placed[Support]], loads: Sequence[Placed[Load]], space: Mesh
) -> Iterator[str]:
    """What cannot be meant, in words.

    Parameters
    ----------
    space : Mesh
        In space.
    """
    yield from _free_and_held(supports, space)
    yield from wrong_turns([placed.at_time(0.0) for placed in supports], space)
    flat = space.is_flat
    for load in loads:
        yield from _lost(load, supports, space, flat)


def _free_and_held(supports: Sequence[Placed[Support]], space: Mesh) -> Iterator[str]:
    """Parts of the mesh that one support calls free and another holds."""
    holding = [p for p in supports if p.item.freedoms and p.place is not None and p.link is None]
    for free in supports:
        if not isinstance(free.item, Free) or free.place is None:
            continue
        for held in holding:
            assert held.place is not None  # chosen so above
            if held.place.dimension != free.place.dimension:
                continue
            both = np.intersect1d(held.place.members, free.place.members)
            if len(both):
                yield (
                    f"{held.item} holds what {free.item} calls free, at "
                    f"{place(_middle(space, free.place.dimension, int(both[0])))}: leave one of them out"
                )


def _middle(space: Mesh, dimension: int, member: int) -> Floats:
    if dimension == 0:
        return np.asarray(space.points[member])
    return np.asarray(space.points[(space.edges if dimension == 1 else space.triangles)[member]].mean(axis=0))


def lost_into_supports(load: Placed[Load], supports: Sequence[Placed[Support]], space: Mesh) -> str:
    """What a load at points or on surfaces does that goes straight into supports, in words.

    No contradiction as on curves: its reaction is asked for, perhaps.
    """
    return next(_lost(load, supports, space, space.is_flat, (0, 2)), "")


def _lost(
    load: Placed[Load],
    supports: Sequence[Placed[Support]],
    space: Mesh,
    flat: bool,
    dimensions: tuple[int, ...] = (1,),
) -> Iterator[str]:
    """A load where supports hold altogether what it pushes along: it goes into them and deforms nothing.

    Springs give way, so loads on them do deform something.
    """
    item = load.item
    if isinstance(item, Temperature | InitialCurvature | InitialStrain):
        return
    if _dimension(load) not in dimensions:
        return
    turns = isinstance(item, EdgeMoment | PointMoment)
    # what turns about any axis is held where the place is, too; what pushes along a normal that varies, along all axes
    along_normal = item.components is None and not turns
    needed = ("z" if flat else "xyz") if isinstance(item, PointMoment) or along_normal else ""
    able = [p for p in supports if _covers(p, load) and set(needed) <= set(p.item.freedoms)]
    if not able:
        return
    for letter, axis in _directions(supports, turns):
        if not turns and not _pushes(load, axis, space):
            continue
        holders = [p for p in able if _holds(p.item, letter, axis, flat)]
        chosen = load.members(space)
        found = [_within(p, load, space) for p in holders]
        if not found or not np.isin(chosen, np.concatenate(found)).all():
            continue
        first = next(p for p, part in zip(holders, found, strict=True) if np.isin(part, chosen).any())
        yield _lost_words(item, first.item, letter, axis)
        return


def _covers(held: Placed[Support], load: Placed[Load]) -> bool:
    """Whether a support may be on all that a load is on: lines on no surface, springs on nothing, as they give way."""
    if held.link is not load.link or isinstance(held.item, Elastic):
        return False
    return held.link is not None or (held.place is not None and held.place.dimension >= _dimension(load))


def _lost_words(load: Load, support: Support, letter: str, axis: Floats) -> str:
    if letter == "r":
        turned = "the edge" if isinstance(load, EdgeMoment) else "a place"
        along = f"turns {turned}, whose rotation"
        mend = 'leave r out of what is held, e.g. kind = "simply_supported"'
    else:
        direction = "the normal" if load.components is None else _axis_words(letter, axis)
        along = f"acts along {direction}, which"
        others = "".join(c for c in "xyzr" if c != letter)
        mend = f'hold the other freedoms only, e.g. fix = "{others}", or leave the load out'
    return f"{load} {along} {support} holds there: it would go straight into the support and deform nothing; {mend}"


def _dimension(load: Placed[Load]) -> int:
    """Of the place it acts on; the point of a link is one."""
    return 0 if load.link is not None else 2 if load.place is None else load.place.dimension


def _pushes(load: Placed[Load], axis: Floats, space: Mesh) -> bool:
    """Whether a load has a part along an axis."""
    if load.item.components is None:  # along the normal, which is z where only z need be held
        return abs(axis[2]) > NEGLIGIBLE
    value = load.item.at(load.places(space))
    return bool(np.abs(value @ axis).max(initial=0.0) > NEGLIGIBLE * np.abs(value).max(initial=0.0))


def _directions(supports: Sequence[Placed[Support]], turns: bool) -> Iterator[tuple[str, Floats]]:
    """Letters with the directions that they mean in some support."""
    if turns:
        yield "r", np.zeros(3)
        return
    for letter, axis in zip("xyz", np.eye(3), strict=True):
        yield letter, axis
    for placed in supports:
        axes = getattr(placed.item, "axes", None)
        if axes is not None:
            for letter, axis in zip("xyz", np.array(axes), strict=True):
                yield letter, axis


def _holds(support: Any, letter: str, axis: Floats, flat: bool) -> bool:
    """Whether a support holds a direction (or, for "r", the rotation about the edge)."""
    if letter not in support.freedoms:
        return False
    if flat and isinstance(support, SimplySupported) and letter in "xy":
        return False  # such an edge of a plate is free to move in the plane, unless the plate is taken as a shell
    axes = getattr(support, "axes", None)
    own = np.eye(3) if axes is None else np.array(axes)
    return letter == "r" or bool(np.abs(own["xyz".index(letter)] @ axis) > 1.0 - 1e-9)


def _within(held: Placed[Support], load: Placed[Load], space: Mesh) -> Ints:
    """Vertices, edges or triangles, as the load has them, that a support holds."""
    if held.link is not None:  # the point of a link, which the load is on
        return load.members(space)
    dimension = _dimension(load)
    assert held.place is not None  # see `_covers`
    members = held.place.members
    if held.place.dimension == dimension:
        return members
    if dimension == 1:
        return distinct(len(space.edges), space.triangle_edges[members])
    return distinct(
        len(space.points), (space.edges if held.place.dimension == 1 else space.triangles)[members]
    )


def _axis_words(letter: str, axis: Floats) -> str:
    return letter if np.abs(axis).max() > 1.0 - 1e-9 else place(axis)
