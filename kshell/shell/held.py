"""Is the shell held? A rigid motion that no support resists is named before anything is solved.

Every part of the mesh that hangs together by vertices moves rigidly in six ways, r = (t, omega / L). What the
conditions leave of such a motion of the unknowns, R r - T c with the best c, shows what they resist.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.reduction import Reduction
from kshell.equilibrium.rigid_modes import direction_words
from kshell.errors import InputError
from kshell.mesh.mesh import Mesh
from kshell.mesh.unjoined import vertex_parts
from kshell.mesh.words import place
from kshell.shell.discretisation import Discretisation
from kshell.solvers.nearest import beside, picked

Floats = NDArray[np.float64]

# resistance to a motion, relative to the largest one in the part, that counts as none
LOOSE = 1e-10
# the square of a resistance that is rounding, relative to the motion
UNRESISTED = 1e-24
# rounding of a sum of forces, in units of the last digit of all of them together, over the root of how many there are:
# 0.1 to 0.4 on closed spheres of 200 to 3,000 unknowns
LOST = 0.5
# so much of a unit vector is rounding in words
ROUND = 1e-6


@dataclass(frozen=True)
class Hanging:
    """Rigid motions of a part that nothing but springs resists.

    Attributes
    ----------
    motions : (unknowns, k)
        Translations, and turns by 1 / size of the part.
    stiffness : (k, k)
    """

    motions: Floats
    stiffness: Floats

    def moved_by_rounding(self, forces: Floats) -> float:
        """Displacement that may come from the rounding of forces (unknowns,) that balance each other."""
        gross = np.abs(self.motions).T @ np.abs(forces)
        lost = LOST * np.sqrt(len(forces)) * np.finfo(float).eps
        drift = np.linalg.pinv(self.stiffness, hermitian=True) * (lost * gross)
        return float(np.abs(drift).max(initial=0.0))


def require_held(
    mesh: Mesh, discretisation: Discretisation, reduction: Reduction, springs: sp.csr_matrix | None
) -> list[Hanging]:
    """The rigid motions that springs alone resist; InputError if a part can move freely, naming motion and part.

    Parameters
    ----------
    mesh : Mesh
        In space.
    discretisation : KoiterDiscretisation or ArgyrisDiscretisation
    """
    part = vertex_parts(mesh)
    count = int(part.max()) + 1
    part_of_unknown = part[discretisation.vertex_of_unknown()]
    # translations, turns and derivatives are compared as displacements: what counts as none has no unit
    unit = 1.0 / discretisation.unknown_sizes()
    scaling = picked(reduction.basis) is None
    rest = beside((sp.diags(unit) @ reduction.basis).tocsc() if scaling else reduction.basis)
    hanging = []
    for number in range(count):
        x = mesh.points[part == number]
        centre = 0.5 * (x.min(axis=0) + x.max(axis=0))
        size = float(np.linalg.norm(np.ptp(x, axis=0)))
        motion = discretisation.rigid_motions(centre, size)
        motion[part_of_unknown != number] = 0.0
        scaled = unit[:, None] * motion
        resisted = rest(scaled)
        gram = resisted.T @ resisted / float((scaled**2).sum(axis=0).max())
        if springs is not None:
            stiff = motion.T @ (springs @ motion)
            value, vector = np.linalg.eigh(gram)
            loose = vector[:, value < max(LOOSE * value[-1], UNRESISTED)]
            if loose.shape[1]:
                hanging.append(Hanging(motion @ loose, loose.T @ stiff @ loose))
            largest = np.abs(stiff).max()
            gram = gram + (stiff / largest if largest > 0 else stiff)
        value, vector = np.linalg.eigh(gram)
        free = vector[:, value < max(LOOSE * value[-1], UNRESISTED)]
        if free.shape[1]:
            where = ""
            if count > 1:
                inside = int((part[mesh.triangles[:, 0]] == number).sum())
                where = (
                    f" (the part of {inside} triangles around {place(x.mean(axis=0))}, one of {count} parts)"
                )
            raise InputError(_words(free, centre, size, where))
    return hanging


def _words(free: Floats, centre: Floats, size: float, where: str) -> str:
    if free.shape[1] == 6:
        return (
            f"the shell{where} is not held: it can move along x, y and z and turn about them; add supports, for "
            "example clamped or simply_supported on a curve group"
        )
    motions = [_motion(column, centre, size) for column in _sorted_out(free).T]
    many = f"in {len(motions)} ways" if len(motions) > 1 else "freely"
    return (
        f"the shell{where} can move as a rigid body {many}: it can {'; it can '.join(motions)}. Hold these motions, "
        'for example with symmetry, clamped, or the exact freedoms fix = "x"'
    )


def _sorted_out(free: Floats) -> Floats:
    """The same motions, pure translations first, translations and turns along axes where possible."""
    _, size, rows = np.linalg.svd(free[3:], full_matrices=True)  # rotations of the combinations
    rank = int((size > ROUND).sum())
    turns, shifts = free @ rows[:rank].T, free @ rows[rank:].T
    out = []
    if shifts.shape[1]:
        out.append(_along_axes(shifts, shifts[:3]))
        turns = turns.copy()
        turns[:3] -= shifts[:3] @ (np.linalg.pinv(shifts[:3]) @ turns[:3])
    if rank:
        out.append(_along_axes(turns, turns[3:]))
    return np.concatenate(out, axis=1)


def _along_axes(motions: Floats, directions: Floats) -> Floats:
    """Combinations of motions (6, n) whose directions (3, n) are as close to coordinate axes as they can be."""
    inverse = np.linalg.pinv(directions)
    closeness = np.diag(directions @ inverse)
    axes = np.sort(np.argsort(-closeness, kind="stable")[: motions.shape[1]])
    combined = motions @ inverse[:, axes]
    return combined if np.linalg.matrix_rank(combined, tol=1e-3) == motions.shape[1] else motions


def _motion(motion: Floats, centre: Floats, size: float) -> str:
    shift, turn = motion[:3], motion[3:] / size
    if np.linalg.norm(turn) * size < ROUND * np.linalg.norm(shift):
        return f"move along {direction_words(shift)}"
    axis = turn / np.linalg.norm(turn)
    # u = shift + turn x (x - centre) vanishes, but for a part along the axis, on the line through this point
    point = centre + np.cross(turn, shift) / (turn @ turn)
    words = f"turn about the axis through {place(size * np.round(point / size, 12))} along {direction_words(axis)}"
    along = float(shift @ axis)
    if abs(along) > ROUND * max(np.linalg.norm(shift), np.linalg.norm(turn) * size):
        words += f" while it moves along it by {along / np.linalg.norm(turn):.4g} per radian"
    return words
