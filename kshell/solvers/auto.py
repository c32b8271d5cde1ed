"""Which solver for which system: a rule from measurements, kept here with the table it came from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from kshell.errors import InputError, SolveError
from kshell.solvers.backends import BACKENDS, Backend, backend_named, preferred_backend
from kshell.solvers.memory import available_bytes, factorisation_bytes, fits
from kshell.solvers.system import PlateSpace

METHODS = ("auto", "direct", "multigrid", *(backend.key for backend in BACKENDS))

# Processor seconds of setup and solution, multigrid / CHOLMOD / PARDISO / SuperLU, one thread, clamped L-shaped
# plate, unstructured mesh (python -m verification.benchmarks.solvers; first uses of libraries included):
#
#   unknowns      Morley                       Argyris
#   1e4           0.14  0.05  0.83  0.07       0.23  0.08  0.71  0.12
#   3e4           0.22  0.10  0.87  0.24       0.65  0.38  0.97  0.61
#   1e5           0.50  0.38  1.44  0.90       2.0   1.4   2.6   3.1
#   3e5           1.4   1.4   3.6   -          4.8   7.0   7.4   -
#   1e6, 8e5      5.0   6.5   14    -          17    25    24    -
#
# Argyris from 3e4 (PARDISO, SuperLU) and 1e5 (all) on is from the run before. The same ratio moves by up to 1.4
# from run to run (CHOLMOD / multigrid for Morley at 3e5: 1.0 and 1.4).
#
# Unknowns from which multigrid is the faster one:
MULTIGRID_FROM = {
    ("morley", "cholmod"): 250_000,
    ("morley", "pardiso"): 60_000,
    ("morley", "superlu"): 30_000,
    ("morley", "rslab"): 150_000,
    ("argyris", "cholmod"): 250_000,
    ("argyris", "rslab"): 200_000,
    ("argyris", "pardiso"): 200_000,
    ("argyris", "superlu"): 60_000,
}

# Thin triangles: height to longest side, and their share above which multigrid needs too many cycles
THIN = 0.125
MANY_THIN = 0.05


@dataclass(frozen=True)
class Choice:
    """A solver and the reasons for it.

    Attributes
    ----------
    backend : Backend or None
        None is multigrid.
    why : str
    warnings : tuple of str
    """

    backend: Backend | None
    why: str
    warnings: tuple[str, ...] = ()


def choose(matrix: Any, space: PlateSpace | None, method: str, available: float | None = None) -> Choice:
    """The solver for a matrix.

    Parameters
    ----------
    method : str
        One of `METHODS`.
    available : float, optional
        Bytes of memory; by default what the system says.

    Raises
    ------
    InputError
        For an unknown method, a back end that is not installed, or multigrid without a space.
    SolveError
        If the factorisation would not fit in memory and multigrid cannot replace it.
    """
    if method not in METHODS:
        raise InputError(f"unknown solver {method!r}: choose one of {', '.join(METHODS)}")
    if method == "multigrid":
        if space is None:
            raise InputError("multigrid is there for Morley and Argyris plates only: use solver = 'direct'")
        return Choice(None, "multigrid as asked for")
    named = method not in ("auto", "direct")
    backend = backend_named(method) if named else preferred_backend()
    unknowns = matrix.shape[0]
    if method == "auto" and space is not None:
        limit = MULTIGRID_FROM[space.element, backend.key]
        thin = thin_share(space)
        if unknowns < limit:
            why = f"{unknowns} unknowns: below {limit} {backend.name} is faster than multigrid"
        elif thin > MANY_THIN:
            why = (
                f"{100 * thin:.0f} % of the triangles are thinner than 1 : {1 / THIN:.0f}, slow in multigrid"
            )
        else:
            why = f"{unknowns} unknowns: from {limit} on multigrid is faster than {backend.name}"
            return Choice(None, why)
    elif space is None and not named:
        why = f"{backend.name}: multigrid is there for plates only"
    else:
        why = f"{backend.name} as asked for"
    have = available_bytes() if available is None else available
    if fits(matrix, backend.key, have):
        return Choice(backend, why)
    need = factorisation_bytes(unknowns, matrix.nnz, backend.key)
    words = (
        f"factorising {unknowns} unknowns with {backend.name} would take about {need / 1e9:.1f} GB, and "
        f"{have / 1e9:.1f} GB are available"
    )
    if space is None:
        raise SolveError(f"{words}: use a coarser mesh or a machine with more memory")
    return Choice(
        None, "the factorisation would not fit in memory", (f"{words}: multigrid was taken instead",)
    )


def thin_share(space: PlateSpace) -> float:
    """Part of the triangles whose height is less than `THIN` of their longest side."""
    a, b, c = (np.asarray(space.points)[space.triangles[:, k]] for k in range(3))
    d, e = b - a, c - a
    twice_area = np.abs(d[:, 0] * e[:, 1] - d[:, 1] * e[:, 0])
    longest = np.maximum(
        np.maximum(np.sum(d * d, axis=1), np.sum(e * e, axis=1)), np.sum((d - e) ** 2, axis=1)
    )
    return float(np.mean(twice_area < THIN * longest))
