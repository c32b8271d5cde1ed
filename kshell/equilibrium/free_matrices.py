"""Matrices T^T K T of one structure, summed from element matrices straight to what is factorised.

At rest first, then the tangents of states nearby. What depends on the pattern alone (numbers of the free unknowns,
what lies inside elements, the order of elimination, what a library found out about it) is found for the first one and
serves for all, unless the structure is large. Small structures have full matrices.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.condensed import Condensation, Condensed
from kshell.equilibrium.energy import Put, StrainEnergy
from kshell.equilibrium.free_pattern import FreePattern
from kshell.equilibrium.merged import Columns, Merged, Mirrored
from kshell.errors import SolveError
from kshell.solvers.frontal import Frontal, Fronts, fronts_of
from kshell.solvers.memory import give_back
from kshell.solvers.nearest import picked
from kshell.solvers.repeated import Cholmod, Factor, SuperLU, dense_factor, renumbered

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

DENSE_UP_TO = 400  # unknowns up to which full matrices are quicker than to look for what is not zero
# free unknowns from which CHOLMOD is quicker in the order of dissection than in one of its own, and takes less memory:
# of 1e6 two thirds of the time
DISSECTED_FROM = 60_000


class Summed(NamedTuple):
    """A factorised sum of element matrices, and what came along with it."""

    factor: Factor
    found: Any  # what the function that made the element matrices gave
    diagonal: Floats  # (unknowns,) of the sum, in all unknowns; zeros where `definite`


class Known:
    """What all matrices of a structure have in common for one library.

    Attributes
    ----------
    pattern : FreePattern
    condensed : Condensed or None
        What lies inside elements, where it is free and no spring acts.
    dissected : bool
        Whether the unknowns are numbered in the order of dissection.
    """

    def __init__(
        self, kind: Any, energy: StrainEnergy, basis: sp.csc_matrix, springs: sp.spmatrix | None
    ) -> None:
        self.condensed: Condensed | None = None
        if springs is None and len(energy.inner):
            inside = Condensed(energy.triangle_unknowns, energy.inner, basis)
            if inside.possible:
                self.condensed, basis = inside, inside.outer
        self.dissected = kind in (Frontal, SuperLU) or (kind is Cholmod and basis.shape[1] > DISSECTED_FROM)
        self.pattern = FreePattern(energy.sparsity, basis, energy.group_places if self.dissected else None)
        self._merged: Merged | None = None
        if springs is not None:
            moved = basis[:, np.argsort(self.pattern.number)]
            self._merged = Merged(self._own(None), sp.tril(moved.T @ springs @ moved))
        self._mirrored = Mirrored(self._lower(None)) if kind is SuperLU else None
        self._first: Any = None  # has the matrix at rest, whose factor stays
        self._further: Any = None

    def _own(self, entries: Any) -> Columns:
        return Columns(self.pattern.indptr, self.pattern.indices, entries)

    def _lower(self, entries: Any) -> Columns:
        return self._own(entries) if self._merged is None else self._merged.with_other(entries)

    def columns(self, entries: Floats) -> Columns:
        """What the library takes, from the entries of the pattern."""
        lower = self._lower(entries)
        return lower if self._mirrored is None else self._mirrored.whole(lower.entries)

    def factorise(self, kind: Any, matrix: Columns) -> Factor:
        """The first matrix, whose factor stays, or another one, whose factor serves until the next."""
        if self._first is None:
            self._first = _solver(kind, matrix, self.dissected, once=self.dissected)
            return Factor(*self._first.factorise(matrix.entries))
        if self._further is None:
            self._further = self._first.another(matrix.indptr, matrix.indices)
        return Factor(*self._further.factorise(matrix.entries))


class FreeMatrices:
    """Factorises sums of element matrices in the free unknowns.

    Parameters
    ----------
    energy : StrainEnergy
    basis : (unknowns, free) sparse
        T.
    springs : (unknowns, unknowns) sparse, optional
        Stiffness of elastic supports, added to every matrix.

    Attributes
    ----------
    small : bool
        Whether full matrices are the quicker ones.
    """

    def __init__(self, energy: StrainEnergy, basis: sp.spmatrix, springs: sp.spmatrix | None = None) -> None:
        self._energy, self._basis, self._springs = energy, sp.csc_matrix(basis), springs
        self.small = bool(basis.shape[1]) and energy.unknowns <= DENSE_UP_TO
        self._known: dict[Any, Known] = {}

    @cached_property
    def possible(self) -> bool:
        """Whether `factorise` is: conditions do not couple groups of unknowns."""
        return bool(self._basis.shape[1]) and FreePattern.possible(self._energy.sparsity, self._basis)

    def fronts(self) -> Fronts:
        """What a factor by fronts looks like."""
        pattern = Known(Frontal, self._energy, self._basis, self._springs).pattern
        return fronts_of(pattern.indptr, pattern.indices)

    def dense(self, evaluate: Callable[[Put], Any]) -> Summed | None:
        """The sum as a full matrix, factorised; None where it is not positive definite. See `factorise`."""
        energy, basis = self._energy, self._basis
        stiffness = np.zeros((energy.unknowns, energy.unknowns))

        def put(triangles: slice, matrices: Floats) -> None:
            where = energy.triangle_unknowns[triangles]
            np.add.at(stiffness, (where[:, :, None], where[:, None]), matrices)

        found = evaluate(put)
        if self._springs is not None:
            stiffness += self._springs.toarray()
        rows = picked(basis)
        if rows is not None and (basis.data == 1.0).all():
            free = stiffness[np.ix_(rows, rows)]
        else:
            free = basis.T @ np.ascontiguousarray((basis.T @ stiffness).T)
        factor = dense_factor(free)
        return None if factor is None else Summed(factor, found, np.diagonal(stiffness))

    def factorise(self, kind: Any, evaluate: Callable[[Put], Any], definite: bool = False) -> Summed:
        """The sum of the element matrices that a function puts, factorised by a library.

        The factor of the first matrix stays; those of further ones serve until the next.

        Parameters
        ----------
        kind : type
            `Frontal`, or of `kshell.solvers.repeated`.
        evaluate : callable
            Is given a function that takes triangles and their matrices (triangle, n, n), symmetric, which may be
            changed.
        definite : bool
            Whether a matrix is of use only if it is positive definite: what the factor does not tell is looked at.

        Raises
        ------
        Singular
            If the library finds no pivots, or what is inside triangles has none, or not positive ones if `definite`.
        SolveError
            If the matrix holds numbers that are not finite.
        """
        energy, kept = self._energy, self._energy.unknowns <= self._energy.kept
        known = self._known.get(kind) or Known(kind, energy, self._basis, self._springs)
        condensed = None if known.condensed is None else known.condensed.of_matrix()
        matrix, found, diagonal = self._sum(known, condensed, evaluate, definite)
        number, dissected = known.pattern.number, known.dissected
        if kept:
            self._known[kind] = known
            factor = known.factorise(kind, matrix)
        else:
            del known  # what is not needed any more leaves room for the factor
            energy.forget()
            give_back()
            if kind is Cholmod:
                solver = _solver(kind, matrix, dissected, once=True)
                del matrix
                factor = solver.factorise()
            else:
                factor = _solver(kind, matrix, dissected, once=True).factorise(matrix.entries)
        factor = renumbered(factor, number)
        if condensed is not None:
            factor = factor._replace(solve=condensed.solving(factor.solve))
        return Summed(factor, found, diagonal)

    def _sum(
        self, known: Known, condensed: Condensation | None, evaluate: Callable[[Put], Any], definite: bool
    ) -> tuple[Columns, Any, Floats]:
        """The matrix, what the function gave, and the diagonal (unknowns,)."""
        energy, pattern = self._energy, known.pattern
        data, diagonal = np.zeros(pattern.entries + 1), np.zeros(energy.unknowns)

        def put(triangles: slice, matrices: Floats) -> None:
            if not definite:
                own = np.einsum("eii->ei", matrices)
                np.add.at(diagonal, energy.triangle_unknowns[triangles].ravel(), own.ravel())
            if condensed is not None:
                condensed.reduce(triangles, matrices, definite)
            pattern.add(data, triangles, matrices)

        found = evaluate(put)
        entries = data[:-1]
        if not np.all(np.isfinite(entries)):
            raise SolveError("the stiffness is not finite: the step led too far away")
        if self._springs is not None and not definite:
            diagonal += self._springs.diagonal()
        return known.columns(entries), found, diagonal


def _solver(kind: Any, matrix: Columns, dissected: bool, once: bool) -> Any:
    if kind is Cholmod:
        return Cholmod(matrix.indptr, matrix.indices, matrix.entries, dissected, once)
    return kind(matrix.indptr, matrix.indices)
