"""One complex symmetric system for every frequency: (K (1 + i omega tau) + G + i omega d M - omega^2 M) x = f.

SuperLU orders the pattern by minimum degree and takes its pivots on the diagonal, which for such matrices mostly holds;
where corrections by the residual do not become small, it chooses its pivots by size.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.errors import SolveError

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]

# last correction of a solution by its residual, relative, up to which it is believed
BELIEVED = 1e-7
STEPS = 3


def harmonic_solution(
    stiffness: Any,
    mass: Any,
    load: Floats,
    omega: float,
    viscosity: float,
    drag: float,
    geometric: Any = None,
) -> Complexes:
    """(n,) complex amplitudes under a load (n,) at a circular frequency.

    Parameters
    ----------
    stiffness, mass : (n, n) sparse matrices
    viscosity, drag : float
        tau and d.
    geometric : (n, n) sparse matrix, optional
        G, of stresses at rest, which damp nothing.

    Raises
    ------
    SolveError
        If the matrix is singular: an undamped structure in resonance.
    """
    factor = 1.0 + 1j * omega * viscosity if viscosity else 1.0
    inertia = omega**2 - 1j * omega * drag if drag else omega**2
    matrix = stiffness * factor - mass * inertia
    matrix = (matrix if geometric is None else matrix + geometric).tocsc()
    for diagonal in (True, False):
        x = _refined(matrix, load.astype(matrix.dtype), diagonal)
        if x is not None:
            return np.asarray(x, dtype=complex)
    raise SolveError(
        f"no answer at {omega / (2 * np.pi):.6g} Hz: without damping a structure has none in resonance; give "
        "[damping], or another range"
    )


def _refined(matrix: Any, load: Any, diagonal: bool) -> Any:
    """The solution; None where corrections by the residual do not become small."""
    from scipy.sparse.linalg import splu

    options: dict[str, Any] = {"permc_spec": "COLAMD"}
    if diagonal:
        options = {
            "permc_spec": "MMD_AT_PLUS_A",
            "diag_pivot_thresh": 0.0,
            "options": {"SymmetricMode": True},
        }
    try:
        factor = splu(matrix, **options)
    except RuntimeError:  # a pivot is zero
        return None
    x = factor.solve(load)
    for _ in range(STEPS):
        correction = factor.solve(load - matrix @ x)
        x = x + correction
        if np.linalg.norm(correction) <= BELIEVED * np.linalg.norm(x) < np.inf:
            return x
    return None
