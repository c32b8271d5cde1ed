"""Loops that are compiled where kshell was installed with a C compiler at hand; elsewhere numpy makes the same numbers.

`compiled` is the module `kshell/mesh/compiled.pyx`, or None; `kshell.solvers.kernels` has others. Who has a loop there
looks at it each time, and has the way of numpy beside it. The variable KSHELL_COMPILED=0 of the environment leaves all
of them out.
"""

from __future__ import annotations

import os
from importlib import import_module
from typing import Any

VARIABLE = "KSHELL_COMPILED"
VERSION = 1  # of the functions of the compiled module, which has the same


def loaded(name: str, version: int) -> Any:
    """A compiled module; None where there is none, or one that an older installation left behind in this folder."""
    if os.environ.get(VARIABLE) == "0":
        return None
    try:
        found = import_module(name)
    except ImportError:
        return None
    return found if version == found.VERSION else None


compiled: Any = loaded("kshell.mesh.compiled", VERSION)
