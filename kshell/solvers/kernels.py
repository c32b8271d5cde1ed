"""Loops that are compiled where kshell was installed with a C compiler at hand; elsewhere numpy makes the same numbers.

`compiled` is the module `kshell/solvers/compiled.pyx`, or None, and `cycles` that of multigrid,
`kshell/solvers/multigrid/compiled.pyx`. Who has a loop there looks at it each time, and has the way of numpy beside
it. The variable KSHELL_COMPILED=0 of the environment leaves both out.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.mesh.kernels import loaded

Ints = NDArray[np.integer]

FRONTS = 1  # of the two that make factors
VERSION = 3  # of the functions of the compiled modules, which have the same


compiled: Any = loaded("kshell.solvers.compiled", VERSION)
cycles: Any = loaded("kshell.solvers.multigrid.compiled", VERSION)


@cache
def fronts() -> Any:
    """Those of `kshell.solvers.frontal` for patterns, `fronts.pyx`; None where there are not all of them."""
    return loaded("kshell.solvers.fronts", FRONTS) if panels() is not None else None


@cache
def panels() -> Any:
    """Those for numbers, `panels.pyx`. They bring the BLAS of scipy, so only who needs it loads them."""
    return loaded("kshell.solvers.panels", FRONTS)


def which() -> str:
    """What makes the loops, in a word."""
    return "numpy" if compiled is None else "compiled"


def contiguous(values: Ints, kind: type) -> Ints:
    """The same numbers as an array that compiled loops take."""
    return np.ascontiguousarray(values, dtype=kind)


def neighbours_of_groups(groups: Ints, count: int, before: bool = False) -> tuple[Ints, Ints]:
    """Groups that each group meets in an element, sorted, and where those of each start, by compiled loops.

    Parameters
    ----------
    groups : (element, g) int32 array
    count : int
        Of groups.
    before : bool
        Whether those before it are wanted, too.
    """
    starts, near = np.empty(count + 1, dtype=np.int64), np.empty(0, dtype=np.int32)
    for _ in range(2):  # first counted, then stored
        total = compiled.neighbours(
            groups,
            np.zeros(count + 1, dtype=np.int64),
            np.empty(groups.size, dtype=np.int32),
            np.full(count, -1, dtype=np.int32),
            starts,
            near,
            before,
        )
        if not total or len(near):
            break
        near = np.empty(total, dtype=np.int32)
    return starts, near


def pairs_of_groups(groups: Ints, count: int) -> tuple[Ints, Ints, Ints]:
    """As `kshell.equilibrium.sparsity.group_pairs`, by compiled loops; the groups as 32-bit numbers."""
    members = contiguous(groups, np.int32)
    starts, high = neighbours_of_groups(members, count)
    low = np.repeat(np.arange(count, dtype=groups.dtype), np.diff(starts))
    place = np.empty((len(groups), groups.shape[1], groups.shape[1]), dtype=np.int32)
    compiled.numbers(members, starts, high, place)
    return low, high.astype(groups.dtype, copy=False), place
