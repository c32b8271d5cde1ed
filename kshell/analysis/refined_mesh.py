"""The next mesh of a structure: bisected, its new nodes where its curves and surfaces are."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.model import Model
from kshell.errors import InputError
from kshell.mesh.mesh import Mesh
from kshell.mesh.refine import Refined, bisect
from kshell.mesh.triangulation import changed
from kshell.plate.domain import Domain
from kshell.plate.model import PlateModel
from kshell.scene.scene import Scene

Floats = NDArray[np.float64]

GEOMETRY = (".geo", ".step", ".stp", ".brep", ".iges", ".igs")


def geometry_of(scene: Scene) -> Path | None:
    """The file that says how a scene is curved, if there is one."""
    for path in (scene.geometry, scene.mesh):
        if isinstance(path, Path) and path.suffix.lower() in GEOMETRY:
            return path
    return None


def shape_is_known(scene: Scene) -> bool:
    """Whether new nodes can be put on the true shape: on a chart, or on the curves and surfaces of a file."""
    return scene.chart is not None or geometry_of(scene) is not None


def refined(scene: Scene, model: Model, marked: NDArray[np.integer]) -> Refined:
    """The mesh of a model (in its parameters on a chart) with triangles cut, and their parents.

    New nodes of a plate lie on its curved edges, of a mesh of order 2 with a geometry on that, of others on the
    quadratic triangles before.
    """
    mesh = model.structure.parameters
    if isinstance(model, PlateModel) and model.problem.domain.curves.curved.any():
        return _on_curves(mesh, model.problem.domain, marked)
    fine = bisect(mesh, marked)
    path = geometry_of(scene)
    if mesh.midpoints is None or path is None or scene.chart is not None:
        return fine
    from kshell.mesh.on_geometry import put_on_geometry

    try:
        found = put_on_geometry(replace(fine.mesh, midpoints=None), path)
    except InputError:
        return (
            fine  # the geometry cannot be looked at again: its nodes are kept, and its share is in the budget
        )
    return Refined(replace(found, notes=mesh.notes), fine.parent)


def _on_curves(mesh: Mesh, domain: Domain, marked: NDArray[np.integer]) -> Refined:
    """Bisected with new vertices, and mid-edge nodes, on the curved edges of a plate."""
    curves = domain.curves
    bent = curves.edges[curves.curved].astype(np.int64)
    place = curves.place(bent)
    middles = mesh.points[mesh.edges].mean(axis=1)
    chord = mesh.points[mesh.edges[bent]]
    at = [
        (1.0 - s) * chord[:, 0, :2] + s * chord[:, 1, :2] + curves.deviation(place, np.array([s]))[:, 0]
        for s in (0.25, 0.5, 0.75)
    ]
    middles[bent, :2] = at[1]
    straight = replace(mesh, midpoints=None)
    cut_mesh = bisect(straight, marked, middles)
    fine = cut_mesh.mesh
    if mesh.midpoints is None:
        return cut_mesh
    midpoints = fine.points[fine.edges].mean(axis=1)
    same = fine.edge_index(mesh.edges)
    midpoints[same[same >= 0]] = mesh.midpoints[same >= 0]
    new = np.full(len(mesh.edges), -1, dtype=np.int64)
    cut = np.flatnonzero(same < 0)
    new[cut] = len(mesh.points) + np.arange(len(cut))
    split = new[bent] >= 0
    for end, where in ((0, at[0]), (1, at[2])):
        halves = fine.edge_index(np.stack([mesh.edges[bent[split], end], new[bent[split]]], axis=1))
        midpoints[halves, :2] = where[split]
    return Refined(changed(fine, midpoints=midpoints), cut_mesh.parent)
