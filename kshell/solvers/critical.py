"""The load factors f of smallest size at which K + f G is singular, of either sign.

K is positive definite, G the geometric stiffness of the loads at the factor 1, of any signs. With nu = 1 / f this is
-G x = nu K x, and Lanczos' method in the inner product of K finds the largest nu in size. Between 0 and tau > 0,
in a gap behind the last factor, lie as many factors as K + tau G has negative eigenvalues, and so for tau < 0:
counted where a library counts.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kshell.errors import SolveError
from kshell.solvers.backends import Singular
from kshell.solvers.eigen import (
    ATTEMPTS,
    BEYOND,
    CONVERGED,
    SPACE,
    WHOLE,
    order_of,
    uncounted,
)
from kshell.solvers.eigenbasis import canonical, gap_behind
from kshell.solvers.pencil import Spectrum
from kshell.solvers.symmetric import counts, factorise_symmetric

Floats = NDArray[np.float64]

# nu against the largest that is rounding: motions whose stiffness the loads do not change
UNTOUCHED = 1e-9
# the smallest positive factor is looked for up to so many times the size of those that are known
REACH = 1e3
RESTARTS = 30
SHARP = 1e-7
# entries of G against those of K that are rounding of a state without stress
NO_STRESS = 1e-12


class CriticalPencil(NamedTuple):
    """The matrices of a buckling problem.

    Attributes
    ----------
    stiffness, geometric : (n, n) CSR matrices
        K, positive definite, and G.
    energy : callable or None
        (n, k) vectors X to X^T K X, formed through strains.
    order : callable or None
        Gives an order of elimination (n,) with little fill.
    """

    stiffness: Any
    geometric: Any
    energy: Callable[[Any], Any] | None = None
    order: Callable[[], NDArray[np.integer] | None] | None = None


def factors(pencil: CriticalPencil, count: int) -> Spectrum:
    """The `count` load factors of smallest size, ascending in size, with vectors of x^T K x = 1.

    There are fewer where the loads change the stiffness of fewer motions.

    Raises
    ------
    SolveError
        If the loads cause no stress that changes the stiffness, or K is not positive definite.
    """
    k, g = pencil.stiffness, pencil.geometric
    if k.shape[0] == 0 or abs(g).max() <= NO_STRESS * abs(k).max():
        raise SolveError(
            "no buckling: the loads cause no membrane forces; give loads that press the structure in its surface"
        )
    if k.shape[0] <= WHOLE:
        nu, x = _whole(k, g)
        found = _sorted(pencil, nu, x, count, Spectrum(nu, x, True, "LAPACK"))
        return found
    try:
        factor = factorise_symmetric(k, True, order_of(pencil))
    except Singular as error:
        raise SolveError(f"the stiffness is singular ({error}): the structure can move freely") from error
    if factor.count_negative():
        raise SolveError("the stiffness is not positive definite: it is beyond buckling already")
    wanted, solves, note = count + BEYOND, 0, ""
    for attempt in range(1, ATTEMPTS + 1):
        nu, x, used = _lanczos(k, g, wanted, factor.solve, attempt)
        solves += used
        found = _sorted(pencil, nu, x, wanted, Spectrum(nu, x, False, factor.name, solves))
        behind = gap_behind(np.abs(found.values), min(count, len(found.values)))
        if behind is None:
            wanted *= 2
            note = "the factors around the last one lie so close together that no gap was found behind them"
            continue
        missing = _missing(pencil, found.values, behind)
        if missing is None or missing <= 0:
            found.checked = missing == 0
            if missing is None:
                found.notes.append(uncounted(k.shape[0]))
            elif missing < 0:
                found.notes.append(
                    f"{behind} factors were found up to the last one, a count says {behind + missing}: "
                    "rounding in the matrices; look at the modes"
                )
            break
        note = f"{missing} factors are missing by count"
        wanted += 2 * missing + BEYOND
    else:
        found.notes.append(f"that none was missed is not confirmed: {note}")
    found.values, found.vectors = found.values[:count], found.vectors[:, :count]
    return found


def smallest_positive(pencil: CriticalPencil, known: float) -> float | None:
    """The smallest positive load factor, at most REACH times the size `known` of another one; None where none is found.

    It is the reciprocal of the largest nu, with its sign, and may lie behind any number of negative factors.

    Raises
    ------
    SolveError
        If K is not positive definite.
    """
    from scipy.sparse.linalg import ArpackError, LinearOperator, eigsh

    k, g = pencil.stiffness, pencil.geometric
    if k.shape[0] <= WHOLE:
        nu = _whole(k, g)[0]
    else:
        solve = factorise_symmetric(k, True, order_of(pencil)).solve
        inverse = LinearOperator(k.shape, matvec=lambda b: np.asarray(solve(np.ravel(b))), dtype=float)
        start = inverse @ (g @ np.random.default_rng(1).standard_normal(k.shape[0]))
        try:
            nu, _ = eigsh(-g, 1, M=k, Minv=inverse, which="LA", v0=start, ncv=40, maxiter=RESTARTS, tol=SHARP)
        except ArpackError:  # a cluster at nu = 0: the loads press nowhere
            return None
    largest = float(nu.max())
    return 1.0 / largest if largest * REACH * known > 1.0 else None


def _missing(pencil: CriticalPencil, values: Floats, behind: int) -> int | None:
    """Factors that a count says lie before the gap, less those found there; None where nothing counts."""
    if not counts(pencil.stiffness.shape[0]):
        return None
    inner = abs(values[behind - 1])
    outer = abs(values[behind]) if behind < len(values) else 2.0 * inner
    tau = inner + 0.3 * (outer - inner)
    total = 0
    for sign in (1.0, -1.0):
        try:
            shifted = (pencil.stiffness + sign * tau * pencil.geometric).tocsr()
            definite = not np.any(values[:behind] * sign > 0)
            negative = factorise_symmetric(shifted, definite, order_of(pencil)).count_negative()
        except Singular:
            return None
        if negative is None:
            return None
        total += negative
    return total - behind


def _lanczos(
    k: Any, g: Any, count: int, solve: Callable[[Any], Any], seed: int
) -> tuple[Floats, Floats, int]:
    from scipy.sparse.linalg import ArpackError, LinearOperator, eigsh

    size, solves = k.shape[0], 0
    count = min(count, size - 1)

    def inverse(b: Floats) -> Floats:
        nonlocal solves
        solves += 1
        return np.asarray(solve(np.ravel(b)))

    start = inverse(g @ np.random.default_rng(seed).standard_normal(size))
    try:
        nu, x = eigsh(
            -g,
            count,
            M=k,
            Minv=LinearOperator((size, size), matvec=inverse, dtype=float),
            which="LM",
            v0=start,
            ncv=min(max(int(SPACE * count), 20), size),
            tol=CONVERGED,
        )
    except ArpackError as error:
        raise SolveError(
            f"the iteration for load factors did not end: {error}; ask for fewer of them"
        ) from error
    return nu, x, solves


def _whole(k: Any, g: Any) -> tuple[Floats, Floats]:
    from scipy.linalg import eigh

    try:
        nu, x = eigh(-g.toarray(), k.toarray())
    except np.linalg.LinAlgError as error:
        raise SolveError(
            f"the stiffness is not positive definite ({error}): the structure can move freely"
        ) from error
    return nu, x


def _sorted(pencil: CriticalPencil, nu: Floats, x: Floats, count: int, found: Spectrum) -> Spectrum:
    """Sharpened through strains, in the order of the size of the factors, positive first among equals."""
    from scipy.linalg import eigh

    touched = np.abs(nu) > UNTOUCHED * np.abs(nu).max()
    order = np.argsort(-np.abs(nu[touched]), kind="stable")[: count + BEYOND]
    x = x[:, touched][:, order]
    a = x.T @ (pencil.stiffness @ x) if pencil.energy is None else pencil.energy(x)
    b = x.T @ (pencil.geometric @ x)
    nu, mix = eigh(-0.5 * (b + b.T), 0.5 * (a + a.T))
    values, x = 1.0 / nu, x @ mix
    weight = np.sqrt(pencil.stiffness.diagonal())
    parts = []
    for sign in (1.0, -1.0):
        mine = np.flatnonzero(values * sign > 0)
        mine = mine[np.argsort(np.abs(values[mine]), kind="stable")]
        parts.append((values[mine], canonical(np.abs(values[mine]), x[:, mine], weight)))
    values = np.concatenate([v for v, _ in parts])
    x = np.concatenate([v for _, v in parts], axis=1)
    # sizes equal up to rounding keep the positive factor in front
    order = np.argsort(np.abs(values) * np.where(values > 0, 1.0, 1.0 + UNTOUCHED), kind="stable")[:count]
    found.values, found.vectors = values[order], x[:, order]
    return found
