"""Bad input to a solver, found early and named: wrong shapes, NaN, singular matrices, what moves freely."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from kshell.errors import InputError, SolveError
from kshell.solvers.system import Floats, PlateSpace

# A vector x whose energy x.A x falls below this part of x.diag(A) x moves freely, up to rounding. Measured:
# matrices without supports reach 4e-16 at most; the softest regular ones, which grow softer like
# (mesh size / length)^4, stay above 1e-13 up to 4e6 unknowns.
FREE_MOTION = 3e-15
KEPT_START = 1000  # unknowns up to which the start of the search for what moves freely is kept


@dataclass(frozen=True, eq=False)
class FreeMotion:
    """What a `SolveError` about a singular matrix carries: the motion that meets no resistance.

    Attributes
    ----------
    vector : (n,) float array
        In the free unknowns, largest entry 1.
    stiffness : float
        x.A x / x.diag(A) x of that vector.
    words : str
    """

    vector: Floats
    stiffness: float
    words: str


def checked_matrix(matrix: Any) -> Any:
    """The matrix as CSR with sorted indices, after a look at its shape, its entries and its diagonal.

    Raises
    ------
    InputError
        If it is not square, empty, or has entries that are not finite.
    SolveError
        If an unknown has no stiffness at all.
    """
    import scipy.sparse as sp

    a = matrix.tocsr() if sp.issparse(matrix) else sp.csr_matrix(matrix)
    if a.shape[0] != a.shape[1] or a.shape[0] == 0:
        raise InputError(f"the stiffness matrix has the shape {a.shape}: it must be square and not empty")
    if not np.isfinite(a.data).all():
        rows = np.unique(np.repeat(np.arange(a.shape[0]), np.diff(a.indptr))[~np.isfinite(a.data)])
        raise InputError(
            f"the stiffness matrix has entries that are not finite in {len(rows)} rows, first row {rows[0]}: "
            "look for triangles without area and for material constants or thicknesses that are not finite"
        )
    if not a.has_sorted_indices:
        a = a.sorted_indices()
    diagonal = a.diagonal()
    bad = np.flatnonzero(diagonal <= 0.0)
    if len(bad):
        raise SolveError(
            f"the stiffness matrix is not positive definite: {len(bad)} of {len(diagonal)} unknowns have no "
            f"stiffness or a negative one, first unknown {bad[0]} with {diagonal[bad[0]]:g}"
        )
    return a


def checked_rhs(rhs: Floats, unknowns: int) -> Floats:
    """The load as float64, after a look at its shape and entries.

    Raises
    ------
    InputError
        If its length is not the number of unknowns, or an entry is not finite.
    """
    b = np.asarray(rhs, dtype=np.float64)
    if b.ndim not in (1, 2) or b.shape[0] != unknowns:
        raise InputError(f"the load has the shape {b.shape}, the matrix has {unknowns} unknowns")
    if not np.isfinite(b).all():
        bad = np.flatnonzero(~np.isfinite(b).reshape(unknowns, -1).all(axis=1))
        raise InputError(
            f"the load is not finite (NaN or infinite) at {len(bad)} of {unknowns} unknowns, "
            f"first at {bad[0]}: check the expressions and values of the loads"
        )
    return b


def check_tolerance(tolerance: float | None) -> None:
    """Raise InputError unless the tolerance is absent or positive."""
    if tolerance is not None and not tolerance > 0:
        raise InputError(f"the tolerance of the solver is {tolerance:g}: it must be positive")


def _start(count: int) -> Floats:
    """Random numbers (n,), always the same; those of small systems are kept, which take longer to make than to use."""
    return _drawn(count) if count <= KEPT_START else _drawn.__wrapped__(count)


@lru_cache(maxsize=16)
def _drawn(count: int) -> Floats:
    return np.random.default_rng(1).standard_normal(count)


def softest_vector(matrix: Any, solve: Callable[[Floats], Floats]) -> tuple[Floats, float]:
    """One step of inverse iteration from a random vector that is always the same.

    Returns
    -------
    x : (n,) float array
        Close to the softest motion, largest entry 1.
    stiffness : float
        x.A x / x.diag(A) x. Formed with A itself: factorisations perturb it a thousand times more.
    """
    diagonal = matrix.diagonal()
    x = solve(_start(len(diagonal)) * np.sqrt(diagonal))
    if not np.isfinite(x).all():
        raise SolveError(
            "the stiffness matrix is singular: its factorisation gave values that are not finite"
        )
    x = x / np.abs(x).max()
    return x, float((x @ (matrix @ x)) / (x @ (diagonal * x)))


def require_stiff(matrix: Any, solve: Callable[[Floats], Floats], space: PlateSpace | None = None) -> None:
    """Refuse a matrix that lets some motion go free, whatever the load is.

    Raises
    ------
    SolveError
        With the `FreeMotion` as its state.
    """
    x, stiffness = softest_vector(matrix, solve)
    if stiffness < -FREE_MOTION:
        raise SolveError(
            f"the stiffness matrix is not positive definite: a motion has the energy {stiffness:.1e}"
        )
    if not stiffness > FREE_MOTION:
        raise free_motion_error(matrix, x, stiffness, space)


def free_motion_error(
    matrix: Any, vector: Floats, stiffness: float, space: PlateSpace | None = None
) -> SolveError:
    """The error for a matrix that lets ``vector`` go free, naming the part that moves and how."""
    words = describe_motion(matrix, vector, space)
    return SolveError(
        f"the system is singular: {words}. Support that part, or remove it from the mesh",
        state=FreeMotion(vector, stiffness, words),
    )


def describe_motion(matrix: Any, vector: Floats, space: PlateSpace | None = None) -> str:
    """A motion in words: which part of the structure moves, where that is, and whether it turns or shifts."""
    from scipy.sparse.csgraph import connected_components

    parts, label = connected_components(matrix, directed=False)
    size = np.bincount(label, minlength=parts)
    moves = np.zeros(parts)
    np.maximum.at(moves, label, np.abs(vector))
    loose = np.flatnonzero(moves > 1e-3 * moves.max())
    if parts == 1:
        where = "the whole structure"
    else:
        where = f"{len(loose)} of {parts} unconnected parts ({size[loose].sum()} of {size.sum()} unknowns)"
    if space is None:
        return f"{where} can move without any stiffness"

    step = 1 if space.element == "morley" else 6
    moving = np.where(np.isin(label, loose), vector, 0.0)
    w = (space.reduction @ moving)[: step * len(space.points) : step]
    inside = np.abs(space.reduction) @ np.isin(label, loose).astype(float)
    here = np.flatnonzero(inside[: step * len(space.points) : step] > 0)
    if len(here) == 0:
        return f"{where} can move without any stiffness"
    p = space.points[here]
    low, high = p.min(axis=0), p.max(axis=0)
    where += f", vertices from ({low[0]:g}, {low[1]:g}) to ({high[0]:g}, {high[1]:g}),"
    if len(loose) > 1:
        return f"{where} can move freely"
    # the rigid motion nearest to the vector: w = c + a.(x - centre)
    centre, length = p.mean(axis=0), max(float(np.ptp(p, axis=0).max()), 1e-300)
    basis = np.column_stack([np.ones(len(p)), (p - centre) / length])
    fit = np.linalg.lstsq(basis, w[here], rcond=None)[0]
    if np.linalg.norm(basis @ fit - w[here]) > 0.05 * np.linalg.norm(w[here]):
        return f"{where} can move without any stiffness, and not as a rigid body (a mechanism)"
    if np.hypot(fit[1], fit[2]) < 1e-6 * abs(fit[0]):
        return f"{where} can shift along z as a rigid body"
    axis = np.array([fit[2], -fit[1]]) / np.hypot(fit[1], fit[2])
    foot = centre - length * fit[0] * fit[1:] / (fit[1:] @ fit[1:])
    return (
        f"{where} can turn as a rigid body, for instance about the axis through "
        f"({foot[0]:.4g}, {foot[1]:.4g}) with direction ({axis[0]:.3g}, {axis[1]:.3g})"
    )
