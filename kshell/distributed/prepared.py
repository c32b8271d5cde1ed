"""Matrices of plates of a team, factorised by MUMPS and made ready for any number of loads."""

from __future__ import annotations

import time
from typing import Any

import scipy.sparse as sp

from kshell.distributed.factor import NAME, whole_factoriser
from kshell.distributed.matrix import Scattered
from kshell.errors import SolveError
from kshell.solvers.checks import free_motion_error, require_stiff, softest_vector
from kshell.solvers.direct import SHIFT, Factorisation
from kshell.solvers.system import PlateSpace


class PetscFactorisation(Factorisation):
    """The matrix of a team, factorised by MUMPS.

    Parameters
    ----------
    matrix : Scattered
        Symmetric positive definite.
    why : str
    space : PlateSpace
        Lets the error about a singular matrix say where and how the structure moves.

    Raises
    ------
    SolveError
        If the matrix is singular or not positive definite.
    """

    def __init__(self, matrix: Scattered, why: str, space: PlateSpace) -> None:
        begin = time.perf_counter()
        self.matrix, self.name, self.why, self.warnings = matrix, NAME, why, ()
        self.factoriser, self.factor_entries = whole_factoriser(matrix), 0
        self._solve = self.factoriser.factorise(matrix).solve
        try:
            require_stiff(matrix, self._solve)
        except SolveError as error:
            raise _named(matrix, space, error) from None
        self.setup_seconds = time.perf_counter() - begin
        self._unused = True


def _named(matrix: Scattered, space: PlateSpace, error: SolveError) -> SolveError:
    """The error with the motion that is free, which needs the whole matrix: the first process gathers it."""
    whole: Any = matrix.whole()

    def words() -> str:
        from kshell.solvers.backends import SUPERLU

        solve, _ = SUPERLU.factorise((whole + sp.diags(SHIFT * whole.diagonal())).tocsr())
        x, stiffness = softest_vector(whole, solve)
        return str(free_motion_error(whole, x, stiffness, space))

    try:
        return SolveError(matrix.team.calls.by_first(words))
    except Exception:
        return error
