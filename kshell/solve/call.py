"""The one call: prepare a matrix, solve with it."""

from __future__ import annotations

from typing import Any

from kshell.errors import InputError
from kshell.solve.backends import BACKENDS, backend_named, installed_backends
from kshell.solve.direct import Factorisation
from kshell.solve.system import Floats, PlateSpace, Prepared, Progress, Solution

METHODS = ("auto", "direct", "multigrid", *(backend.key for backend in BACKENDS))


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
    if method not in METHODS:
        raise InputError(f"unknown solver {method!r}: choose one of {', '.join(METHODS)}")
    if method in ("auto", "direct"):
        backend = installed_backends()[0]
        return Factorisation(matrix, backend, f"the fastest factorisation installed is {backend.name}", space)
    return Factorisation(matrix, backend_named(method), "asked for by name", space)


def solve_system(
    matrix: Any,
    rhs: Floats,
    space: PlateSpace | None = None,
    method: str = "auto",
    tolerance: float | None = None,
    progress: Progress | None = None,
) -> Solution:
    """Solve A x = b for one load (n,) or several (n, load). See `prepare` for the other parameters.

    Parameters
    ----------
    tolerance : float, optional
        Relative error in the energy norm. By default a direct solver goes to rounding.
    progress : function, optional
        Called with the iteration and its estimated relative energy error.

    Raises
    ------
    InputError, SolveError
        As `prepare` and `Prepared.solve`.
    """
    return prepare(matrix, space, method).solve(rhs, tolerance, progress)
