"""A shell that is not quite the one drawn: its nodes are moved before anything is solved, without stress."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kshell.equilibrium.bifurcation import buckling_modes
from kshell.equilibrium.model import Model
from kshell.errors import InputError, clipped
from kshell.mesh.words import is_file, place
from kshell.scene.imperfection import Imperfection
from kshell.shell.koiter.model import KoiterModel
from kshell.shell.limits import USE_KOITER
from kshell.shell.problem import ShellProblem
from kshell.shell.reference import lagrange, lattice

Floats = NDArray[np.float64]

# how far the points of a file may lie off the vertices, against the size of the mesh
APART = 1e-6


def imperfect(model: Model) -> KoiterModel:
    """The model with the imperfection of its structure: nodes moved, and words about it among its reasons.

    Raises
    ------
    InputError
        If the file does not fit the mesh, or the discretisation has no nodes to move.
    SolveError
        If there are not so many buckling modes.
    """
    imperfection = model.structure.imperfection
    assert imperfection is not None
    if not isinstance(model, KoiterModel):
        raise InputError(f"imperfection: Argyris elements on a chart follow the chart: {USE_KOITER}")
    problem = model.problem
    if imperfection.file is not None:
        offsets, what = _of_file(problem, imperfection), f"{imperfection.file.name}"
    else:
        problem.require_no_links()
        mode = buckling_modes(problem.equilibrium(), problem.load, imperfection.mode)[-1]
        offsets = problem.energy.surface.split(mode.motion)[0]
        what = f"linear buckling mode {imperfection.mode}, load factor {mode.factor:.6g}"
    largest = float(np.linalg.norm(offsets, axis=1).max())
    if largest == 0.0:
        raise InputError(f"imperfection: {what} moves no node: leave it out")
    amplitude = largest if imperfection.amplitude is None else imperfection.amplitude
    words = f"imperfection: nodes are moved by up to {abs(amplitude):.6g}, {what}"
    return KoiterModel(model.structure, model.order, [*model.reasons, words], offsets * (amplitude / largest))


def _of_file(problem: ShellProblem, imperfection: Imperfection) -> Floats:
    """(node, 3): offsets of the vertices, and between them their interpolation along edges and triangles."""
    from scipy.spatial import cKDTree

    mesh, surface = problem.space, problem.energy.surface
    points, values = _read(imperfection)
    distance, vertex = cKDTree(mesh.points).query(points)
    worst = int(np.argmax(distance))
    if distance[worst] > APART * mesh.size:
        raise InputError(
            f"imperfection: {imperfection.file}: the point {place(points[worst])} lies {distance[worst]:.3g} off the "
            "next vertex of the mesh: give the offsets of vertices"
        )
    at_vertices = np.zeros((len(mesh.points), 3))
    at_vertices[vertex] = values
    shape = lagrange(1, lattice(surface.order))  # (node, corner)
    offsets = np.zeros((surface.node_count, 3))
    offsets[surface.triangle_nodes] = shape @ at_vertices[mesh.triangles]
    return offsets


def _read(imperfection: Imperfection) -> tuple[Floats, Floats]:
    """Points and offsets, (n, 3) each."""
    path = imperfection.file
    if not is_file(path):
        raise InputError(f"imperfection: {clipped(path)}: no such file")
    if path.suffix == ".vtu":
        import meshio

        found = meshio.read(path)
        if imperfection.field not in found.point_data:
            raise InputError(
                f'imperfection: {path}: no field "{imperfection.field}": it has {", ".join(found.point_data)}'
            )
        vertices = np.unique(np.concatenate([cells.data[:, :3].ravel() for cells in found.cells]))
        values = np.asarray(found.point_data[imperfection.field], dtype=float)
        points, values = found.points[vertices], values[vertices]
    else:
        try:
            table = np.loadtxt(path, ndmin=2, delimiter="," if path.suffix == ".csv" else None)
        except ValueError as error:
            raise InputError(f"imperfection: {path}: {error}") from None
        if table.shape[1] != 6:
            raise InputError(f"imperfection: {path}: a line has x y z dx dy dz, not {table.shape[1]} numbers")
        points, values = table[:, :3], table[:, 3:]
    if values.ndim != 2 or values.shape[1] != 3 or not np.isfinite(values).all():
        raise InputError(f"imperfection: {path}: the offsets are not finite vectors in space")
    return points, values
