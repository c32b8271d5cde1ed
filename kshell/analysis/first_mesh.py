"""The first mesh of a refinement: vertices where a scene has places, graded toward corners that are known."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kshell.analysis.plate_choice import has_curved_edges
from kshell.analysis.refined_mesh import Refiner
from kshell.analysis.remeshed import in_space, single_places
from kshell.analysis.run import Run
from kshell.error.bounds import ORDER
from kshell.error.geometry_share import (
    curvature_of_triangles,
    domed,
    share_of_chart,
    turn_of_triangles,
)
from kshell.error.marking import MOST_HALVINGS, halvings
from kshell.error.plates import vertex_at
from kshell.error.premises import require_pair
from kshell.errors import InputError
from kshell.mesh.insert import with_vertices
from kshell.mesh.mesh import Mesh
from kshell.mesh.refine import bisect, bisect_around, cuttable
from kshell.plate.corner_exponents import corner_exponents
from kshell.plate.domain import Domain
from kshell.plate.hhj.model import HHJModel
from kshell.plate.model import PlateModel

Floats = NDArray[np.float64]

TURN, LARGEST_TURN = 0.1, 0.4  # radians by which a triangle of the first mesh may turn
SHARE_SHAPE = 0.3  # of the tolerance, that a shape may use up
MOST_CUTS = 60
MOST_MORLEY = 10  # halvings toward a corner: the matrix of smaller triangles has no digits left for the plate


def plate_start(
    model: PlateModel | HHJModel,
    mesh: Mesh,
    names: Sequence[str],
    run: Run,
    refiner: Refiner,
    most: int = MOST_HALVINGS,
) -> tuple[Mesh, bool]:
    """The first mesh of a plate, and whether guaranteed bounds can be had on it.

    Those are of Argyris elements on straight edges. A mesh with curved edges is graded toward corners alone.

    Parameters
    ----------
    most : int
        Halvings toward a corner.
    """
    problem = model.problem
    tolerance = float(run.options.tolerance)
    if has_curved_edges(model):
        domain = Domain(problem.mesh, True, problem.domain.bent)
        for vertex, exponent in corner_exponents(problem, domain).items():
            for _ in range(min(halvings(exponent, tolerance), most)):
                around = (mesh.triangles == vertex).any(axis=1)
                if not cuttable(mesh)[around].all():
                    break
                mesh = refiner.refined(mesh, np.flatnonzero(around))
        return mesh, False
    if mesh.midpoints is not None:  # straight edges need no nodes in their middle, and bounds take none
        mesh = Mesh(mesh.points, mesh.triangles, None, mesh.groups)
    pair = model.element == "argyris"
    if pair:
        try:
            require_pair(problem, ORDER)
        except InputError:
            return mesh, False
    probes = [model.structure.probes[name] for name in names]
    places = np.array([in_space(p, mesh) for p in (*probes, *single_places(run.scene))]).reshape(-1, 3)
    mesh, left = with_vertices(mesh, places)
    pair = pair and not any(number < len(probes) for number in left)
    exponents = corner_exponents(problem)
    corners = problem.mesh.points[np.array(list(exponents), dtype=np.int64)]
    most = min(most, MOST_MORLEY) if model.element == "morley" else most
    for place, exponent in zip(corners, exponents.values(), strict=True):
        times = min(halvings(exponent, tolerance), most)
        mesh = bisect_around(mesh, np.array([vertex_at(mesh, place)]), times)
    if model.element != "morley":
        near = max(int(np.log2(1.0 / tolerance) / 2.0) - 3, 0)
        for place in places[: len(probes)]:
            mesh = bisect_around(mesh, np.array([vertex_at(mesh, place)]), near)
    return mesh, pair


def shell_start(run: Run, mesh: Mesh, membrane: float) -> Mesh:
    """Triangles on a chart that turn by too much for its interpolants are cut beforehand.

    ``membrane`` is its share in the energy.
    """
    if run.scene.chart is None:
        return mesh
    most = SHARE_SHAPE * float(run.options.tolerance)
    order = 3 if run.options.order == "auto" else int(run.options.order)
    for _ in range(MOST_CUTS):
        structure = run.on_mesh(mesh).structure
        space = structure.space
        turn = turn_of_triangles(space)
        slender = structure.thickness * curvature_of_triangles(space)
        share = share_of_chart(order, turn, domed(space), membrane, slender)
        large = (turn > LARGEST_TURN) | ((turn > TURN) & (share > most))
        if not large.any():
            break
        mesh = bisect(mesh, np.flatnonzero(large)).mesh
    return mesh
