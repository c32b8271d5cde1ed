"""Rigid motions that supports leave, as modes: found, M-orthonormal, named, and taken part in by other modes.

Symbols
-------
r = (t, omega)   translation (3,) and turn (3,) of a rigid motion, u(x) = t + omega x (x - c), c the centre of mass
R                (unknowns, 6) the six of them as motions of the unknowns
T                basis of the free motions, x = T q
M                mass on all unknowns
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.mesh.words import place
from kshell.solvers.eigenbasis import orthonormal
from kshell.solvers.nearest import nearest

Floats = NDArray[np.float64]

# resistance to a motion, relative to the largest one in the part, that counts as none
LOOSE = 1e-10
# so much of a unit vector is rounding in words
ROUND = 1e-6


class RigidPart(NamedTuple):
    """A part of the structure that hangs together.

    Attributes
    ----------
    motions : (unknowns, k) array
        Rigid motions, turns about the centre in radians, zero outside the part.
    kinds : (6, k) array
        Each as (t, omega).
    centre : (3,) array
        Of mass.
    size : float
        A length of the part.
    where : str
        Words for the part, empty where there is only one.
    """

    motions: Floats
    kinds: Floats
    centre: Floats
    size: float
    where: str = ""


class RigidModes(NamedTuple):
    """Free rigid motions.

    Attributes
    ----------
    vectors : (free, r) array
        In the free unknowns, M-orthonormal.
    names : list of str
        Such as "translation along x", "rotation about z".
    """

    vectors: Floats
    names: list[str]


def rigid_modes(
    parts: Sequence[RigidPart], basis: Any, mass: Any, springs: Any = None, scale: Floats | None = None
) -> RigidModes:
    """Rigid motions that neither supports nor springs resist.

    Parameters
    ----------
    basis : (unknowns, free) sparse
        T.
    mass : (free, free) sparse
        T^T M T.
    springs : (free, free) sparse, optional
    scale : (unknowns,), optional
        By which unknowns of different kinds are divided before they are compared.
    """
    rows = basis.tocsc() if scale is None else (sp.diags(1.0 / scale) @ basis).tocsc()
    free = rows.shape[1]
    best = nearest(rows)
    vectors, names = [np.zeros((free, 0))], []
    for part in parts:
        motion = part.motions * np.where(np.abs(part.kinds[3:]).any(axis=0), 1.0 / part.size, 1.0)
        scaled = motion if scale is None else motion / scale[:, None]
        q = best(scaled)
        resisted = scaled - rows @ q
        gram = _relative(resisted.T @ resisted, float((scaled**2).sum(axis=0).max()))
        if springs is not None:
            stiff = q.T @ (springs @ q)
            gram = gram + _relative(stiff, float(np.abs(stiff).max()))
        value, combination = np.linalg.eigh(gram)
        loose = combination[:, value < LOOSE * max(value[-1], 1.0)]
        if not loose.shape[1]:
            continue
        scaled_kinds = part.kinds * np.where(np.abs(part.kinds[3:]).any(axis=0), 1.0 / part.size, 1.0)
        loose = _principal(loose, q, mass, scaled_kinds)
        kinds = scaled_kinds @ loose
        vectors.append(orthonormal(mass, q @ loose))
        names += [name_of(kind, part.centre, part.size) + part.where for kind in kinds.T]
    return RigidModes(np.concatenate(vectors, axis=1), names)


def _relative(gram: Floats, largest: float) -> Floats:
    return gram / largest if largest > 0 else gram


def _principal(loose: Floats, q: Floats, mass: Any, kinds: Floats) -> Floats:
    """Combinations that are translations along axes, and turns about principal axes that go with them."""
    turns = (kinds @ loose)[3:] * 1.0
    size = np.abs(kinds).max()
    _, length, rows = np.linalg.svd(turns, full_matrices=True)
    rank = int((length > ROUND * size).sum())
    shift, turn = loose @ rows[rank:].T, loose @ rows[:rank].T
    if shift.shape[1]:
        shift = _along_axes(shift, (kinds @ shift)[:3])
    if rank:
        if shift.shape[1]:  # orthogonal to the translations in the inner product of the mass
            moved = q @ shift
            weight = moved.T @ (mass @ moved)
            turn = turn - shift @ np.linalg.solve(weight, moved.T @ (mass @ (q @ turn)))
        turn = _along_axes(turn, (kinds @ turn)[3:])
        moved = q @ turn
        inertia = moved.T @ (mass @ moved)
        if np.abs(inertia - np.diag(np.diag(inertia))).max() > ROUND * np.abs(inertia).max():
            _, axes = np.linalg.eigh(inertia)
            turn = turn @ axes
            if (
                np.abs(np.diff(np.linalg.eigvalsh(inertia))).min(initial=np.inf)
                < ROUND * np.abs(inertia).max()
            ):
                turn = _along_axes(turn, (kinds @ turn)[3:])
    return np.concatenate([shift, turn], axis=1)


def _along_axes(motions: Floats, directions: Floats) -> Floats:
    """Combinations of motions (k, n) whose directions (3, n) are as close to coordinate axes as they can be."""
    inverse = np.linalg.pinv(directions)
    closeness = np.diag(directions @ inverse)
    axes = np.sort(np.argsort(-closeness, kind="stable")[: motions.shape[1]])
    combined = motions @ inverse[:, axes]
    return combined if np.linalg.matrix_rank(combined, tol=1e-3) == motions.shape[1] else motions


def name_of(kind: Floats, centre: Floats, size: float) -> str:
    """Words for a rigid motion (t, omega)."""
    shift, turn = kind[:3], kind[3:]
    if np.linalg.norm(turn) * size < ROUND * np.linalg.norm(shift):
        return f"translation along {direction_words(shift)}"
    axis = turn / np.linalg.norm(turn)
    words = f"rotation about {direction_words(turn)}"
    aside = np.cross(turn, shift) / (turn @ turn)
    if np.linalg.norm(aside) > ROUND * size:
        words += f" through {place(np.round(centre + aside, 12))}"
    along = float(shift @ axis)
    if abs(along) > ROUND * np.linalg.norm(turn) * size:
        words += f" with {along / np.linalg.norm(turn):.4g} along it per radian"
    return words


def direction_words(vector: Floats) -> str:
    """A coordinate axis by its letter, other directions by their components."""
    unit = vector / np.linalg.norm(vector)
    axis = int(np.argmax(np.abs(unit)))
    if abs(unit[axis]) > 1 - ROUND:
        return "xyz"[axis]
    unit = unit * np.sign(unit[axis])
    return "(" + ", ".join(f"{c + 0.0:.3g}" for c in np.where(np.abs(unit) < ROUND, 0.0, unit)) + ")"


class Participation(NamedTuple):
    """How modes take part in rigid motions of the whole, along x, y, z and about them through the centre of mass.

    Attributes
    ----------
    factors : (mode, 6) array
        phi^T M r of modes with phi^T M phi = 1.
    total : (6,) array
        r^T M r: mass, and moments of inertia.
    """

    factors: Floats
    total: Floats

    @property
    def effective_mass(self) -> Floats:
        """(mode, 6): squares of the factors; over all modes they add up to the total of what supports leave free."""
        return np.asarray(self.factors**2)


def participation(motions: Floats, moving: Floats, basis: Any, vectors: Floats) -> Participation:
    """Of modes (free, mode).

    Parameters
    ----------
    motions : (unknowns, 6) array
        R about the centre of mass.
    moving : (unknowns, 6) array
        M R.
    """
    return Participation((basis @ vectors).T @ moving, np.einsum("ux,ux->x", motions, moving))
