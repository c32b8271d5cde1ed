"""The weight of added masses: what a gravity load does to them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.mesh import Mesh
from kshell.mesh.select import Selection
from kshell.scene.loads import LineForce, PointForce, Traction
from kshell.scene.placed import Placed

Floats = NDArray[np.float64]

# by the dimension of the place: a force, per length, per area
FORCES = (PointForce, LineForce, Traction)


def weights(masses: Sequence[Placed[Any]], gravity: Placed[Any], mesh: Mesh) -> Iterator[Placed[Any]]:
    """The weight of added masses as loads: of those within the place of a gravity load.

    Curves and points are within a surface group if they belong to a triangle of it.
    """
    for placed in masses:
        place = placed.place
        assert place is not None  # masses are somewhere
        inside = place.members
        if gravity.place is not None:
            triangles = gravity.place.members
            within = (
                (mesh.triangles, mesh.triangle_edges)[place.dimension][triangles]
                if place.dimension < 2
                else triangles
            )
            inside = np.intersect1d(inside, within)
        if not len(inside):
            continue
        force = FORCES[place.dimension](
            on=placed.item.on, value=partial(_weight, placed.item, gravity.item), name=gravity.item.name
        )
        yield Placed(force, Selection(place.dimension, inside.astype(np.int32), place.label))


def _weight(mass: Any, gravity: Any, x: Floats, y: Floats, z: Floats) -> list[Floats]:
    """Components of mass times acceleration."""
    points = np.stack(np.broadcast_arrays(x, y, z), axis=-1)
    return list(np.moveaxis(mass.at(points)[..., None] * gravity.at(points), -1, 0))
