"""Multigrid as a prepared solver: one setup, then nested iteration and conjugate gradients for each load."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

import numpy as np

from kshell.errors import InputError, SolveError
from kshell.solvers.backends import preferred_backend
from kshell.solvers.checks import check_tolerance, checked_matrix, checked_rhs
from kshell.solvers.direct import Factorisation
from kshell.solvers.memory import fits
from kshell.solvers.multigrid.cycle import cycle, nested_iteration
from kshell.solvers.multigrid.hierarchy import build
from kshell.solvers.multigrid.pcg import Run, conjugate_gradients
from kshell.solvers.system import Floats, PlateSpace, Prepared, Product, Progress, Solution

# Relative energy error at which the iteration stops by itself. Reactions follow it to first order, deflections to
# second: at a tenth of Morley's discretisation error loads and reactions differ by 2e-3, here by 1e-7; the seven
# iterations between take a seventh of a whole solution of 1e6 unknowns.
STOP = {"morley": 1e-8, "argyris": 1e-9}
# A stalled error below this is the limit of double precision on a fine mesh; it is reported, not refused.
ROUNDING_LIMIT = 1e-6
CORRECTIONS = 3


class Multigrid(Prepared):
    """The hierarchy of one matrix.

    Parameters
    ----------
    matrix : (n, n) sparse matrix
    space : PlateSpace
    why : str

    Attributes
    ----------
    hierarchy : Hierarchy

    Raises
    ------
    InputError
        If matrix and space do not belong together.
    SolveError
        If the structure can move freely; `state` is a `FreeMotion`.
    """

    def __init__(self, matrix: Any, space: PlateSpace, why: str, warnings: tuple[str, ...] = ()) -> None:
        begin = time.perf_counter()
        self.matrix = checked_matrix(matrix)
        if space.reduction.shape[1] != self.matrix.shape[0]:
            raise InputError(
                f"the space has {space.reduction.shape[1]} unknowns, the matrix {self.matrix.shape[0]}: they must "
                "come from the same problem"
            )
        self.element = space.element
        self.hierarchy = build(self.matrix, space)
        self.name = "multigrid"
        self.why = why
        self.warnings = warnings + self.hierarchy.notes
        self.setup_seconds = time.perf_counter() - begin
        self._factorisation: Factorisation | None = None
        self._unused = True

    def precondition(self, residual: Floats) -> Floats:
        """One cycle from zero: a symmetric approximation of the inverse of the matrix."""
        return cycle(self.hierarchy.levels, self.hierarchy.coarsest, residual)[0]

    def solve(
        self,
        rhs: Floats,
        tolerance: float | None = None,
        progress: Progress | None = None,
        product: Product | None = None,
    ) -> Solution:
        """Solve for (n,) or (n, load). See `Prepared.solve`.

        Without a ``tolerance`` Morley is solved to 1e-8, Argyris to 1e-9.
        """
        begin = time.perf_counter()
        check_tolerance(tolerance)
        b = checked_rhs(rhs, self.matrix.shape[0])
        columns = b.reshape(len(b), -1)
        runs = [self._run(np.ascontiguousarray(column), tolerance, progress, product) for column in columns.T]
        worst = max(runs, key=lambda run: run.history[-1])
        x = np.stack([run.x for run in runs], axis=1)
        reached = min(worst.history)
        warnings = self.warnings
        failed = not all(run.converged for run in runs)
        if failed and reached <= ROUNDING_LIMIT:
            warnings += (
                f"multigrid stopped at a relative energy error of {reached:.1e}, the limit of "
                "double precision for this matrix",
            )
        solution = Solution(
            x=x.reshape(b.shape),
            name=self.name,
            why=self.why,
            iterations=max(len(run.history) for run in runs) - 1,
            history=worst.history,
            energy_error=reached,
            residual=max(run.residual for run in runs),
            seconds={
                "setup": self.setup_seconds if self._unused else 0.0,
                "solve": time.perf_counter() - begin,
            },
            warnings=warnings,
        )
        self._unused = False
        if failed and reached > ROUNDING_LIMIT:
            return self._rescue(solution, b, tolerance, product)
        return solution

    def _rescue(
        self, solution: Solution, rhs: Floats, tolerance: float | None, product: Product | None
    ) -> Solution:
        """A factorisation takes over where the iteration stalls, if it fits in memory."""
        words = (
            f"multigrid stalled after {solution.iterations} iterations at a relative energy error of "
            f"{solution.energy_error:.1e}; very thin triangles do that, or parts that hang together at a vertex"
        )
        backend = preferred_backend()
        if not fits(self.matrix, backend.key):
            raise SolveError(
                f"{words}. A factorisation would not fit in memory: use a better mesh", state=solution
            )
        if self._factorisation is None:
            self._factorisation = Factorisation(
                self.matrix, backend, f"multigrid stalled; {backend.name} took over"
            )
        rescued = self._factorisation.solve(rhs, tolerance, None, product)
        seconds = {name: rescued.seconds[name] + solution.seconds[name] for name in solution.seconds}
        warning = f"{words}: {backend.name} took over"
        return replace(rescued, seconds=seconds, warnings=(*self.warnings, warning))

    def _run(
        self, rhs: Floats, tolerance: float | None, progress: Progress | None, product: Product | None
    ) -> Run:
        if not rhs.any():
            return Run(np.zeros_like(rhs), (0.0,), True, 0.0)
        start = nested_iteration(self.hierarchy.levels, self.hierarchy.coarsest, rhs)
        if tolerance is None:
            tolerance = STOP[self.element]
        run = conjugate_gradients(self.matrix, rhs, self.precondition, tolerance, start, progress)
        return run if product is None else self._refined(run, rhs, tolerance, product)

    def _refined(self, run: Run, rhs: Floats, tolerance: float, product: Product) -> Run:
        """Add corrections for residuals that are formed with the more accurate product."""
        for _ in range(CORRECTIONS):
            residual = rhs - product(run.x)
            error = float(np.sqrt(abs(residual @ self.precondition(residual)) / abs(rhs @ run.x)))
            history = (*run.history[:-1], error)
            size = float(np.linalg.norm(residual) / np.linalg.norm(rhs))
            run = Run(run.x, history, run.converged and error <= tolerance, size)
            if error <= tolerance:
                break
            aim = max(0.3 * tolerance / error, 1e-8)
            part = conjugate_gradients(self.matrix, residual, self.precondition, aim)
            history += tuple(error * e for e in part.history[1:])
            run = Run(run.x + part.x, history, part.converged, size)
        return run
