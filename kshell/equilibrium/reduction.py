"""What conditions leave of the motions: x = T q + x0."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


class Following(Protocol):
    """What prescribed motions do on their way besides growing in proportion to the load factor.

    Attributes
    ----------
    longest : float
        Growth of the factor that one step may make.
    """

    @property
    def longest(self) -> float:
        """Growth of the factor that one step may make."""

    def aside(self, before: float, after: float) -> Floats:
        """(unknowns,) motion from a factor to another, less the proportional one."""

    def rate(self, factor: float) -> Floats:
        """(unknowns,) derivative of the motion by the factor, less the proportional one."""

    def times(self, motion: float) -> Following:
        """That of the prescribed motion times a number."""


class Reduction(NamedTuple):
    """x = basis q + given.

    Attributes
    ----------
    basis : (unknowns, free) sparse
        Orthonormal columns, or columns that pick unknowns and others that follow them.
    given : (unknowns,)
        Prescribed motion.
    rotations : (n,) int
        Unknown numbers of the prescribed rotations, which stay in the unknowns when a state settles.
    following : Following, optional
        Of finite motions that do not grow along a straight line, such as turns.
    """

    basis: sp.csc_matrix
    given: Floats
    rotations: Ints
    following: Following | None = None

    def shift(self, before: float, after: float) -> Floats:
        """(unknowns,) prescribed motion from a load factor to another, from a settled state."""
        straight = (after - before) * self.given
        return straight if self.following is None else straight + self.following.aside(before, after)

    def rate(self, factor: float) -> Floats:
        """(unknowns,) derivative of the prescribed motion by the load factor, in a settled state."""
        return self.given if self.following is None else self.given + self.following.rate(factor)

    def times(self, motion: float) -> Reduction:
        """The same with the prescribed motion times a number."""
        following = None if self.following is None else self.following.times(motion)
        return self._replace(given=motion * self.given, following=following)

    def reduce(self, matrix: sp.spmatrix) -> sp.csr_matrix:
        """basis^T matrix basis; by picking rows and columns where the basis only picks unknowns."""
        basis = self.basis
        if basis.nnz > basis.shape[1]:
            return (basis.T @ matrix @ basis).tocsr()
        reduced = matrix.tocsr()[basis.indices][:, basis.indices]
        if np.any(basis.data != 1.0):
            signs = sp.diags(basis.data)
            reduced = signs @ reduced @ signs
        return reduced.tocsr()
