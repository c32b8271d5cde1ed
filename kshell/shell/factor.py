"""Factorisation of tangent matrices that need not be positive definite, with the count of negative pivots."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from kshell.errors import SolveError
from kshell.solve.backends import Singular, installed_backends


@dataclass
class Factor:
    """A factorised symmetric matrix.

    Attributes
    ----------
    solve : callable
    negative : int
        Negative pivots.
    """

    solve: Callable[[Any], Any]
    negative: int = field(default=0)


def factorise(matrix: sp.spmatrix, symmetric: bool = True) -> Factor:
    """Cholesky where the matrix is positive definite, else LU with pivots on the diagonal, whose signs count.

    Parameters
    ----------
    symmetric : bool
        False for a tangent with follower loads, which is symmetric only up to terms on free edges.

    Raises
    ------
    SolveError
        If the matrix is singular or holds numbers that are not finite.
    """
    if not np.all(np.isfinite(matrix.data)):
        raise SolveError("the stiffness is not finite: the step led too far away")
    cholesky = next((backend for backend in installed_backends() if backend.key != "superlu"), None)
    if symmetric and cholesky is not None:  # SuperLU would factorise an indefinite matrix without a word
        try:
            solve: Callable[[Any], Any] = cholesky.factorise(matrix.tocsr())[0]
            return Factor(solve)
        except Singular:
            pass  # not positive definite: the pivots below say how far
    try:
        lu = splu(
            matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        )
    except RuntimeError as error:
        raise SolveError("the tangent stiffness is singular") from error
    return Factor(lu.solve, int(np.sum(lu.U.diagonal() < 0)))
