"""What supports and loads say against each other: held and free at once, loads along what their own edge holds."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.check import is_flat
from kshell.mesh.mesh import Mesh
from kshell.mesh.select import Selection
from kshell.mesh.words import place
from kshell.scene.loads import NEGLIGIBLE, EdgeMoment, LineForce, Load
from kshell.scene.supports import Elastic, Free, SimplySupported, Support
from kshell.scene.turns import wrong_turns

if TYPE_CHECKING:
    from kshell.scene.structure import Placed

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
    flat = is_flat(space.points)
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


def _lost(load: Placed[Load], supports: Sequence[Placed[Support]], space: Mesh, flat: bool) -> Iterator[str]:
    """A load on curves that supports hold altogether along it: it goes into them and deforms nothing."""
    item, chosen = load.item, load.place
    turns = isinstance(item, EdgeMoment)
    if chosen is None or not isinstance(item, LineForce | EdgeMoment):
        return
    for letter, axis in _directions(supports, turns):
        if not turns:
            value = item.at(load.vertices(space))
            if np.abs(value @ axis).max(initial=0.0) <= NEGLIGIBLE * np.abs(value).max(initial=0.0):
                continue
        holders = [p for p in supports if p.link is None and _holds(p.item, letter, axis, flat)]
        found = [_within(p.place, chosen, space) for p in holders if p.place is not None]
        if found and np.isin(chosen.members, np.concatenate(found)).all():
            first = next(
                p for p, part in zip(holders, found, strict=True) if np.isin(part, chosen.members).any()
            )
            along = (
                "turns the edge, whose rotation"
                if turns
                else f"acts along {_axis_words(letter, axis)}, which"
            )
            yield (
                f"{item} {along} {first.item} holds there: it would go straight into the support and deform nothing; "
                + (
                    'leave r out of what is held, e.g. kind = "simply_supported"'
                    if turns
                    else "hold the other freedoms only, e.g. fix = "
                    f'"{"".join(c for c in "xyzr" if c != letter)}", or leave the load out'
                )
            )
            return


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
    if isinstance(support, Elastic) or letter not in support.freedoms:
        return False
    if flat and isinstance(support, SimplySupported) and letter in "xy":
        return False  # such an edge of a plate is free to move in the plane, unless the plate is taken as a shell
    axes = getattr(support, "axes", None)
    own = np.eye(3) if axes is None else np.array(axes)
    return letter == "r" or bool(np.abs(own["xyz".index(letter)] @ axis) > 1.0 - 1e-9)


def _within(held: Selection, chosen: Selection, space: Mesh) -> Ints:
    """Edges that a support holds."""
    if held.dimension < chosen.dimension:
        return np.zeros(0, dtype=np.int64)
    if held.dimension == chosen.dimension:
        return held.members
    return np.unique(space.triangle_edges[held.members])


def _axis_words(letter: str, axis: Floats) -> str:
    return letter if np.abs(axis).max() > 1.0 - 1e-9 else place(axis)
