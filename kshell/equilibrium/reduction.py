"""What conditions leave of the motions: x = T q + x0."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


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
    """

    basis: sp.csc_matrix
    given: Floats
    rotations: Ints

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
