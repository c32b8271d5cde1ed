"""Conjugate gradients that stop on an estimate of the energy error, and know when they stall."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from kshell.solvers.system import Floats, Progress

PATIENCE = 50  # iterations without halving the error before giving up
LIMIT = 400
DRIFT = 10.0  # restart if the true residual exceeds the updated one by this factor at the end


@dataclass(frozen=True, eq=False)
class Run:
    """What conjugate gradients reached.

    Attributes
    ----------
    x : (n,) float array
        The best iterate.
    history : tuple of float
        Estimated relative energy error before each iteration and after the last.
    converged : bool
    residual : float
        |b - A x| / |b|.
    """

    x: Floats
    history: tuple[float, ...]
    converged: bool
    residual: float


def conjugate_gradients(
    matrix: Any,
    rhs: Floats,
    precondition: Callable[[Floats], Floats],
    tolerance: float,
    start: Floats | None = None,
    progress: Progress | None = None,
) -> Run:
    """Preconditioned conjugate gradients for one load.

    The error is estimated by sqrt(r.M r / b.x). For a cycle M with the spectrum of M A in (1/2, 1], that is
    within a factor 1.5 of the relative error in the energy norm.

    Parameters
    ----------
    precondition : function
        r -> M r, symmetric and positive definite.
    tolerance : float
        Of the estimated error.
    start : (n,) float array, optional
    """
    x = np.zeros_like(rhs) if start is None else start.copy()
    best, best_error = x.copy(), np.inf
    history: list[float] = []
    size = float(np.linalg.norm(rhs))
    if size == 0.0:
        return Run(np.zeros_like(rhs), (0.0,), True, 0.0)

    last_gain = 0
    while True:  # each pass starts from the true residual
        r = rhs - matrix @ x
        z = precondition(r)
        rz = float(r @ z)
        p = z.copy()
        converged = False
        while True:
            energy = float(rhs @ x)
            error = np.sqrt(max(rz, 0.0) / energy) if energy > 0 else 1.0
            if not np.isfinite(rz):
                error = np.inf
            history.append(float(error))
            if progress is not None:
                progress(len(history) - 1, float(error))
            if error < 0.5 * best_error:
                last_gain = len(history)
            if error < best_error:
                best_error = float(error)
                np.copyto(best, x)
            converged = bool(error <= tolerance)
            stalled = len(history) - last_gain > PATIENCE or len(history) > LIMIT or rz <= 0
            if converged or stalled:
                break
            q = matrix @ p
            alpha = rz / float(p @ q)
            x += alpha * p
            r -= alpha * q
            z = precondition(r)
            new = float(r @ z)
            p *= new / rz
            p += z
            rz = new
        true = rhs - matrix @ (x if converged else best)
        residual = float(np.linalg.norm(true)) / size
        drifted = np.linalg.norm(true) > DRIFT * np.linalg.norm(r)
        if not (converged and drifted) or len(history) > LIMIT:
            break
        best_error, last_gain = np.inf, len(history)
    return Run(x if converged else best, tuple(history), converged, residual)
