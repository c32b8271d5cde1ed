"""The symmetry classes of elastic stiffness, from triclinic to isotropic.

C is the 6x6 stiffness in the order xx yy zz yz xz xy with engineering shears. The distinguished axis of
monoclinic, tetragonal, trigonal and transversely isotropic (hexagonal) materials is z.

| class | constants | left unchanged by |
|---|---|---|
| triclinic | 21 | nothing |
| monoclinic | 13 | half turn about z |
| orthotropic | 9 | half turns about z and x |
| tetragonal | 6, or 7 with C16 | quarter turn about z |
| trigonal | 6, or 7 with C15 | third of a turn about z |
| transversely isotropic | 5 | every turn about z |
| cubic | 3 | quarter turns about x, y, z |
| isotropic | 2 | every turn |

Source: Nye, Physical Properties of Crystals, 1985, table 9; Ting, Anisotropic Elasticity, 1996, section 2.6.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kshell.errors import InputError
from kshell.material.elasticity import ENGINEERING, PAIRS
from kshell.mesh.words import shown

Floats = NDArray[np.float64]

ALL = tuple(f"C{i}{j}" for i in range(1, 7) for j in range(i, 7))
HALF_DIFFERENCE = {"C11": 0.5, "C12": -0.5}

# class: the constants to give, those that may be left out (zero), and what the others are made of
CLASSES: dict[str, tuple[tuple[str, ...], tuple[str, ...], dict[str, dict[str, float]]]] = {
    "triclinic": (ALL, (), {}),
    "monoclinic": (
        ("C11", "C12", "C13", "C22", "C23", "C33", "C44", "C55", "C66"),
        ("C16", "C26", "C36", "C45"),
        {},
    ),
    "orthotropic": (("C11", "C12", "C13", "C22", "C23", "C33", "C44", "C55", "C66"), (), {}),
    "tetragonal": (
        ("C11", "C12", "C13", "C33", "C44", "C66"),
        ("C16",),
        {"C22": {"C11": 1}, "C23": {"C13": 1}, "C55": {"C44": 1}, "C26": {"C16": -1}},
    ),
    "trigonal": (
        ("C11", "C12", "C13", "C14", "C33", "C44"),
        ("C15",),
        {
            "C22": {"C11": 1}, "C23": {"C13": 1}, "C55": {"C44": 1}, "C66": HALF_DIFFERENCE,
            "C24": {"C14": -1}, "C56": {"C14": 1}, "C25": {"C15": -1}, "C46": {"C15": -1},
        },
    ),
    "transversely isotropic": (
        ("C11", "C12", "C13", "C33", "C44"),
        (),
        {"C22": {"C11": 1}, "C23": {"C13": 1}, "C55": {"C44": 1}, "C66": HALF_DIFFERENCE},
    ),
    "cubic": (
        ("C11", "C12", "C44"),
        (),
        {
            "C22": {"C11": 1}, "C33": {"C11": 1}, "C13": {"C12": 1}, "C23": {"C12": 1},
            "C55": {"C44": 1}, "C66": {"C44": 1},
        },
    ),
    "isotropic": (
        ("C11", "C12"),
        (),
        {
            "C22": {"C11": 1}, "C33": {"C11": 1}, "C13": {"C12": 1}, "C23": {"C12": 1},
            "C44": HALF_DIFFERENCE, "C55": HALF_DIFFERENCE, "C66": HALF_DIFFERENCE,
        },
    ),
}  # fmt: skip
SYNONYMS = {"hexagonal": "transversely isotropic", "orthorhombic": "orthotropic"}

# turns (axis, angle in parts of a full turn) that leave a class unchanged, the most symmetric class first;
# for a tensor of rank four a seventh of a turn stands for all turns about an axis
GENERATORS: tuple[tuple[str, tuple[tuple[str, int], ...]], ...] = (
    ("isotropic", (("z", 7), ("x", 7))),
    ("cubic", (("z", 4), ("x", 4))),
    ("transversely isotropic", (("z", 7),)),
    ("tetragonal", (("z", 4),)),
    ("trigonal", (("z", 3),)),
    ("orthotropic", (("z", 2), ("x", 2))),
    ("monoclinic", (("z", 2),)),
)
WITH_AXIS = ("transversely isotropic", "tetragonal", "trigonal", "monoclinic")


class Symmetry(NamedTuple):
    """A symmetry class and its distinguished axis "x", "y" or "z" (None where there is none)."""

    kind: str
    axis: str | None


def stiffness(kind: str, **constants: float) -> Floats:
    """(6, 6) stiffness of a class from its independent constants, such as C11=..., C12=..., C44=....

    Raises
    ------
    InputError
        If the class is unknown, a constant is missing, superfluous or not finite, or the stiffness is not
        positive definite.
    """
    name = SYNONYMS.get(kind, kind)
    if name not in CLASSES:
        raise InputError(f'there is no symmetry class "{kind}"; there are {", ".join(CLASSES)}')
    needed, optional, made = CLASSES[name]
    missing = [c for c in needed if c not in constants]
    extra = [c for c in constants if c not in needed + optional]
    if missing or extra:
        wrong = f"{', '.join(missing)} missing" if missing else f"{', '.join(extra)} not among them"
        may = f" and may have {', '.join(optional)}" if optional else ""
        raise InputError(f"{kind}: {wrong}; the class has the constants {', '.join(needed)}{may}")
    C = np.zeros((6, 6))
    for c in ALL:
        parts = made.get(c, {c: 1.0})
        i, j = int(c[1]) - 1, int(c[2]) - 1
        C[i, j] = C[j, i] = sum(factor * constants.get(part, 0.0) for part, factor in parts.items())
    return stiffness_matrix(C)


def strain_rotation(rotation: ArrayLike) -> Floats:
    """(6, 6) matrix T of a rotation R: strains (engineering) in axes turned by R, from those in the old axes.

    The new axes are the columns of R; eps' = R^T eps R.
    """
    R = np.asarray(rotation, dtype=np.float64)
    if R.shape != (3, 3) or not np.allclose(R @ R.T, np.eye(3), atol=1e-9):
        raise InputError("a rotation must be a 3x3 matrix with orthonormal columns")
    T = np.empty((6, 6))
    for a, (i, j) in enumerate(PAIRS):
        for b, (k, m) in enumerate(PAIRS):
            both = R[k, i] * R[m, j] + R[m, i] * R[k, j]
            T[a, b] = 0.5 * both * ENGINEERING[a]  # eps'_ij = R_ki eps_km R_mj; gamma holds both shears
    return T


def turned(C: ArrayLike, rotation: ArrayLike) -> Floats:
    """(6, 6) the stiffness of a material whose axes are the columns of the rotation, in the old axes.

    With T the strains in the material's axes from those in the old ones, it is T^T C T.
    """
    T = strain_rotation(rotation)
    return T.T @ np.asarray(C, dtype=np.float64) @ T


def about(axis: str, angle: float) -> Floats:
    """(3, 3) rotation about a coordinate axis."""
    c, s = np.cos(angle), np.sin(angle)
    k = "xyz".index(axis)
    i, j = (k + 1) % 3, (k + 2) % 3
    R = np.eye(3)
    R[i, i] = R[j, j] = c
    R[i, j], R[j, i] = -s, s
    return R


def symmetry(C: ArrayLike, tolerance: float = 1e-8) -> Symmetry:
    """The most symmetric class that a stiffness has in its own axes, in any order of these.

    Parameters
    ----------
    C : (6, 6) array
    tolerance : float
        A turn leaves C unchanged if no entry changes by more than this part of the largest.

    Raises
    ------
    InputError
        If C is not a symmetric positive definite 6x6 matrix.
    """
    given = np.asarray(C, dtype=np.float64)
    if given.shape != (6, 6):
        raise InputError(f"the stiffness must be 6x6, not of shape {given.shape}")
    stiffness_matrix(given)
    to_z = {"z": np.eye(3), "x": about("y", np.pi / 2), "y": about("x", -np.pi / 2)}
    for kind, turns in GENERATORS:
        for axis in ("z", "x", "y") if kind in WITH_AXIS else ("z",):
            seen = turned(given, to_z[axis].T)
            changes = [np.abs(turned(seen, about(a, 2.0 * np.pi / n)) - seen).max() for a, n in turns]
            if max(changes) <= tolerance * np.abs(given).max():
                return Symmetry(kind, axis if kind in WITH_AXIS else None)
    return Symmetry("triclinic", None)


def stiffness_matrix(given: Any) -> Floats:
    """A (6, 6) or (3, 3) stiffness as an array, exactly symmetric.

    Raises
    ------
    InputError
        If it is no such matrix, not finite, not symmetric or not positive definite.
    """
    try:
        C = np.array(given, dtype=float)
    except (TypeError, ValueError):
        raise InputError(
            f"material: C = {shown(given)} is not a matrix of numbers: give 6 rows of 6, or 3 of 3"
        ) from None
    if C.shape not in ((6, 6), (3, 3)):
        raise InputError(f"material: C has the shape {C.shape}: it must be 6 x 6, or 3 x 3 in plane stress")
    if not np.isfinite(C).all():
        row, column = np.argwhere(~np.isfinite(C))[0] + 1
        raise InputError(f"material: C{row}{column} = {C[row - 1, column - 1]:g} must be a finite number")
    lopsided = np.abs(C - C.T)
    if lopsided.max() > 1e-9 * np.abs(C).max():
        row, column = np.unravel_index(lopsided.argmax(), C.shape)
        raise InputError(
            f"material: C is not symmetric: C{row + 1}{column + 1} = {C[row, column]:g} but "
            f"C{column + 1}{row + 1} = {C[column, row]:g}"
        )
    C = 0.5 * (C + C.T)
    eigenvalues, vectors = np.linalg.eigh(C)
    if eigenvalues[0] <= 1e-12 * np.abs(eigenvalues).max():
        order = "xx yy zz yz xz xy" if len(C) == 6 else "xx yy xy"
        strain = ", ".join(f"{v:.3g}" for v in vectors[:, 0])
        raise InputError(
            f"material: C is not positive definite: its eigenvalue {eigenvalues[0]:.4g} must be > 0 "
            f"(the strain {order} = {strain} would cost no energy): check the constants and their order"
        )
    return C
