"""The next mesh of a structure: bisected, its new nodes where its curves and surfaces are."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from kshell.analysis.followed import Followed
from kshell.equilibrium.model import Model
from kshell.errors import InputError
from kshell.mesh.mesh import Mesh
from kshell.mesh.refine import Refined, bisect
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


class Refiner:
    """Finer and finer meshes of one scene.

    New nodes of a plate lie on its curved edges as the first mesh has them, those of a mesh of order 2 with a geometry
    on that, of others on the quadratic triangles before.

    Parameters
    ----------
    scene : Scene
    model : Model
        On the first mesh.

    Attributes
    ----------
    followed : Followed or None
        The curved edges of a plate.
    """

    def __init__(self, scene: Scene, model: Model) -> None:
        self.scene = scene
        self.followed: Followed | None = None
        if model.kind == "plate":
            curved = isinstance(model, PlateModel) and model.problem.element.maxdeg > 2
            domain = model.problem.domain if curved else Domain(model.structure.space, True)  # type: ignore[attr-defined]
            self.followed = Followed.of(model.structure.space, domain)

    def refined(self, mesh: Mesh, marked: NDArray[np.integer]) -> Refined:
        """A mesh (in its parameters on a chart), the first or the last one from here, with triangles cut."""
        if self.followed is not None:
            found, self.followed = self.followed.bisected(mesh, marked)
            return found
        fine = bisect(mesh, marked)
        path = geometry_of(self.scene)
        if mesh.midpoints is None or path is None or self.scene.chart is not None:
            return fine
        from kshell.mesh.on_geometry import put_on_geometry

        try:
            found_mesh = put_on_geometry(replace(fine.mesh, midpoints=None), path)
        except InputError:
            return (
                fine  # the geometry cannot be looked at again: its nodes are kept, its share is in the budget
            )
        return Refined(replace(found_mesh, notes=mesh.notes), fine.parent)
