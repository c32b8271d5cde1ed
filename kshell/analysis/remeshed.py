"""The geometry file of a scene meshed anew, with triangles as large as a tolerance wants them.

Decided by measurement, CPU seconds of the whole way with gmsh in it, bisection / meshing anew at every level, to
tolerances of 1e-2, 1e-3 and 1e-4; starts of 8 to 62 triangles that turn by .5 to .9 rad:

    tube with a round cut-out (STEP)     .65 / .64   missed / 1.1  not run / 2.0
    the same, start of 222 triangles     .71 / .50   2.7 / .86     7.9 / 2.6
    clamped quarter of a cylinder        .27 / .21    .41 / .27     .78 / .57
    B-spline surface, 5 by 5 poles       .26 / .34    .85 / .39    1.6 / .62

The tube's small start cannot be bisected: finer triangles fold where the rim bends inside them, and those that are left
on the quadratic triangles before had an interval that missed the truth. So curved shells of geometry files are meshed
anew at every level. What stays with bisection: plates, whose few triangles of high order and graded corners are
cheaper (`Followed` puts their nodes on the curves); shells of plane faces, which bisection follows exactly; regular
meshes (Transfinite, Layers), which gmsh makes as the file says whatever the sizes; meshes of other files, which keep
their triangles.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.error.geometry_share import turn_of_triangles
from kshell.errors import InputError
from kshell.mesh.by_size import mesh_by_size, sizes_at_vertices, sizes_of_triangles
from kshell.mesh.mesh import Mesh
from kshell.mesh.read import GEOMETRY_SUFFIXES, STRAIGHT_INSTEAD
from kshell.mesh.refine import longest_first
from kshell.scene.facets import curved
from kshell.scene.scene import Scene

Floats = NDArray[np.float64]

TRIES, SMALLER = 3, 0.7  # where triangles fold
FINER = 0.5  # of the number of triangles that the sizes ask for, at least


@dataclass(frozen=True, eq=False)
class Remesher:
    """Meshes of the geometry file of a scene.

    Attributes
    ----------
    scene : Scene
    path : Path
    order : 1 or 2
    places : (n, 3) array
        Of probes, single loads, supports and masses: they become vertices.
    allow_system : bool
        Whether the file may run programs and write files.
    """

    scene: Scene
    path: Path
    order: int
    places: Floats
    allow_system: bool

    @classmethod
    def of(cls, scene: Scene, mesh: Mesh, allow_system: bool) -> Remesher | None:
        """For the first mesh of a scene; None where that was not made from a geometry file, or was cut open after."""
        path = scene.mesh
        if (
            not isinstance(path, Path)
            or path.suffix.lower() not in GEOMETRY_SUFFIXES
            or scene.chart
            or scene.cuts
        ):
            return None
        folded = any(note.startswith(STRAIGHT_INSTEAD) for note in mesh.notes)
        single = [in_space(at, mesh) for at in (*scene.probes.values(), *single_places(scene))]
        return cls(scene, path, 2 if folded else mesh.order, np.array(single).reshape(-1, 3), allow_system)

    def anew(self, mesh: Mesh, ratios: Floats) -> Mesh:
        """A mesh whose triangles are smaller than those of the one before by the ratios (triangle,) wanted.

        Raises
        ------
        InputError
            If gmsh cannot make one, or makes one that is no finer.
        """
        wanted = sizes_of_triangles(mesh) * ratios
        expected = FINER * float((ratios**-2.0).sum())
        for tries in range(TRIES):
            try:
                new = mesh_by_size(
                    mesh,
                    sizes_at_vertices(mesh, wanted),
                    self.path,
                    self.order,
                    self.places,
                    self.allow_system,
                )
                break
            except InputError:
                if tries + 1 == TRIES:
                    raise
                wanted = SMALLER * wanted
        if len(new.triangles) < expected:
            raise InputError(
                f"{self.path.name}: gmsh makes {len(new.triangles)} triangles whatever sizes are wanted: the file asks "
                "for a regular mesh (Transfinite, Layers), or its surfaces are too small"
            )
        return longest_first(curved(self.scene, new))


def turns(mesh: Mesh) -> Floats:
    """(triangle,) angle by which a triangle of order 2 turns: between its normals, or along one of its edges."""
    out = turn_of_triangles(mesh)
    if mesh.midpoints is None:
        return out
    sagitta = np.linalg.norm(mesh.midpoints - mesh.points[mesh.edges].mean(axis=1), axis=1)
    along = 8.0 * sagitta / mesh.edge_lengths  # of a parabola
    return np.asarray(np.maximum(out, along[mesh.triangle_edges].max(axis=1)))


def single_places(scene: Scene) -> list[Any]:
    """Points at which single supports, loads and masses stand."""
    return [item.on for item in (*scene.supports, *scene.loads, *scene.masses) if _is_place(item.on)]


def in_space(place: Any, mesh: Mesh) -> Floats:
    """A place of two or three coordinates; in the plane of a flat mesh."""
    at = np.asarray(place, dtype=float)
    return np.array([*at[:2], mesh.points[0, 2]]) if len(at) == 2 or mesh.is_flat else at


def _is_place(on: Any) -> bool:
    return isinstance(on, tuple | list | np.ndarray) and len(on) in (2, 3) and not isinstance(on[0], str)
