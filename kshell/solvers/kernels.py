"""Loops that are compiled where kshell was installed with a C compiler at hand; elsewhere numpy makes the same numbers.

`compiled` is the module `kshell/solvers/compiled.pyx`, or None. Who has a loop there looks at it each time, and has the
way of numpy beside it. The variable KSHELL_COMPILED=0 of the environment leaves it out.
"""

from __future__ import annotations

import os
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.integer]

VARIABLE = "KSHELL_COMPILED"
VERSION = 2  # of the functions of the compiled module, which has the same


def _loaded() -> Any:
    if os.environ.get(VARIABLE) == "0":
        return None
    try:
        found = import_module("kshell.solvers.compiled")
    except ImportError:
        return None
    return (
        found if found.VERSION == VERSION else None
    )  # left behind by an older installation from this folder


compiled: Any = _loaded()


def which() -> str:
    """What makes the loops, in a word."""
    return "numpy" if compiled is None else "compiled"


def contiguous(values: Ints, kind: type) -> Ints:
    """The same numbers as an array that compiled loops take."""
    return np.ascontiguousarray(values, dtype=kind)


def pairs_of_groups(groups: Ints, count: int) -> tuple[Ints, Ints, Ints]:
    """As `kshell.equilibrium.sparsity.group_pairs`, by compiled loops; the groups as 32-bit numbers."""
    members = contiguous(groups, np.int32)
    starts, high = np.empty(count + 1, dtype=np.int64), np.empty(0, dtype=np.int32)
    for _ in range(2):  # first counted, then stored
        total = compiled.neighbours(
            members,
            np.zeros(count + 1, dtype=np.int64),
            np.empty(members.size, dtype=np.int32),
            np.full(count, -1, dtype=np.int32),
            starts,
            high,
        )
        if not total or len(high):
            break
        high = np.empty(total, dtype=np.int32)
    low = np.repeat(np.arange(count, dtype=groups.dtype), np.diff(starts))
    place = np.empty((len(groups), groups.shape[1], groups.shape[1]), dtype=np.int32)
    compiled.numbers(members, starts, high, place)
    return low, high.astype(groups.dtype, copy=False), place
