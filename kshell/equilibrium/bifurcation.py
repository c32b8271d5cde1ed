"""Linear buckling: the load factors at which the linear solution loses its stiffness, with their motions.

    K phi = -f G phi,

K the stiffness at rest and G the geometric stiffness of the stress of the linear solution at the factor 1. Good where
the shell hardly moves before it buckles; its first motions are the usual shapes of imperfections.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from kshell.equilibrium.linear import solve_linear
from kshell.equilibrium.problem import Problem
from kshell.errors import SolveError

Floats = NDArray[np.float64]

# geometric stiffness, against the elastic one, that is rounding
NO_STRESS = 1e-12
# matrices so small are solved whole
SMALL = 40


class BucklingMode(NamedTuple):
    """One of them.

    Attributes
    ----------
    factor : float
        Of the loads.
    motion : (unknowns,)
        Largest unknown 1 and positive.
    """

    factor: float
    motion: Floats


def buckling_modes(problem: Problem, load: Floats, count: int) -> list[BucklingMode]:
    """The motions with the smallest positive load factors, in their order.

    Parameters
    ----------
    load : (unknowns,)
        All loads at rest, those that turn with the surface too.
    count : int

    Raises
    ------
    SolveError
        If there are fewer, because the loads press nowhere.
    """
    solution = solve_linear(problem.energy, load, problem.reduction, problem.springs, problem.initial)
    rest, memory = np.zeros(problem.energy.unknowns), problem.energy.rest
    stiffness = problem.energy.energy(rest, 2, memory, np.zeros_like(solution.stress)).hessian
    geometric = problem.energy.energy(rest, 2, memory, solution.stress).hessian - stiffness
    if problem.springs is not None:
        stiffness = stiffness + problem.springs
    reduce, basis = problem.reduction.reduce, problem.reduction.basis
    elastic, released = reduce(stiffness), -reduce(geometric)
    if abs(released).max() <= NO_STRESS * abs(elastic).max():
        raise SolveError("no buckling modes: the loads cause no membrane forces")
    values, vectors = _largest(released, elastic, problem.factorise(stiffness).solve, count)
    found = [
        BucklingMode(1.0 / v, _scaled(basis @ q)) for v, q in zip(values, vectors.T, strict=True) if v > 0
    ]
    if len(found) < count:
        raise SolveError(
            f"{len(found)} buckling modes found, not {count}: the loads press too little, or the other way"
        )
    return found


def _largest(
    a: sp.csr_matrix, b: sp.csr_matrix, solve: Callable[[Floats], Floats], count: int
) -> tuple[Floats, Floats]:
    """Largest eigenvalues of a q = v b q, falling, and their vectors."""
    from scipy.linalg import eigh
    from scipy.sparse.linalg import LinearOperator, eigsh

    size = a.shape[0]
    if size <= SMALL + count:
        values, vectors = eigh(a.toarray(), b.toarray())
    else:
        inverse = LinearOperator(a.shape, matvec=solve, dtype=float)
        start = np.random.default_rng(0).normal(size=size)
        values, vectors = eigsh(a, count, M=b, Minv=inverse, which="LA", v0=start)
    order = np.argsort(-values)[:count]
    return values[order], vectors[:, order]


def _scaled(motion: Floats) -> Floats:
    return motion / motion[np.argmax(np.abs(motion))]
