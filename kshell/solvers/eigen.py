"""The smallest eigenvalues of K x = lambda M x by Lanczos' method, none missed and none doubled.

M may be singular: unknowns without mass follow the others without inertia. The iteration runs with the operator
(K - sigma M)^-1 M from a start vector in its range, K^-1 M times random numbers, so that no part of the null space of M
ever enters it. Known rigid motions, K R = 0, are taken out of every vector. How many eigenvalues lie below a value tau
in a gap behind the last one is counted by the negative eigenvalues of K - tau M (Sylvester's law of inertia), and
compared with how many were found.

Symbols
-------
K, M     stiffness and mass, sparse and symmetric, M positive semidefinite
R        rigid motions, M-orthonormal
sigma    shift: eigenvalues next to it are found
theta    eigenvalues of the operator, 1 / (lambda - sigma)
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kshell.errors import InputError, SolveError
from kshell.solvers.backends import Singular
from kshell.solvers.eigen_dense import whole
from kshell.solvers.eigenbasis import gap_behind
from kshell.solvers.pencil import Pencil, Spectrum, deflated, finished, massive_unknowns
from kshell.solvers.symmetric import SymmetricFactor, counts, factorise_symmetric

Floats = NDArray[np.float64]

# up to so many unknowns the matrices are solved whole
WHOLE = 300
# eigenvalues found beyond those asked for, where to look for a gap
BEYOND = 3
# attempts to find eigenvalues that the count says are missing
ATTEMPTS = 3
# dimension of the Krylov space, against the eigenvalues wanted: fewest solves on plates and shells
SPACE = 2.5
# relative residual of theta; values are as good as its square, and are sharpened afterwards
CONVERGED = 1e-11
# unknowns from which an order of elimination is worth looking for, and factors are not kept beside others
LARGE = 30_000
NOT_COUNTED = "that none was missed is not checked: "
NO_LIBRARY = "no library here counts eigenvalues of so large a matrix in reasonable time (cvxopt does)"
ROUNDED_AWAY = (
    "the matrix rounds too much for a count of its eigenvalues; triangles may differ too much in size"
)


def smallest(pencil: Pencil, count: int, shift: float | None = None) -> Spectrum:
    """The `count` smallest eigenvalues, or those next to a shift, beside the rigid motions.

    Raises
    ------
    InputError
        If there are not so many.
    SolveError
        If the matrix cannot be factorised, or eigenvalues stay missing.
    """
    available = massive_unknowns(pencil.mass) - pencil.rigid.shape[1]
    if count > available:
        raise InputError(
            f"count = {count}: there are only {available} modes: as many as unknowns that carry mass on this mesh with "
            "these supports; ask for fewer or refine the mesh"
        )
    if pencil.stiffness.shape[0] <= WHOLE or count + BEYOND > available // 2:
        found = whole(pencil)
        if shift is not None:
            near = np.sort(np.argsort(np.abs(found.values - shift), kind="stable")[:count])
            return finished(pencil, found.values[near], found.vectors[:, near], found)
        return finished(pencil, found.values[:count], found.vectors[:, :count], found)
    if shift is not None:
        return _near(pencil, count, shift)
    return _lowest(pencil, count)


def in_range(pencil: Pencil, low: float, high: float, most: int) -> Spectrum:
    """All eigenvalues in [low, high), rigid motions not among them.

    Parameters
    ----------
    most : int
        More of them are refused.

    Raises
    ------
    InputError
        If there are more than `most`.
    SolveError
        If eigenvalues stay missing.
    """
    if pencil.stiffness.shape[0] <= WHOLE:
        found = whole(pencil)
        inside = (found.values >= low) & (found.values < high)
        found.first = int(np.sum(found.values < low))
        return finished(pencil, found.values[inside], found.vectors[:, inside], found)
    rigid = pencil.rigid.shape[1]
    below, until = (_count_below(pencil, value) for value in (low, high))
    if low <= 0.0:
        below = rigid
    if until is None or below is None:
        return _range_uncounted(pencil, low, high, most)
    wanted = until - below
    if wanted > most:
        raise InputError(
            f"range: {wanted} modes lie in it, more than {most}: give a smaller range, or several one after the other"
        )
    if wanted == 0:
        return Spectrum(np.zeros(0), np.zeros((pencil.stiffness.shape[0], 0)), True)
    if below == rigid:
        found = smallest(pencil, wanted)
        inside = (found.values >= low) & (found.values < high)
        found.values, found.vectors = found.values[inside], found.vectors[:, inside]
        return found
    for attempt in range(1, ATTEMPTS + 1):
        found = _near(pencil, wanted + attempt * BEYOND, 0.5 * (low + high), attempt)
        inside = (found.values >= low) & (found.values < high)
        if int(inside.sum()) == wanted:
            found.values, found.vectors, found.checked = found.values[inside], found.vectors[:, inside], True
            found.first = below - rigid
            return found
    raise SolveError(f"range: {wanted} modes lie in it by count, but {int(inside.sum())} were found")


def _range_uncounted(pencil: Pencil, low: float, high: float, most: int) -> Spectrum:
    """More and more eigenvalues around the middle, until some lie on both sides of the range."""
    count = 2 * BEYOND
    while count <= most:
        found = _near(pencil, count, 0.5 * (low + high))
        if found.values[-1] >= high and (found.values[0] < low or low <= 0.0):
            inside = (found.values >= low) & (found.values < high)
            found.first = int(np.sum(found.values < low)) if low <= 0.0 else None
            found.values, found.vectors = found.values[inside], found.vectors[:, inside]
            return found
        count *= 2
    raise InputError(f"range: more than {most // 2} modes lie in or near it: give a smaller range")


def _factor(pencil: Pencil, shift: float, definite: bool) -> SymmetricFactor:
    shifted = pencil.stiffness if shift == 0.0 else (pencil.stiffness - shift * pencil.mass).tocsr()
    try:
        return factorise_symmetric(shifted, definite, order_of(pencil))
    except Singular as error:
        raise SolveError(
            f"the stiffness is singular ({error}): the structure can move freely in a way that its rigid motions do "
            "not say (a mechanism); look for hinges in a row and parts that hang together at a vertex"
        ) from error


def order_of(pencil: Any) -> NDArray[np.integer] | None:
    """An order of elimination of a `Pencil` or `CriticalPencil`, where it is large and not divided."""
    small = pencil.stiffness.shape[0] < LARGE
    if pencil.order is None or small or hasattr(pencil.stiffness, "factorised"):
        return None
    return pencil.order()


def _count_below(pencil: Pencil, value: float) -> int | None:
    """Eigenvalues below a value, rigid motions included; None where no library here counts in reasonable time."""
    if value <= 0.0 and not pencil.rigid.shape[1]:
        return 0
    divided = hasattr(pencil.stiffness, "factorised")  # factors of several processes count
    if not divided and not counts(pencil.stiffness.shape[0]):
        return None
    for nudge in (0.0, 1e-7, -1e-7):  # pivots on the diagonal can vanish by chance
        try:
            tau = value * (1.0 + nudge)
            # nothing here holds the shifted matrix, which is let go when its half is copied
            below = factorise_symmetric(_shifted(pencil, tau), False, order_of(pencil)).count_negative()
        except Singular:
            continue
        if below is not None:
            return below
    return None


def _lowest(pencil: Pencil, count: int) -> Spectrum:
    """The smallest ones, confirmed by a count."""
    factor: SymmetricFactor | None
    sigma, factor = _shift_below(pencil)
    wanted, note, solves = count + BEYOND, "", 0
    for attempt in range(1, ATTEMPTS + 1):
        if factor is None:
            factor = _factor(pencil, sigma, True)
        values, vectors, used = _lanczos(pencil, wanted, sigma, factor, attempt)
        solves += used
        behind = gap_behind(values, count)
        if behind is None:  # the last cluster is not complete
            wanted = 2 * wanted
            note = "the modes around the last one lie so close together that no gap was found behind them"
            continue
        tau = _between(values[behind - 1], values[behind])
        found = _spectrum(values, vectors, factor, sigma, solves)
        large = pencil.stiffness.shape[0] >= LARGE and not hasattr(pencil.stiffness, "factorised")
        if large:
            finished(pencil, values, vectors, found, count)
            found.solve = _solve_again(pencil, sigma)
            factor, vectors = None, found.vectors  # the count needs room for another factor
        below = _count_below(pencil, tau)
        missing = 0 if below is None else below - pencil.rigid.shape[1] - behind
        if missing > 0:
            note = f"{missing} modes are missing by count"
            wanted += 2 * missing + BEYOND
            continue
        found.checked = below is not None and missing == 0
        if missing < 0:
            found.notes.append(
                f"{behind} modes were found up to the last one, a count says {behind + missing}: "
                "rounding in the matrices; look at the modes"
            )
        if below is None:
            found.notes.append(uncounted(pencil.stiffness.shape[0]))
        return found if large else finished(pencil, values, vectors, found, count)
    if "gap" in note and factor is not None:
        found = _spectrum(values, vectors, factor, sigma, solves)
        found.notes.append(f"that none was missed is not checked: {note}")
        return finished(pencil, values, vectors, found, count)
    raise SolveError(
        f"{note} after {ATTEMPTS} attempts: the iteration does not find them; refine or mend the mesh"
    )


def _shifted(pencil: Pencil, value: float) -> Any:
    return (pencil.stiffness - value * pencil.mass).tocsr()


def _near(pencil: Pencil, count: int, shift: float, attempt: int = 1) -> Spectrum:
    """Those next to a shift."""
    factor = _factor(pencil, shift, False)
    values, vectors, used = _lanczos(pencil, count, shift, factor, attempt)
    found = _spectrum(values, vectors, factor, shift, used)
    found.first = None
    return finished(pencil, values, vectors, found)


def _spectrum(
    values: Floats, vectors: Floats, factor: SymmetricFactor, sigma: float, solves: int
) -> Spectrum:
    return Spectrum(values, vectors, solver=factor.name, solves=solves, solve=factor.solve, shift=-sigma)


def _solve_again(pencil: Pencil, sigma: float) -> Callable[[Any], Any]:
    """The solution with K - sigma M, factorised when it is asked for."""
    kept: list[SymmetricFactor] = []

    def solve(rhs: Any) -> Any:
        if not kept:
            kept.append(_factor(pencil, sigma, True))
        return kept[0].solve(rhs)

    return solve


def _shift_below(pencil: Pencil) -> tuple[float, SymmetricFactor]:
    """A shift at or below the spectrum, and its factor: 0 where nothing moves rigidly.

    Otherwise a negative one, of a hundredth to ten times the first eigenvalue in size: smaller ones cost digits, larger
    ones steps. Rayleigh's quotient after two steps of inverse iteration is close to the first eigenvalue.
    """
    if not pencil.rigid.shape[1]:
        return 0.0, _factor(pencil, 0.0, True)
    k, m = pencil.stiffness.diagonal(), pencil.mass.diagonal()
    massive = m > 0
    guess = float(np.min(k[massive] / m[massive])) / massive.sum()
    for _ in range(8):
        factor = _factor(pencil, -guess, True)
        x = _start(pencil, factor, 0)
        for _ in range(2):
            x = deflated(pencil, factor.solve(pencil.mass @ x))
        first = float(x @ (pencil.stiffness @ x)) / float(x @ (pencil.mass @ x))
        if 0.01 * first <= guess <= 10.0 * first:
            break
        guess = 0.3 * first
    return -guess, factor


def _start(pencil: Pencil, factor: SymmetricFactor, seed: int) -> Floats:
    """A vector in the range of the operator: nothing of the null space of M, nothing rigid."""
    random = np.random.default_rng(seed).standard_normal(pencil.stiffness.shape[0])
    return deflated(pencil, factor.solve(pencil.mass @ random))


def _lanczos(
    pencil: Pencil, count: int, sigma: float, factor: SymmetricFactor, seed: int
) -> tuple[Floats, Floats, int]:
    """Values and vectors next to sigma, ascending, and the number of solves."""
    from scipy.sparse.linalg import ArpackError, LinearOperator, eigsh

    size, solves = pencil.stiffness.shape[0], 0
    count = min(count, massive_unknowns(pencil.mass) - pencil.rigid.shape[1] - 1)

    def inverse(b: Floats) -> Floats:
        nonlocal solves
        solves += 1
        return deflated(pencil, factor.solve(np.ravel(b)))

    try:
        values, vectors = eigsh(
            pencil.stiffness,
            count,
            M=pencil.mass,
            sigma=sigma,
            which="LM",
            OPinv=LinearOperator((size, size), matvec=inverse, dtype=float),
            v0=_start(pencil, factor, seed),
            ncv=min(max(int(SPACE * count), 20), size - 1),
            tol=CONVERGED,
        )
    except ArpackError as error:
        raise SolveError(f"the iteration for modes did not end: {error}; ask for fewer modes") from error
    order = np.argsort(values, kind="stable")
    return values[order], vectors[:, order], solves


def uncounted(unknowns: int) -> str:
    """Why nothing was counted, in words."""
    return NOT_COUNTED + (ROUNDED_AWAY if counts(unknowns) else NO_LIBRARY)


def _between(a: float, b: float) -> float:
    """A value in a gap, nearer to its lower end: what lies above is known less well."""
    return a + 0.3 * (b - a)
