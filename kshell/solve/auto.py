"""Which solver for which system: a rule from measurements, kept here with the table it came from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from kshell.errors import InputError, SolveError
from kshell.solve.backends import BACKENDS, Backend, backend_named, installed_backends
from kshell.solve.memory import available_bytes, factorisation_bytes, fits
from kshell.solve.system import PlateSpace

METHODS = ("auto", "direct", "multigrid", *(backend.key for backend in BACKENDS))

# Processor seconds of setup and solution, multigrid / CHOLMOD / PARDISO / SuperLU, one thread, clamped L-shaped
# plate, unstructured mesh (python -m verification.benchmarks.solvers; first uses of libraries included):
#
#   unknowns      Morley                       Argyris
#   1e4           0.14  0.04  1.05  0.06       0.20  0.10  0.72  0.15
#   1e5           0.70  0.76  1.73  1.79       2.6   1.5   2.9   4.4
#   3e5           1.5   1.7   3.5   -          6.6   5.7   7.7   -
#   1e6, 8e5      4.2   5.9   -     -          16    25    -     -
#
# Unknowns from which multigrid is the faster one:
MULTIGRID_FROM = {
    ("morley", "cholmod"): 200_000,
    ("morley", "pardiso"): 60_000,
    ("morley", "superlu"): 40_000,
    ("argyris", "cholmod"): 400_000,
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
    backend = backend_named(method) if named else installed_backends()[0]
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
    if have is None or fits(matrix, backend.key, have):
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
