"""An eigenproblem K x = lambda M x and its answer, sharpened: what dense and sparse ways to solve it share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kshell.solvers.eigenbasis import canonical

Floats = NDArray[np.float64]

# relative difference of energies by entries and through strains from which vectors are improved
ROUNDED = 1e-10


class Pencil(NamedTuple):
    """The matrices of an eigenproblem.

    Attributes
    ----------
    stiffness, mass : (n, n) CSR matrices
    rigid : (n, r) array
        Motions without strain, M-orthonormal; none where the structure is held.
    energy : callable or None
        (n, k) vectors X to X^T K X, formed through strains: more accurate than by the entries of K.
    product : callable or None
        (n, k) vectors X to K X, formed through strains.
    order : callable or None
        Gives an order of elimination (n,) with little fill.
    """

    stiffness: Any
    mass: Any
    rigid: Floats
    energy: Callable[[Any], Any] | None = None
    product: Callable[[Any], Any] | None = None
    order: Callable[[], NDArray[np.integer] | None] | None = None


@dataclass
class Spectrum:
    """Eigenvalues and vectors, rigid motions not among them.

    Attributes
    ----------
    values : (k,) array
        Ascending.
    vectors : (n, k) array
        M-orthonormal; the largest entries are positive.
    checked : bool
        Whether a count confirmed that none is missing up to the last one.
    solver : str
    solves : int
        Solutions with the factor.
    notes : list of str
        What to say about the check.
    solve : callable or None
        The solution with K + shift M, where the matrix is sparse.
    shift : float
    first : int or None
        Number of elastic modes below the first one; None where it is not known.
    """

    values: Floats
    vectors: Floats
    checked: bool = False
    solver: str = ""
    solves: int = 0
    notes: list[str] = field(default_factory=list)
    solve: Callable[[Any], Any] | None = field(default=None, repr=False)
    shift: float = 0.0
    first: int | None = 0


def massive_unknowns(mass: Any) -> int:
    """Unknowns that carry mass."""
    return int(np.sum(mass.diagonal() > 0.0))


def deflated(pencil: Pencil, x: Floats) -> Floats:
    """Vectors (n,) or (n, k) less their rigid parts."""
    if not pencil.rigid.shape[1]:
        return x
    return np.asarray(x - pencil.rigid @ (pencil.rigid.T @ (pencil.mass @ x)))


def finished(
    pencil: Pencil, values: Floats, vectors: Floats, found: Spectrum, keep: int | None = None
) -> Spectrum:
    """Sharpened through strains, in order, in a basis of clusters that does not depend on the start vector."""
    if len(values):
        values, vectors = _sharpened(pencil, values, vectors, found.solve)
    found.values, found.vectors = values, canonical(values, vectors, np.sqrt(pencil.mass.diagonal()))
    if keep is not None:
        found.values, found.vectors = found.values[:keep], found.vectors[:, :keep]
    return found


def _sharpened(
    pencil: Pencil, values: Floats, vectors: Floats, solve: Callable[[Any], Any] | None
) -> tuple[Floats, Floats]:
    """Rayleigh-Ritz with the energy through strains, where the entries of K have lost digits.

    Where both energies differ, the vectors are improved first by a step of inverse iteration whose residual
    lambda M x - K x is formed through strains.
    """
    a = vectors.T @ (pencil.stiffness @ vectors)
    if pencil.energy is not None:
        by_entries, a = a, pencil.energy(vectors)
        lost = np.abs(np.diag(by_entries) - np.diag(a)).max() > ROUNDED * np.abs(np.diag(a)).max()
        if lost and solve is not None and pencil.product is not None:
            for _ in range(2):
                values, vectors = _ritz(a, vectors.T @ (pencil.mass @ vectors), vectors)
                miss = pencil.mass @ (vectors * values) - pencil.product(vectors)
                vectors = vectors + deflated(pencil, np.column_stack([solve(r) for r in miss.T]))
                a = pencil.energy(vectors)
    return _ritz(a, vectors.T @ (pencil.mass @ vectors), vectors)


def _ritz(a: Floats, b: Floats, vectors: Floats) -> tuple[Floats, Floats]:
    """Values and vectors of the combinations for which a and b are diagonal, b the unit matrix."""
    from scipy.linalg import eigh

    values, mix = eigh(0.5 * (a + a.T), 0.5 * (b + b.T))
    return values, vectors @ mix
