"""Cycles through a hierarchy, and nested iteration from its coarsest level up."""

from __future__ import annotations

from typing import Any

import numpy as np

from kshell.solvers.system import Floats


def cycle(solver: Any, rhs: Floats, level: int = 0, x: Floats | None = None, visits: int = 2) -> Floats:
    """One cycle for A x = b on a level.

    Parameters
    ----------
    solver : pyamg.MultilevelSolver
        With smoothers that are each other's transpose, so that the cycle from x = 0 is a symmetric operator.
    x : (n,) float array, optional
        Start, overwritten; zero by default.
    visits : int
        1 is a V-cycle, 2 a W-cycle.
    """
    levels = solver.levels
    here = levels[level]
    if level == len(levels) - 1:
        correction = solver.coarse_solver(here.A, rhs if x is None else rhs - here.A @ x)
        return correction if x is None else x + correction
    if x is None:
        x = np.zeros_like(rhs)
    here.presmoother(here.A, x, rhs)
    coarse_rhs = here.R @ (rhs - here.A @ x)
    coarse = cycle(solver, coarse_rhs, level + 1, None, visits)
    if visits > 1 and level + 2 < len(levels):
        for _ in range(visits - 1):
            coarse = cycle(solver, coarse_rhs, level + 1, coarse, visits)
    x += here.P @ coarse
    here.postsmoother(here.A, x, rhs)
    return x


def nested_iteration(solver: Any, rhs: Floats, visits: int = 2) -> tuple[Floats, list[float]]:
    """Solve level by level from the coarsest up, with one cycle each.

    Returns
    -------
    x : (n,) float array
        On the finest level, with an error near that of the discretisation.
    energies : list of float
        b.x on each level, the finest first: they grow towards that of the plate.
    """
    levels = solver.levels
    loads = [rhs]
    for level in levels[:-1]:
        loads.append(level.R @ loads[-1])
    x = solver.coarse_solver(levels[-1].A, loads[-1])
    energies = [float(loads[-1] @ x)]
    for k in range(len(levels) - 2, -1, -1):
        x = cycle(solver, loads[k], k, levels[k].P @ x, visits)
        energies.append(float(loads[k] @ x))
    return x, energies[::-1]
