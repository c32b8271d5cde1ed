"""Prescribed rotations that cannot be meant: where there is no outward side, or where they break off at a corner.

With the outward normal n of an edge in the surface, the rotation about it is -w,n. Where another support holds the
displacement along an edge b that meets it at an angle, w,b = 0 there; where it holds another rotation along an edge
that goes on from it, w,n is another one. A slope that jumps at a point costs energy without bound (logarithmically in
the size of the triangles), so whatever a mesh answers there is a matter of the mesh.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.mesh import Mesh
from kshell.mesh.words import place
from kshell.scene.placed import Placed
from kshell.scene.supports import Elastic, Support
from kshell.values.varying import is_constant

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

# sine of the angle between edges that go on from each other, and the part of the largest rotation that is none
SMOOTH, NONE = 0.1, 1e-6


def wrong_turns(supports: Sequence[Placed[Support]], space: Mesh) -> Iterator[str]:
    """What is wrong with prescribed rotations, in words."""
    for placed in supports:
        if placed.item.rotation is None or placed.place is None:
            continue
        words = _not_on_edges(placed, space)
        if words:
            yield words
        else:
            yield from _broken_off(placed, supports, space)


def _not_on_edges(placed: Placed[Support], space: Mesh) -> str:
    chosen = placed.place
    assert chosen is not None  # supports are somewhere
    if chosen.dimension != 1:
        where = "a point" if chosen.dimension == 0 else "a surface"
        return f"{placed.item}: rotation is about edges, and it is on {where}: put it on a curve group of the boundary"
    inside = chosen.members[space.edge_counts[chosen.members] > 1]
    if not len(inside):
        return ""
    return (
        f"{placed.item}: the edge at {place(space.points[space.edges[inside[0]]].mean(axis=0))} lies inside, where a "
        "rotation has no outward side: put it on a boundary edge"
    )


def _broken_off(placed: Placed[Support], supports: Sequence[Placed[Support]], space: Mesh) -> Iterator[str]:
    """Where a rotation meets, at an end of its line, a support that does not let it go on."""
    chosen = placed.place
    assert chosen is not None  # checked by the caller
    ends = space.edges[chosen.members]
    rotation = placed.item.rotation_at(space.points[ends])  # (edge, end)
    largest = np.abs(rotation).max(initial=0.0)
    for other in supports:
        if other is placed or other.place is None or other.place.dimension != 1 or other.link is not None:
            continue
        if isinstance(other.item, Elastic):
            continue
        theirs = np.setdiff1d(other.place.members, chosen.members)
        for edge in theirs[np.isin(space.edges[theirs], ends).any(axis=1)].tolist():
            for vertex in np.intersect1d(space.edges[edge], ends).tolist():
                row, end = np.argwhere(ends == vertex)[0]
                mine, turn = int(chosen.members[row]), float(rotation[row, end])
                straight = abs(_sine(space, mine, edge)) < SMOOTH
                wanted = float(other.item.rotation_at(space.points[vertex][None])[0]) if straight else 0.0
                holds = "r" in other.item.freedoms if straight else _holds_across(other, space)
                if holds and abs(turn - wanted) > NONE * largest:
                    yield _words(placed, other, turn, space.points[vertex])
                    return


def _holds_across(other: Placed[Support], space: Mesh) -> bool:
    """Whether a support holds the displacement across the surface, along its own edge."""
    letters = set(other.item.freedoms)
    if getattr(other.item, "axes", None) is not None or letters >= set("xyz"):
        return letters >= set("xyz")
    return "z" in letters and bool(np.ptp(space.points[:, 2]) == 0.0)


def _sine(space: Mesh, a: int, b: int) -> float:
    along = [space.points[space.edges[edge, 1]] - space.points[space.edges[edge, 0]] for edge in (a, b)]
    sizes = np.linalg.norm(along[0]) * np.linalg.norm(along[1])
    return float(np.linalg.norm(np.cross(*along)) / sizes)


def _words(placed: Placed[Support], other: Placed[Support], turn: float, point: Floats) -> str:
    rotation = placed.item.rotation
    given = f"{rotation:g}" if is_constant(rotation) else f"{turn:.3g} there"
    return (
        f"{placed.item} and {other.item} meet at {place(point)}: the first turns the edge by {given}, the second does "
        "not let it turn, and a slope that jumps takes energy without bound, more on every finer mesh: let the "
        'rotation vanish there, e.g. rotation = "0.1*sin(pi*y)", or leave a part of the edge between the two free'
    )
