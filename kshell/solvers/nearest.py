"""Least squares with a basis of few entries a column, such as that of the supports."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def nearest(basis: sp.spmatrix) -> Callable[[Floats], Floats]:
    """The function that gives the q whose T q is nearest to vectors.

    Parameters
    ----------
    basis : (n, free) sparse
        T, of full rank.

    Returns
    -------
    function of (n,) or (n, k) to (free,) or (free, k)
    """
    free = basis.shape[1]
    if not free:
        return lambda given: np.zeros((0, *given.shape[1:]))
    basis = sp.csr_matrix(basis)
    gram = (basis.T @ basis).tocsc()
    diagonal = gram.diagonal()
    if gram.nnz == np.count_nonzero(diagonal):  # columns are orthogonal: nothing is to be factorised

        def divided(given: Floats) -> Floats:
            found: Floats = basis.T @ given
            return found / (diagonal if found.ndim == 1 else diagonal[:, None])

        return divided
    from scipy.sparse.linalg import splu

    factor: Any = splu(gram)
    return lambda given: np.asarray(factor.solve(basis.T @ given))


def beside(basis: sp.csc_matrix) -> Callable[[Floats], Floats]:
    """The function that takes off vectors (n,) or (n, k) what a basis can give: v - T q with q as in `nearest`."""
    if (
        picked(basis) is not None
    ):  # of columns with one entry each, and so the same rows whatever their lengths

        def cleared(given: Floats) -> Floats:
            out = given.copy()
            out[basis.indices] = 0.0
            return out

        return cleared
    best = nearest(basis)
    return lambda given: given - basis @ best(given)


def picked(basis: sp.csc_matrix) -> NDArray[np.integer] | None:
    """Rows of the entries where each column has one; None where some have none or more."""
    single = basis.format == "csc" and basis.nnz == basis.shape[1] and (np.diff(basis.indptr) == 1).all()
    return basis.indices if single else None
