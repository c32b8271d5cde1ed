"""Loops that are compiled where kshell was installed with a C compiler at hand, as those of `kshell.mesh.kernels`.

`compiled` is the module `kshell/elements/compiled.pyx`, or None.
"""

from __future__ import annotations

from typing import Any

from kshell.mesh.kernels import loaded

VERSION = 1  # of the functions of the compiled module, which has the same

compiled: Any = loaded("kshell.elements.compiled", VERSION)
