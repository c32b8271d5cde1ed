"""What vibration needs of a plate beside stiffness and mass: rigid motions, energies through curvatures."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.rigid_modes import Participation, RigidModes, RigidPart, rigid_modes
from kshell.mesh.words import place
from kshell.plate.assembly import Part, assemble, residual
from kshell.plate.pattern import Pattern
from kshell.plate.planes import plane_slopes
from kshell.plate.problem import PlateProblem
from kshell.plate.rigid import rigid_motions

Floats = NDArray[np.float64]

# (6, 3): w = 1 is a translation along z, w = y - y_c a turn about x, w = -(x - x_c) one about y
KINDS = np.array([[0.0, 0, 0], [0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0]])
# unknowns from which rounding of the matrix of quintics shows in frequencies
ROUNDED_FROM = 5_000


class Weights:
    """Mass of a plate: total, centre and moments of inertia, of pieces and of the whole."""

    def __init__(self, problem: PlateProblem) -> None:
        self.piece = problem.mesh.sheets
        self.count = int(self.piece.max()) + 1
        z = float(problem.mesh.points[0, 2])
        moments = np.zeros((self.count, 6))  # of 1, x, y, xx, yy, xy
        for patch in problem.domain.patches(4):
            height = np.full((*patch.xy.shape[:2], 1), z)
            density = problem.section.mass(patch.triangles, np.concatenate([patch.xy, height], axis=2))
            x, y = patch.xy[..., 0], patch.xy[..., 1]
            parts = np.stack([np.ones_like(x), x, y, x * x, y * y, x * y])
            here = (parts * patch.weights * density).sum(axis=2).T
            np.add.at(moments, self.piece[patch.triangles], here)
        added = problem.inertia[1:]  # beside that of the material
        for piece in range(self.count) if added else ():
            inside = np.flatnonzero(self.piece == piece)
            d = rigid_motions(problem.domain, problem.layout, np.zeros(3), inside)  # 1, y, -x
            whole = Part(problem.domain, problem.every)
            moving = [residual(added, [], problem.reduction, column, whole) for column in d.T]
            one, y, x = d.T @ np.stack(moving, axis=1)
            moments[piece] += [one[0], -one[2], one[1], x[2], y[1], -y[2]]
        self.moments, self.z = moments, z
        self.middle = problem.mesh.points.mean(axis=0)

    def centre(self, piece: int | None = None) -> Floats:
        """(3,) of mass, of a piece or the whole; some point where there is no mass."""
        m = self.moments.sum(axis=0) if piece is None else self.moments[piece]
        return np.array([m[1] / m[0], m[2] / m[0], self.z]) if m[0] > 0.0 else self.middle

    def total(self) -> Floats:
        """(6,) mass along x, y, z, moments of inertia about x, y, z through the centre."""
        m, c = self.moments.sum(axis=0), self.centre()
        about_x, about_y = m[4] - m[0] * c[1] ** 2, m[3] - m[0] * c[0] ** 2
        return np.array([m[0], m[0], m[0], about_x, about_y, about_x + about_y])


def rigid_modes_of(problem: PlateProblem, mass: sp.csr_matrix) -> RigidModes:
    """The rigid motions that the supports leave, piece by piece."""
    weights, mesh = Weights(problem), problem.mesh
    parts = []
    for number in range(weights.count):
        inside = np.flatnonzero(weights.piece == number)
        corners = mesh.points[mesh.triangles[inside]].reshape(-1, 3)
        centre = weights.centre(number)
        where = ""
        if weights.count > 1:
            where = f" of the piece around {place(corners.mean(axis=0)[:2])}"
        size = float(np.linalg.norm(np.ptp(corners, axis=0)))
        parts.append(
            RigidPart(
                rigid_motions(problem.domain, problem.layout, centre, inside), KINDS, centre, size, where
            )
        )
    springs = None
    if problem.supports.springs:
        forms = [form for _, form in problem.supports.springs]
        springs = assemble(forms, [], problem.domain, problem.reduction, Pattern(problem.reduction)).matrix
    return rigid_modes(parts, problem.reduction.matrix(), mass, springs, problem.layout.scale)


def participation(problem: PlateProblem, vectors: Floats) -> Participation:
    """Of modes (free, mode) in motions of the whole; a plate has none in its plane."""
    weights = Weights(problem)
    every = np.arange(len(problem.mesh.triangles))
    motions = rigid_motions(problem.domain, problem.layout, weights.centre(), every)
    whole = Part(problem.domain, every)
    moving = np.stack(
        [residual(problem.inertia, [], problem.reduction, d, whole) for d in motions.T],
        axis=1,
    )
    factors = np.zeros((vectors.shape[1], 6))
    factors[:, 2:5] = vectors.T @ (problem.reduction.matrix().T @ moving)
    return Participation(factors, weights.total())


def energies(problem: PlateProblem, vectors: Floats, strains: bool = False) -> Floats:
    """X^T K X of motions X (free, k), through curvatures where the entries of K have lost digits.

    See `kshell.plate.product`: the plane through the vertices of each triangle is taken off first.

    Parameters
    ----------
    strains : bool
        Through curvatures in any case.
    """
    quintic = problem.element.maxdeg > 2
    if not quintic or not (strains or problem.reduction.count >= ROUNDED_FROM):
        return np.asarray(vectors.T @ (problem.assembled.matrix @ vectors))
    out = np.zeros((vectors.shape[1], vectors.shape[1]))
    for _, local, _, matrices in bent(problem, vectors):
        out += np.tensordot(local, matrices @ local, axes=([0, 1], [0, 1]))
    others = [form for form in problem.forms if form is not problem.bending]
    if others:
        rest = assemble(others, [], problem.domain, problem.reduction, Pattern(problem.reduction)).matrix
        out += vectors.T @ (rest @ vectors)
    return out


def bent(problem: PlateProblem, vectors: Floats) -> Iterator[tuple[np.ndarray, Floats, Floats, Floats]]:
    """Motions (free, k) of quintics in blocks of triangles, less the planes through their vertices.

    Yields
    ------
    triangles (n,), physical degrees of freedom (n, local, k), the size (n, k) of the slopes before, and of the terms
    whose sums were taken off, and matrices of bending (n, local, local).
    """
    mesh, layout, domain = problem.mesh, problem.layout, problem.domain
    d = problem.reduction.matrix() @ vectors
    step = layout.per_vertex
    for block in domain.blocks():
        local = d[layout.triangle_dofs(block)]  # (triangle, dof, k)
        corners, affine = domain.points[mesh.triangles[block]], domain.affine(block)
        height = np.abs(affine.determinant) / mesh.edge_lengths[mesh.triangle_edges[block]].max(axis=1)
        w, size = local[:, : 3 * step : step], np.abs(local)
        taken = 2.0 * np.ptp(w, axis=1) / height[:, None]
        for axis in (1, 2):
            taken = np.maximum(taken, size[:, axis : 3 * step : step].max(axis=1))
        taken = np.maximum(taken, size[:, 3 * step :].max(axis=1))
        for mode in range(vectors.shape[1]):
            slope = plane_slopes(corners, local[:, : 3 * step : step, mode])
            for vertex in range(3):
                local[:, vertex * step + 1 : vertex * step + 3, mode] -= slope
            local[:, 3 * step :, mode] -= (affine.normals @ slope[:, :, None])[..., 0]
        local[:, : 3 * step : step] = 0.0
        yield block, local, taken, problem.bending.matrices(block, layout.element.transformation(affine))


def energy_rounding(problem: PlateProblem, vectors: Floats, unit: float) -> Floats:
    """(k,) relative rounding of energies through curvatures, sums of terms that are each rounded by a unit.

    Slopes less those of the planes are left with a unit of the slopes before, which bends the triangles.
    """
    layout = problem.layout
    step, k = layout.per_vertex, vectors.shape[1]
    value, terms, left = np.zeros(k), np.zeros(k), np.zeros(k)
    slopes = [vertex * step + axis for vertex in range(3) for axis in (1, 2)]
    slopes += list(range(3 * step, 3 * step + 3))
    for _, local, taken, matrices in bent(problem, vectors):
        size = np.abs(matrices)
        value += (local * (matrices @ local)).sum(axis=(0, 1))
        terms += (np.abs(local) * (size @ np.abs(local))).sum(axis=(0, 1))
        wrong = np.zeros_like(local)
        wrong[:, slopes] = unit * taken[:, None]
        left += (wrong * (size @ wrong)).sum(axis=(0, 1))
    share = np.sqrt(left / value)
    return np.asarray(unit * terms / value + 2.0 * share + share**2)
