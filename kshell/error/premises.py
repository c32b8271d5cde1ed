"""What a guaranteed bound rests on, and which of it a plate does not have."""

from __future__ import annotations

import numpy as np

from kshell.errors import InputError
from kshell.plate.forms import AreaSpring, EdgeSpring
from kshell.plate.loading import LOAD_DEGREE, AreaLoad, CurvatureLoad, EdgeLoad, PointLoad
from kshell.plate.problem import PlateProblem

LARGEST_PAIR = 8  # the forces of springs and their correction are integrated exactly up to this order
ARGYRIS_DEGREE = 5  # of a prescribed deflection along an edge


def require_pair(problem: PlateProblem, order: int) -> None:
    """Refuse what a pair of bounds cannot be made for.

    Raises
    ------
    InputError
        For curved edges, elements other than Argyris, and orders that loads and springs are not integrated for.
    """
    if not 1 <= order <= LARGEST_PAIR:
        raise InputError(f"order = {order} of the equilibrated side: it has orders from 1 to {LARGEST_PAIR}")
    if problem.element.maxdeg < 5:
        raise InputError('bounds need a conforming deflection: use element = "argyris"')
    if problem.domain.curves.curved.any():
        raise InputError(
            "bounds of both sides need straight edges and lines: along curved ones the two plates are not the same"
        )


def why_not(problem: PlateProblem, order: int) -> str:
    """The premises that fail, in words; empty if a bound by moments of an order is guaranteed."""
    reasons = []
    if not problem.section.constant_per_triangle:
        reasons.append("the stiffness varies inside triangles")
    for load in problem.loads.forms:
        if isinstance(load, AreaLoad) and not _exact(load.degree, LOAD_DEGREE):
            reasons.append(f"a pressure is not known to be a polynomial of degree {LOAD_DEGREE} at most")
        elif isinstance(load, EdgeLoad):
            limit = order - 1 if load.moment else LOAD_DEGREE
            if not _exact(load.degree, limit):
                kind = "moment" if load.moment else "force"
                reasons.append(f"an edge {kind} is not known to be a polynomial of degree {limit} at most")
        elif isinstance(load, CurvatureLoad) and not _exact(load.degree, LOAD_DEGREE):
            reasons.append(
                f"an initial curvature is not known to be a polynomial of degree {LOAD_DEGREE} at most"
            )
        elif isinstance(load, PointLoad) and np.any(load.total[1:]):
            reasons.append(
                "a moment at a point does work on a slope, which moments of finite energy do not feel"
            )
    for _, spring in problem.supports.springs:
        if isinstance(spring, AreaSpring | EdgeSpring) and spring.degree != 0:
            reasons.append("the stiffness of an elastic support varies")
    limit = min(order, ARGYRIS_DEGREE)
    if any(group.value is not None and not _exact(group.degree, limit) for group in problem.supports.held):
        reasons.append(f"a prescribed deflection is not known to be a polynomial of degree {limit} at most")
    limit = min(order, ARGYRIS_DEGREE) - 1
    if any(
        group.slope is not None and not _exact(group.slope_degree, limit) for group in problem.supports.held
    ):
        reasons.append(f"a prescribed rotation is not known to be a polynomial of degree {limit} at most")
    return "; ".join(dict.fromkeys(reasons))


def _exact(degree: int | None, limit: int) -> bool:
    return degree is not None and degree <= limit
