"""The next mesh of a structure: bisected, its new nodes on its curves and surfaces, or its geometry meshed anew."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from kshell.analysis.followed import Followed
from kshell.analysis.remeshed import Remesher
from kshell.equilibrium.model import Model
from kshell.errors import InputError
from kshell.mesh.mesh import Mesh
from kshell.mesh.read import GEOMETRY_SUFFIXES
from kshell.mesh.refine import bisect
from kshell.plate.domain import Domain
from kshell.plate.model import PlateModel
from kshell.scene.scene import Scene

Floats = NDArray[np.float64]

HALF = 0.5


def geometry_of(scene: Scene) -> Path | None:
    """The file that says how a scene is curved, if there is one."""
    for path in (scene.geometry, scene.mesh):
        if isinstance(path, Path) and path.suffix.lower() in GEOMETRY_SUFFIXES:
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
    allow_system : bool
        Whether geometry files may run programs and write files.

    Attributes
    ----------
    followed : Followed or None
        The curved edges of a plate.
    remesher : Remesher or None
        What meshes the geometry file of a curved shell anew; None where there is none, or gmsh does not.
    lost : str
        Why new nodes do not lie on the geometry any more, in words; empty while they do.
    """

    def __init__(self, scene: Scene, model: Model, allow_system: bool = False) -> None:
        self.scene, self.allow_system = scene, allow_system
        self.followed: Followed | None = None
        self.remesher: Remesher | None = None
        self.lost = ""
        if model.kind == "plate":
            curved = isinstance(model, PlateModel) and model.problem.element.maxdeg > 2
            domain = model.problem.domain if curved else Domain(model.structure.space, True)  # type: ignore[attr-defined]
            self.followed = Followed.of(model.structure.space, domain)
        elif model.structure.space.midpoints is not None:
            self.remesher = Remesher.of(scene, model.structure.parameters, allow_system)

    def sized(self, mesh: Mesh, ratios: Floats) -> Mesh | None:
        """The geometry meshed anew, its triangles smaller by the ratios wanted; None where that cannot be."""
        if self.remesher is None:
            return None
        try:
            return self.remesher.anew(mesh, ratios)
        except InputError:
            self.remesher = None
            return None

    def refined(self, mesh: Mesh, marked: NDArray[np.integer]) -> Mesh:
        """A mesh (in its parameters on a chart), the first or the last one from here, with triangles cut."""
        if self.followed is not None:
            found, self.followed = self.followed.bisected(mesh, marked)
            return found.mesh
        fine = bisect(mesh, marked).mesh
        path = geometry_of(self.scene)
        if mesh.midpoints is None or path is None or self.scene.chart is not None or self.lost:
            return fine
        from kshell.mesh.on_geometry import put_on_geometry

        try:
            found_mesh = put_on_geometry(replace(fine, midpoints=None), path, self.allow_system)
        except InputError as error:
            ratios = np.ones(len(mesh.triangles))
            ratios[marked] = HALF
            anew = self.sized(mesh, ratios)
            if anew is None:
                self.lost = f"new nodes are not put on {path.name}, but on the triangles before ({error})"
            return fine if anew is None else anew
        return replace(found_mesh, notes=mesh.notes)
