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
    added: tuple[Floats, Floats]  # first moments (part, 3) and masses (part,) of added ones

    def centre(self, part: int | None = None) -> Floats:
        """(3,) of mass; of the area where there is no mass."""
        inside = slice(None) if part is None else self.part == part
        mass, points = self.mass[inside], self.points[inside]
        chosen = slice(None) if part is None else slice(part, part + 1)
        moment = np.einsum("tq,tqx->x", mass, points) + self.added[0][chosen].sum(axis=0)
        total = mass.sum() + self.added[1][chosen].sum()
        return np.asarray(moment / total) if total > 0.0 else points.mean(axis=(0, 1))


def _weights(problem: ShellProblem) -> _Weights:
    mesh = problem.space
    every = np.arange(len(mesh.triangles))
    points, weight = problem.discretisation.interior_points(every)
    density = problem.section.mass(every, points)
    part = vertex_parts(mesh)
    return _Weights(weight * density, points, part[mesh.triangles[:, 0]], _added(problem, part))


def _added(problem: ShellProblem, part: np.ndarray) -> tuple[Floats, Floats]:
    """First moments (part, 3) and masses (part,) of added masses, from what they do to unit motions."""
    count = int(part.max()) + 1
    moments, masses = np.zeros((count, 3)), np.zeros(count)
    added = problem.added_mass
    if added is None:
        return moments, masses
    motions = problem.discretisation.rigid_motions(np.zeros(3), 1.0)
    part_of_unknown = part[problem.discretisation.vertex_of_unknown()]
    for number in range(count):
        moving = motions * (part_of_unknown == number)[:, None]
        pushed = moving.T @ (added @ moving)
        masses[number] = pushed[0, 0]
        # a turn about z moves (x, y) by (-y, x), one about y moves z by -x: u = axis x place
        moments[number] = [pushed[1, 5], -pushed[0, 5], pushed[0, 4]]
    return moments, masses


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
