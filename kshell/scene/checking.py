"""Whether the supports and loads of a scene act on something, with finite values there."""

from __future__ import annotations

import numpy as np

from kshell.mesh import Mesh, select
from kshell.scene.loads import Load, Temperature
from kshell.scene.places import Place
from kshell.scene.supports import Elastic, Support


def check_support(mesh: Mesh, support: Support) -> None:
    """Raise InputError if the support is on nothing, or what it prescribes has no value at some vertex."""
    points = _vertices(mesh, support.on, str(support))
    support.translation_at(points)
    if isinstance(support, Elastic):
        support.stiffness_at(points)


def check_load(mesh: Mesh, load: Load) -> None:
    """Raise InputError if the load is on nothing, or has no finite value at some vertex.

    Quadrature points lie inside triangles: without this a pole on a vertex or edge goes unnoticed.
    """
    points = mesh.points if load.on is None else _vertices(mesh, load.on, str(load))
    if isinstance(load, Temperature):
        load.curvature_at(points)
        load.strain_at(points)
    else:
        load.at(points)


def _vertices(mesh: Mesh, on: Place, what: str) -> np.ndarray:
    chosen = select(mesh, on, what=what)
    if chosen.dimension == 0:
        return mesh.points[chosen.members]
    corners = mesh.edges if chosen.dimension == 1 else mesh.triangles
    return mesh.points[np.unique(corners[chosen.members])]
