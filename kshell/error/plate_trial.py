"""A plate as the method of Lehmann and Goerisch needs it: trial functions anywhere, and moments under loads."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.elements import matrices
from kshell.error.buckling import Pressed
from kshell.error.goerisch import Trial
from kshell.plate.hhj.geometry import Triangles
from kshell.plate.hhj.system import HHJSystem
from kshell.plate.hhj.translate import bending_stiffness, held
from kshell.plate.problem import PlateProblem
from kshell.plate.vibration import energies
from kshell.solvers.critical import CriticalPencil
from kshell.solvers.pencil import Pencil, Spectrum

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
    energy[rigid:, rigid:] = energies(problem, vectors, strains=True)
    jet = _jets(problem, q)
    centres = problem.mesh.points[problem.mesh.triangles].mean(axis=1)[:, None]
    mass = problem.section.mass(np.arange(len(centres)), centres)[:, 0]
    inertia = q.T @ (pencil.mass @ q)
    return Trial(values, energy, inertia, lambda xy: jet(xy, 0)[..., 0], mass, lambda xy: jet(xy, 2))


def pressed_of(
    problem: PlateProblem,
    pencil: CriticalPencil,
    found: Spectrum,
    force: Callable[[NDArray[Any], Floats], Floats],
) -> Pressed:
    """Buckling shapes as trial functions.

    Parameters
    ----------
    found : Spectrum
        Its factors.
    force : function
        (n,) triangles and reference points (n, point, 2) to N (n, point, 2, 2).
    """
    vectors = found.vectors
    jet = _jets(problem, vectors)
    triangles = np.arange(len(problem.mesh.triangles))
    affine = problem.domain.affine(triangles)
    work = -vectors.T @ (pencil.geometric @ vectors)

    def flux(xy: Floats) -> Floats:
        pull = force(triangles, affine.reference_coordinates(xy))
        return -(pull @ jet(xy, 1)[..., None])[..., 0]

    return Pressed(found.values, energies(problem, vectors, strains=True), work, flux, lambda xy: jet(xy, 2))


def _jets(problem: PlateProblem, q: Floats) -> Callable[[Floats, int], Floats]:
    """From places (triangle, point, 2) and 0, 1, 2 to values, slopes or curvatures (mode, triangle, point, row)."""
    d = problem.reduction.matrix() @ q
    triangles = np.arange(len(problem.mesh.triangles))
    affine = problem.domain.affine(triangles)
    reference = problem.element.transformation(affine) @ d[problem.layout.triangle_dofs(triangles)]
    itself = np.broadcast_to(np.eye(problem.element.count), (len(triangles), *(2 * [problem.element.count])))

    def jet(xy: Floats, derivative: int) -> Floats:
        rows = matrices.rows(problem.element, affine, affine.reference_coordinates(xy), derivative, itself)
        return np.moveaxis(rows @ reference[:, None], 3, 0)

    return jet


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
