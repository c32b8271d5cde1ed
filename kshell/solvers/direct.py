"""Direct solution: factorise once, check that nothing moves freely, solve and refine any number of loads."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from kshell.errors import SolveError
from kshell.solvers.backends import SUPERLU, Backend, Singular
from kshell.solvers.checks import (
    check_tolerance,
    checked_matrix,
    checked_rhs,
    free_motion_error,
    require_stiff,
    softest_vector,
)
from kshell.solvers.refine import refine
from kshell.solvers.system import Floats, PlateSpace, Prepared, Product, Progress, Solution

# A relative energy error that refinement could not push below this: the factorisation is not worth its name.
HOPELESS = 1e-3
OVERFLOWS = 1e140  # loads whose squares, over a stiffness, may be no number
ATTAINABLE = 1e-9  # no smaller error is insisted on, whatever tolerance is asked for
SHIFT = 1e-12  # stiffness, as part of the diagonal, that makes a singular matrix factorisable


class Factorisation(Prepared):
    """A factorised matrix.

    Parameters
    ----------
    matrix : (n, n) sparse matrix
        Symmetric positive definite.
    backend : Backend
    why : str
        Why this back end was taken.
    space : PlateSpace, optional
        Lets the error about a singular matrix say where and how the structure moves.

    Attributes
    ----------
    factor_entries : int
        Stored entries of the factor, 0 where the library does not say.

    Raises
    ------
    SolveError
        If the matrix is singular or not positive definite; `state` is a `FreeMotion` where one was found.
    MemoryError
        If the factor does not fit.
    """

    def __init__(
        self,
        matrix: Any,
        backend: Backend,
        why: str,
        space: PlateSpace | None = None,
        warnings: tuple[str, ...] = (),
    ) -> None:
        begin = time.perf_counter()
        self.matrix = checked_matrix(matrix)
        self.name = backend.name
        self.why = why
        self.warnings = warnings
        try:
            self._solve, self.factor_entries = backend.factorise(self.matrix)
        except Singular as error:
            raise self._singular(str(error), space) from error
        require_stiff(self.matrix, self._solve, space)
        self.setup_seconds = time.perf_counter() - begin
        self._unused = True

    def _singular(self, reason: str, space: PlateSpace | None) -> SolveError:
        """After a pivot broke down: find the motion with a tiny stiffness added to every unknown."""
        import scipy.sparse as sp

        try:
            solve, _ = SUPERLU.factorise((self.matrix + sp.diags(SHIFT * self.matrix.diagonal())).tocsr())
        except Singular:
            return SolveError(f"the system is singular or not positive definite ({reason})")
        x, stiffness = softest_vector(self.matrix, solve)
        if abs(stiffness) > SHIFT:
            return SolveError(f"the stiffness matrix is not positive definite ({reason})")
        return free_motion_error(self.matrix, x, stiffness, space)

    def apply(self, rhs: Floats) -> Floats:
        """One solution with the factors, for callers that refine by themselves with better residuals."""
        return np.asarray(self._solve(rhs))

    def _times(self, x: Floats) -> Floats:
        return np.asarray(self.matrix @ x)

    def solve(
        self,
        rhs: Floats,
        tolerance: float | None = None,
        progress: Progress | None = None,
        product: Product | None = None,
    ) -> Solution:
        """Solve for (n,) or (n, load) with up to three steps of refinement. See `Prepared.solve`.

        ``tolerance`` is the relative energy error that must be reached; refinement goes to rounding anyway.
        """
        begin = time.perf_counter()
        check_tolerance(tolerance)
        b = checked_rhs(rhs, self.matrix.shape[0])
        columns = b.reshape(len(b), -1)
        times = self._times if product is None else product
        x, history, steps, left = refine(times, columns, self._solve, progress)
        size = np.linalg.norm(columns, axis=0)
        residual = np.linalg.norm(left, axis=0) / np.where(size > 0, size, 1.0)
        solution = Solution(
            x=x.reshape(b.shape),
            name=self.name,
            why=self.why,
            iterations=steps,
            history=history,
            energy_error=history[-1],
            residual=float(np.max(residual, initial=0.0)),
            seconds={
                "setup": self.setup_seconds if self._unused else 0.0,
                "solve": time.perf_counter() - begin,
            },
            warnings=self.warnings,
        )
        self._unused = False
        limit = HOPELESS if tolerance is None else max(tolerance, ATTAINABLE)
        if not np.isfinite(x).all() or not history[-1] <= limit:
            if np.abs(columns).max(initial=0.0) > OVERFLOWS:
                raise SolveError(
                    f"{self.name}: loads up to {np.abs(columns).max():.1e} have energies that numbers cannot hold; "
                    "look at their units",
                    state=solution,
                )
            raise SolveError(
                f"{self.name}: iterative refinement stalled at a relative energy error of {history[-1]:.1e}; "
                "the system is nearly singular. Look for parts that hang together at a vertex, and for "
                "stiffnesses or triangle sizes that differ by many orders of magnitude",
                state=solution,
            )
        return solution
