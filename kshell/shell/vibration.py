"""What vibration needs of a shell beside its stiffness: rigid motions and how modes take part in them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.rigid_modes import Participation, RigidModes, RigidPart, participation, rigid_modes
from kshell.mesh.unjoined import vertex_parts
from kshell.mesh.words import place
from kshell.shell.problem import ShellProblem

Floats = NDArray[np.float64]


class _Weights(NamedTuple):
    """Mass of each quadrature point, with its place and part."""

    mass: Floats  # (triangle, point)
    points: Floats  # (triangle, point, 3)
    part: np.ndarray  # (triangle,)

    def centre(self, part: int | None = None) -> Floats:
        inside = slice(None) if part is None else self.part == part
        mass = self.mass[inside]
        return np.asarray(np.einsum("tq,tqx->x", mass, self.points[inside]) / mass.sum())


def _weights(problem: ShellProblem) -> _Weights:
    mesh = problem.space
    every = np.arange(len(mesh.triangles))
    points, weight = problem.discretisation.interior_points(every)
    density = problem.section.mass(every, points)
    return _Weights(weight * density, points, vertex_parts(mesh)[mesh.triangles[:, 0]])


def rigid_modes_of(problem: ShellProblem, mass: sp.csr_matrix) -> RigidModes:
    """The rigid motions that the supports leave, part by part of the mesh."""
    weights, mesh, discretisation = _weights(problem), problem.space, problem.discretisation
    part = vertex_parts(mesh)
    part_of_unknown = part[discretisation.vertex_of_unknown()]
    parts = []
    for number in range(int(part.max()) + 1):
        x = mesh.points[part == number]
        centre = weights.centre(number)
        motions = discretisation.rigid_motions(centre, 1.0)
        motions[part_of_unknown != number] = 0.0
        where = f" of the part around {place(x.mean(axis=0))}" if part.max() > 0 else ""
        parts.append(RigidPart(motions, np.eye(6), centre, float(np.linalg.norm(np.ptp(x, axis=0))), where))
    springs = None if problem.springs is None else problem.reduction.reduce(problem.springs)
    return rigid_modes(parts, problem.reduction.basis, mass, springs)


def participation_of(problem: ShellProblem, full_mass: sp.csr_matrix, vectors: Floats) -> Participation:
    """Of modes (free, mode) in motions of the whole."""
    motions = problem.discretisation.rigid_motions(_weights(problem).centre(), 1.0)
    return participation(motions, full_mass @ motions, problem.reduction.basis, vectors)


def energies(problem: ShellProblem, vectors: Floats) -> Floats:
    """X^T K X of motions X (free, k), through strains."""
    elastic = problem.energy
    x = problem.reduction.basis @ vectors
    strains = [elastic.linear_strain(column) for column in x.T]
    out = np.empty((len(strains), len(strains)))
    for i, strain in enumerate(strains):
        stress = elastic.stress(strain)
        for j in range(i + 1):
            out[i, j] = out[j, i] = float(np.sum(stress * strains[j]))
    return out if problem.springs is None else out + x.T @ (problem.springs @ x)
