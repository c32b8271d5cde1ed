"""Cycles through a hierarchy, and nested iteration from its coarsest level up."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from kshell.solvers.multigrid.levels import Level
from kshell.solvers.system import Floats

Coarsest = Callable[[Floats], Floats]  # the solution on the coarsest level


def cycle(
    levels: Sequence[Level], coarsest: Coarsest, rhs: Floats, visits: int = 2, wanted: bool = False
) -> tuple[Floats, Floats | None]:
    """One cycle for A x = b on the first of some levels, from x = 0.

    Parameters
    ----------
    levels : sequence of Level
        All but the coarsest.
    coarsest : function
    visits : int
        1 is a V-cycle, 2 a W-cycle.
    wanted : bool
        Whether the residual is.

    Returns
    -------
    x : (n,) float array
    residual : (n,) float array or None
        b - A x
    """
    if not levels:
        return coarsest(rhs), None
    here, below = levels[0], levels[1:]
    x, left = here.before(rhs)
    more = here.restrict(left)
    coarse = np.zeros_like(more)
    count = visits if below else 1  # what is solved once for all need not be visited again
    for visit in range(count):
        step, rest = cycle(below, coarsest, more, visits, visit + 1 < count)
        coarse += step
        if rest is not None:
            more = rest
    return here.after(rhs, x, left, here.interpolate(coarse), wanted)


def nested_iteration(levels: Sequence[Level], coarsest: Coarsest, rhs: Floats, visits: int = 2) -> Floats:
    """Solve level by level from the coarsest up, with one cycle each.

    Returns
    -------
    x : (n,) float array
        On the finest level, with an error near that of the discretisation.
    """
    loads = [rhs]
    for level in levels:
        loads.append(level.restrict(loads[-1]))
    x = coarsest(loads[-1])
    for k in range(len(levels) - 1, -1, -1):
        x = levels[k].interpolate(x)
        x += cycle(levels[k:], coarsest, levels[k].residual(x, loads[k]), visits)[0]
    return x
