"""The one call: prepare a matrix, solve with it."""

from __future__ import annotations

from typing import Any

import scipy.sparse as sp

from kshell.solvers.auto import choose
from kshell.solvers.direct import Factorisation
from kshell.solvers.system import Floats, PlateSpace, Prepared, Product, Progress, Solution


def prepare(matrix: Any, space: PlateSpace | None = None, method: str = "auto") -> Prepared:
    """Make a matrix ready for any number of loads.

    Parameters
    ----------
    matrix : (n, n) sparse matrix
        Symmetric positive definite, on the free unknowns.
    space : PlateSpace, optional
        What multigrid needs. Without it, "auto" is "direct".
    method : str
        "auto", "direct", "multigrid", or the name of a back end: "superlu", "cholmod", "pardiso".

    Raises
    ------
    InputError
        For an unknown method, a matrix of the wrong shape, or entries that are not finite.
    SolveError
        For a singular matrix; `state` is a `FreeMotion` that names the motion.
    """
    matrix = matrix.tocsr() if sp.issparse(matrix) else sp.csr_matrix(matrix)
    choice = choose(matrix, space, method)
    if choice.backend is None:
        from kshell.solvers.multigrid.solver import Multigrid

        assert space is not None  # `choose` takes multigrid only then
        return Multigrid(matrix, space, choice.why, choice.warnings)
    return Factorisation(matrix, choice.backend, choice.why, space, choice.warnings)


def solve_system(
    matrix: Any,
    rhs: Floats,
    space: PlateSpace | None = None,
    method: str = "auto",
    tolerance: float | None = None,
    progress: Progress | None = None,
    product: Product | None = None,
) -> Solution:
    """Solve A x = b for one load (n,) or several (n, load). See `prepare` for the other parameters.

    Parameters
    ----------
    tolerance : float, optional
        Relative error in the energy norm. By default a direct solver goes to rounding, multigrid to 1e-8
        (Morley) or 1e-9 (Argyris).
    progress : function, optional
        Called with the iteration and its estimated relative energy error.
    product : function, optional
        x -> A x more accurately than by the entries of the matrix, see `Prepared.solve`.

    Raises
    ------
    InputError, SolveError
        As `prepare` and `Prepared.solve`.
    """
    return prepare(matrix, space, method).solve(rhs, tolerance, progress, product)
