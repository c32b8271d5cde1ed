"""Supports as conditions on single freedoms of nodes: 1 to 3 translations, 4 to 6 rotations about x, y, z."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError
from kshell.export.nodes import Nodes
from kshell.scene.placed import Placed
from kshell.scene.structure import Structure
from kshell.scene.supports import Clamped, Fixed, Free, SimplySupported, Symmetry
from kshell.shell.koiter.conormal import across_line
from kshell.shell.koiter.surface import Surface
from kshell.shell.planes import plane_normal

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

ALONG = 1e-3  # how far, as a sine, a plane that was found may miss the axes
TRANSLATIONS = {"x": 1, "y": 2, "z": 3}


class Hold(NamedTuple):
    """Nodes with one freedom held at values."""

    nodes: Ints
    freedom: int
    values: Floats


def holds(structure: Structure, nodes: Nodes, plate: bool) -> Iterator[Hold]:
    """Conditions of all supports; of plates nothing moves in the plane.

    Raises
    ------
    InputError
        For supports that are no conditions on single freedoms along x, y and z.
    """
    if plate:
        every = np.arange(len(nodes.points))
        for freedom in (1, 2):
            yield Hold(every, freedom, np.zeros(len(every)))
    for placed in structure.supports:
        item: Any = placed.item
        if placed.link is not None or placed.place is None:
            raise InputError(f"{item}: rigid links are not written into .inp files")
        if getattr(item, "axes", None) is not None or item.rotation is not None:
            raise InputError(f"{item}: own axes and prescribed rotations are not written into .inp files")
        chosen = nodes.on(placed.place.dimension, placed.place.members)
        for freedom in _translations(item, placed, nodes, plate):
            values = np.zeros(len(chosen))
            if item.value is not None:
                values = item.translation_at(nodes.points[chosen])[:, freedom - 1]
            yield Hold(chosen, freedom, values)
        if "r" in item.freedoms:
            yield from _rotations(placed, nodes, chosen)


def _translations(item: Any, placed: Placed[Any], nodes: Nodes, plate: bool) -> list[int]:
    """Freedoms 1 to 3 that a support holds; of plates the third alone."""
    if isinstance(item, Symmetry):
        held = [_axis(item, _normal(placed, nodes))]
    elif isinstance(item, Free | Clamped | SimplySupported | Fixed):
        held = [TRANSLATIONS[letter] for letter in item.freedoms if letter in TRANSLATIONS]
    else:
        kind = item.kind.replace("_", " ")
        raise InputError(f"{item}: {kind} supports are not written into .inp files: leave it out")
    return [freedom for freedom in held if freedom == 3] if plate else held


def _rotations(placed: Placed[Any], nodes: Nodes, chosen: Ints) -> Iterator[Hold]:
    """No rotation about edges, at points and on surfaces about no axis.

    Edges that run askew are held about the axis nearest to them: about two of them the turning of the surface in itself
    would be held, too, which CalculiX makes stiff.
    """
    assert placed.place is not None
    if placed.place.dimension != 1:
        for freedom in (4, 5, 6):
            yield Hold(chosen, freedom, np.zeros(len(chosen)))
        return
    rows = nodes.edge(placed.place.members)
    x = nodes.points[rows]
    along = np.zeros((len(nodes.points), 3))
    np.add.at(along, rows.ravel(), np.repeat(np.abs(x[:, 2] - x[:, 0]), 3, axis=0))
    axis = np.argmax(along[chosen], axis=1)
    for k in range(3):
        mine = chosen[axis == k]
        if len(mine):
            yield Hold(mine, 4 + k, np.zeros(len(mine)))


def _normal(placed: Placed[Any], nodes: Nodes) -> Floats:
    """The normal of the plane in which the support lies, across the surface."""
    assert placed.place is not None
    if placed.place.dimension != 1:
        raise InputError(f"{placed.item}: symmetry is written into .inp files for curves only")
    edges = placed.place.members
    x = nodes.points[nodes.on(1, edges)]
    surface = Surface(nodes.mesh, nodes.mesh.order)
    return plane_normal(x, str(placed.item), None, lambda: across_line(surface, edges))


def _axis(item: Any, direction: Floats) -> int:
    """1, 2 or 3: the axis along a direction."""
    k = int(np.argmax(np.abs(direction)))
    if np.linalg.norm(np.delete(direction, k)) > ALONG:
        raise InputError(
            f"{item}: its plane is not normal to x, y or z, and conditions along other axes are not written into "
            ".inp files"
        )
    return k + 1
