"""A plate as the method of Lehmann and Goerisch needs it: trial functions anywhere, and moments under loads."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from kshell.elements import matrices
from kshell.error.goerisch import Trial
from kshell.plate.hhj.geometry import Triangles
from kshell.plate.hhj.system import HHJSystem
from kshell.plate.hhj.translate import bending_stiffness, held
from kshell.plate.problem import PlateProblem
from kshell.plate.vibration import energies
from kshell.solvers.pencil import Pencil

Floats = NDArray[np.float64]


def trial_of(problem: PlateProblem, pencil: Pencil, values: Floats, vectors: Floats) -> Trial:
    """Rigid motions, then modes, as trial functions.

    Parameters
    ----------
    pencil : Pencil
        With the rigid motions.
    values : (rigid + mode,) array
    vectors : (free, mode) array
    """
    q = np.concatenate([pencil.rigid, vectors], axis=1)
    rigid = pencil.rigid.shape[1]
    energy = np.zeros((q.shape[1], q.shape[1]))
    energy[rigid:, rigid:] = energies(problem, vectors)
    d = problem.reduction.matrix() @ q
    triangles = np.arange(len(problem.mesh.triangles))
    affine = problem.domain.affine(triangles)
    reference = problem.element.transformation(affine) @ d[problem.layout.triangle_dofs(triangles)]
    itself = np.broadcast_to(np.eye(problem.element.count), (len(triangles), *(2 * [problem.element.count])))

    def at(xy: Floats) -> Floats:
        rows = matrices.rows(problem.element, affine, affine.reference_coordinates(xy), 0, itself)[:, :, 0]
        return np.moveaxis(rows @ reference, 2, 0)

    def curvature(xy: Floats) -> Floats:
        rows = matrices.rows(problem.element, affine, affine.reference_coordinates(xy), 2, itself)
        return np.moveaxis(rows @ reference[:, None], 3, 0)

    centres = problem.mesh.points[problem.mesh.triangles].mean(axis=1)[:, None]
    mass = problem.section.mass(triangles, centres)[:, 0]
    return Trial(values, energy, q.T @ (pencil.mass @ q), at, mass, curvature)


def hhj_system(problem: PlateProblem, order: int, rigid: Floats) -> HHJSystem:
    """The plate with Hellan-Herrmann-Johnson elements; held at some vertices where it moves rigidly.

    Loads in equilibrium with themselves need no reaction there, and modes are such loads.

    Parameters
    ----------
    rigid : (free, r) array
        Rigid motions that the supports leave.
    """
    triangles = Triangles(problem.mesh)
    conditions = held(triangles, order, problem.supports)
    if rigid.shape[1]:
        from scipy.linalg import qr

        layout = problem.layout
        w = (problem.reduction.matrix() @ rigid)[
            : layout.per_vertex * layout.vertex_count : layout.per_vertex
        ]
        _, _, chosen = qr(w.T, mode="economic", pivoting=True)
        vertices = np.union1d(conditions.vertices, chosen[: rigid.shape[1]])
        conditions = replace(conditions, vertices=vertices.astype(np.int64))
    return HHJSystem(triangles, order, bending_stiffness(problem.section), conditions)
